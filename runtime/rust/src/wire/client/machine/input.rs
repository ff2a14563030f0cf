//! What a client does with what comes.

use super::super::super::message::octet;
use super::super::super::{can, i2c, link, uart};
use super::super::super::{Direction, Error, Event};
use super::super::State;
use super::taken::Transaction;
use super::Machine;

impl<const N: usize> Machine<N> {
    /// A message on the UART.
    pub(in crate::wire::client) fn heard(
        &mut self,
        now: u32,
        message: &[u8],
        on_event: &mut dyn FnMut(Event<'_>),
    ) {
        let (id, data) = match message {
            [id, data @ ..] => (*id, data),
            [] => return,
        };
        let response = Response {
            id: id.into(),
            data,
        };
        match uart::kind(self.link, message) {
            uart::Kind::Log => return on_event(Event::Log { message }),
            uart::Kind::Packet => {
                if let Some(form) = uart::unsolicited(self.link, id) {
                    let id = form.id.into();
                    return on_event(Event::Arrived { id, data });
                }
            }
            uart::Kind::Reply => return self.replied(response, on_event),
            uart::Kind::Acknowledge => {
                if let Some((command, code)) = uart::acknowledged(self.link, message) {
                    if self.waits_for(Direction::Telecommand, command.into()) {
                        return self.outcome(now, code.into(), None, on_event);
                    }
                    let command = command.into();
                    return self.unawaited(Direction::Telecommand, command, response, on_event);
                }
            }
            uart::Kind::Other => {}
        }
        on_event(response.stray());
    }

    /// The node said what became of the telecommand.
    fn outcome(
        &mut self,
        now: u32,
        code: u32,
        parameter: Option<u32>,
        on_event: &mut dyn FnMut(Event<'_>),
    ) {
        if self.link.is_success(code) {
            self.done(&[], on_event);
        } else {
            self.refused(now, Some(code), parameter, on_event);
        }
    }

    /// Process telemetry.
    fn replied(&mut self, reply: Response<'_>, on_event: &mut dyn FnMut(Event<'_>)) {
        let Response { id, data } = reply;
        let length = match u8::try_from(id).ok().and_then(|id| self.link.telemetry(id)) {
            Some(form) => form.length,
            None => return on_event(reply.stray()),
        };
        match self.frame(id, data, length) {
            Err(fault) => on_event(fault),
            Ok(frame) if self.waits_for(Direction::Telemetry, id) => self.done(frame, on_event),
            Ok(data) => {
                self.unawaited(Direction::Telemetry, id, Response { id, data }, on_event);
            }
        }
    }

    /// Report a response that the request does not wait for. `command`: id of its request.
    fn unawaited(
        &mut self,
        direction: Direction,
        command: u32,
        response: Response<'_>,
        on_event: &mut dyn FnMut(Event<'_>),
    ) {
        let Response { id, data } = response;
        on_event(if self.late.count(direction, command) {
            Event::Late { id, data }
        } else {
            response.stray()
        });
    }

    /// Return the frame in telemetry. Its length shows whether it has a checksum.
    fn frame<'a>(
        &self,
        id: u32,
        data: &'a [u8],
        length: usize,
    ) -> Result<&'a [u8], Event<'static>> {
        let checksum = self.link.checksum.as_ref();
        let may_have = checksum.filter(|form| form.telemetry_buses.of(self.bus));
        if may_have.map_or(false, |form| data.len() == length + form.bytes) {
            i2c::reply(self.link, octet(id), data, true).map_err(|_| Event::Checksum { id })
        } else if data.len() != length {
            Err(Event::Length { id })
        } else if self.checks_telemetry {
            Err(Event::Unchecked { id })
        } else {
            Ok(data)
        }
    }

    /// A message on CAN.
    pub(in crate::wire::client) fn joined(
        &mut self,
        now: u32,
        message: &can::Message<'_>,
        on_event: &mut dyn FnMut(Event<'_>),
    ) {
        let can::Message { id, data, .. } = *message;
        let node = self.link.can.as_ref().map(|can| can.node_address.into());
        let response = Response { id, data };
        let direction = match message.kind {
            _ if Some(message.source) != node => return on_event(response.stray()),
            can::Kind::Reply => return self.replied(response, on_event),
            can::Kind::Acknowledge | can::Kind::Refusal => Direction::Telecommand,
            can::Kind::RequestRefusal => Direction::Telemetry,
            _ => return on_event(response.stray()),
        };
        if !self.waits_for(direction, id) {
            self.unawaited(direction, id, response, on_event);
        } else if message.kind == can::Kind::Acknowledge {
            self.done(&[], on_event);
        } else {
            self.refused(now, None, None, on_event);
        }
    }

    /// What was read in the transaction of the request.
    pub(in crate::wire::client) fn transferred(
        &mut self,
        now: u32,
        bytes: Option<&[u8]>,
        on_event: &mut dyn FnMut(Event<'_>),
    ) {
        match (self.state, bytes) {
            (State::Poll, None) => self.again(now, on_event),
            (State::Poll, Some(bytes)) => self.polled(now, bytes, on_event),
            (_, None) => {
                self.owed_responses = 0;
                self.no_reply(now, on_event);
            }
            (_, Some(bytes)) if self.direction == Direction::Telemetry => {
                match self.read_frame(self.id, bytes) {
                    Ok(frame) => self.done(frame, on_event),
                    Err(fault) => {
                        on_event(fault);
                        self.no_reply(now, on_event);
                    }
                }
            }
            (_, Some(_)) => {
                let form = self.form(self.direction, self.id);
                if form.map_or(true, |form| form.acknowledged) {
                    self.sent_whole = true;
                    self.give_up = now.wrapping_add(self.settings.poll_timeout_ms);
                    self.latest = self.give_up;
                    self.again(now, on_event);
                } else {
                    self.ended_sent(on_event);
                }
            }
        }
    }

    /// The result of a transaction that nothing awaits any more.
    pub(in crate::wire::client) fn transferred_late(
        &self,
        transaction: Transaction,
        bytes: Option<&[u8]>,
        on_event: &mut dyn FnMut(Event<'_>),
    ) {
        let id = transaction.id.into();
        let read = bytes.filter(|_| transaction.reads);
        let frame = read.map_or(Ok(&[][..]), |bytes| self.read_frame(transaction.id, bytes));
        on_event(match frame {
            Ok(data) => Event::Late { id, data },
            Err(fault) => fault,
        });
    }

    /// I2C: return the frame in the bytes read.
    fn read_frame<'a>(&self, id: u8, bytes: &'a [u8]) -> Result<&'a [u8], Event<'static>> {
        i2c::reply(self.link, id, bytes, self.checks_telemetry).map_err(|error| {
            let id = id.into();
            match error {
                Error::Checksum { .. } => Event::Checksum { id },
                _ => Event::Length { id },
            }
        })
    }

    /// The acknowledge frame came.
    fn polled(&mut self, now: u32, bytes: &[u8], on_event: &mut dyn FnMut(Event<'_>)) {
        let polled = match &self.link.polled {
            Some(polled) => polled,
            None => return,
        };
        match self.read_frame(polled.frame, bytes) {
            Ok(frame) => {
                let found = |place| link::get(place, frame);
                if found(polled.id) != self.id.into() || found(polled.processed) == 0 {
                    return self.again(now, on_event);
                }
                let parameter = Some(found(polled.parameter));
                self.outcome(now, found(polled.error), parameter, on_event);
            }
            Err(fault) => {
                on_event(fault);
                self.again(now, on_event);
            }
        }
    }
}

/// A response: its id, and the data behind it.
#[derive(Clone, Copy)]
struct Response<'a> {
    id: u32,
    data: &'a [u8],
}

impl<'a> Response<'a> {
    const fn stray(self) -> Event<'a> {
        let (id, data) = (Some(self.id), self.data);
        Event::Stray { id, data }
    }
}
