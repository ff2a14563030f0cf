//! The requests of a client that are under way.

use super::judge::Event;
use super::Request;
use crate::wire::bits::{head, reached};
use crate::wire::link::{Settings, Stream, StreamRow};
use crate::wire::request::Started;
use crate::wire::{Direction, Error};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Idle,
    /// A late reply to a request before may still come.
    Hold,
    /// For the reply.
    Wait,
}

/// Room for a request, and the memory of the one before that may still be answered.
#[derive(Clone, Copy, Debug)]
struct Slot<const N: usize> {
    state: State,
    direction: Direction,
    id: u32,
    sent: u32, // id of the telecommand
    data: [u8; N],
    length: usize,
    repeat: bool,
    reply: Option<u32>,
    attempts: u16,
    until: u32,               // when the state ends by itself
    ticket: Option<u32>,      // its turn to be sent
    was_taken: bool,          // by whoever sends
    late: Option<(u32, u32)>, // id of telemetry that may still come, and until when
}

impl<const N: usize> Slot<N> {
    const EMPTY: Self = Self {
        state: State::Idle,
        direction: Direction::Telecommand,
        id: 0,
        sent: 0,
        data: [0; N],
        length: 0,
        repeat: false,
        reply: None,
        attempts: 0,
        until: 0,
        ticket: None,
        was_taken: false,
        late: None,
    };

    /// The reply may still come, or come again.
    fn remember(&mut self, until: u32) {
        if let (true, Some(reply)) = (self.was_taken, self.reply) {
            self.late = Some((reply, until));
        }
    }

    fn end(&mut self) {
        self.state = State::Idle;
        self.ticket = None;
    }
}

/// As many requests as there is room for.
#[derive(Clone, Debug)]
pub(super) struct Slots<const N: usize, const R: usize> {
    pub(super) settings: Settings,
    rooms: [Slot<N>; R],
    tickets: u32,
}

impl<const N: usize, const R: usize> Slots<N, R> {
    pub(super) const fn new(settings: Settings) -> Self {
        Self {
            settings,
            rooms: [Slot::EMPTY; R],
            tickets: 0,
        }
    }

    pub(super) fn deadline(&self) -> Option<u32> {
        let busy = self.rooms.iter().filter(|slot| slot.state != State::Idle);
        let ends = busy.map(|slot| slot.until);
        ends.reduce(
            |least, until| {
                if reached(until, least) {
                    least
                } else {
                    until
                }
            },
        )
    }

    pub(super) fn start(
        &mut self,
        form: &Stream,
        now: u32,
        request: &Request<'_>,
    ) -> Result<Started, Error> {
        let asks = request.direction == Direction::Telemetry;
        let row = telecommand(form, request)?;
        let reply = match request.reply {
            Some(named) if !asks => {
                form.row(Direction::Telemetry, named)
                    .ok_or(Error::UnknownId { id: named })?;
                Some(named)
            }
            _ => row.reply,
        };
        let held = reply.and_then(|reply| self.late_until(now, reply));
        let timeout = self.settings.reply_timeout_ms;
        let slot = free(&mut self.rooms, reply).ok_or(Error::Busy)?;
        let data = if asks { &[] } else { request.data };
        if data.len() < row.least || data.len() > row.most {
            return Err(Error::Length {
                expected: data.len().clamp(row.least, row.most),
                actual: data.len(),
            });
        }
        let (expected, actual) = (data.len(), N);
        let room = slot.data.get_mut(..data.len());
        room.ok_or(Error::Length { expected, actual })?
            .copy_from_slice(data);
        slot.direction = request.direction;
        slot.id = request.id;
        slot.sent = row.id;
        slot.length = data.len();
        slot.repeat = request.repeat || asks;
        slot.reply = reply;
        slot.attempts = 0;
        slot.was_taken = false;
        if let Some(until) = held {
            slot.state = State::Hold;
            slot.until = until;
        } else {
            transmit(slot, &mut self.tickets, now, timeout);
            if reply.is_none() {
                return Ok(Started::Done);
            }
        }
        Ok(Started::Waiting)
    }

    /// Until when that telemetry may be a late reply to another request.
    fn late_until(&self, now: u32, reply: u32) -> Option<u32> {
        let late = self.rooms.iter().filter_map(|slot| slot.late);
        let late = late.filter(|(id, until)| *id == reply && !reached(now, *until));
        late.map(|(_, until)| until)
            .max_by_key(|until| until.wrapping_sub(now))
    }

    /// Writes the next message to be sent, by `put` with its id and data.
    pub(super) fn output(
        &mut self,
        put: impl FnOnce(u32, &[u8]) -> Result<usize, Error>,
    ) -> Result<Option<usize>, Error> {
        let tickets = self.tickets;
        let queued = self.rooms.iter_mut().filter_map(|slot| {
            let waited = tickets.wrapping_sub(slot.ticket?);
            Some((waited, slot))
        });
        let slot = match queued.max_by_key(|(waited, _)| *waited) {
            Some((_, slot)) => slot,
            None => return Ok(None),
        };
        let size = put(slot.sent, head(&slot.data, slot.length))?;
        slot.ticket = None;
        slot.was_taken = true;
        Ok(Some(size))
    }

    pub(super) fn tick(&mut self, now: u32, on_event: &mut dyn FnMut(Event<'_>)) {
        let timeout = self.settings.reply_timeout_ms;
        for slot in &mut self.rooms {
            slot.late = slot.late.filter(|(_, until)| !reached(now, *until));
            if slot.state == State::Idle || !reached(now, slot.until) {
                continue;
            }
            let is_left = slot.repeat && slot.attempts <= u16::from(self.settings.retries);
            if slot.state == State::Hold || is_left {
                transmit(slot, &mut self.tickets, now, timeout);
                continue;
            }
            slot.end();
            slot.remember(now.wrapping_add(timeout));
            on_event(Event::Timeout {
                direction: slot.direction,
                id: slot.id,
                attempts: slot.attempts,
            });
        }
    }

    /// Telemetry came: the end of a request, or what nobody waits for.
    pub(super) fn found<'a>(&mut self, now: u32, found: Event<'a>) -> Event<'a> {
        let (reply, data, values) = match found {
            Event::Message { id, data, values } => (id, data, values),
            other => return other,
        };
        let awaits = |slot: &&mut Slot<N>| {
            slot.state == State::Wait && slot.was_taken && slot.reply == Some(reply)
        };
        match self.rooms.iter_mut().find(awaits) {
            None => found,
            Some(slot) => {
                slot.end();
                if slot.attempts > 1 {
                    slot.remember(now.wrapping_add(self.settings.reply_timeout_ms));
                }
                Event::Done {
                    direction: slot.direction,
                    id: slot.id,
                    attempts: slot.attempts,
                    reply,
                    data,
                    values,
                }
            }
        }
    }

    /// Gives up requests; None: all.
    pub(super) fn cancel(&mut self, which: Option<(Direction, u32)>) {
        for slot in &mut self.rooms {
            if which.map_or(true, |which| which == (slot.direction, slot.id)) {
                if slot.state != State::Idle {
                    let more = self.settings.reply_timeout_ms;
                    slot.remember(slot.until.wrapping_add(more));
                }
                slot.end();
            }
        }
    }
}

/// Room for a request with that reply; none if another one waits for it.
fn free<const N: usize>(slots: &mut [Slot<N>], reply: Option<u32>) -> Option<&mut Slot<N>> {
    let mut busy = slots.iter().filter(|slot| slot.state != State::Idle);
    if reply.is_some() && busy.any(|slot| slot.reply == reply) {
        return None;
    }
    let mut slots = slots.iter_mut();
    slots.find(|slot| slot.state == State::Idle && slot.ticket.is_none())
}

/// Sends a request, for the first time or again.
fn transmit<const N: usize>(slot: &mut Slot<N>, tickets: &mut u32, now: u32, timeout: u32) {
    slot.attempts = slot.attempts.saturating_add(1);
    if slot.ticket.is_none() {
        slot.ticket = Some(*tickets);
        *tickets = tickets.wrapping_add(1);
    }
    if slot.reply.is_some() {
        slot.state = State::Wait;
        slot.until = now.wrapping_add(timeout);
    }
}

/// The telecommand that is sent.
fn telecommand(form: &Stream, request: &Request<'_>) -> Result<&'static StreamRow, Error> {
    let id = request.id;
    if request.direction == Direction::Telecommand {
        let row = form.row(Direction::Telecommand, id);
        return row.map(|(_, row)| row).ok_or(Error::UnknownId { id });
    }
    let mut rows = form.telecommands.iter();
    let asking = rows.find(|row| row.reply == Some(id) && row.least == 0);
    let is_known = form.row(Direction::Telemetry, id).is_some();
    asking.ok_or(if is_known {
        Error::Unsupported
    } else {
        Error::UnknownId { id }
    })
}
