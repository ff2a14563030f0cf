//! Hole map: one bit for each packet of a block.

use super::super::bits::{copy, head, index, part};
use super::super::link::{Files, HoleMapForm, Link};
use super::super::links::MAP_BYTES;
use super::super::Error;

/// Map of the received packets of a block, in the format of the node.
///
/// ```
/// use icdgen_runtime::wire::files::HoleMap;
/// use icdgen_runtime::wire::{Error, Link};
///
/// /// Returns the missing packets of a block of eight.
/// fn missing(link: &Link, seen: &[u32]) -> Result<Vec<u32>, Error> {
///     let mut map = HoleMap::new(link, 8)?;
///     for number in seen {
///         map.set(*number)?;
///     }
///     Ok(map.missing().collect())
/// }
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HoleMap {
    bytes: [u8; MAP_BYTES],
    packets: usize,
    first: u32,
    size: usize,
    message_bytes: usize,
    msb0: bool,
    received: bool,
}

impl HoleMap {
    /// Create the map of a block with all packets missing.
    ///
    /// # Errors
    ///
    /// [`Error::Range`] if a block cannot have so many packets, [`Error::Unsupported`] if the ICD
    /// does not describe hole maps.
    pub fn new(link: &Link, packets: usize) -> Result<Self, Error> {
        let files = link.files.as_ref().ok_or(Error::Unsupported)?;
        let form = files.hole_map.as_ref().ok_or(Error::Unsupported)?;
        let mut map = Self::empty(files, form, packets)?;
        for bit in 0..form.bytes.saturating_mul(8) {
            let there = if bit < packets {
                !form.received
            } else {
                form.beyond_end
            };
            map.write(bit, there);
        }
        Ok(map)
    }

    /// Create the map of a block from the bytes that the node sent.
    ///
    /// # Errors
    ///
    /// [`Error::Length`] if the map has the wrong length, [`Error::Range`] if a block cannot have
    /// so many packets, [`Error::Unsupported`] if the ICD does not describe hole maps.
    pub fn from_bytes(link: &Link, packets: usize, bytes: &[u8]) -> Result<Self, Error> {
        let files = link.files.as_ref().ok_or(Error::Unsupported)?;
        let form = files.hole_map.as_ref().ok_or(Error::Unsupported)?;
        let (expected, actual) = (form.bytes, bytes.len());
        if expected != actual {
            return Err(Error::Length { expected, actual });
        }
        let mut map = Self::empty(files, form, packets)?;
        copy(&mut map.bytes, bytes);
        Ok(map)
    }

    fn empty(files: &Files, form: &HoleMapForm, packets: usize) -> Result<Self, Error> {
        if packets > form.bytes.saturating_mul(8) {
            return Err(Error::range("packets"));
        }
        Ok(Self {
            bytes: [0; MAP_BYTES],
            packets,
            first: files.first_packet,
            size: form.bytes,
            message_bytes: form.message_bytes,
            msb0: form.msb0,
            received: form.received,
        })
    }

    /// Mark a packet as received.
    ///
    /// # Errors
    ///
    /// [`Error::Range`] if the block has no such packet.
    pub fn set(&mut self, number: u32) -> Result<(), Error> {
        let error = Error::range("number");
        let bit = index(number.checked_sub(self.first).ok_or(error)?);
        if bit >= self.packets {
            return Err(error);
        }
        self.write(bit, self.received);
        Ok(())
    }

    /// Return the map as bytes.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8] {
        head(&self.bytes, self.size)
    }

    /// Return the pieces of the map, one for each message.
    pub fn messages(&self) -> impl Iterator<Item = &[u8]> {
        self.as_bytes().chunks(self.message_bytes.max(1))
    }

    /// A piece of the map.
    pub(super) fn message(&self, piece: usize) -> &[u8] {
        part(
            self.as_bytes(),
            piece.wrapping_mul(self.message_bytes),
            self.message_bytes,
        )
    }

    /// Return the numbers of the missing packets, in ascending order.
    pub fn missing(&self) -> impl Iterator<Item = u32> + '_ {
        let numbers = (0..self.packets).zip(self.first..);
        let missing = numbers.filter(move |(bit, _)| self.read(*bit) != self.received);
        missing.map(|(_, number)| number)
    }

    const fn place(&self, bit: usize) -> (usize, usize) {
        (bit / 8, if self.msb0 { 7 - bit % 8 } else { bit % 8 })
    }

    fn read(&self, bit: usize) -> bool {
        let (byte, shift) = self.place(bit);
        let byte = self.bytes.get(byte).copied().unwrap_or(0);
        (byte >> shift) & 1 == 1
    }

    fn write(&mut self, bit: usize, there: bool) {
        let (byte, shift) = self.place(bit);
        if let Some(byte) = self.bytes.get_mut(byte) {
            if there {
                *byte |= 1 << shift;
            } else {
                *byte &= !(1 << shift);
            }
        }
    }
}
