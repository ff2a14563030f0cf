//! What a client does, whichever way its bytes come and go.

mod input;
mod late;
mod output;
mod taken;

use super::super::bits::reached;
use super::super::event::Event;
use super::super::i2c;
use super::super::link::{Bus, Form, Link, Reason, Settings};
use super::super::request::{Direction, Request, Started};
use super::super::uart::Encoder;
use super::super::Error;
use super::{Output, State};
use late::Late;
use taken::Taken;

/// Bytes of a piece of UART output.
const PIECE: usize = 64;
/// Outputs that wait to be taken.
const QUEUE: usize = 4;

#[derive(Clone, Debug)]
pub(super) struct Machine<const N: usize> {
    pub(super) link: &'static Link,
    pub(super) bus: Bus,
    pub(super) settings: Settings,
    address: u32,
    pub(super) checks_telecommands: bool,
    pub(super) checks_telemetry: bool,
    pub(super) state: State,
    pub(super) until: u32, // when the state ends by itself
    give_up: u32,          // when polling ends
    sent_whole: bool,      // I2C: the telecommand is sent, its acknowledge is polled
    direction: Direction,
    id: u8,
    repeat: bool,
    attempts: u16,
    latest: u32,         // until when a response is in time
    owed_responses: u16, // that may still arrive
    late: Late,
    pub(super) message: [u8; N], // the request, with id and checksum
    pub(super) length: usize,
    poll: [u8; 1],
    pub(super) taken: Taken, // I2C: transactions whose results are missing
    queue: [Option<Output>; QUEUE],
    repeats: u16,            // so often more the first one of the queue is sent
    pub(super) begun: usize, // packets of it that were taken
    pub(super) encoder: Option<Encoder<'static>>,
    pub(super) piece: [u8; PIECE],
}

impl<const N: usize> Machine<N> {
    pub(super) fn new(link: &'static Link, bus: Bus, address: u32) -> Self {
        let poll = link.polled.as_ref().map_or(0, |polled| polled.frame);
        let checksum = link.checksum.as_ref();
        Self {
            link,
            bus,
            settings: link.client,
            address,
            checks_telecommands: checksum.map_or(false, |form| form.telecommand_always.of(bus)),
            checks_telemetry: checksum.map_or(false, |form| form.telemetry_always.of(bus)),
            state: State::Idle,
            until: 0,
            give_up: 0,
            sent_whole: false,
            direction: Direction::Telemetry,
            id: 0,
            repeat: false,
            attempts: 0,
            latest: 0,
            owed_responses: 0,
            late: Late::NONE,
            message: [0; N],
            length: 0,
            poll: [poll],
            taken: Taken::NONE,
            queue: [None; QUEUE],
            repeats: 0,
            begun: 0,
            encoder: None,
            piece: [0; PIECE],
        }
    }

    /// Whether a request is going on, or its output has not been taken.
    pub(super) fn is_busy(&self) -> bool {
        self.state != State::Idle || self.first().is_some()
    }

    fn form(&self, direction: Direction, id: u8) -> Option<&'static Form> {
        match direction {
            Direction::Telecommand => self.link.telecommand(id),
            Direction::Telemetry => self.link.telemetry(id),
        }
    }

    pub(super) fn start(&mut self, now: u32, request: &Request<'_>) -> Result<Started, Error> {
        let id = request.id;
        let form = self.form(request.direction, id);
        let form = form.ok_or_else(|| Error::UnknownId { id: id.into() })?;
        if self.is_busy() {
            return Err(Error::Busy);
        }
        let telecommand = request.direction == Direction::Telecommand;
        let (expected, actual) = (form.length, request.data.len());
        if telecommand && actual != expected {
            return Err(Error::Length { expected, actual });
        }
        let data = if telecommand { request.data } else { &[] };
        let checked = telecommand && self.checks_telecommands;
        self.length = i2c::write(self.link, id, data, checked, &mut self.message)?;
        self.direction = request.direction;
        self.id = id;
        self.repeat = request.repeat || !telecommand || form.repeatable;
        self.attempts = 0;
        self.owed_responses = 0;
        self.send_or_hold(now, &mut |_| {});
        Ok(if self.state == State::Idle {
            Started::Sent
        } else {
            Started::Waiting
        })
    }

    pub(super) fn cancel(&mut self) {
        // Nothing responds to what was not sent.
        self.owed_responses = self.owed_responses.saturating_sub(self.untaken());
        self.drop_output();
        if self.state != State::Idle {
            self.end(0);
        }
    }

    /// I2C: whether the last transaction was taken, and is that of the request.
    pub(super) fn awaits_transfer(&self) -> bool {
        matches!(self.state, State::Wait | State::Poll) && self.first().is_none()
    }

    pub(super) fn tick(&mut self, now: u32, on_event: &mut dyn FnMut(Event<'_>)) {
        self.late.forget(now); // the time may wrap until the next request
        if self.state == State::Idle || !reached(now, self.until) {
            return;
        }
        match self.state {
            State::Idle => {}
            State::Hold => self.send_or_hold(now, on_event),
            State::Pause if reached(now, self.give_up) => self.timeout(on_event),
            State::Pause if self.sent_whole => {
                self.state = State::Poll;
                self.until = now.wrapping_add(self.settings.reply_timeout_ms);
                self.push(Output::Poll);
            }
            State::Pause => self.send(now, on_event),
            State::Poll => self.again(now, on_event),
            State::Wait => self.no_reply(now, on_event),
        }
    }

    /// Send the request, or wait while a late response could be taken for its own.
    fn send_or_hold(&mut self, now: u32, on_event: &mut dyn FnMut(Event<'_>)) {
        self.late.forget(now);
        match self.late.hold(self.direction, self.id) {
            Some(end) => {
                self.state = State::Hold;
                self.until = end;
            }
            None => self.send(now, on_event),
        }
    }

    /// Send the request if the late response has arrived for which it waits.
    pub(super) fn no_longer_held(&mut self, now: u32, on_event: &mut dyn FnMut(Event<'_>)) {
        if self.state == State::Hold {
            self.send_or_hold(now, on_event);
        }
    }

    /// Return whether the request waits for this response.
    fn waits_for(&self, direction: Direction, id: u32) -> bool {
        self.state == State::Wait && self.direction == direction && u32::from(self.id) == id
    }

    /// Sends the request, for the first time or again.
    fn send(&mut self, now: u32, on_event: &mut dyn FnMut(Event<'_>)) {
        self.attempts = self.attempts.saturating_add(1);
        self.sent_whole = false;
        self.state = State::Wait;
        self.until = now.wrapping_add(self.settings.reply_timeout_ms);
        self.latest = self.until;
        self.push(Output::Request);
        let form = self.form(self.direction, self.id);
        let telecommand = self.direction == Direction::Telecommand;
        let answered = !telecommand || form.map_or(true, |form| form.acknowledged);
        if self.bus == Bus::I2c {
            // A transaction brings telemetry itself; only an acknowledge is polled.
            self.owed_responses = u16::from(telecommand && answered);
        } else if answered {
            self.owed_responses = self.owed_responses.saturating_add(1);
        } else {
            self.ended_sent(on_event);
        }
    }

    fn done(&mut self, data: &[u8], on_event: &mut dyn FnMut(Event<'_>)) {
        let (id, attempts) = self.end(1);
        on_event(Event::Done { id, attempts, data });
    }

    /// End a telecommand to which nothing responds.
    fn ended_sent(&mut self, on_event: &mut dyn FnMut(Event<'_>)) {
        let (id, attempts) = self.end(0);
        on_event(Event::Sent { id, attempts });
    }

    fn timeout(&mut self, on_event: &mut dyn FnMut(Event<'_>)) {
        let (id, attempts) = self.end(0);
        on_event(Event::Timeout { id, attempts });
    }

    /// The node refused it. A wrong checksum is no fault of the request: it is sent again.
    fn refused(
        &mut self,
        now: u32,
        code: Option<u32>,
        parameter: Option<u32>,
        on_event: &mut dyn FnMut(Event<'_>),
    ) {
        let reason = code.and_then(|code| self.link.reason(code));
        if reason == Some(Reason::Checksum) && self.checks_telecommands && self.may_repeat() {
            self.owed_responses = self.owed_responses.saturating_sub(1);
            return self.send(now, on_event);
        }
        let (id, attempts) = self.end(1);
        on_event(Event::Refused {
            id,
            attempts,
            code,
            reason,
            parameter,
        });
    }

    const fn may_repeat(&self) -> bool {
        self.attempts <= self.settings.retries as u16
    }

    /// End the request, and remember the responses that may still arrive. They count from the last
    /// transmission. `received`: number of responses that end it.
    fn end(&mut self, received: u16) -> (u8, u16) {
        let responses = self.owed_responses.saturating_sub(received);
        let until = self.latest.wrapping_add(self.settings.late_ms);
        self.late.add(self.direction, self.id, responses, until);
        self.state = State::Idle;
        (self.id, self.attempts)
    }

    /// There was no reply, or none that can be used: once more, or the end.
    fn no_reply(&mut self, now: u32, on_event: &mut dyn FnMut(Event<'_>)) {
        if !self.repeat || !self.may_repeat() {
            self.timeout(on_event);
        } else if self.bus == Bus::I2c {
            // The bus said so at once: give the node some time.
            self.state = State::Pause;
            self.until = now.wrapping_add(self.settings.poll_interval_ms);
            self.give_up = now.wrapping_add(self.settings.poll_timeout_ms);
        } else {
            self.send(now, on_event);
        }
    }

    /// Polls once more after a while.
    fn again(&mut self, now: u32, on_event: &mut dyn FnMut(Event<'_>)) {
        if reached(now, self.give_up) {
            self.timeout(on_event);
        } else {
            self.state = State::Pause;
            self.until = now.wrapping_add(self.settings.poll_interval_ms);
        }
    }
}
