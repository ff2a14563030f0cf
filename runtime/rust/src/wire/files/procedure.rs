//! Common part of all procedures.

use super::super::bits::{head, part_mut, reached};
use super::super::event::Event;
use super::super::link::{Link, Role, Step};
use super::super::links::STEP_BYTES;
use super::super::message::octet;
use super::super::procedure::{self, Sink};
use super::super::request::{Direction, Request};
use super::super::Error;

/// Result of a procedure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum End {
    /// The procedure succeeded.
    Done,
    /// The node rejected a necessary request.
    Refused,
    /// No reply to a necessary request, or a flag did not change in time.
    Timeout,
    /// The node cannot load the block.
    Parameter,
    /// A block has a different length than requested.
    Length,
    /// The file or the list is longer than the ICD allows.
    Limit,
    /// Packets are still missing after the maximum number of rounds.
    Rounds,
    /// The checksum is still wrong after the maximum number of rounds.
    Checksum,
    /// The node reports that the operation failed.
    Error,
}

/// A procedure: returns the next request and processes its outcome.
///
/// ```
/// use icdgen_runtime::wire::files::{End, Procedure};
/// use icdgen_runtime::wire::{Client, Error};
///
/// /// Runs a procedure. `exchange` writes bytes to the port and returns received bytes; `now` is a clock.
/// fn run<T, const N: usize>(
///     client: &mut Client<T, N>,
///     procedure: &mut dyn Procedure,
///     mut exchange: impl FnMut(Option<&[u8]>) -> Vec<u8>,
///     now: impl Fn() -> u32,
/// ) -> Result<End, Error> {
///     loop {
///         while client.advance(now(), procedure)? {}
///         if let Some(end) = procedure.result() {
///             return Ok(end);
///         }
///         let input = exchange(client.output());
///         client.received(now(), &input, |event| procedure.event(now(), &event));
///     }
/// }
/// ```
pub trait Procedure {
    /// Return the next request, each once; None if there is nothing to send. `now` is in
    /// milliseconds.
    fn next(&mut self, now: u32) -> Option<Request<'_>>;

    /// Pass an event of the client to the procedure. Unrelated events are ignored.
    fn event(&mut self, now: u32, event: &Event<'_>);

    /// Return the time in milliseconds at which `next` must be called at the latest; None while a
    /// request is in progress.
    fn deadline(&self) -> Option<u32>;

    /// Return the result; None while the procedure is running.
    fn result(&self) -> Option<End>;
}

/// What became of a request.
#[derive(Clone, Copy, Debug)]
pub enum Answer<'a> {
    Done(&'a [u8]),
    Refused,
    Timeout,
}

/// What comes next.
#[derive(Clone, Copy, Debug)]
enum Want {
    Begin,
    Ask(Direction, u8, usize, bool),
    Wait(u32),
    Nothing,
}

/// What a procedure remembers.
#[derive(Clone, Debug)]
pub struct Core {
    pub now: u32,
    want: Want,
    asked: bool,
    retries: u8,
    damaged: u8, // acknowledges of the request that were
    result: Option<End>,
    data: [u8; STEP_BYTES],
}

impl Core {
    pub(super) const fn new(link: &Link) -> Self {
        Self {
            now: 0,
            want: Want::Begin,
            asked: false,
            retries: link.client.retries,
            damaged: 0,
            result: None,
            data: [0; STEP_BYTES],
        }
    }

    /// Sends the telecommand of a step with values by role; others as a fresh message has them.
    pub(super) fn send(&mut self, step: &Step, repeat: bool, values: &[(Role, u32)]) {
        self.data = [0; STEP_BYTES];
        super::super::bits::copy(&mut self.data, step.fresh);
        for (role, value) in values {
            step.put(*role, *value, &mut self.data);
        }
        self.want = Want::Ask(Direction::Telecommand, step.id, step.fresh.len(), repeat);
    }

    /// Sends a telecommand of so many bytes, all 0 but what is put into `payload`.
    pub(super) fn send_bytes(&mut self, id: u8, length: usize) {
        self.data = [0; STEP_BYTES];
        self.want = Want::Ask(Direction::Telecommand, id, length, true);
    }

    /// Some bytes of the telecommand that is to be sent.
    pub(super) fn payload(&mut self, at: usize, size: usize) -> &mut [u8] {
        part_mut(&mut self.data, at, size)
    }

    pub(super) fn ask(&mut self, id: u8) {
        self.want = Want::Ask(Direction::Telemetry, id, 0, true);
    }

    pub(super) fn wait(&mut self, until: u32) {
        self.want = Want::Wait(until);
    }

    /// Ends a wait.
    pub(super) fn hurry(&mut self) {
        if let Want::Wait(until) = &mut self.want {
            *until = self.now;
        }
    }

    /// Whether the same request is made once more, after a damaged acknowledge.
    fn asks_again(&mut self) -> bool {
        let again = matches!(self.want, Want::Ask(.., true)) && self.damaged < self.retries;
        self.damaged += u8::from(again);
        again
    }

    pub(super) fn end(&mut self, end: End) {
        self.want = Want::Nothing;
        self.result = Some(end);
    }

    /// The frame, or none: then the procedure has ended.
    pub(super) fn frame<'a>(&mut self, answer: Option<Answer<'a>>) -> Option<&'a [u8]> {
        match answer {
            Some(Answer::Done(frame)) => return Some(frame),
            Some(Answer::Refused) => self.end(End::Refused),
            Some(Answer::Timeout) => self.end(End::Timeout),
            None => {}
        }
        None
    }
}

/// Whether a number is one of those that are allowed, of which none stands for all.
pub(super) fn allowed(numbers: &[u8], number: u8, field: &'static str) -> Result<(), Error> {
    // Not `contains`, which indexes for bytes, and Rust 1.63 does not see that it stays in range.
    if !numbers.is_empty() && numbers.iter().all(|one| *one != number) {
        Err(Error::range(field))
    } else {
        Ok(())
    }
}

/// Whether it is a refusal with a code that the ICD does not have: a damaged acknowledge.
const fn is_damaged(event: &Event<'_>) -> bool {
    matches!(
        event,
        Event::Refused {
            code: Some(_),
            reason: None,
            ..
        }
    )
}

/// A procedure as a step machine.
pub trait Run {
    fn core(&self) -> &Core;

    fn core_mut(&mut self) -> &mut Core;

    /// Goes on until there is something to ask or to wait for: at the beginning and after a wait without an answer.
    fn resume(&mut self, answer: Option<Answer<'_>>);

    /// Takes a packet of a file.
    fn packet(&mut self, number: u32, data: &[u8]) {
        let _ = (number, data);
    }
}

impl<T: Run> Procedure for T {
    fn next(&mut self, now: u32) -> Option<Request<'_>> {
        self.core_mut().now = now;
        loop {
            match self.core().want {
                Want::Begin => {}
                Want::Wait(until) if reached(now, until) => {}
                _ => break,
            }
            self.resume(None);
        }
        let core = self.core_mut();
        match core.want {
            Want::Ask(direction, id, length, repeat) if !core.asked => {
                core.asked = true;
                Some(Request {
                    direction,
                    id,
                    data: head(&core.data, length),
                    repeat,
                })
            }
            _ => None,
        }
    }

    fn event(&mut self, now: u32, event: &Event<'_>) {
        self.core_mut().now = now;
        let damaged = is_damaged(event);
        let answer = match event {
            Event::Done { data, .. } => Answer::Done(data),
            Event::Refused { .. } if damaged => Answer::Timeout,
            Event::Refused { .. } => Answer::Refused,
            Event::Timeout { .. } => Answer::Timeout,
            Event::Packet { number, data } => return self.packet(*number, data),
            _ => return,
        };
        let core = self.core_mut();
        if core.asked {
            core.asked = false;
            if damaged && core.asks_again() {
                return;
            }
            core.damaged = 0;
            self.resume(Some(answer));
        }
    }

    fn deadline(&self) -> Option<u32> {
        match self.core().want {
            Want::Wait(until) => Some(until),
            _ => None,
        }
    }

    fn result(&self) -> Option<End> {
        self.core().result
    }
}

/// Procedures of the ICD run in the same way.
impl<S: Sink> Procedure for procedure::Procedure<'_, S> {
    fn next(&mut self, now: u32) -> Option<Request<'_>> {
        let request = procedure::Procedure::next(self, now)?;
        Some(Request {
            direction: request.direction,
            id: octet(request.id),
            data: request.data,
            repeat: request.repeat,
        })
    }

    fn event(&mut self, now: u32, event: &Event<'_>) {
        procedure::Procedure::event(self, now, event);
    }

    fn deadline(&self) -> Option<u32> {
        procedure::Procedure::deadline(self)
    }

    fn result(&self) -> Option<End> {
        procedure::Procedure::result(self).map(|end| match end {
            procedure::End::Done => End::Done,
            procedure::End::Refused | procedure::End::Busy => End::Refused,
            procedure::End::Timeout => End::Timeout,
            procedure::End::Failed => End::Error,
            procedure::End::Length => End::Length,
            procedure::End::Checksum => End::Checksum,
            procedure::End::Rounds => End::Rounds,
            procedure::End::Limit => End::Limit,
        })
    }
}
