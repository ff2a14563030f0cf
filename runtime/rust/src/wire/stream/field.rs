//! Fields of the header and trailer.

use crate::wire::bits::{head, number, part_mut, put_number};
use crate::wire::link::{
    Content, FieldRole, NumberPlace, PacketField, PacketForm, Stream, StreamRow,
};
use crate::wire::Direction;

impl PacketField {
    /// The greatest value.
    pub(super) const fn mask(&self) -> u32 {
        u32::MAX.wrapping_shr(32_u32.wrapping_sub(self.bits))
    }

    /// The value of a constant, or unless another is chosen.
    pub(super) const fn value(&self, direction: Direction) -> u32 {
        let [telecommand, telemetry] = self.values;
        match direction {
            Direction::Telecommand => telecommand,
            Direction::Telemetry => telemetry,
        }
    }

    /// Return the number of data bytes that a value of a length says; None if it is invalid.
    pub(super) fn bytes_of(&self, value: u32) -> Option<usize> {
        let bytes = i64::from(value).checked_mul(i64::from(self.unit))?;
        usize::try_from(bytes.checked_sub(i64::from(self.plus))?).ok()
    }

    /// Return the value of a length for a number of data bytes.
    pub(super) fn counted(&self, length: usize) -> i64 {
        let length = i64::try_from(length).unwrap_or(i64::MAX);
        let bytes = length.wrapping_add(i64::from(self.plus));
        bytes.checked_div(i64::from(self.unit)).unwrap_or(bytes)
    }

    /// Its value in a frame; 0 if that ends before.
    pub(super) fn get(&self, packet: &PacketForm, frame: &[u8]) -> u32 {
        let behind = frame.len().saturating_sub(packet.trailer_bytes);
        let at = self.at + if self.in_trailer { behind } else { 0 };
        let bytes = frame.get(at..at + self.size).unwrap_or(&[]);
        let join = |number: u32, byte: &u8| (number << 8) | u32::from(*byte);
        let number = match bytes {
            [byte] => u32::from(*byte), // quick, as noise is compared with it
            _ if self.little => bytes.iter().rev().fold(0, join),
            _ => bytes.iter().fold(0, join),
        };
        number.wrapping_shr(self.shift) & self.mask()
    }

    /// Puts a value into the header or trailer, where there are zeros.
    pub(super) fn put(&self, bytes: &mut [u8], value: u32) {
        let value = value.wrapping_shl(self.shift);
        let places = bytes.get_mut(self.at..self.at + self.size);
        let count = u32::try_from(self.size).unwrap_or(0);
        for (place, number) in places.unwrap_or(&mut []).iter_mut().zip(0_u32..) {
            let byte = if self.little {
                number
            } else {
                count.wrapping_sub(number).wrapping_sub(1)
            };
            let [low, ..] = value.wrapping_shr(byte.wrapping_mul(8)).to_le_bytes();
            *place |= low;
        }
    }
}

impl NumberPlace {
    /// Return the number in `first`, followed by `rest`.
    pub(in crate::wire) fn get(&self, first: &[u8], rest: &[u8]) -> u32 {
        let mut octets = [0; 4];
        let bytes = first.iter().chain(rest).skip(self.at).take(self.size);
        for (octet, byte) in octets.iter_mut().zip(bytes) {
            *octet = *byte;
        }
        let number = number(head(&octets, self.size), self.little).wrapping_shr(self.shift);
        self.mask() & u32::try_from(number).unwrap_or(0)
    }

    /// Put a number into a message and keep the other bits.
    pub(in crate::wire) fn put(&self, value: u32, bytes: &mut [u8]) {
        let place = part_mut(bytes, self.at, self.size);
        let kept = number(place, self.little) & !(u64::from(self.mask()) << self.shift);
        let value = u64::from(value & self.mask()) << self.shift;
        put_number(place, kept | value, self.little);
    }

    /// The greatest number.
    pub(super) const fn mask(&self) -> u32 {
        u32::MAX.wrapping_shr(32_u32.wrapping_sub(self.bits))
    }
}

impl Stream {
    /// The messages of a direction, by rising id.
    pub(super) const fn rows(&self, direction: Direction) -> &'static [StreamRow] {
        match direction {
            Direction::Telecommand => self.telecommands,
            Direction::Telemetry => self.telemetry,
        }
    }

    /// The place and the row of a message.
    pub(in crate::wire) fn row(
        &self,
        direction: Direction,
        id: u32,
    ) -> Option<(usize, &'static StreamRow)> {
        let rows = self.rows(direction);
        let at = rows.binary_search_by_key(&id, |row| row.id).ok()?;
        Some((at, rows.get(at)?))
    }

    /// Return the packet formats of a direction and their indices.
    pub(super) fn packets_of(
        &self,
        direction: Direction,
    ) -> impl Iterator<Item = (usize, &'static PacketForm)> + Clone {
        let packets = self.packets.iter().enumerate();
        packets.filter(move |(_, packet)| packet.is_from(direction))
    }
}

impl PacketForm {
    const fn is_from(&self, direction: Direction) -> bool {
        match direction {
            Direction::Telecommand => self.from_host,
            Direction::Telemetry => self.from_device,
        }
    }

    /// Return whether the packet tells of which message it is.
    pub(super) const fn tells_message(&self) -> bool {
        matches!(self.content, Content::Message | Content::Request)
    }

    /// Return the first field of a role.
    pub(super) fn field(&self, role: FieldRole) -> Option<&'static PacketField> {
        self.fields.iter().find(|field| field.role == role)
    }

    /// Return the size of header and trailer in bytes.
    pub(super) const fn around(&self) -> usize {
        self.header_bytes + self.trailer_bytes
    }

    /// Return the part of an id that belongs into a field. If the id is too large, its topmost part
    /// does not fit.
    pub(super) fn part(&self, field: &PacketField, id: u32) -> u32 {
        let parts = self.fields.iter();
        let parts = parts.filter(|part| part.role == FieldRole::Id);
        let bits = parts.fold(0_u32, |bits, part| bits.wrapping_add(part.bits));
        let part = id.wrapping_shr(field.id_shift);
        if field.id_shift.wrapping_add(field.bits) < bits {
            part & field.mask()
        } else {
            part
        }
    }

    /// Return the id in a frame; None if the packet has none.
    pub(super) fn id(&self, frame: &[u8]) -> Option<u32> {
        let parts = self.fields.iter();
        let parts = parts.filter(|field| field.role == FieldRole::Id);
        let parts = parts.map(|part| part.get(self, frame).wrapping_shl(part.id_shift));
        parts.reduce(|id, part| id | part)
    }
}
