//! Places of numbers in frames, and the frame that identifies the node.

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

/// The frame that identifies the node.
#[derive(Clone, Copy, Debug)]
pub struct Identification {
    /// Bytes of the frame.
    pub length: usize,
    /// Type of the node.
    pub node_type: Place,
    /// Version of the interface.
    pub interface_version: Place,
}

/// The number at a place of a frame.
pub(crate) fn get(place: &[Piece], frame: &[u8]) -> u32 {
    place.iter().fold(0, |value, piece| {
        let byte = u32::from(frame.get(piece.byte).copied().unwrap_or(0));
        let run = byte.wrapping_shr(piece.shift.into()) & ones(piece.bits);
        value | run.wrapping_shl(piece.at.into())
    })
}

/// So many bits, at most those of a byte.
const fn ones(bits: u8) -> u32 {
    1_u32.wrapping_shl(bits as u32).wrapping_sub(1)
}
