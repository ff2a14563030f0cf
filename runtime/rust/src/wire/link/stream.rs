//! The envelope of a link that the ICD describes as fields with roles around the data.

use super::CrcForm;
use crate::wire::Table;

/// What tells where a message ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delimiter {
    /// A field of the header.
    Length,
    /// SLIP, RFC 1055.
    Slip,
    /// Consistent overhead byte stuffing.
    Cobs,
    /// Flags and escapes as on asynchronous lines, RFC 1662.
    Hdlc,
    /// The packet that carries it.
    Packet,
}

/// What a field of the envelope is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnvelopeRole {
    /// Counts messages.
    Sequence,
    /// Who sends.
    Source,
    /// Who it is for.
    Destination,
    /// What kind of message it is.
    Type,
    /// Bits of any meaning.
    Flags,
    /// When it was sent.
    Time,
    /// Always the same.
    Constant,
    /// The id of the message.
    Id,
    /// How long it is.
    Length,
    /// The checksum.
    Checksum,
}

/// A field: `size` bytes from byte `at` of the header or trailer on are a number, shifted and cut to `bits`.
#[derive(Clone, Copy, Debug)]
pub struct EnvelopeField {
    /// What it is.
    pub role: EnvelopeRole,
    /// Whether it stands in the trailer.
    pub in_trailer: bool,
    /// Its first byte.
    pub at: usize,
    /// Bytes that it has part in.
    pub size: usize,
    /// Bits below it.
    pub shift: u32,
    /// Its width.
    pub bits: u32,
    /// Whether the least significant byte comes first.
    pub little: bool,
    /// Of a constant, or unless another is chosen: in telecommands, in telemetry.
    pub values: [u32; 2],
}

/// How a checksum is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckKind {
    /// A cyclic redundancy check.
    Crc,
    /// Two running sums modulo 256.
    Fletcher,
    /// Two running sums modulo 255.
    Fletcher255,
    /// The sum of the bytes.
    Sum,
    /// Exclusive or of the bytes.
    Xor,
}

/// The checksum; kinds other than a CRC use init, `xor_out` and width of the form.
#[derive(Clone, Copy, Debug)]
pub struct CheckForm {
    /// How it is computed.
    pub kind: CheckKind,
    /// Its parameters.
    pub crc: CrcForm,
    /// What makes a CRC fast.
    pub table: Option<&'static Table>,
    /// The byte of the header from which on it is computed.
    pub covered_from: usize,
    /// Bytes of the trailer that it covers.
    pub covered_trailer: usize,
    /// Whether the seed of the message is covered, as a byte after all others.
    pub is_seeded: bool,
}

/// A message.
#[derive(Clone, Copy, Debug)]
pub struct StreamRow {
    /// Its id.
    pub id: u32,
    /// Least bytes of its data.
    pub least: usize,
    /// Most bytes of its data.
    pub most: usize,
    /// Whether zeros at the end of the data are not sent, but for one byte.
    pub cuts_zeros: bool,
    /// What its checksum covers after all others.
    pub seed: u8,
    /// Of a telecommand: the id of the telemetry that it is answered with.
    pub reply: Option<u32>,
}

/// How messages are put into a stream of bytes, or into packets.
#[derive(Clone, Copy, Debug)]
pub struct Stream {
    /// What tells where a message ends.
    pub delimited_by: Delimiter,
    /// Bytes before the data.
    pub header_bytes: usize,
    /// Bytes behind the data.
    pub trailer_bytes: usize,
    /// What the field of the length has more than the data have bytes.
    pub length_plus: i32,
    /// Whether each id counts its own sequence.
    pub per_id: bool,
    /// The fields.
    pub fields: &'static [EnvelopeField],
    /// The checksum.
    pub check: Option<CheckForm>,
    /// The telecommands, by rising id.
    pub telecommands: &'static [StreamRow],
    /// The telemetry, by rising id.
    pub telemetry: &'static [StreamRow],
}
