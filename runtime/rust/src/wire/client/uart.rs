//! The line of a UART with escape characters.

use super::bus::{self, Messages};
use super::line::{Arrival, Buffer, ByteTransport, Plan, Sent, Transport};
use super::machine::Machine;
use super::Client;
use crate::wire::bits::head;
use crate::wire::link::{Bus, Link};
use crate::wire::stream::Values;
use crate::wire::uart::{self, Decoder, Kind};
use crate::wire::{Error, Event, Linked, Request};

/// The line of a client on the UART. `N` is the constant `LONGEST` of the module of the node.
#[derive(Clone, Debug)]
pub struct Line<const N: usize> {
    pub(super) messages: Messages,
    decoder: Decoder<N>,
}

impl<T, const N: usize, const R: usize> Client<T, Line<N>, R> {
    /// Create a client on the UART with the timeouts of the ICD.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the node is not on this bus, [`Error::Length`] if `N` is too
    /// small.
    pub fn uart(link: &'static impl Linked<Node = T>) -> Result<Self, Error> {
        let link = link.link();
        let line = Line {
            messages: Messages::new(link, Bus::Uart)?,
            decoder: Decoder::with_limit(link, link.longest)?,
        };
        Self::over(link, line)
    }

    /// Enable optional checksums. Checksums that the ICD requires on the bus are always used.
    #[must_use]
    pub fn with_checksums(mut self) -> Self {
        self.line.messages.enable_checksums();
        self
    }
}

impl<const N: usize> Transport for Line<N> {
    type Buffer = [u8; N];

    const BUS: Option<Bus> = Some(Bus::Uart);

    fn plan(&self, request: &Request<'_>) -> Result<Plan, Error> {
        self.messages.plan(request)
    }
}

impl<const N: usize> ByteTransport for Line<N> {
    type Header = [u8; 0];

    fn encode(
        &mut self,
        sent: Sent,
        data: &[u8],
        out: &mut [u8],
    ) -> Result<(usize, [u8; 0]), Error> {
        let mut message = <[u8; N]>::EMPTY;
        let size = self.messages.write(sent, data, &mut message)?;
        let size = uart::encode(self.messages.link, head(&message, size), out)?;
        Ok((size, []))
    }

    fn feed<const R: usize>(
        &mut self,
        bytes: &[u8],
        machine: &mut Machine<[u8; N], R>,
        on_event: &mut dyn FnMut(Event<'_>),
    ) {
        let messages = &self.messages;
        self.decoder.feed(bytes, |found| {
            let event = match found {
                uart::Event::Message(message) => machine.processed(arrival(messages, message)),
                uart::Event::UnexpectedStart => Some(Event::UnexpectedStart),
                uart::Event::ProtocolError => Some(Event::ProtocolError),
                uart::Event::Overrun => Some(Event::Overrun),
                uart::Event::Empty => Some(Event::Empty),
            };
            if let Some(event) = event {
                on_event(event);
            }
        });
    }
}

/// Return what a message is, or the event of one that no request can have.
fn arrival<'a>(messages: &Messages, message: &'a [u8]) -> Result<Arrival<'a>, Event<'a>> {
    let link: &Link = messages.link;
    let (first, data) = match message {
        [first, data @ ..] => (first, data),
        [] => return Err(Event::Empty),
    };
    let id = u32::from(*first);
    match uart::kind(link, message) {
        Kind::Log => Err(Event::Log { message }),
        Kind::Packet => Err(match uart::unsolicited(link, *first) {
            Some(form) => Event::Arrived {
                id: form.id.into(),
                data,
                values: &Values::NONE,
            },
            None => bus::stray(id, data),
        }),
        Kind::Reply => messages.telemetry(id, data),
        Kind::Acknowledge => Ok(bus::packet(
            bus::ACKNOWLEDGE,
            id,
            core::slice::from_ref(first),
            data,
        )),
        Kind::Other => Err(bus::stray(id, data)),
    }
}
