//! Messages used in procedures.

use super::Span;

/// Where a number stands in a frame.
pub type Place = &'static [Piece];

/// A run of bits of one byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece {
    /// The byte.
    pub byte: usize,
    /// How many bits of the byte stand below it.
    pub shift: u8,
    /// How many bits it has.
    pub bits: u8,
    /// How many bits of the number stand below it.
    pub at: u8,
}

/// Role of a field in a procedure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Everything, and not one file.
    All,
    /// Size of blocks.
    BlockSize,
    /// The node is busy.
    Busy,
    /// A checksum.
    Checksum,
    /// Counter of a file.
    Counter,
    /// Where an upload goes.
    Destination,
    /// Something went wrong.
    Error,
    /// Whether all packets are to be sent.
    IgnoreHoleMap,
    /// Version of the interface.
    InterfaceVersion,
    /// Bytes of a block.
    Length,
    /// Type of the node.
    NodeType,
    /// Number of a packet.
    Number,
    /// Where a block begins in its file.
    Offset,
    /// A stored program.
    Program,
    /// The block is ready.
    Ready,
    /// Size of a file.
    Size,
    /// When a file was created.
    Time,
    /// Type of a file.
    Type,
}

/// A message used in a procedure.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Its id.
    pub id: u8,
    /// Initial content of the frame.
    pub fresh: &'static [u8],
    /// Its numbers.
    pub places: &'static [(Role, Place)],
    /// Its bytes, where it carries some.
    pub payload: Option<Span>,
}

impl Step {
    /// The number of that role in a frame; None if the message has none.
    pub(crate) fn get(&self, role: Role, frame: &[u8]) -> Option<u32> {
        let found = self.places.iter().find(|(known, _)| *known == role);
        found.map(|(_, place)| get(place, frame))
    }

    /// Puts the number of that role into a frame.
    pub(crate) fn put(&self, role: Role, value: u32, frame: &mut [u8]) {
        if let Some((_, place)) = self.places.iter().find(|(known, _)| *known == role) {
            put(place, value, frame);
        }
    }
}

/// The number at a place of a frame.
pub(crate) fn get(place: &[Piece], frame: &[u8]) -> u32 {
    place.iter().fold(0, |value, piece| {
        let byte = u32::from(frame.get(piece.byte).copied().unwrap_or(0));
        let run = byte.wrapping_shr(piece.shift.into()) & ones(piece.bits);
        value | run.wrapping_shl(piece.at.into())
    })
}

fn put(place: &[Piece], value: u32, frame: &mut [u8]) {
    for piece in place {
        if let Some(byte) = frame.get_mut(piece.byte) {
            let run = value.wrapping_shr(piece.at.into()) & ones(piece.bits);
            *byte |= super::super::bits::low(run.wrapping_shl(piece.shift.into()).into());
        }
    }
}

/// So many bits, at most those of a byte.
const fn ones(bits: u8) -> u32 {
    1_u32.wrapping_shl(bits as u32).wrapping_sub(1)
}
