//! File download.

use super::super::bits::{copy, count, head, index, number, part, part_mut, pieces, reached};
use super::super::crc;
use super::super::link::{Bus, CrcForm, DownloadForm, Files, HoleMapForm, Link, Role};
use super::super::links::BLOCK_PACKETS;
use super::super::Error;
use super::hole_map::HoleMap;
use super::poll::Poll;
use super::procedure::{Answer, Core, End, Run};

#[derive(Clone, Debug)]
enum State {
    Begin,
    Load,
    Poll(Poll),
    Map(usize),
    Burst,
    Packets(usize),
    Silence,
}

/// Download of a file block by block.
#[derive(Debug)]
pub struct Download<'a, F> {
    core: Core,
    link: &'static Link,
    files: &'static Files,
    form: &'static DownloadForm,
    map: &'static HoleMapForm,
    crc: &'static CrcForm,
    bus: Bus,
    kind: u8,
    counter: u8,
    size: Option<u32>,
    block: u32,
    buffer: &'a mut [u8],
    on_block: F,
    state: State,
    offset: u32,
    wanted: u32, // bytes of the block that were asked for
    length: u32, // that it has
    checksum: u32,
    rounds: u32,
    packets: usize, // of the block
    there: [bool; BLOCK_PACKETS],
    got: usize,
    last: u32, // when the last new packet came
}

impl<'a, F: FnMut(u32, &[u8])> Download<'a, F> {
    /// Create a download of the file with this type and counter. Calls `on_block` with the offset
    /// and the bytes of each block. Without a size, it downloads up to the end of the file; use
    /// this for the index file. The block size is the size of the buffer, at most the block size of
    /// the ICD.
    ///
    /// # Errors
    ///
    /// [`Error::Length`] if the buffer is smaller than a packet, [`Error::Range`] if the size is
    /// above the limit of the ICD, [`Error::Unsupported`] if the node has no downloads on this bus.
    pub fn new(
        link: &'static Link,
        bus: Bus,
        (kind, counter): (u8, u8),
        size: Option<u32>,
        buffer: &'a mut [u8],
        on_block: F,
    ) -> Result<Self, Error> {
        let files = link.files.as_ref().ok_or(Error::Unsupported)?;
        if bus != Bus::Uart {
            files.packet_ids.of(bus).ok_or(Error::Unsupported)?;
        }
        let whole = pieces(buffer.len() + 1, files.packet_bytes).saturating_sub(1);
        let block = whole
            .saturating_mul(files.packet_bytes)
            .min(files.block_bytes);
        if block == 0 {
            let (expected, actual) = (files.packet_bytes, buffer.len());
            return Err(Error::Length { expected, actual });
        }
        let form = files.download.as_ref().ok_or(Error::Unsupported)?;
        if size.map_or(false, |size| size > form.max_bytes) {
            return Err(Error::range("size"));
        }
        Ok(Self {
            core: Core::new(link),
            link,
            files,
            form,
            map: files.hole_map.as_ref().ok_or(Error::Unsupported)?,
            crc: link.crc16.as_ref().ok_or(Error::Unsupported)?,
            bus,
            kind,
            counter,
            size,
            block: count(block),
            buffer,
            on_block,
            state: State::Begin,
            offset: 0,
            wanted: 0,
            length: 0,
            checksum: 0,
            rounds: 0,
            packets: 0,
            there: [false; BLOCK_PACKETS],
            got: 0,
            last: 0,
        })
    }

    /// Use smaller blocks, of this number of bytes.
    #[must_use]
    pub fn with_block(mut self, bytes: u32) -> Self {
        self.block = bytes.min(self.block).max(1);
        self
    }

    /// Return the number of bytes delivered, and the file size if it is known.
    #[must_use]
    pub const fn progress(&self) -> (u32, Option<u32>) {
        (self.offset, self.size)
    }

    fn next_block(&mut self) {
        let left = self.size.map(|size| size.saturating_sub(self.offset));
        if left == Some(0) {
            return self.core.end(End::Done);
        }
        self.wanted = left.map_or(self.block, |left| left.min(self.block));
        self.rounds = 0;
        self.load();
    }

    fn load(&mut self) {
        self.there = [false; BLOCK_PACKETS];
        self.got = 0;
        self.packets = 0;
        let values = [
            (Role::Type, self.kind.into()),
            (Role::Counter, self.counter.into()),
            (Role::Offset, self.offset),
            (Role::Length, self.wanted),
        ];
        self.core.send(&self.form.load, true, &values);
        self.state = State::Load;
    }

    fn poll(&mut self) {
        let form = self.form;
        let (interval, timeout) = (form.poll_interval_ms, form.ready_timeout_ms);
        let wanted = (Role::Ready, true);
        let poll = Poll::begin(&mut self.core, &form.ready, wanted, interval, timeout);
        self.state = State::Poll(poll);
    }

    fn ready(&mut self, frame: &[u8]) {
        let read = |role| self.form.ready.get(role, frame).unwrap_or(0);
        if read(Role::Error) != 0 {
            return self.core.end(End::Parameter);
        }
        self.length = read(Role::Length);
        self.checksum = read(Role::Checksum);
        let shorter = self.size.is_some() && self.length != self.wanted;
        if self.length > self.wanted || shorter {
            return self.core.end(End::Length);
        }
        if self.length > self.form.max_bytes.saturating_sub(self.offset) {
            return self.core.end(End::Limit);
        }
        self.packets = pieces(index(self.length), self.files.packet_bytes);
        self.round();
    }

    fn round(&mut self) {
        if self.got >= self.packets {
            return self.complete();
        }
        if self.rounds == self.form.rounds {
            return self.core.end(End::Rounds);
        }
        self.rounds += 1;
        if self.got > 0 {
            self.send_map(0);
        } else {
            self.burst();
        }
    }

    /// Sets a piece of the hole map.
    fn send_map(&mut self, piece: usize) {
        let mut map = HoleMap::new(self.link, self.packets).ok();
        if let Some(map) = &mut map {
            let numbers = self.there.iter().zip(self.files.first_packet..);
            for (_, number) in numbers.take(self.packets).filter(|(there, _)| **there) {
                let _ = map.set(number);
            }
        }
        let bytes = map.as_ref().map(|map| map.message(piece));
        match (self.map.messages.get(piece), bytes) {
            (Some(message), Some(bytes)) if piece < self.maps() => {
                self.core.send_bytes(message.set_id, message.length);
                let span = message.piece;
                copy(self.core.payload(span.at, span.bytes), bytes);
                self.state = State::Map(piece);
            }
            _ => self.burst(),
        }
    }

    /// Messages that carry the hole map of this block.
    fn maps(&self) -> usize {
        pieces(self.packets, self.map.message_bytes.saturating_mul(8))
    }

    fn burst(&mut self) {
        self.last = self.core.now;
        let values = [
            (Role::Length, self.form.message_length),
            (Role::IgnoreHoleMap, (self.got == 0).into()),
        ];
        // Sent once: that packets come, or none, tells more than its acknowledge.
        self.core.send(&self.form.burst, false, &values);
        self.state = State::Burst;
    }

    /// Requests the next packet of so many.
    fn ask_packet(&mut self, left: usize) {
        match (left.checked_sub(1), self.files.packet_ids.of(self.bus)) {
            (Some(left), Some(id)) => {
                self.core.ask(id);
                self.state = State::Packets(left);
            }
            _ => self.round(),
        }
    }

    /// Waits for packets, until there was silence.
    fn listen(&mut self) {
        let until = self.last.wrapping_add(self.form.silence_ms);
        if self.got < self.packets && !reached(self.core.now, until) {
            self.core.wait(until);
            self.state = State::Silence;
        } else {
            self.round();
        }
    }

    fn complete(&mut self) {
        let whole = self.packets.wrapping_mul(self.files.packet_bytes);
        let length = index(self.length);
        let covered = if self.form.checksum_covers_fill {
            whole
        } else {
            length
        };
        if crc::whole(self.crc, head(self.buffer, covered)) == self.checksum {
            if length > 0 {
                (self.on_block)(self.offset, head(self.buffer, length));
                self.offset = self.offset.wrapping_add(self.length);
            }
            if self.size.is_none() && self.length < self.wanted {
                self.core.end(End::Done);
            } else {
                self.next_block();
            }
            return;
        }
        if self.rounds == self.form.rounds {
            return self.core.end(End::Checksum);
        }
        if length == 0 {
            self.rounds += 1;
        }
        self.load();
    }

    fn take(&mut self, number: u32, data: &[u8]) {
        let position = match number.checked_sub(self.files.first_packet) {
            Some(position) if index(position) < self.packets => index(position),
            _ => return,
        };
        let size = self.files.packet_bytes;
        match self.there.get_mut(position) {
            Some(there) if !*there && data.len() == size => *there = true,
            _ => return,
        }
        self.got += 1;
        let at = position.wrapping_mul(size);
        copy(part_mut(self.buffer, at, size), data);
        self.last = self.core.now;
        if self.got == self.packets {
            self.core.hurry();
        }
    }
}

impl<F: FnMut(u32, &[u8])> Run for Download<'_, F> {
    fn core(&self) -> &Core {
        &self.core
    }

    fn core_mut(&mut self) -> &mut Core {
        &mut self.core
    }

    fn packet(&mut self, number: u32, data: &[u8]) {
        self.take(number, data);
    }

    fn resume(&mut self, answer: Option<Answer<'_>>) {
        match &self.state {
            State::Begin => self.next_block(),
            State::Load => {
                if self.core.frame(answer).is_some() {
                    self.poll();
                }
            }
            State::Poll(poll) => {
                if let Some(frame) = poll.resume(&mut self.core, answer) {
                    self.ready(frame);
                }
            }
            State::Map(piece) => {
                let next = *piece + 1;
                if self.core.frame(answer).is_some() {
                    self.send_map(next);
                }
            }
            State::Burst => match answer {
                Some(Answer::Refused) => self.core.end(End::Refused),
                _ if self.bus == Bus::Uart => {
                    self.last = self.core.now;
                    self.listen();
                }
                _ => self.ask_packet(self.packets.saturating_sub(self.got)),
            },
            State::Packets(left) => {
                let left = *left;
                if let Some(Answer::Done(data)) = answer {
                    let size = self.files.counter_bytes;
                    let number = number(part(data, 0, size), self.link.little);
                    let number = u32::try_from(number).unwrap_or(u32::MAX);
                    self.take(number, data.get(size..).unwrap_or(&[]));
                }
                self.ask_packet(left);
            }
            State::Silence => self.listen(),
        }
    }
}
