//! Runs the steps of a procedure.

use super::sink::Sink;
use super::tables::{Blocks, Form, Put, Step, Take, Test, Value, MOST_REGISTERS};
use crate::wire::bits::{copy, head, index, part_mut, reached};
use crate::wire::link::Bus;
use crate::wire::links::{ENTRY_BYTES, STEP_BYTES};
use crate::wire::{Direction, Error, Event, Request};

// The registers with a fixed meaning; the next ones are those of the inputs.
pub(super) const BLOCK_OFFSET: usize = 0;
pub(super) const BLOCK_LENGTH: usize = 1;
pub(super) const BLOCK_IS_EMPTY: usize = 2;
pub(super) const PACKET_NUMBER: usize = 3;
pub(super) const PACKET_OFFSET: usize = 4;
const FIRST_INPUT: usize = 5;

/// Result of a procedure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum End {
    /// The procedure succeeded.
    Done,
    /// The node rejected a request.
    Refused,
    /// The device was busy each time a request was sent.
    Busy,
    /// No reply to a request, or the node did not become ready in time.
    Timeout,
    /// The node reports an error.
    Failed,
    /// A block has a different length than requested.
    Length,
    /// The checksum of a block is still wrong after the maximum number of rounds.
    Checksum,
    /// Packets are still missing after the maximum number of rounds.
    Rounds,
    /// The device exceeds a limit of the ICD, or the procedure takes longer than the ICD allows.
    Limit,
}

/// What comes next.
#[derive(Clone, Copy, Debug)]
pub(super) enum Want {
    /// The current step.
    Run,
    /// A request: direction, id, number of data bytes, whether it may be sent again.
    Ask(Direction, u32, usize, bool),
    /// Nothing until this time.
    Wait(u32),
    /// Nothing more.
    Nothing,
}

/// What follows a step.
pub(super) enum Flow {
    /// The next step.
    Next,
    /// The step with this index.
    To(usize),
    /// The same step, after this.
    Stay(Want),
}

/// What follows a step, or the result of the procedure.
pub(super) type Turn = Result<Flow, End>;

/// A procedure: returns the next request and processes its outcome.
///
/// ```
/// use icdgen_runtime::wire::procedure::{End, Procedure, Sink};
/// use icdgen_runtime::wire::{ByteLine, Client, Error};
///
/// /// Runs a procedure. `exchange` writes bytes to the port and returns received bytes; `now` is a clock.
/// fn run<T, S: Sink, L: ByteLine>(
///     client: &mut Client<T, L, 1>,
///     procedure: &mut Procedure<'_, S>,
///     mut exchange: impl FnMut(Option<&[u8]>) -> Vec<u8>,
///     now: impl Fn() -> u32,
/// ) -> Result<End, Error> {
///     loop {
///         while client.advance(now(), procedure)? {}
///         if let Some(end) = procedure.result() {
///             return Ok(end);
///         }
///         let mut line = [0; 600];
///         let input = exchange(client.output(&mut line)?);
///         client.received(now(), &input, |event| procedure.event(now(), &event));
///     }
/// }
/// ```
#[derive(Debug)]
pub struct Procedure<'a, S = ()> {
    engine: Engine<'a>,
    sink: S,
}

impl<'a, S: Sink> Procedure<'a, S> {
    /// Create a procedure. The generated code has a function with the inputs of each one.
    ///
    /// `bytes` are sent. `memory` has room for the packets of a received block, and one bit for
    /// each packet; if it is smaller than a block of the ICD, blocks are smaller.
    ///
    /// # Errors
    ///
    /// [`Error::Range`] if an input has a value that the ICD does not allow, [`Error::TooLong`] if
    /// there are too many bytes, [`Error::Length`] if the memory is too small for a packet.
    pub fn new(
        form: &'static Form,
        inputs: &[Option<u32>],
        bytes: &'a [u8],
        memory: &'a mut [u8],
        sink: S,
    ) -> Result<Self, Error> {
        let engine = Engine::new(form, inputs, bytes, memory)?;
        Ok(Self { engine, sink })
    }
}

impl<S: Sink> Procedure<'_, S> {
    /// Use smaller blocks, of this number of bytes.
    pub fn set_block(&mut self, bytes: u32) {
        self.engine.size = bytes.min(self.engine.size).max(1);
    }

    /// Set the bus of the client; None: a framed link; without this call: the UART.
    /// [`Client::advance`] does so.
    ///
    /// [`Client::advance`]: crate::wire::Client::advance
    pub fn set_bus(&mut self, bus: Option<Bus>) {
        self.engine.bus = bus;
    }

    /// Return the next request, each once; None if there is nothing to send. `now` is in
    /// milliseconds.
    pub fn next(&mut self, now: u32) -> Option<Request<'_>> {
        self.engine.next(now, &mut self.sink)
    }

    /// Pass an event of the client to the procedure. Unrelated events are ignored. Call `next` after
    /// it.
    pub fn event(&mut self, now: u32, event: &Event<'_>) {
        self.engine.event(now, event);
    }

    /// Return the time in milliseconds at which `next` must be called at the latest; None while a
    /// request is in progress.
    #[must_use]
    pub const fn deadline(&self) -> Option<u32> {
        match self.engine.want {
            Want::Wait(until) => Some(until),
            _ => None,
        }
    }

    /// Return the result; None while the procedure is running.
    #[must_use]
    pub const fn result(&self) -> Option<End> {
        self.engine.result
    }

    /// Return the number of bytes transferred, and the total number if it is known.
    #[must_use]
    pub fn progress(&self) -> (u32, Option<u32>) {
        (self.engine.registers[BLOCK_OFFSET], self.engine.total())
    }

    /// Return the output with this register; None until the procedure succeeded.
    #[must_use]
    pub fn output(&self, register: u8) -> Option<u32> {
        let is_done = self.engine.result == Some(End::Done);
        is_done.then(|| self.engine.value(Value::Register(register)))
    }
}

/// The types of generated procedures have this trait, too: clients take both.
impl<'a, S> AsMut<Procedure<'a, S>> for Procedure<'a, S> {
    fn as_mut(&mut self) -> &mut Self {
        self
    }
}

/// What a procedure remembers.
#[derive(Debug)]
pub(super) struct Engine<'a> {
    form: &'static Form,
    bus: Option<Bus>,
    pub(super) registers: [u32; MOST_REGISTERS],
    pub(super) now: u32,
    began: Option<u32>,
    requests: u32,    // that were made
    at: usize,        // index of the step
    is_resumed: bool, // whether the step has made a request or waited
    want: Want,
    is_asked: bool,  // whether the request was returned
    has_reply: bool, // whether the requested telemetry came before the outcome
    damaged: u8,     // acknowledges of the request that were
    result: Option<End>,
    pub(super) data: [u8; STEP_BYTES], // of the telecommand
    count: usize, // messages of a map that are through, or packets that are not requested yet
    until: u32,   // end of a poll
    // Entries.
    frame: [u8; ENTRY_BYTES],
    frame_length: usize,
    last: [u8; ENTRY_BYTES],
    is_zeros: bool,   // all bytes of the last telemetry
    entries: u32,     // passed to the application
    repetitions: u32, // of the last entry
    // Blocks.
    pub(super) blocks: &'static Blocks,
    pub(super) bytes: &'a [u8],     // to send
    pub(super) block: &'a mut [u8], // that is received
    pub(super) there: &'a mut [u8], // a bit for each packet
    pub(super) size: u32,           // largest number of bytes of a block
    pub(super) is_begun: bool,      // the first block
    pub(super) requested: u32,      // bytes of the block
    pub(super) rounds: u32,         // of the block
    pub(super) has_round: bool,     // whether one began since the block began again
    pub(super) missing: usize,      // packets of the block
    pub(super) cursor: usize,       // position of the next packet of the round
    pub(super) last_new: u32,       // when the last new packet arrived
}

impl<'a> Engine<'a> {
    fn new(
        form: &'static Form,
        inputs: &[Option<u32>],
        bytes: &'a [u8],
        memory: &'a mut [u8],
    ) -> Result<Self, Error> {
        let mut registers = [0; MOST_REGISTERS];
        let places = registers.iter_mut().skip(FIRST_INPUT);
        let mut numbers = inputs.iter().copied();
        for (place, input) in places.zip(form.inputs) {
            *place = input.checked(numbers.next().flatten())?;
        }
        let (most, actual) = (form.most_bytes, bytes.len());
        if actual > most {
            return Err(Error::TooLong { most, actual });
        }
        let blocks = form.blocks.as_ref().unwrap_or(&Blocks::NONE);
        let (block, there) = blocks.split(memory);
        let size = blocks.size_in(block, there)?;
        Ok(Self {
            form,
            bus: Some(Bus::Uart),
            registers,
            now: 0,
            began: None,
            requests: 0,
            at: 0,
            is_resumed: false,
            want: Want::Run,
            is_asked: false,
            has_reply: false,
            damaged: 0,
            result: None,
            data: [0; STEP_BYTES],
            count: 0,
            until: 0,
            frame: [0; ENTRY_BYTES],
            frame_length: 0,
            last: [0; ENTRY_BYTES],
            is_zeros: false,
            entries: 0,
            repetitions: 0,
            blocks,
            bytes,
            block,
            there,
            size,
            is_begun: false,
            requested: 0,
            rounds: 0,
            has_round: false,
            missing: 0,
            cursor: 0,
            last_new: 0,
        })
    }

    fn next(&mut self, now: u32, sink: &mut dyn Sink) -> Option<Request<'_>> {
        self.now = now;
        let began = *self.began.get_or_insert(now);
        if self.result.is_none() && now.wrapping_sub(began) > self.form.time_ms {
            self.end(End::Limit);
        }
        loop {
            match self.want {
                Want::Run => {}
                Want::Wait(until) if reached(now, until) => {}
                _ => break,
            }
            self.turn(None, sink);
        }
        match self.want {
            Want::Ask(..) if !self.is_asked && self.requests >= self.form.requests => {
                self.end(End::Limit);
                None
            }
            Want::Ask(direction, id, length, repeat) if !self.is_asked => {
                self.requests += 1;
                self.is_asked = true;
                self.has_reply = false;
                Some(Request {
                    direction,
                    id,
                    data: head(&self.data, length),
                    repeat,
                    reply: None,
                })
            }
            _ => None,
        }
    }

    fn event(&mut self, now: u32, event: &Event<'_>) {
        self.now = now;
        if let Event::Arrived { id, data, .. } = *event {
            return self.arrived(id, data);
        }
        if !self.is_of_request(event) {
            return;
        }
        let mut is_damaged = false;
        let outcome = match *event {
            Event::Reply { data, .. } => {
                self.take(data);
                self.has_reply = true;
                return;
            }
            Event::Done { .. } | Event::Sent { .. } => {
                let data = match *event {
                    Event::Done { data, .. } => data,
                    _ => &[],
                };
                if !self.has_reply {
                    self.take(data);
                }
                Ok(())
            }
            Event::Refused { may_be_damaged, .. } => {
                is_damaged = may_be_damaged;
                Err(if is_damaged {
                    End::Timeout
                } else {
                    End::Refused
                })
            }
            Event::Busy { .. } => Err(End::Busy),
            Event::Timeout { .. } => Err(End::Timeout),
            _ => return,
        };
        self.is_asked = false;
        if is_damaged && self.asks_again() {
            return;
        }
        self.damaged = 0;
        self.turn(Some(outcome), &mut ());
    }

    /// Return whether an event is about the request; a client can have several.
    fn is_of_request(&self, event: &Event<'_>) -> bool {
        match (self.want, event.request()) {
            (Want::Ask(direction, id, ..), Some(request)) => {
                self.is_asked && request == (direction, id)
            }
            _ => false,
        }
    }

    /// Return whether the same request is made once more, after a damaged acknowledge.
    fn asks_again(&mut self) -> bool {
        let repeats = matches!(self.want, Want::Ask(.., true));
        let again = repeats && self.damaged < self.form.retries;
        self.damaged += u8::from(again);
        again
    }

    fn end(&mut self, end: End) {
        self.want = Want::Nothing;
        self.is_asked = false;
        self.result = Some(end);
    }

    /// Run the current step. `outcome`: of its request.
    fn turn(&mut self, outcome: Option<Result<(), End>>, sink: &mut dyn Sink) {
        let step = match self.form.steps.get(self.at) {
            Some(step) => step,
            None => return self.end(End::Done),
        };
        let (at, want) = match self.step(step, outcome, sink) {
            Ok(Flow::Next) => (self.at + 1, Want::Run),
            Ok(Flow::To(at)) => (at, Want::Run),
            Ok(Flow::Stay(want)) => (self.at, want),
            Err(end) => return self.end(end),
        };
        self.is_resumed = !matches!(want, Want::Run);
        self.at = at;
        self.want = want;
    }

    fn step(&mut self, step: &Step, outcome: Option<Result<(), End>>, sink: &mut dyn Sink) -> Turn {
        match *step {
            Step::Send {
                ignores_timeout: true,
                ..
            } if outcome == Some(Err(End::Timeout)) => Ok(Flow::Next),
            Step::Send { .. } | Step::Get { .. } if outcome.is_some() => {
                outcome.unwrap_or(Ok(())).map(|()| Flow::Next)
            }
            Step::Send {
                id,
                data,
                puts,
                packet_at,
                repeats,
                ..
            } => {
                copy(&mut self.data, data);
                self.put_packet(packet_at);
                self.put(puts);
                let want = Want::Ask(Direction::Telecommand, id, data.len(), repeats);
                Ok(Flow::Stay(want))
            }
            Step::Get { id, .. } => Ok(ask(id)),
            Step::Poll {
                id,
                until,
                fails,
                interval_ms,
                timeout_ms,
                ..
            } => {
                if !self.is_resumed {
                    self.until = self.now.wrapping_add(timeout_ms);
                }
                match outcome {
                    Some(outcome) => outcome?,
                    None => return Ok(ask(id)),
                }
                if fails.iter().any(|test| self.holds(test)) {
                    Err(End::Failed)
                } else if until.iter().all(|test| self.holds(test)) {
                    Ok(Flow::Next)
                } else if reached(self.now, self.until) {
                    Err(End::Timeout)
                } else {
                    Ok(Flow::Stay(Want::Wait(self.now.wrapping_add(interval_ms))))
                }
            }
            Step::SendMap => self.exchange_map(true, outcome),
            Step::GetMap => self.exchange_map(false, outcome),
            Step::Receive {
                id,
                silence_ms,
                requested_on,
                ..
            } => Ok(if requested_on.of(self.bus.unwrap_or(Bus::Uart)) {
                self.request_packets(id)
            } else {
                self.await_packets(silence_ms)
            }),
            Step::NextBlock { to } => Ok(self.next_block(to, sink)),
            Step::SetLength(value) => self.set_length(self.value(value)),
            Step::NextRound { to } => self.next_round(to),
            Step::NextPacket { to } => Ok(self.next_packet(to)),
            Step::PacketDone => {
                self.mark(self.cursor.wrapping_sub(1), true);
                Ok(Flow::Next)
            }
            Step::VerifyChecksum {
                algorithm,
                of_block,
                covers_fill,
                value,
                again,
            } => {
                let is_right = self.checksum(algorithm, of_block, covers_fill) == self.value(value);
                self.verified(is_right, again, End::Checksum)
            }
            Step::Verify { test, again } => self.verified(self.holds(&test), again, End::Failed),
            Step::Collect => self.collect(sink),
            Step::EndIfZeros if self.is_zeros => Err(End::Done),
            Step::EndIfZeros => Ok(Flow::Next),
            Step::SkipUnless { test, .. } if self.holds(&test) => Ok(Flow::Next),
            Step::SkipUnless { to, .. } | Step::Jump { to } => Ok(Flow::To(to)),
        }
    }

    pub(super) fn value(&self, value: Value) -> u32 {
        match value {
            Value::Constant(number) => number,
            Value::Register(register) => {
                let found = self.registers.get(usize::from(register));
                found.copied().unwrap_or(0)
            }
        }
    }

    fn holds(&self, test: &Test) -> bool {
        self.value(Value::Register(test.register)) == self.value(test.value)
    }

    fn put(&mut self, puts: &[Put]) {
        for put in puts {
            put.place.put(self.value(put.value), &mut self.data);
        }
    }

    /// Put the bytes of the selected packet.
    fn put_packet(&mut self, packet_at: Option<usize>) {
        if let Some(at) = packet_at {
            let place = part_mut(&mut self.data, at, self.blocks.packet_bytes);
            place.fill(self.blocks.fill);
            let end = self.registers[BLOCK_OFFSET].wrapping_add(self.registers[BLOCK_LENGTH]);
            let size = end.wrapping_sub(self.registers[PACKET_OFFSET]);
            let rest = self.bytes.get(index(self.registers[PACKET_OFFSET])..);
            copy(place, head(rest.unwrap_or(&[]), index(size)));
        }
    }

    /// Process requested telemetry of the current step.
    fn take(&mut self, data: &[u8]) {
        let step = match self.form.steps.get(self.at) {
            Some(step) => step,
            None => return,
        };
        match *step {
            Step::Get { id, takes } | Step::Poll { id, takes, .. } => {
                for Take { place, register } in takes {
                    if let Some(number) = self.registers.get_mut(usize::from(*register)) {
                        *number = place.get(data, &[]);
                    }
                }
                self.is_zeros = data.iter().all(|byte| *byte == 0);
                if self.form.entry == Some(id) {
                    copy(&mut self.frame, data);
                    self.frame_length = data.len();
                }
            }
            Step::GetMap => self.read_map(self.count, data),
            Step::Receive {
                number, data_at, ..
            } => {
                self.take_packet(number.get(data, &[]), data, data_at);
            }
            _ => {}
        }
    }

    /// Process telemetry that was not requested: a packet of the block.
    fn arrived(&mut self, arrived: u32, data: &[u8]) {
        for (at, step) in self.form.steps.iter().enumerate() {
            match *step {
                Step::Receive {
                    id,
                    number,
                    data_at,
                    silence_ms,
                    ..
                } if id == arrived => {
                    let is_new = self.take_packet(number.get(data, &[]), data, data_at);
                    if is_new && at == self.at && matches!(self.want, Want::Wait(_)) {
                        let rest = if self.missing == 0 { 0 } else { silence_ms };
                        self.want = Want::Wait(self.now.wrapping_add(rest));
                    }
                }
                _ => {}
            }
        }
    }

    fn exchange_map(&mut self, sends: bool, outcome: Option<Result<(), End>>) -> Turn {
        if !self.is_resumed {
            self.count = 0;
        }
        if let Some(outcome) = outcome {
            outcome?;
            self.count += 1;
        }
        let map = self
            .blocks
            .map
            .as_ref()
            .filter(|map| self.count < map.count(self.packets()));
        let message = map.and_then(|map| Some((map, map.messages.get(self.count)?)));
        let (map, (telecommand, telemetry)) = match message {
            Some(found) => found,
            None => return Ok(Flow::Next),
        };
        if !sends {
            return Ok(ask(*telemetry));
        }
        self.data = [0; STEP_BYTES];
        self.write_map(map, self.count);
        let want = Want::Ask(Direction::Telecommand, *telecommand, map.length, true);
        Ok(Flow::Stay(want))
    }

    /// Request each packet that was missing at the beginning of the step.
    fn request_packets(&mut self, id: u32) -> Flow {
        self.count = if self.is_resumed {
            self.count.saturating_sub(1)
        } else {
            self.missing
        };
        if self.count == 0 {
            Flow::Next
        } else {
            ask(id)
        }
    }

    /// Wait for packets until all are there, or there was silence.
    fn await_packets(&mut self, silence: u32) -> Flow {
        if !self.is_resumed {
            self.last_new = self.now;
        }
        let until = self.last_new.wrapping_add(silence);
        if self.missing == 0 || reached(self.now, until) {
            Flow::Next
        } else {
            Flow::Stay(Want::Wait(until))
        }
    }

    /// Add the frame to the entries. If it is equal to the last one, the list did not advance.
    fn collect(&mut self, sink: &mut dyn Sink) -> Turn {
        let frame = head(&self.frame, self.frame_length);
        if self.entries > 0 && frame == head(&self.last, self.frame_length) {
            self.repetitions += 1;
            if self.repetitions > self.form.retries.into() {
                return Err(End::Timeout);
            }
        } else if self.entries == self.form.most_entries {
            return Err(End::Limit);
        } else {
            self.entries += 1;
            self.repetitions = 0;
            sink.entry(frame);
            self.last = self.frame;
        }
        Ok(Flow::Next)
    }
}

/// Request telemetry.
const fn ask(id: u32) -> Flow {
    Flow::Stay(Want::Ask(Direction::Telemetry, id, 0, true))
}
