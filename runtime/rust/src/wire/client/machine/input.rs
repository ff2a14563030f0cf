//! What a client does with what comes.

use super::super::super::bits::{number, part};
use super::super::super::{can, i2c, link, uart};
use super::super::super::{Direction, Event};
use super::super::State;
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
        let waiting = (self.state == State::Wait).then_some(self.direction);
        match (uart::kind(self.link, message), waiting) {
            (uart::Kind::Log, _) => return on_event(Event::Log { message }),
            (uart::Kind::Packet, _) => {
                let size = self
                    .link
                    .files
                    .as_ref()
                    .map_or(0, |files| files.counter_bytes);
                let number = number(part(data, 0, size), self.link.little);
                return on_event(Event::Packet {
                    number: u32::try_from(number).unwrap_or(u32::MAX),
                    data: data.get(size..).unwrap_or(&[]),
                });
            }
            (uart::Kind::Reply, Some(Direction::Telemetry)) if id == self.id => {
                return self.replied(now, data, on_event);
            }
            (uart::Kind::Acknowledge, Some(Direction::Telecommand)) => {
                match uart::acknowledged(self.link, message) {
                    Some((id, code)) if id == self.id => {
                        return self.outcome(now, code.into(), None, on_event);
                    }
                    _ => {}
                }
            }
            _ => {}
        }
        let id = Some(id.into());
        on_event(Event::Stray { id, data });
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
            self.done(now, &[], on_event);
        } else {
            self.refused(now, Some(code), parameter, on_event);
        }
    }

    /// What came as the frame: with a checksum where there may be one, without where there need not.
    fn replied(&mut self, now: u32, data: &[u8], on_event: &mut dyn FnMut(Event<'_>)) {
        let id = self.id.into();
        let length = self
            .form(self.direction, self.id)
            .map_or(0, |form| form.length);
        let checksum = self.link.checksum.as_ref();
        let may_have = checksum.filter(|form| form.telemetry_buses.of(self.bus));
        if may_have.map_or(false, |form| data.len() == length + form.bytes) {
            match i2c::reply(self.link, self.id, data, true) {
                Ok(frame) => self.done(now, frame, on_event),
                Err(_) => on_event(Event::Checksum { id }),
            }
        } else if data.len() != length {
            on_event(Event::Malformed { id });
        } else if self.checks_telemetry {
            on_event(Event::Unchecked { id });
        } else {
            self.done(now, data, on_event);
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
        let ours = id == u32::from(self.id) && Some(message.source) == node;
        let waiting = (self.state == State::Wait && ours).then_some(self.direction);
        match (waiting, message.kind) {
            (Some(Direction::Telecommand), can::Kind::Acknowledge) => {
                self.done(now, &[], on_event);
            }
            (Some(Direction::Telecommand), can::Kind::Refusal)
            | (Some(Direction::Telemetry), can::Kind::RequestRefusal) => {
                self.refused(now, None, None, on_event);
            }
            (Some(Direction::Telemetry), can::Kind::Reply) => self.replied(now, data, on_event),
            _ => on_event(Event::Stray { id: Some(id), data }),
        }
    }

    /// What was read in a transaction; `awaited`: it is that of the request.
    pub(in crate::wire::client) fn transferred(
        &mut self,
        now: u32,
        bytes: Option<&[u8]>,
        awaited: bool,
        on_event: &mut dyn FnMut(Event<'_>),
    ) {
        match (self.state, bytes) {
            (State::Poll, None) if awaited => self.again(now, on_event),
            (State::Poll, Some(bytes)) if awaited => self.polled(now, bytes, on_event),
            (State::Wait, None) if awaited => self.no_reply(now, on_event),
            (State::Wait, Some(bytes)) if awaited && self.direction == Direction::Telemetry => {
                let reply = i2c::reply(self.link, self.id, bytes, self.checks_telemetry);
                if let Ok(frame) = reply {
                    self.done(now, frame, on_event);
                } else {
                    let id = self.id.into();
                    on_event(Event::Malformed { id });
                    self.no_reply(now, on_event);
                }
            }
            (State::Wait, Some(_)) if awaited => {
                let form = self.form(self.direction, self.id);
                if form.map_or(true, |form| form.acknowledged) {
                    self.sent_whole = true;
                    self.give_up = now.wrapping_add(self.settings.poll_timeout_ms);
                    self.again(now, on_event);
                } else {
                    self.done(now, &[], on_event);
                }
            }
            _ => {
                let data = bytes.unwrap_or(&[]);
                on_event(Event::Stray { id: None, data });
            }
        }
    }

    /// The acknowledge frame came.
    fn polled(&mut self, now: u32, bytes: &[u8], on_event: &mut dyn FnMut(Event<'_>)) {
        let polled = match &self.link.polled {
            Some(polled) => polled,
            None => return,
        };
        let reply = i2c::reply(self.link, polled.frame, bytes, self.checks_telemetry);
        if let Ok(frame) = reply {
            let found = |place| link::get(place, frame);
            if found(polled.id) != self.id.into() || found(polled.processed) == 0 {
                return self.again(now, on_event);
            }
            let parameter = Some(found(polled.parameter));
            self.outcome(now, found(polled.error), parameter, on_event);
        } else {
            let id = polled.frame.into();
            on_event(Event::Malformed { id });
            self.again(now, on_event);
        }
    }
}
