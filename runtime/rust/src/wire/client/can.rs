//! The line of a CAN bus.

use super::bus::{self, Messages};
use super::line::{Arrival, Buffer, Plan, Sent, Transport};
use super::Client;
use crate::wire::bits::part;
use crate::wire::can::{self, Joiner, Kind, Packet, Splitter};
use crate::wire::link::Bus;
use crate::wire::message::octet;
use crate::wire::{Error, Event, Linked, NodeEvent, Request};

/// The line of a client on CAN. `N` is the constant `LONGEST` of the module of the node.
#[derive(Clone, Debug)]
pub struct Line<const N: usize> {
    messages: Messages,
    joiner: Joiner<N, 1>,
    node: u32, // its address
    address: u32,
    message: [u8; N], // of which packets are taken
}

impl<T, const N: usize, const R: usize> Client<T, Line<N>, R> {
    /// Create a client on CAN. `address` is the CAN address of the client, to which the node
    /// replies.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the node is not on this bus, [`Error::Length`] if `N` is too
    /// small.
    pub fn can(link: &'static impl Linked<Node = T>, address: u8) -> Result<Self, Error> {
        let (link, address) = (link.link(), u32::from(address));
        let form = link.can.as_ref().ok_or(Error::Unsupported)?;
        let line = Line {
            messages: Messages::new(link, Bus::Can)?,
            joiner: Joiner::new(link, Some(address))?,
            node: form.node_address.into(),
            address,
            message: Buffer::EMPTY,
        };
        Self::over(link, line)
    }

    /// Enable optional checksums. Checksums that the ICD requires on the bus are always used.
    #[must_use]
    pub fn with_checksums(mut self) -> Self {
        self.line.messages.enable_checksums();
        self
    }

    /// Return the next packet to send; None if there is nothing to send. Its times count from the
    /// `now` of the previous call of another method.
    pub fn output_packet(&mut self) -> Option<Packet> {
        let line = &mut self.line;
        let put = |sent, data: &[u8], taken| line.packet(sent, data, taken);
        self.machine.output_piece(put).ok().flatten()?
    }

    /// Pass a received packet to the client.
    pub fn packet(
        &mut self,
        now: u32,
        packet: &Packet,
        mut on_event: impl FnMut(NodeEvent<'_, T>),
    ) {
        self.tick(now, &mut on_event);
        let (machine, messages) = (&mut self.machine, &self.line.messages);
        let node = self.line.node;
        self.line.joiner.feed(now, packet, |found| {
            let head;
            let event = match found {
                can::Event::Message(message) => {
                    head = [octet(message.id)];
                    machine.processed(arrival(messages, node, &message, &head))
                }
                other => Some(fault(&other)),
            };
            if let Some(event) = event {
                on_event(NodeEvent::new(event));
            }
        });
    }
}

impl<const N: usize> Line<N> {
    /// Return a packet of what is sent for a request, and whether more packets follow.
    fn packet(
        &mut self,
        sent: Sent,
        data: &[u8],
        index: usize,
    ) -> Result<(Option<Packet>, bool), Error> {
        let size = self.messages.write(sent, data, &mut self.message)?;
        let mut packets = self.packets(sent, size)?;
        let packet = packets.nth(index);
        Ok((packet, packets.len() > 0))
    }

    /// Return the packets of the message with this number of bytes.
    fn packets(&self, sent: Sent, size: usize) -> Result<Splitter<'_>, Error> {
        let (kind, id) = match sent {
            Sent::Telecommand(id) => (Kind::Telecommand, id),
            Sent::Request(id) => (Kind::Request, id),
        };
        let message = can::Message {
            kind,
            id,
            source: self.address,
            destination: self.node,
            data: part(&self.message, 1, size.saturating_sub(1)),
        };
        Splitter::new(self.messages.link, &message)
    }
}

impl<const N: usize> Transport for Line<N> {
    type Buffer = [u8; N];

    const BUS: Option<Bus> = Some(Bus::Can);

    fn plan(&self, request: &Request<'_>) -> Result<Plan, Error> {
        let plan = self.messages.plan(request)?;
        let (size, _) = plan.lengths;
        if request.data.len() == size {
            self.packets(plan.sent, self.messages.size(plan.sent, size))?; // does it fit?
        }
        Ok(plan)
    }

    fn expire(&mut self, now: u32, on_event: &mut dyn FnMut(Event<'_>)) {
        self.joiner.expire(now, |found| on_event(fault(&found)));
    }
}

/// Return what a message is, or the event of one that no request can have. `head` is its id as a byte.
fn arrival<'a>(
    messages: &Messages,
    node: u32,
    message: &can::Message<'a>,
    head: &'a [u8],
) -> Result<Arrival<'a>, Event<'a>> {
    let can::Message { id, data, .. } = *message;
    let packet = match message.kind {
        _ if message.source != node => return Err(bus::stray(id, data)),
        Kind::Reply => return messages.telemetry(id, data),
        Kind::Acknowledge => bus::ACKNOWLEDGE,
        Kind::Refusal => bus::REFUSAL,
        Kind::RequestRefusal => bus::REQUEST_REFUSAL,
        Kind::Telecommand | Kind::Request => return Err(bus::stray(id, data)),
    };
    Ok(bus::packet(packet, id, head, data))
}

/// Convert an error event of the joiner.
fn fault(found: &can::Event<'_>) -> Event<'static> {
    match *found {
        can::Event::Message(can::Message { id, .. }) | can::Event::Malformed { id, .. } => {
            Event::Malformed { id }
        }
        can::Event::Duplicate { id, .. } => Event::Duplicate { id },
        can::Event::Incomplete { id, .. } => Event::Incomplete { id },
        can::Event::Busy { id, .. } => Event::Dropped { id },
        can::Event::UnknownType { id, .. } => Event::UnknownType { id },
    }
}
