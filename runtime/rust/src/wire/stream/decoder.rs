//! Decoder of messages with header and trailer.

use super::encoder::{
    COBS_WHOLE, HDLC_ESCAPE, HDLC_FLAG, HDLC_FLIP, SLIP_END, SLIP_ESCAPE, SLIP_ESCAPED_END,
    SLIP_ESCAPED_ESCAPE,
};
use super::judge::{judge_delimited, Event, Judge, Verdict};
use crate::wire::link::{Delimiter, Escaping, Link, PacketForm, Stream};
use crate::wire::{Direction, Error};

/// Decoder that finds the messages of one direction in a stream. `N` is the size of its buffer in
/// bytes; `LONGEST` of the module of the node is enough for all messages. `S` is the number of
/// sequence counters for the detection of gaps; use `SEQUENCES` of this module.
///
/// ```
/// use icdgen_runtime::wire::stream::{Decoder, Event};
/// use icdgen_runtime::wire::{Direction, Error, Link};
///
/// /// The ids of the messages in what a line recorder kept.
/// fn ids(link: &'static Link, recorded: &[u8]) -> Result<Vec<u32>, Error> {
///     let mut found = Vec::new();
///     let mut decoder = Decoder::<512, 1>::new(link, Direction::Telemetry)?;
///     decoder.feed(recorded, |event| {
///         if let Event::Message { id, .. } = event {
///             found.push(id);
///         }
///     });
///     Ok(found)
/// }
/// ```
#[derive(Clone, Debug)]
pub struct Decoder<const N: usize, const S: usize> {
    search: Search<S>,
    header_bytes: usize, // of the shortest header
    buffer: [u8; N],
    length: usize,
    pending: u64,
    is_escaped: bool,
    is_inside: bool, // with escape characters: whether a packet has begun
    is_zero: bool,   // whether a zero follows the block of COBS
    left: u8,        // bytes that the block of COBS still has
    fault: Option<Event<'static>>,
}

/// Search for packets in received bytes, wherever these are.
#[derive(Clone, Debug)]
struct Search<const S: usize> {
    form: &'static Stream,
    direction: Direction,
    longest: usize,
    limit: usize,
    needed: usize, // bytes with which the next thing is decided, where a field tells the length
    sequences: [Option<u32>; S],
    discarded: u64,
}

impl<const N: usize, const S: usize> Decoder<N, S> {
    /// Create a decoder for messages of at most `N` bytes.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD describes no packets of this direction, [`Error::Length`] if
    /// header and trailer do not fit into the buffer.
    pub fn new(link: &'static Link, direction: Direction) -> Result<Self, Error> {
        Self::with_limit(link, direction, N)
    }

    /// Create a decoder for messages of at most `limit` bytes, which must not exceed `N`.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD describes no packets of this direction, [`Error::Length`] if
    /// header and trailer do not fit into the buffer.
    pub fn with_limit(
        link: &'static Link,
        direction: Direction,
        limit: usize,
    ) -> Result<Self, Error> {
        let form = link.stream.as_ref().ok_or(Error::Unsupported)?;
        let packets = form.packets_of(direction).map(|(_, packet)| packet);
        let around = packets.clone().map(PacketForm::around);
        let (expected, actual) = (around.max().ok_or(Error::Unsupported)?, limit.min(N));
        if actual < expected {
            return Err(Error::Length { expected, actual });
        }
        Ok(Self {
            search: Search {
                form,
                direction,
                longest: link.longest,
                limit: actual.min(link.longest),
                needed: 0,
                sequences: [None; S],
                discarded: 0,
            },
            header_bytes: packets.map(|packet| packet.header_bytes).min().unwrap_or(0),
            buffer: [0; N],
            length: 0,
            pending: 0,
            is_escaped: false,
            is_inside: false,
            is_zero: false,
            left: 0,
            fault: None,
        })
    }

    /// Return the number of received bytes that are not part of a message.
    #[must_use]
    pub const fn discarded(&self) -> u64 {
        self.search.discarded
    }

    /// Return the number of received bytes that may still become part of a message.
    #[must_use]
    pub const fn pending(&self) -> u64 {
        self.pending
    }

    /// Pass received bytes: a piece of the stream of any size, or one packet.
    pub fn feed(&mut self, bytes: &[u8], mut on_event: impl FnMut(Event<'_>)) {
        let end = match self.search.form.delimited_by {
            Delimiter::Datagram => return self.search.packet(bytes, &mut on_event),
            Delimiter::Length => return self.append(bytes, &mut on_event),
            Delimiter::Slip => SLIP_END,
            Delimiter::Hdlc => HDLC_FLAG,
            Delimiter::Cobs => 0,
            Delimiter::Escape(escaping) => return self.unescape(escaping, bytes, &mut on_event),
        };
        for &byte in bytes {
            self.pending = self.pending.wrapping_add(1);
            if byte == end {
                self.end(&mut on_event);
            } else if self.fault.is_none() {
                self.inside(byte);
            }
        }
    }

    /// Bytes where a field of the length delimits messages. A full buffer is always decided.
    fn append(&mut self, bytes: &[u8], on_event: &mut dyn FnMut(Event<'_>)) {
        let mut rest = bytes;
        while !rest.is_empty() {
            if self.length == 0 {
                // Whole messages need not be copied.
                let decided = self.search.decide(rest, on_event);
                rest = rest.get(decided..).unwrap_or(&[]);
            }
            let needed = self.search.needed.max(self.header_bytes);
            let wanted = needed.saturating_sub(self.length).max(1);
            let (piece, others) = rest.split_at(wanted.min(rest.len()));
            let end = self.length + piece.len();
            let free = self.buffer.get_mut(self.length..end).unwrap_or(&mut []);
            for (place, byte) in free.iter_mut().zip(piece) {
                *place = *byte;
            }
            self.length = end;
            rest = others;
            if self.length >= self.search.needed {
                let received = self.buffer.get(..self.length).unwrap_or(&[]);
                let decided = self.search.decide(received, on_event);
                self.buffer.copy_within(decided..self.length, 0);
                self.length -= decided;
            }
        }
        self.pending = u64::try_from(self.length).unwrap_or(0);
    }

    /// A delimiter came.
    fn end(&mut self, on_event: &mut dyn FnMut(Event<'_>)) {
        if self.is_escaped || self.left > 0 {
            self.fail(Event::Framing);
        }
        let frame = self.buffer.get(..self.length).unwrap_or(&[]);
        let is_taken = if let Some(fault) = self.fault {
            on_event(fault);
            false
        } else if frame.is_empty() && !self.is_inside {
            true
        } else {
            let judges = Judge::all(self.search.form, self.search.direction);
            judge_delimited(judges, frame, &mut self.search.sequences, on_event) == Verdict::Taken
        };
        if !is_taken {
            self.search.discarded = self.search.discarded.wrapping_add(self.pending);
        }
        self.pending = 0;
        self.length = 0;
        self.is_escaped = false;
        self.is_inside = false;
        self.is_zero = false;
        self.left = 0;
        self.fault = None;
    }

    /// Bytes of a stream with escape characters.
    fn unescape(&mut self, escaping: Escaping, bytes: &[u8], on_event: &mut dyn FnMut(Event<'_>)) {
        let mut rest = bytes;
        while let Some((&first, others)) = rest.split_first() {
            if self.is_escaped {
                self.after_escape(escaping, first, on_event);
                rest = others;
                continue;
            }
            let escape = rest.iter().position(|byte| *byte == escaping.escape);
            let (run, others) = rest.split_at(escape.unwrap_or(rest.len()));
            self.plain(run);
            rest = others;
            if let Some((_, others)) = rest.split_first() {
                self.is_escaped = true;
                self.pending = self.pending.wrapping_add(1);
                rest = others;
            }
        }
    }

    /// Bytes between two escape bytes.
    fn plain(&mut self, run: &[u8]) {
        if !self.is_inside {
            self.search.drop_bytes(run.len());
            return;
        }
        let count = u64::try_from(run.len()).unwrap_or(0);
        self.pending = self.pending.wrapping_add(count);
        if self.fault.is_none() {
            let end = self.search.limit.min(self.length.saturating_add(run.len()));
            let free = self.buffer.get_mut(self.length..end).unwrap_or(&mut []);
            for (place, byte) in free.iter_mut().zip(run) {
                *place = *byte;
            }
            if free.len() < run.len() {
                self.fail(Event::Overrun);
            }
            self.length = end;
        }
    }

    /// The byte after an escape byte.
    fn after_escape(&mut self, escaping: Escaping, byte: u8, on_event: &mut dyn FnMut(Event<'_>)) {
        self.is_escaped = false;
        self.pending = self.pending.wrapping_add(1);
        if escaping.begins(byte) {
            if self.is_inside {
                // The end of the packet before was lost.
                self.pending = self.pending.wrapping_sub(2);
                self.fail(Event::Framing);
                self.end(on_event);
            }
            self.is_inside = true;
            self.pending = 2;
            if escaping.start.is_none() {
                self.put(byte);
            }
        } else if !self.is_inside {
            // The last one of several escape bytes can begin a packet.
            self.is_escaped = byte == escaping.escape;
            self.pending = u64::from(self.is_escaped);
            self.search.drop_bytes(if self.is_escaped { 1 } else { 2 });
        } else if byte == escaping.end {
            self.end(on_event);
        } else if byte == escaping.data {
            if self.fault.is_none() {
                self.put(escaping.escape);
            }
        } else if !escaping.ignores_other {
            self.fail(Event::Framing);
            self.is_escaped = byte == escaping.escape;
        }
    }

    fn fail(&mut self, fault: Event<'static>) {
        self.fault = self.fault.or(Some(fault));
    }

    fn put(&mut self, byte: u8) {
        let has_room = self.length < self.search.limit;
        match self.buffer.get_mut(self.length) {
            Some(place) if has_room => {
                *place = byte;
                self.length += 1;
            }
            _ => self.fail(Event::Overrun),
        }
    }

    /// A byte of a frame between delimiters.
    fn inside(&mut self, byte: u8) {
        match self.search.form.delimited_by {
            Delimiter::Cobs if self.left > 0 => {
                self.left -= 1;
                self.put(byte);
            }
            Delimiter::Cobs => {
                if self.is_zero {
                    self.put(0);
                }
                self.left = byte.wrapping_sub(1);
                self.is_zero = byte != COBS_WHOLE;
            }
            Delimiter::Hdlc if self.is_escaped => {
                self.is_escaped = false;
                self.put(byte ^ HDLC_FLIP);
            }
            Delimiter::Hdlc if byte == HDLC_ESCAPE => self.is_escaped = true,
            Delimiter::Slip if self.is_escaped => {
                self.is_escaped = false;
                match byte {
                    SLIP_ESCAPED_END => self.put(SLIP_END),
                    SLIP_ESCAPED_ESCAPE => self.put(SLIP_ESCAPE),
                    _ => self.fail(Event::Framing),
                }
            }
            Delimiter::Slip if byte == SLIP_ESCAPE => self.is_escaped = true,
            _ => self.put(byte),
        }
    }
}

impl<const S: usize> Search<S> {
    fn packet(&mut self, bytes: &[u8], on_event: &mut dyn FnMut(Event<'_>)) {
        let is_taken = if bytes.len() > self.limit {
            on_event(Event::Overrun);
            false
        } else {
            let judges = Judge::all(self.form, self.direction);
            judge_delimited(judges, bytes, &mut self.sequences, on_event) == Verdict::Taken
        };
        if !is_taken {
            self.drop_bytes(bytes.len());
        }
    }

    /// Count discarded bytes, and return their number.
    fn drop_bytes(&mut self, count: usize) -> usize {
        let bytes = u64::try_from(count).unwrap_or(0);
        self.discarded = self.discarded.wrapping_add(bytes);
        count
    }

    /// Decide about bytes from the first one on. Return the number of decided ones; the others may
    /// become part of a message.
    fn decide(&mut self, bytes: &[u8], on_event: &mut dyn FnMut(Event<'_>)) -> usize {
        let mut rest = bytes;
        self.needed = 0;
        loop {
            let begin = self.begin(rest);
            let noise = begin.map_or(rest.len(), |(place, _)| place);
            self.drop_bytes(noise);
            rest = rest.get(noise..).unwrap_or(&[]);
            match begin.and_then(|(_, judge)| self.front(rest, &judge, on_event)) {
                Some(count) => rest = rest.get(count..).unwrap_or(&[]),
                None => return bytes.len() - rest.len(),
            }
        }
    }

    /// Return the first place where a packet can begin, and its format.
    fn begin(&self, bytes: &[u8]) -> Option<(usize, Judge)> {
        let judges = Judge::all(self.form, self.direction);
        (0..bytes.len()).find_map(|place| {
            let frame = bytes.get(place..)?;
            let judge = judges.clone().find(|it| it.header_is_right(frame))?;
            Some((place, judge))
        })
    }

    /// Decide about a packet that can begin here. Return the number of decided bytes; None while
    /// more are needed.
    fn front(
        &mut self,
        frame: &[u8],
        judge: &Judge,
        on_event: &mut dyn FnMut(Event<'_>),
    ) -> Option<usize> {
        let packet = judge.packet;
        if frame.len() < packet.header_bytes {
            return None;
        }
        let length = judge.length(frame);
        let size = match length.map(|length| length.saturating_add(packet.around())) {
            Ok(size) if size <= self.limit => size,
            other => {
                on_event(match other {
                    Ok(size) if size <= self.longest => Event::Overrun,
                    Err(Some(id)) => Event::UnknownId {
                        id,
                        header: &[],
                        is_request: false,
                    },
                    _ => Event::WRONG_LENGTH,
                });
                return Some(self.drop_bytes(1));
            }
        };
        if frame.len() < size {
            self.needed = size;
        }
        let whole = frame.get(..size)?;
        let verdict = judge.judge(whole, &mut self.sequences, on_event);
        let taken = if verdict == Verdict::Doubtful {
            1
        } else {
            size
        };
        if verdict != Verdict::Taken {
            self.drop_bytes(taken);
        }
        Some(taken)
    }
}
