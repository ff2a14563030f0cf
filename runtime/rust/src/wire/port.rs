//! Clients over the ports of embedded programs, by the traits of `embedded-io`. Feature `embedded-io`.
//!
//! The method `poll` of a client sends pending output, processes received bytes, and returns
//! without waiting. Call it regularly with the current time in milliseconds, which may wrap around.

use super::{bits, ByteLine, Client, Error, NodeEvent};
use core::fmt;
use embedded_io::{Read, ReadReady, Write};

const PIECE: usize = 64; // bytes that are read at once

/// Error of `poll`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PortError<E> {
    /// The port failed.
    Port(E),
    /// The output of the client does not fit into the buffer.
    Wire(Error),
}

impl<E: fmt::Debug> fmt::Display for PortError<E> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Port(error) => write!(out, "the port failed: {error:?}"),
            Self::Wire(error) => error.fmt(out),
        }
    }
}

impl<T, L: ByteLine, const R: usize> Client<T, L, R> {
    /// UART and framed links: process timeouts, send pending output and process received bytes, without waiting. `line` is
    /// a buffer for one encoded message.
    ///
    /// # Errors
    ///
    /// [`PortError::Port`], [`PortError::Wire`] if a message does not fit into `line`; requests
    /// continue unless they are cancelled.
    pub fn poll<P: Read + ReadReady + Write>(
        &mut self,
        now: u32,
        port: &mut P,
        line: &mut [u8],
        mut on_event: impl FnMut(NodeEvent<'_, T>),
    ) -> Result<(), PortError<P::Error>> {
        self.tick(now, &mut on_event);
        let mut is_sent = false;
        while let Some(bytes) = self.output(line).map_err(PortError::Wire)? {
            port.write_all(bytes).map_err(PortError::Port)?;
            is_sent = true;
        }
        if is_sent {
            port.flush().map_err(PortError::Port)?;
        }
        let mut input = [0; PIECE];
        while let Some(bytes) = came(port, &mut input)? {
            self.received(now, bytes, &mut on_event);
        }
        Ok(())
    }
}

/// Return the received bytes; None if there are none.
fn came<'a, P: Read + ReadReady>(
    port: &mut P,
    input: &'a mut [u8; PIECE],
) -> Result<Option<&'a [u8]>, PortError<P::Error>> {
    if !port.read_ready().map_err(PortError::Port)? {
        return Ok(None);
    }
    let count = port.read(input).map_err(PortError::Port)?;
    Ok((count > 0).then(|| bits::head(input, count)))
}
