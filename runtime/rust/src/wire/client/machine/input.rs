//! What a client does with what comes.

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
        match uart::kind(self.link, message) {
            uart::Kind::Log => return on_event(Event::Log { message }),
            uart::Kind::Packet => {
                if let Some(form) = uart::unsolicited(self.link, id) {
                    let id = form.id.into();
                    return on_event(Event::Arrived { id, data });
                }
            }
            uart::Kind::Reply if self.replied(id.into(), data, on_event) => return,
            uart::Kind::Acknowledge => {
                if let Some((id, code)) = uart::acknowledged(self.link, message) {
                    if self.is_response(Direction::Telecommand, id.into()) {
                        return self.outcome(now, code.into(), None, on_event);
                    }
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
            self.done(&[], on_event);
        } else {
            self.refused(now, Some(code), parameter, on_event);
        }
    }

    /// Process telemetry. Return false if no request waits for it.
    fn replied(&mut self, id: u32, data: &[u8], on_event: &mut dyn FnMut(Event<'_>)) -> bool {
        match self.frame(id, data) {
            Ok(frame) => {
                let is_response = self.is_response(Direction::Telemetry, id);
                if is_response {
                    self.done(frame, on_event);
                }
                is_response
            }
            Err(fault) => {
                let waits = self.waits_for(Direction::Telemetry, id);
                if waits {
                    on_event(fault);
                }
                waits
            }
        }
    }

    /// Return the frame in telemetry. Its length shows whether it has a checksum.
    fn frame<'a>(&self, id: u32, data: &'a [u8]) -> Result<&'a [u8], Event<'static>> {
        let octet = u8::try_from(id).unwrap_or(u8::MAX);
        let form = self.form(Direction::Telemetry, octet);
        let length = form.map_or(0, |form| form.length);
        let checksum = self.link.checksum.as_ref();
        let may_have = checksum.filter(|form| form.telemetry_buses.of(self.bus));
        if may_have.map_or(false, |form| data.len() == length + form.bytes) {
            i2c::reply(self.link, octet, data, true).map_err(|_| Event::Checksum { id })
        } else if data.len() != length {
            Err(Event::Malformed { id })
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
        let ours = Some(message.source) == node;
        match message.kind {
            can::Kind::Reply if ours && self.replied(id, data, on_event) => {}
            can::Kind::Acknowledge if ours && self.is_response(Direction::Telecommand, id) => {
                self.done(&[], on_event);
            }
            can::Kind::Refusal if ours && self.is_response(Direction::Telecommand, id) => {
                self.refused(now, None, None, on_event);
            }
            can::Kind::RequestRefusal if ours && self.is_response(Direction::Telemetry, id) => {
                self.refused(now, None, None, on_event);
            }
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
            (State::Wait, None) if awaited => {
                self.owed_responses = 0;
                self.no_reply(now, on_event);
            }
            (State::Wait, Some(bytes)) if awaited && self.direction == Direction::Telemetry => {
                let reply = i2c::reply(self.link, self.id, bytes, self.checks_telemetry);
                if let Ok(frame) = reply {
                    self.done(frame, on_event);
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
                    self.latest = self.give_up;
                    self.again(now, on_event);
                } else {
                    self.done(&[], on_event);
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
