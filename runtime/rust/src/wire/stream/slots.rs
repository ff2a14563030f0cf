//! The requests of a client, and the responses that may still arrive after their end.

use super::awaited::{Awaited, Needed, Owed};
use super::encoder::{Header, Values};
use super::judge::Event;
use super::sender::Sent;
use super::Request;
use crate::wire::bits::{head, reached};
use crate::wire::link::{
    Content, Response, ResponseKind, Settings, Stream, StreamRow, Verdict, MOST_AWAITED,
};
use crate::wire::{Direction, Error};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Idle,
    /// To be sent.
    Queued,
    /// Nothing responds to it.
    Sent,
    /// For a response.
    Wait,
    /// Before it is sent to a busy device again.
    Pause,
}

/// Room for a request.
#[derive(Clone, Copy, Debug)]
struct Slot<const N: usize> {
    state: State,
    number: u32, // of the request, in the order of their beginning
    direction: Direction,
    id: u32,
    sent: Sent,
    data: [u8; N],
    length: usize,
    repeats: bool, // whether it may be sent again after a time-out
    awaited: Awaited,
    timeout: u32,
    attempts: u16,
    until: u32,  // end of the state
    latest: u32, // until when a response is in time
    limit: u32,  // until when progress extends `latest`
    missing: Needed,
    owed: Owed,
}

impl<const N: usize> Slot<N> {
    const EMPTY: Self = Self {
        state: State::Idle,
        number: 0,
        direction: Direction::Telecommand,
        id: 0,
        sent: Sent::Telecommand(0),
        data: [0; N],
        length: 0,
        repeats: false,
        awaited: Awaited::NOTHING,
        timeout: 0,
        attempts: 0,
        until: 0,
        latest: 0,
        limit: 0,
        missing: Needed::NONE,
        owed: Owed::NONE,
    };

    /// Whether its state ends by itself.
    fn is_timed(&self) -> bool {
        !matches!(self.state, State::Idle | State::Queued)
    }

    /// Whether a response may arrive, also to an earlier attempt.
    fn is_awaited(&self) -> bool {
        self.state == State::Wait || self.owed != Owed::NONE
    }

    /// Whether the device handles it.
    fn is_in_flight(&self) -> bool {
        matches!(self.state, State::Wait | State::Pause)
    }
}

/// Responses that may still arrive although their request has ended.
#[derive(Clone, Copy, Debug)]
struct Late {
    awaited: Awaited,
    owed: Owed,
    until: u32,
}

/// Telemetry or a packet without a message.
struct Arrival<'a> {
    id: u32,
    packet: Option<usize>,
    data: &'a [u8],
    values: &'a Values,
}

impl Arrival<'_> {
    fn kind(&self) -> ResponseKind {
        self.packet
            .map_or(ResponseKind::Telemetry(self.id), ResponseKind::Packet)
    }
}

/// The requests of a client.
#[derive(Clone, Debug)]
pub(super) struct Slots<const N: usize, const R: usize> {
    pub(super) settings: Settings,
    pub(super) form: &'static Stream,
    requests: [Slot<N>; R],
    late: [Option<Late>; MOST_AWAITED],
    begun: u32, // number of requests
    now: u32,   // time of the last call
    gap_end: Option<u32>,
}

impl<const N: usize, const R: usize> Slots<N, R> {
    pub(super) const fn new(form: &'static Stream, settings: Settings) -> Self {
        Self {
            settings,
            form,
            requests: [Slot::EMPTY; R],
            late: [None; MOST_AWAITED],
            begun: 0,
            now: 0,
            gap_end: None,
        }
    }

    pub(super) fn deadline(&self) -> Option<u32> {
        let timed = self.requests.iter().filter(|slot| slot.is_timed());
        let ends = timed.map(|slot| slot.until);
        let is_queued = self.requests.iter().any(|slot| slot.state == State::Queued);
        // It may be possible to send the request then.
        let late = self.late.iter().flatten().map(|late| late.until);
        let chances = self.gap_end.into_iter().chain(late);
        let chances = chances.filter(|end| is_queued && !reached(self.now, *end));
        ends.chain(chances).reduce(earlier)
    }

    pub(super) fn is_full(&self) -> bool {
        self.requests.iter().all(|slot| slot.state != State::Idle)
    }

    pub(super) fn start(&mut self, now: u32, request: &Request<'_>) -> Result<(), Error> {
        let asks = request.direction == Direction::Telemetry;
        let (sent, row) = self.sent_for(request)?;
        let named = request.reply.filter(|_| !asks);
        if let Some(id) = named {
            let known = self.form.row(Direction::Telemetry, id);
            known.ok_or(Error::UnknownId { id })?;
        }
        let mut slots = self.requests.iter_mut();
        let free = slots.find(|slot| slot.state == State::Idle);
        let slot = free.ok_or(Error::Busy)?;
        let (least, most) = match sent {
            Sent::Telecommand(_) => (row.least, row.most),
            Sent::Request(_) => (0, 0), // the encoder knows its data
        };
        let length = if asks { least } else { request.data.len() };
        let expected = length.clamp(least, most);
        let room = slot.data.get_mut(..length);
        let data = room.filter(|_| length == expected).ok_or(Error::Length {
            expected,
            actual: length,
        })?;
        if asks {
            data.fill(0);
        } else {
            data.copy_from_slice(request.data);
        }
        let (exchange, reply) = match sent {
            Sent::Telecommand(_) => (row.exchange, named),
            Sent::Request(id) => (self.form.request.map(|form| form.exchange), Some(id)),
        };
        let exchange = exchange.and_then(|index| self.form.exchanges.get(index));
        let timeout = exchange.map_or(0, |exchange| exchange.timeout_ms);
        let mut awaited = Awaited::new(exchange, reply, row.id, data);
        let answer = reply.and_then(|id| self.form.row(Direction::Telemetry, id));
        awaited.nameless = answer.map(|(_, answer)| answer).filter(|answer| {
            let packet = self.form.packets.get(usize::from(answer.packet));
            packet.map_or(false, |packet| packet.content == Content::Requested)
        });
        *slot = Slot {
            state: State::Queued,
            number: self.begun,
            direction: request.direction,
            id: request.id,
            sent,
            length,
            repeats: asks || request.repeat || row.repeats,
            awaited,
            timeout: match timeout {
                0 => self.settings.reply_timeout_ms,
                _ => timeout,
            },
            data: slot.data,
            ..Slot::EMPTY
        };
        self.begun = self.begun.wrapping_add(1);
        self.set_time(now);
        Ok(())
    }

    /// Return what is sent for a request: its telecommand, or a packet that requests telemetry; and
    /// the message of its id.
    fn sent_for(&self, request: &Request<'_>) -> Result<(Sent, &'static StreamRow), Error> {
        let id = request.id;
        let message = self.form.row(request.direction, id).map(|(_, row)| row);
        if request.direction == Direction::Telecommand {
            let row = message.ok_or(Error::UnknownId { id })?;
            return Ok((Sent::Telecommand(id), row));
        }
        let mut rows = self.form.telecommands.iter();
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

    /// Store the time, and drop responses that can no longer arrive.
    fn set_time(&mut self, now: u32) {
        self.now = now;
        self.gap_end = self.gap_end.filter(|end| !reached(now, *end));
        for late in &mut self.late {
            *late = late.filter(|late| !reached(now, late.until));
        }
    }

    /// Return the place of the oldest request with this property.
    fn oldest(&self, property: impl Fn(&Slot<N>) -> bool) -> Option<usize> {
        let slots = self.requests.iter().enumerate();
        let such = slots.filter(|(_, slot)| property(slot));
        let oldest = such.max_by_key(|(_, slot)| self.begun.wrapping_sub(slot.number));
        oldest.map(|(place, _)| place)
    }

    /// Write the next message to send, by `put` with its data.
    pub(super) fn output(
        &mut self,
        put: impl FnOnce(Sent, &[u8]) -> Result<(usize, Header), Error>,
    ) -> Result<Option<usize>, Error> {
        let place = self.oldest(|slot| slot.state == State::Queued);
        let sent = place.filter(|place| self.may_be_sent(*place));
        let slot = match sent.and_then(|place| self.requests.get_mut(place)) {
            Some(slot) => slot,
            None => return Ok(None),
        };
        let (size, header) = put(slot.sent, head(&slot.data, slot.length))?;
        slot.awaited.set_header(&header);
        let now = self.now;
        slot.attempts = slot.attempts.saturating_add(1);
        slot.missing = slot.awaited.needed();
        slot.owed.add(slot.missing);
        slot.latest = now.wrapping_add(slot.timeout);
        (slot.state, slot.until) = match slot.missing {
            Needed::NONE => (State::Sent, now),
            _ => (State::Wait, slot.latest),
        };
        slot.limit = now.wrapping_add(self.settings.progress_for_ms);
        self.gap_end = Some(now.wrapping_add(self.settings.gap_ms));
        Ok(Some(size))
    }

    /// Return whether the device handles the queued request now, and no response to another request
    /// could be taken for a response to it.
    fn may_be_sent(&self, place: usize) -> bool {
        let slot = match self.requests.get(place) {
            Some(slot) if self.gap_end.map_or(true, |end| reached(self.now, end)) => slot,
            _ => return false,
        };
        let others = self.requests.iter().enumerate();
        let others = others.filter(|(other, _)| *other != place);
        let others = others.map(|(_, other)| other);
        let in_flight = others.clone().filter(|other| other.is_in_flight()).count();
        // Also those that are to be sent again: otherwise one of these and this request could each
        // wait until the other has ended.
        let unfinished = others.filter(|other| other.missing != Needed::NONE);
        let late = self.late.iter().flatten().map(|late| &late.awaited);
        let mut awaited = unfinished.map(|other| &other.awaited).chain(late);
        slot.awaited.is_empty()
            || in_flight < usize::from(self.settings.in_flight)
                && awaited.clone().count() < MOST_AWAITED
                && !awaited.any(|other| slot.awaited.is_like(other))
    }

    pub(super) fn tick(&mut self, now: u32, on_event: &mut dyn FnMut(Event<'_>)) {
        self.set_time(now);
        while let Some(place) = self.oldest(|slot| slot.is_timed() && reached(now, slot.until)) {
            if let Some(event) = self.expire(place) {
                on_event(event);
            }
        }
    }

    /// End the state of a request whose time is up. Return the outcome, if it has one.
    fn expire(&mut self, place: usize) -> Option<Event<'static>> {
        let retries = u16::from(self.settings.retries);
        let slot = self.requests.get_mut(place)?;
        let is_left = slot.repeats && slot.attempts <= retries;
        if slot.state == State::Pause || slot.state == State::Wait && is_left {
            slot.state = State::Queued;
            return None;
        }
        let (direction, id, attempts) = (slot.direction, slot.id, slot.attempts);
        let is_sent = slot.state == State::Sent;
        self.end(place);
        Some(if is_sent {
            Event::Sent {
                direction,
                id,
                attempts,
            }
        } else {
            Event::Timeout {
                direction,
                id,
                attempts,
            }
        })
    }

    /// Return what arrived: a response to a request, late, stray or unsolicited.
    pub(super) fn found<'a>(&mut self, found: Event<'a>) -> Event<'a> {
        let found = self.identified(found);
        let arrival = match found {
            Event::Message { id, data, values } => Arrival {
                id,
                packet: None,
                data,
                values,
            },
            Event::Packet {
                packet,
                id,
                data,
                values,
            } => Arrival {
                id,
                packet: Some(packet),
                data,
                values,
            },
            other => return other,
        };
        let (kind, data) = (arrival.kind(), arrival.data);
        let matches = |awaited: &Awaited| awaited.matching(kind, data);
        let place = self.oldest(|slot| slot.is_awaited() && matches(&slot.awaited).is_some());
        if let Some(place) = place {
            return self.responded(place, &arrival).unwrap_or(found);
        }
        let (id, packet) = (arrival.id, arrival.packet);
        for entry in &mut self.late {
            let response = entry.as_ref().and_then(|late| matches(&late.awaited));
            if let (Some(late), Some(response)) = (entry.as_mut(), response) {
                late.owed.remove(response.verdict_of(data));
                *entry = entry.filter(|late| late.owed != Owed::NONE);
                return Event::Late { id, packet, data };
            }
        }
        if packet.is_some() || self.form.confirming.contains(&id) {
            return Event::Stray { id, packet, data };
        }
        found
    }

    /// Return the telemetry that a packet without its id carries: that of the request whose response
    /// it can be. If it has the length of none, return this error. Return any other event, and the
    /// packet if no response is awaited, unchanged.
    fn identified<'a>(&self, found: Event<'a>) -> Event<'a> {
        let (packet, frame, values) = match found {
            Event::Packet {
                packet,
                data,
                values,
                ..
            } => (packet, data, values),
            _ => return found,
        };
        let packet = self.form.packets.get(packet);
        let packet = match packet.filter(|packet| packet.content == Content::Requested) {
            Some(packet) => packet,
            None => return found,
        };
        let end = frame.len().saturating_sub(packet.trailer_bytes);
        let data = frame.get(packet.header_bytes..end).unwrap_or(&[]);
        let first = self.oldest(|slot| slot.is_awaited() && slot.awaited.nameless.is_some());
        let first = first.and_then(|place| self.requests.get(place));
        let first = first.and_then(|slot| slot.awaited.nameless);
        let late = self.late.iter().flatten();
        let mut rows = first
            .into_iter()
            .chain(late.filter_map(|late| late.awaited.nameless));
        let fits = |row: &&StreamRow| (row.least..=row.most).contains(&data.len());
        match (rows.clone().find(fits), rows.next()) {
            (Some(row), _) => Event::Message {
                id: row.id,
                data,
                values,
            },
            (None, Some(row)) => Event::Length { id: Some(row.id) },
            (None, None) => found,
        }
    }

    /// Process a response to a request.
    fn responded<'a>(&mut self, place: usize, arrival: &Arrival<'a>) -> Option<Event<'a>> {
        let (reply, packet) = (arrival.id, arrival.packet);
        let (data, values) = (arrival.data, arrival.values);
        let (now, settings) = (self.now, self.settings);
        let slot = self.requests.get_mut(place)?;
        let response: Response = slot.awaited.matching(arrival.kind(), data)?;
        let verdict = response.verdict_of(data);
        let code = response.reason.map(|reason| reason.get(data, &[]));
        let (direction, id, attempts) = (slot.direction, slot.id, slot.attempts);
        slot.owed.remove(verdict);
        match verdict {
            Verdict::Progress => {
                let extended = earlier(now.wrapping_add(slot.timeout), slot.limit);
                slot.latest = later(slot.latest, extended);
                if slot.state == State::Wait {
                    slot.until = slot.latest;
                }
            }
            Verdict::Busy if slot.attempts <= u16::from(settings.retries) => {
                slot.state = State::Pause;
                slot.until = now.wrapping_add(settings.busy_pause_ms);
            }
            Verdict::Ack => slot.missing.ack = false,
            Verdict::Reply => slot.missing.reply = false,
            Verdict::Nak | Verdict::Busy => slot.missing = Needed::NONE,
        }
        let is_ended = slot.missing == Needed::NONE;
        if is_ended {
            self.end(place);
        }
        Some(match verdict {
            Verdict::Nak => Event::Refused {
                direction,
                id,
                attempts,
                code,
                reply,
                packet,
                data,
            },
            Verdict::Busy if is_ended => Event::Busy {
                direction,
                id,
                attempts,
                code,
                reply,
                packet,
                data,
            },
            Verdict::Ack | Verdict::Reply if is_ended => Event::Done {
                direction,
                id,
                attempts,
                reply,
                packet,
                data,
                values,
            },
            Verdict::Reply => Event::Reply {
                direction,
                id,
                reply,
                data,
                values,
            },
            Verdict::Ack | Verdict::Busy | Verdict::Progress => Event::Progress {
                direction,
                id,
                reply,
                packet,
                data,
            },
        })
    }

    /// End a request, and remember the responses that may still arrive.
    fn end(&mut self, place: usize) {
        if let Some(slot) = self.requests.get_mut(place) {
            // A response counts from the transmission or from progress, not from the end.
            let until = slot.latest.wrapping_add(self.settings.late_ms);
            let mut entries = self.late.iter_mut();
            if slot.owed != Owed::NONE && !reached(self.now, until) {
                if let Some(free) = entries.find(|late| late.is_none()) {
                    *free = Some(Late {
                        awaited: slot.awaited,
                        owed: slot.owed,
                        until,
                    });
                }
            }
            slot.state = State::Idle;
            slot.missing = Needed::NONE;
            slot.owed = Owed::NONE;
        }
    }

    /// Cancel the requests of a message; None: all.
    pub(super) fn cancel(&mut self, which: Option<(Direction, u32)>) {
        let is_meant = |slot: &Slot<N>| {
            slot.state != State::Idle && which.map_or(true, |it| it == (slot.direction, slot.id))
        };
        while let Some(place) = self.oldest(is_meant) {
            self.end(place);
        }
    }
}

fn earlier(time: u32, other: u32) -> u32 {
    if reached(time, other) {
        other
    } else {
        time
    }
}

fn later(time: u32, other: u32) -> u32 {
    if reached(time, other) {
        time
    } else {
        other
    }
}
