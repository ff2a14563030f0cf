//! Sender that does not wait for replies.

use super::encoder::{encoded, encoded_request, Header, Values};
use crate::wire::link::{EnvelopeRole, Link};
use crate::wire::{Direction, Error, Linked, TelecommandOf};
use core::marker::PhantomData;

/// What is sent, with its id.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sent {
    Telecommand(u32),
    /// The packet that requests telemetry.
    Request(u32),
}

/// Encodes telecommands of node `T` with header and trailer. `S` is the number of sequence
/// counters: `SEQUENCES` of the module of the node.
///
/// ```
/// use icdgen_runtime::wire::stream::Sender;
/// use icdgen_runtime::wire::{Error, Link};
///
/// fn sent(sender: &mut Sender<(), 1>, id: u32, data: &[u8], port: &mut Vec<u8>) -> Result<(), Error> {
///     let mut line = [0; 600];
///     let size = sender.put(id, data, &mut line)?;
///     port.extend_from_slice(&line[..size]);
///     Ok(())
/// }
/// ```
#[derive(Clone, Debug)]
pub struct Sender<T, const S: usize> {
    /// Values of the header and trailer fields that the sender chooses. `sequence` is the first
    /// number.
    pub values: Values,
    link: &'static Link,
    next: [Option<u32>; S],
    node: PhantomData<fn() -> T>,
}

impl<T, const S: usize> Sender<T, S> {
    /// Create a sender with the values of the ICD.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD describes no framing.
    pub fn new(link: &'static impl Linked<Node = T>) -> Result<Self, Error> {
        let link = link.link();
        if link.stream.is_none() {
            return Err(Error::Unsupported);
        }
        Ok(Self {
            values: Values::default(),
            link,
            next: [None; S],
            node: PhantomData,
        })
    }

    /// Encode a telecommand and return the number of bytes written to `out`.
    ///
    /// # Errors
    ///
    /// See [`Sender::put`]; also [`Error::Range`] if a value does not fit into its field.
    pub fn send<M: TelecommandOf<T>>(
        &mut self,
        message: &M,
        out: &mut [u8],
    ) -> Result<usize, Error> {
        let data = message.to_bytes()?;
        self.put(M::TELECOMMAND_ID, data.as_ref(), out)
    }

    /// Encode a telecommand with these data and return the number of bytes written to `out`.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownId`] if there is no such telecommand, [`Error::Length`] if the data have the
    /// wrong length or `out` is too small, [`Error::Range`] if a header or trailer value does not
    /// fit into its field.
    pub fn put(&mut self, id: u32, data: &[u8], out: &mut [u8]) -> Result<usize, Error> {
        let sent = self.put_packet(Sent::Telecommand(id), data, out);
        sent.map(|(size, _)| size)
    }

    /// Encode a request of the telemetry with this id and return the number of bytes written to
    /// `out`.
    ///
    /// # Errors
    ///
    /// See [`crate::wire::stream::encode_request`].
    pub fn put_request(&mut self, id: u32, out: &mut [u8]) -> Result<usize, Error> {
        let sent = self.put_packet(Sent::Request(id), &[], out);
        sent.map(|(size, _)| size)
    }

    /// Encode a packet with the next sequence number. Return its size and its header.
    pub(super) fn put_packet(
        &mut self,
        sent: Sent,
        data: &[u8],
        out: &mut [u8],
    ) -> Result<(usize, Header), Error> {
        let form = self.link.stream.as_ref().ok_or(Error::Unsupported)?;
        let (place, packet) = match sent {
            Sent::Telecommand(id) => {
                let row = form.row(Direction::Telecommand, id);
                let (place, row) = row.ok_or(Error::UnknownId { id })?;
                (Some(place), usize::from(row.packet))
            }
            Sent::Request(_) => {
                let request = form.request.as_ref().ok_or(Error::Unsupported)?;
                (None, request.packet)
            }
        };
        // Only messages have a counter for each id.
        let key = if form.per_id { place } else { Some(0) };
        let counter = key.and_then(|key| self.next.get_mut(key));
        let mut values = self.values;
        if let Some(Some(next)) = counter {
            values.sequence = Some(*next);
        }
        let written = match sent {
            Sent::Telecommand(id) => {
                encoded(self.link, Direction::Telecommand, id, data, &values, out)
            }
            Sent::Request(id) => encoded_request(self.link, id, &values, out),
        }?;
        let packet = form.packets.get(packet);
        let field = packet.and_then(|packet| packet.field(EnvelopeRole::Sequence));
        if let (Some(field), Some(counter)) = (field, counter) {
            let default = field.value(Direction::Telecommand);
            let number = values.sequence.unwrap_or(default);
            *counter = Some(number.wrapping_add(1) & field.mask());
        }
        Ok(written)
    }
}
