//! Blocks of bytes and their packets.

use super::engine::{
    End, Engine, Flow, Turn, BLOCK_IS_EMPTY, BLOCK_LENGTH, BLOCK_OFFSET, PACKET_NUMBER,
    PACKET_OFFSET,
};
use super::sink::Sink;
use super::tables::{Blocks, Input, PacketMap, Value, UNKNOWN};
use crate::wire::bits::{copy, count, head, index, part, part_mut, pieces};
use crate::wire::checksum::Check;
use crate::wire::link::ChecksumAlgorithm;
use crate::wire::Error;

impl Input {
    /// Return the number if the input allows it.
    pub(super) fn checked(&self, number: Option<u32>) -> Result<u32, Error> {
        let is_supported = |number: &u32| match self.values {
            [] => *number <= self.most,
            values => values.contains(number),
        };
        let (field, allowed) = (self.name, self.allowed);
        match number {
            None if self.is_optional => Ok(UNKNOWN),
            _ => number
                .filter(is_supported)
                .ok_or(Error::Range { field, allowed }),
        }
    }
}

impl Blocks {
    /// Those of a procedure without blocks.
    pub(super) const NONE: Self = Self {
        sends: false,
        total: None,
        size: 0,
        begin: 0,
        packet_bytes: 1,
        first_packet: 0,
        fill: 0,
        rounds: 0,
        most: 0,
        map: None,
    };

    /// Divide the memory into the bytes of a block and one bit for each of its packets.
    pub(super) fn split<'a>(&self, memory: &'a mut [u8]) -> (&'a mut [u8], &'a mut [u8]) {
        if self.sends {
            return (&mut [], memory);
        }
        let (bits, per_packet) = (memory.len().saturating_mul(8), self.packet_bytes * 8 + 1);
        let packets = bits.checked_div(per_packet).unwrap_or(0);
        let mut size = packets.saturating_mul(self.packet_bytes);
        if size + pieces(packets, 8) > memory.len() {
            size = size.saturating_sub(self.packet_bytes);
        }
        memory.split_at_mut(size.min(memory.len()))
    }

    /// Return the largest number of bytes of a block for which there is memory.
    pub(super) fn size_in(&self, block: &[u8], there: &[u8]) -> Result<u32, Error> {
        let room = if self.sends {
            there
                .len()
                .saturating_mul(8)
                .saturating_mul(self.packet_bytes)
        } else {
            block.len()
        };
        if room == 0 && self.size > 0 {
            let expected = 1 + if self.sends { 0 } else { self.packet_bytes };
            let actual = there.len();
            return Err(Error::Length { expected, actual });
        }
        Ok(self.size.min(count(room)))
    }
}

impl PacketMap {
    /// Return the number of messages for a number of packets.
    pub(super) fn count(&self, packets: usize) -> usize {
        pieces(packets, self.bytes.saturating_mul(8))
    }

    /// Return the packets of a message, with the byte and the mask of their bits.
    fn bits(&self, message: usize) -> impl Iterator<Item = (usize, usize, u8)> {
        let (at, msb0, bits) = (self.at, self.msb0, self.bytes.saturating_mul(8));
        let first = message.saturating_mul(bits);
        (0..bits).map(move |bit| {
            let mask = if msb0 {
                0x80 >> (bit % 8)
            } else {
                1 << (bit % 8)
            };
            (first + bit, at + bit / 8, mask)
        })
    }
}

impl Engine<'_> {
    /// Return the number of bytes in all, if it is known.
    pub(super) fn total(&self) -> Option<u32> {
        if self.blocks.sends {
            return Some(count(self.bytes.len()));
        }
        let total = self
            .blocks
            .total
            .map(|total| self.value(Value::Register(total)));
        total.filter(|total| *total != UNKNOWN)
    }

    /// Return the number of packets of the block.
    pub(super) fn packets(&self) -> usize {
        pieces(
            index(self.registers[BLOCK_LENGTH]),
            self.blocks.packet_bytes,
        )
    }

    fn is_there(&self, position: usize) -> bool {
        let byte = self.there.get(position / 8).copied().unwrap_or(0);
        (byte >> (position % 8)) & 1 == 1
    }

    /// Note whether a packet is there.
    pub(super) fn mark(&mut self, position: usize, there: bool) {
        if position >= self.packets() || self.is_there(position) == there {
            return;
        }
        if let Some(byte) = self.there.get_mut(position / 8) {
            *byte ^= 1 << (position % 8);
        }
        self.missing = if there {
            self.missing.saturating_sub(1)
        } else {
            self.missing + 1
        };
        self.registers[BLOCK_IS_EMPTY] = (self.missing == self.packets()).into();
    }

    /// Return the position of the first missing packet, from a position on.
    fn next_missing(&self, from: usize) -> Option<usize> {
        (from..self.packets()).find(|position| !self.is_there(*position))
    }

    pub(super) fn next_block(&mut self, to: usize, sink: &mut dyn Sink) -> Flow {
        let mut is_last = false;
        if self.is_begun {
            let length = self.registers[BLOCK_LENGTH];
            if !self.blocks.sends && length > 0 {
                let data = head(self.block, index(length));
                sink.block(self.registers[BLOCK_OFFSET], data);
            }
            self.registers[BLOCK_OFFSET] = self.registers[BLOCK_OFFSET].wrapping_add(length);
            is_last = length < self.requested;
            self.has_round = false;
            self.resize(0);
        }
        self.is_begun = true;
        let offset = self.registers[BLOCK_OFFSET];
        let left = self.total().map(|total| total.saturating_sub(offset));
        if left.map_or(is_last, |left| left == 0) {
            return Flow::To(to);
        }
        self.requested = left.map_or(self.size, |left| left.min(self.size));
        self.rounds = 0;
        self.begin(self.requested);
        Flow::Next
    }

    /// Begin a block of this length, for the first time or again.
    fn begin(&mut self, length: u32) {
        self.has_round = false;
        self.resize(length);
        self.block.fill(self.blocks.fill);
    }

    /// Set the length of the block, of which no packet is there.
    fn resize(&mut self, length: u32) {
        self.registers[BLOCK_LENGTH] = length;
        self.registers[BLOCK_IS_EMPTY] = 1;
        self.missing = self.packets();
        self.there.fill(0);
    }

    pub(super) fn set_length(&mut self, length: u32) -> Turn {
        let is_shorter = self.total().is_some() && length != self.requested;
        if length > self.requested || is_shorter {
            return Err(End::Length);
        }
        let most = self
            .blocks
            .most
            .saturating_sub(self.registers[BLOCK_OFFSET]);
        if length > most {
            return Err(End::Limit);
        }
        self.resize(length);
        Ok(Flow::Next)
    }

    pub(super) fn next_round(&mut self, to: usize) -> Turn {
        if self.missing == 0 {
            return Ok(Flow::To(to));
        }
        if self.rounds == self.blocks.rounds {
            return Err(End::Rounds);
        }
        self.rounds += 1;
        self.has_round = true;
        self.cursor = 0;
        Ok(Flow::Next)
    }

    pub(super) fn next_packet(&mut self, to: usize) -> Flow {
        match self.next_missing(self.cursor) {
            Some(position) => {
                let number = count(position);
                self.registers[PACKET_NUMBER] = self.blocks.first_packet.wrapping_add(number);
                let at = count(position.wrapping_mul(self.blocks.packet_bytes));
                self.registers[PACKET_OFFSET] = self.registers[BLOCK_OFFSET].wrapping_add(at);
                self.cursor = position + 1;
                Flow::Next
            }
            None => Flow::To(to),
        }
    }

    /// Take a packet of the block. Return whether it is new. Before the first round it may belong to
    /// the previous block.
    pub(super) fn take_packet(&mut self, number: u32, data: &[u8], data_at: usize) -> bool {
        let size = self.blocks.packet_bytes;
        let packet = part(data, data_at, size);
        let position = match number.checked_sub(self.blocks.first_packet) {
            Some(position) if self.has_round && packet.len() == size => index(position),
            _ => return false,
        };
        if position >= self.packets() || self.is_there(position) {
            return false;
        }
        copy(
            part_mut(self.block, position.wrapping_mul(size), size),
            packet,
        );
        self.mark(position, true);
        self.last_new = self.now;
        true
    }

    /// Put the bits of the packets into a message.
    pub(super) fn write_map(&mut self, map: &PacketMap, message: usize) {
        for (position, byte, mask) in map.bits(message) {
            let is_set = if position < self.packets() {
                self.is_there(position) == map.received
            } else {
                map.beyond_end
            };
            if let Some(byte) = self.data.get_mut(byte).filter(|_| is_set) {
                *byte |= mask;
            }
        }
    }

    /// Take the bits of the packets from a message.
    pub(super) fn read_map(&mut self, message: usize, data: &[u8]) {
        if let Some(map) = &self.blocks.map {
            for (position, byte, mask) in map.bits(message) {
                // Bytes that a message does not have are 0, as in numbers.
                let bit = data.get(byte).copied().unwrap_or(0) & mask != 0;
                self.mark(position, bit == map.received);
            }
        }
    }

    /// Compute the checksum of the block, or of all bytes that are sent.
    pub(super) fn checksum(
        &self,
        algorithm: &ChecksumAlgorithm,
        of_block: bool,
        covers_fill: bool,
    ) -> u32 {
        let mut check = Check::new(algorithm, None);
        let length = index(self.registers[BLOCK_LENGTH]);
        let whole = self.packets().wrapping_mul(self.blocks.packet_bytes);
        if !of_block {
            check.feed(self.bytes);
        } else if self.blocks.sends {
            check.feed(part(
                self.bytes,
                index(self.registers[BLOCK_OFFSET]),
                length,
            ));
            if covers_fill {
                (length..whole).for_each(|_| check.feed(&[self.blocks.fill]));
            }
        } else {
            check.feed(head(self.block, if covers_fill { whole } else { length }));
        }
        check.result()
    }

    /// Go on if a check succeeded; otherwise transfer the block again, or end with this result.
    pub(super) fn verified(&mut self, is_right: bool, again: bool, end: End) -> Turn {
        if is_right {
            return Ok(Flow::Next);
        }
        if !again {
            return Err(end);
        }
        if self.rounds == self.blocks.rounds {
            return Err(End::Checksum);
        }
        self.rounds += u32::from(!self.has_round);
        self.begin(self.requested);
        Ok(Flow::To(self.blocks.begin))
    }
}
