//! The line of a framed link.

use super::awaited::Awaited;
use super::line::{with_length, Arrival, ByteTransport, Plan, Sent, Transport};
use super::machine::Machine;
use super::Client;
use crate::wire::link::{Bus, Content, Stream, StreamRow};
use crate::wire::stream::{self, Decoder, Header, Sender, Values};
use crate::wire::{Direction, Error, Event, Linked, Request};

/// The line of a client of a framed link. `N` is the constant `LONGEST` and `S` the constant
/// `SEQUENCES` of the module of the node.
#[derive(Clone, Debug)]
pub struct Line<const N: usize, const S: usize> {
    sender: Sender<(), S>,
    decoder: Decoder<N, S>,
    form: &'static Stream,
}

impl<T, const N: usize, const S: usize, const R: usize> Client<T, Line<N, S>, R> {
    /// Create a client of a framed link with the timeouts and values of the ICD.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD describes no framing, [`Error::Length`] if `N` is too
    /// small.
    pub fn new(link: &'static impl Linked<Node = T>) -> Result<Self, Error> {
        let link = link.link();
        let line = Line {
            sender: Sender::new(link)?,
            decoder: Decoder::with_limit(link, Direction::Telemetry, link.longest)?,
            form: link.stream.as_ref().ok_or(Error::Unsupported)?,
        };
        Self::over(link, line)
    }

    /// Set the header and trailer values of the following messages. `sequence` is the number of the
    /// first message.
    ///
    /// # Errors
    ///
    /// [`Error::Range`] if a value does not fit into its field.
    pub fn set_values(&mut self, values: Values) -> Result<(), Error> {
        values.check(self.line.form)?;
        self.line.sender.values = values;
        Ok(())
    }

    /// Return the number of received bytes that are not part of a message.
    #[must_use]
    pub const fn discarded(&self) -> u64 {
        self.line.decoder.discarded()
    }
}

impl<const N: usize, const S: usize> Transport for Line<N, S> {
    type Buffer = [u8; N];

    const BUS: Option<Bus> = None;

    fn plan(&self, request: &Request<'_>) -> Result<Plan, Error> {
        let form = self.form;
        let (sent, row) = sent_for(form, request)?;
        let asks = request.direction == Direction::Telemetry;
        let named = request.reply.filter(|_| !asks);
        if let Some(id) = named {
            let known = form.row(Direction::Telemetry, id);
            known.ok_or(Error::UnknownId { id })?;
        }
        let (exchange, reply) = match sent {
            Sent::Telecommand(_) => (row.exchange, named),
            Sent::Request(id) => (form.request.map(|form| form.exchange), Some(id)),
        };
        let exchange = exchange.and_then(|index| form.exchanges.get(index));
        let mut awaited = Awaited::new(exchange, reply, row.id);
        let answer = reply.and_then(|id| form.row(Direction::Telemetry, id));
        awaited.nameless = answer.map(|(_, answer)| answer).filter(|answer| {
            let packet = form.packets.get(usize::from(answer.packet));
            packet.map_or(false, |packet| packet.content == Content::Requested)
        });
        let lengths = match sent {
            Sent::Telecommand(_) => (row.least, row.most),
            Sent::Request(_) => (0, 0), // the encoder knows its data
        };
        Ok(Plan {
            sent,
            lengths,
            repeats: row.repeats,
            // If a refusal can say that the checksum was wrong, there is one.
            is_checked: true,
            awaited,
        })
    }
}

impl<const N: usize, const S: usize> ByteTransport for Line<N, S> {
    type Header = Header;

    fn encode(
        &mut self,
        sent: Sent,
        data: &[u8],
        out: &mut [u8],
    ) -> Result<(usize, Header), Error> {
        match sent {
            Sent::Telecommand(id) => self.sender.message(id, data, out),
            Sent::Request(id) => self.sender.request(id, out),
        }
    }

    fn feed<const R: usize>(
        &mut self,
        bytes: &[u8],
        machine: &mut Machine<[u8; N], R>,
        on_event: &mut dyn FnMut(Event<'_>),
    ) {
        let form = self.form;
        self.decoder.feed(bytes, |found| {
            let arrival = arrival(form, machine, &found);
            if let Some(event) = machine.processed(arrival) {
                on_event(event);
            }
        });
    }
}

/// Return what is sent for a request: its telecommand, or a packet that requests telemetry; and
/// the message of its id.
fn sent_for(
    form: &'static Stream,
    request: &Request<'_>,
) -> Result<(Sent, &'static StreamRow), Error> {
    let id = request.id;
    let message = form.row(request.direction, id).map(|(_, row)| row);
    if request.direction == Direction::Telecommand {
        let row = message.ok_or(Error::UnknownId { id })?;
        return Ok((Sent::Telecommand(id), row));
    }
    let mut rows = form.telecommands.iter();
    if let Some(row) = rows.find(|row| row.requests == Some(id)) {
        return Ok((Sent::Telecommand(row.id), row));
    }
    let row = message.ok_or(Error::UnknownId { id })?;
    if row.is_requested {
        Ok((Sent::Request(id), row))
    } else {
        Err(Error::Unsupported)
    }
}

/// Return what an event of the decoder is, or its error.
fn arrival<'a, const N: usize, const R: usize>(
    form: &Stream,
    machine: &Machine<[u8; N], R>,
    found: &stream::Event<'a>,
) -> Result<Arrival<'a>, Event<'a>> {
    let (id, packet, data, values) = match *found {
        stream::Event::Message {
            id, data, values, ..
        } => (id, None, data, values),
        stream::Event::Packet {
            packet,
            id,
            data: frame,
            values,
        } => {
            // A packet without its id has the telemetry of the request whose response it can be.
            let format = form.packets.get(packet);
            let format = format.filter(|format| format.content == Content::Requested);
            let end = |trailer| frame.len().saturating_sub(trailer);
            let part = format.and_then(|it| frame.get(it.header_bytes..end(it.trailer_bytes)));
            let row = part.and_then(|data| with_length(machine.nameless(), data.len()));
            match (row, part) {
                (Some((row, true)), Some(data)) => (row.id, None, data, values),
                (Some((row, false)), _) => return Err(Event::Length { id: Some(row.id) }),
                _ => (id, Some(packet), frame, values),
            }
        }
        stream::Event::Request { id, .. } | stream::Event::UnknownId { id, .. } => {
            return Err(Event::UnknownId { id });
        }
        stream::Event::Gap { id, missing } => return Err(Event::Gap { id, missing }),
        stream::Event::Checksum { id, .. } => return Err(Event::Checksum { id }),
        stream::Event::Length { id, .. } => return Err(Event::Length { id }),
        stream::Event::Overrun => return Err(Event::Overrun),
        stream::Event::Framing => return Err(Event::Framing),
    };
    Ok(Arrival {
        id,
        packet,
        head: &[],
        data,
        values,
        is_response: packet.is_some() || form.confirming.contains(&id),
    })
}
