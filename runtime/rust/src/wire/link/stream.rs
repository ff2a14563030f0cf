//! Framing of a link: header and trailer fields with roles.

use super::CrcForm;
use crate::wire::Table;

/// How messages are delimited.
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
    /// The packets of the transport.
    Packet,
}

/// Role of a header or trailer field.
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

/// A header or trailer field. The number in the `size` bytes from byte `at` on is shifted right by
/// `shift` and masked to `bits` bits.
#[derive(Clone, Copy, Debug)]
pub struct EnvelopeField {
    /// Role of the field.
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
    /// Constant or default value in telecommands and in telemetry.
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

/// The checksum. Kinds other than a CRC use `init`, `xor_out` and `width` of the form.
#[derive(Clone, Copy, Debug)]
pub struct CheckForm {
    /// How it is computed.
    pub kind: CheckKind,
    /// Its parameters.
    pub crc: CrcForm,
    /// Lookup table of a CRC.
    pub table: Option<&'static Table>,
    /// First byte of the header that it covers.
    pub covered_from: usize,
    /// Number of bytes of the trailer that it covers.
    pub covered_trailer: usize,
    /// Whether the seed of the message is appended as the last byte that it covers.
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
    /// Whether trailing zeros of the data are not sent, except for the first byte.
    pub cuts_zeros: bool,
    /// Seed: byte that the checksum covers last.
    pub seed: u8,
    /// Telecommand: id of the telemetry that is its reply.
    pub reply: Option<u32>,
}

/// Framing of messages in a stream of bytes or in packets.
#[derive(Clone, Copy, Debug)]
pub struct Stream {
    /// How messages are delimited.
    pub delimited_by: Delimiter,
    /// Size of the header in bytes.
    pub header_bytes: usize,
    /// Size of the trailer in bytes.
    pub trailer_bytes: usize,
    /// Value of the length field minus the number of data bytes.
    pub length_plus: i32,
    /// Whether each id has its own sequence counter.
    pub per_id: bool,
    /// The fields.
    pub fields: &'static [EnvelopeField],
    /// The checksum.
    pub check: Option<CheckForm>,
    /// The telecommands, in ascending order of the ids.
    pub telecommands: &'static [StreamRow],
    /// The telemetry, in ascending order of the ids.
    pub telemetry: &'static [StreamRow],
}
