//! The device's half of a framed link: responses to telecommands and to requests.

use super::encoder::{name, Values};
use super::judge::Event;
use super::sender::Sender;
use crate::wire::bits::{head, part};
use crate::wire::link::{
    Exchange, NumberPlace, PacketForm, Response, ResponseKind, Stream, Verdict,
};
use crate::wire::{Direction, Error};

/// Bytes of the id in front of the data, from which places count.
const ID_BYTES: usize = 4;

/// What a device answers to a telecommand, or to a request of telemetry.
#[derive(Debug)]
pub struct Answer<'a> {
    /// What the response says.
    pub verdict: Verdict,
    /// Reason of a refusal. Without one, the number in the data stays as it is; in a packet without
    /// a message it is 0.
    pub reason: Option<u32>,
    /// Buffer into which the response is put. It begins with the data of the telemetry that
    /// responds; `LONGEST` bytes of the module of the node are always enough.
    pub buffer: &'a mut [u8],
    /// Number of these data bytes. Those that are missing are 0.
    pub length: usize,
}

/// A telecommand or a request that the device has received.
#[derive(Clone, Copy)]
struct Received<'a> {
    id: u32,
    data: &'a [u8],
    header: &'a [u8],
    is_request: bool,
}

impl<'a> Received<'a> {
    /// Return what an event says about it; None for an event without an id.
    fn of(event: &Event<'a>) -> Option<Self> {
        let (id, data, header, is_request): (u32, &[u8], _, _) = match *event {
            Event::Message {
                id, data, header, ..
            } => (id, data, header, false),
            Event::Request { id, header, .. } => (id, &[], header, true),
            Event::Checksum {
                id,
                header,
                is_request,
            }
            | Event::UnknownId {
                id,
                header,
                is_request,
            }
            | Event::Length {
                id: Some(id),
                header,
                is_request,
            } => (id, &[], header, is_request),
            _ => return None,
        };
        Some(Self {
            id,
            data,
            header,
            is_request,
        })
    }

    /// Return a number that a response repeats; None if it is in a header that is not known.
    fn number(&self, exchange: &Exchange, source: usize) -> Option<u32> {
        let place = exchange.sources.get(source)?;
        if !exchange.is_in_header(source) {
            return Some(place.get(&self.id.to_be_bytes(), self.data));
        }
        Some(place.get(self.header, &[])).filter(|_| !self.header.is_empty())
    }
}

impl<T, const S: usize> Sender<T, S> {
    /// Encode the response of a device to what it has received, and return the number of bytes
    /// written to `out`. For firmware, simulators and tests of a client; the sender is one of
    /// [`Direction::Telemetry`].
    ///
    /// `received` is an event of the decoder of telecommands: a message or a request; to refuse, also
    /// an unknown id, a wrong length or a wrong checksum with an id. The response repeats the numbers
    /// that the ICD describes as `echo`, and has the status for the verdict: of several values, the
    /// first in the ICD.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD has no response with this verdict, [`Error::Range`] if the
    /// reason does not fit into its field or is the status of another verdict, [`Error::Length`] if a
    /// buffer is too small.
    pub fn respond(
        &mut self,
        received: &Event<'_>,
        answer: &mut Answer<'_>,
        out: &mut [u8],
    ) -> Result<usize, Error> {
        let (verdict, reason) = (answer.verdict, answer.reason);
        let received = Received::of(received).ok_or(Error::Unsupported)?;
        let form = self.form()?;
        let exchange = form.exchange_of(&received, verdict);
        let exchange = exchange.ok_or(Error::Unsupported)?;
        let response = exchange.response_for(verdict);
        let response = response.ok_or(Error::Unsupported)?;
        let mut filling = Filling {
            length: answer.length,
            buffer: &mut *answer.buffer,
        };
        match response.kind {
            ResponseKind::Packet(index) => {
                let packet = form.packets.get(index).ok_or(Error::Unsupported)?;
                filling.begin(packet, self.values)?;
                filling.answer(&received, exchange, response, (verdict, reason))?;
                let (id, values) = filling.values(packet);
                self.put_packet(index, id, &values, out)
            }
            ResponseKind::Telemetry(_) | ResponseKind::Requested => {
                let id = match response.kind {
                    ResponseKind::Telemetry(id) => id,
                    _ => received.id,
                };
                let row = form.row(Direction::Telemetry, id);
                let (_, row) = row.ok_or(Error::Unsupported)?;
                filling.extend(row.least)?;
                filling.answer(&received, exchange, response, (verdict, reason))?;
                let data = filling.buffer.get(..filling.length).unwrap_or(&[]);
                self.put(id, data, out)
            }
        }
    }

    /// Return the framing, if the sender sends telemetry.
    fn form(&self) -> Result<&'static Stream, Error> {
        let form = self.link.stream.as_ref();
        form.filter(|_| self.direction == Direction::Telemetry)
            .ok_or(Error::Unsupported)
    }
}

/// A response that is being filled.
struct Filling<'a> {
    buffer: &'a mut [u8],
    length: usize,
}

impl Filling<'_> {
    /// Append zeros up to a length.
    fn extend(&mut self, length: usize) -> Result<(), Error> {
        let (expected, actual) = (length.max(self.length), self.buffer.len());
        if expected > actual {
            return Err(Error::Length { expected, actual });
        }
        let added = self.buffer.iter_mut().take(expected).skip(self.length);
        added.for_each(|byte| *byte = 0);
        self.length = expected;
        Ok(())
    }

    /// Fill a packet without a message with the values of its sender.
    fn begin(&mut self, packet: &PacketForm, mut values: Values) -> Result<(), Error> {
        self.length = 0;
        self.extend(packet.around() + packet.reserved.len())?;
        for field in packet.fields {
            if let Some(chosen) = values.place(field.role) {
                let behind = self.length.saturating_sub(packet.trailer_bytes);
                let at = if field.in_trailer { behind } else { 0 };
                let value = chosen.unwrap_or_else(|| field.value(Direction::Telemetry));
                if value > field.mask() {
                    return Err(Error::range(name(field.role)));
                }
                field.put(self.buffer.get_mut(at..).unwrap_or(&mut []), value);
            }
        }
        Ok(())
    }

    /// Put what the response repeats, its status and its reason.
    fn answer(
        &mut self,
        received: &Received<'_>,
        exchange: &Exchange,
        response: &Response,
        (verdict, reason): (Verdict, Option<u32>),
    ) -> Result<(), Error> {
        for echo in response.echoes {
            if let Some(number) = received.number(exchange, echo.source) {
                self.put(&echo.place, number)?;
            }
        }
        if let Some(place) = &response.status {
            self.put(place, response.status_for(verdict))?;
        }
        if let (Some(place), Some(reason)) = (&response.reason, reason) {
            self.put(place, reason)?;
            let data = head(self.buffer, self.length);
            let says = match response.verdict_of(data, &[]) {
                Verdict::Again => Verdict::Nak, // a refusal can say that the telecommand was damaged
                says => says,
            };
            if place.get(data, &[]) != reason || says != verdict {
                return Err(Error::range("reason"));
            }
        }
        Ok(())
    }

    fn put(&mut self, place: &NumberPlace, number: u32) -> Result<(), Error> {
        self.extend(place.at + place.size)?;
        place.put(number, self.buffer);
        Ok(())
    }

    /// Return the id of a packet without a message, and its values.
    fn values(&self, packet: &PacketForm) -> (u32, Values) {
        let frame = part(self.buffer, 0, self.length);
        let mut values = Values::default();
        for field in packet.fields {
            if let Some(value) = values.place(field.role) {
                *value = Some(field.get(packet, frame));
            }
        }
        (packet.id(frame).unwrap_or(0), values)
    }
}

impl Stream {
    /// Return the responses to what was received; None without any.
    fn exchange_of(&self, received: &Received<'_>, verdict: Verdict) -> Option<&'static Exchange> {
        if received.is_request {
            return self.exchanges.get(self.request.as_ref()?.exchange);
        }
        match self.row(Direction::Telecommand, received.id) {
            Some((_, row)) => self.exchanges.get(row.exchange?),
            // The node does not have the telecommand.
            None if verdict == Verdict::Nak => {
                let mut exchanges = self.exchanges.iter();
                exchanges.find(|exchange| exchange.refuses_any())
            }
            None => None,
        }
    }
}

impl Exchange {
    fn is_in_header(&self, source: usize) -> bool {
        source >= self.sources.len().saturating_sub(self.in_header)
    }

    /// Return the response that says a verdict; None without one. One that only refuses precedes one
    /// whose status can also refuse.
    fn response_for(&self, verdict: Verdict) -> Option<&'static Response> {
        let (mut listed, mut others) = (self.responses.iter(), self.responses.iter());
        let listed = listed.find(|response| response.says(verdict));
        listed.or_else(|| others.find(|response| response.says_otherwise(verdict)))
    }

    /// Return whether its refusal repeats no part of a telecommand but its id.
    fn refuses_any(&self) -> bool {
        let is_of_id = |source: usize| matches!(self.sources.get(source), Some(at) if at.at + at.size <= ID_BYTES);
        self.response_for(Verdict::Nak).map_or(false, |response| {
            let mut sources = response.echoes.iter().map(|echo| echo.source);
            sources.all(|source| self.is_in_header(source) || is_of_id(source))
        })
    }
}

impl Response {
    /// Return whether a value of the ICD says this verdict; without such values, whether the response
    /// itself says it.
    fn says(&self, verdict: Verdict) -> bool {
        // `Again` is a refusal for a certain reason.
        let meanings = self.meanings.iter().map(|(_, meaning)| *meaning);
        let mut listed = meanings.filter(|meaning| *meaning != Verdict::Again);
        let is_listed = listed.clone().next().is_some();
        listed.any(|meaning| meaning == verdict) || (!is_listed && self.verdict == verdict)
    }

    /// Return whether a value that the ICD does not list says this verdict.
    fn says_otherwise(&self, verdict: Verdict) -> bool {
        let is_left = |place: &NumberPlace| {
            let listed = u64::try_from(self.meanings.len()).unwrap_or(u64::MAX);
            listed <= u64::from(place.mask())
        };
        self.verdict == verdict && self.status.as_ref().map_or(false, is_left)
    }

    /// Return the status that says a verdict: the first of the ICD; otherwise, the smallest number
    /// that the ICD omits.
    fn status_for(&self, verdict: Verdict) -> u32 {
        let mut listed = self.meanings.iter();
        let listed = listed.find(|(_, meaning)| *meaning == verdict);
        let is_free = |status: &u32| self.meanings.iter().all(|(value, _)| value != status);
        listed.map_or_else(
            || (0..=u32::MAX).find(is_free).unwrap_or(0),
            |(value, _)| *value,
        )
    }
}
