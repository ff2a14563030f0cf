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
    /// Escape characters.
    Escape(Escaping),
    /// Each datagram is a message.
    Datagram,
}

/// The escape byte that delimits packets, and the bytes that follow it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Escaping {
    /// The escape byte.
    pub escape: u8,
    /// Begins a packet; None: the first byte of the packet does.
    pub start: Option<u8>,
    /// Ends a packet.
    pub end: u8,
    /// Stands for the escape byte itself.
    pub data: u8,
    /// Within a packet: whether an escape byte and any other byte are skipped.
    pub ignores_other: bool,
}

impl Escaping {
    /// Return whether a byte that follows the escape byte begins a packet.
    #[must_use]
    pub const fn begins(&self, byte: u8) -> bool {
        match self.start {
            Some(start) => byte == start,
            None => byte != self.escape && byte != self.end && byte != self.data,
        }
    }
}

/// Role of a header or trailer field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldRole {
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
    /// Result of a request.
    Status,
    /// Reason of a refusal.
    Reason,
    /// Always the same.
    Constant,
    /// The id of the message, or a part of it.
    Id,
    /// How long it is.
    Length,
    /// How long the requested telemetry is.
    ResponseLength,
    /// The checksum.
    Checksum,
}

/// A header or trailer field. The number in the `size` bytes from byte `at` on is shifted right by
/// `shift` and masked to `bits` bits.
#[derive(Clone, Copy, Debug)]
pub struct PacketField {
    /// Role of the field.
    pub role: FieldRole,
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
    /// Part of an id: bits of the id below it.
    pub id_shift: u32,
    /// Length: number of bytes that it counts as one.
    pub unit: u32,
    /// Length: number that is added to the bytes of the data, before it counts.
    pub plus: i32,
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

/// How a checksum is computed. Kinds other than a CRC use `init`, `xor_out` and `width` of `crc`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChecksumAlgorithm {
    /// Its kind.
    pub kind: CheckKind,
    /// Its parameters.
    pub crc: CrcForm,
}

/// The checksum of a packet.
#[derive(Clone, Copy, Debug)]
pub struct CheckForm {
    /// How it is computed.
    pub algorithm: ChecksumAlgorithm,
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
    /// Index of its packet format in [`Stream::packets`].
    pub packet: u16,
    /// Telemetry: whether packets of [`Stream::request`] request it.
    pub is_requested: bool,
    /// Telecommand: index of its exchange in [`Stream::exchanges`]; None if nothing responds to it.
    pub exchange: Option<usize>,
    /// Telecommand: whether it may be sent again after a time-out.
    pub repeats: bool,
    /// Telecommand: id of the telemetry that it requests if it is sent as `least` zero bytes.
    pub requests: Option<u32>,
}

/// What a response says about a telecommand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// It was accepted.
    Ack,
    /// The telemetry that it requested.
    Reply,
    /// It was refused.
    Nak,
    /// The device is busy.
    Busy,
    /// It is still being executed.
    Progress,
    /// It was damaged on the line, and is sent again.
    Again,
}

/// Place of a number: the `size` bytes (at most 4) from byte `at` on, shifted right by `shift` and
/// masked to `bits` bits. Bytes that a message does not have are 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NumberPlace {
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
}

/// What a response is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ResponseKind {
    /// Telemetry with this id.
    Telemetry(u32),
    /// The telemetry that was requested.
    Requested,
    /// A packet without a message: index in [`Stream::packets`].
    Packet(usize),
}

/// A number of a response that repeats a number of the telecommand.
#[derive(Clone, Copy, Debug)]
pub struct Echo {
    /// Its place in the response.
    pub place: NumberPlace,
    /// Index in [`Exchange::sources`].
    pub source: usize,
}

/// What can end, refuse, defer or prolong a request. The places are those in the data of telemetry,
/// or in a whole packet.
#[derive(Clone, Copy, Debug)]
pub struct Response {
    /// What it is.
    pub kind: ResponseKind,
    /// What it means; with a status, what a value means that is not in `meanings`.
    pub verdict: Verdict,
    /// Numbers that must be equal to those of the telecommand.
    pub echoes: &'static [Echo],
    /// The status.
    pub status: Option<NumberPlace>,
    /// Values of the status and their meanings.
    pub meanings: &'static [(u32, Verdict)],
    /// Reason of a refusal.
    pub reason: Option<NumberPlace>,
    /// Number that says more about a refusal.
    pub detail: Option<NumberPlace>,
}

/// Telemetry that a client requests until it is the response to a telecommand.
#[derive(Clone, Copy, Debug)]
pub struct Poll {
    /// Its id.
    pub telemetry: u32,
    /// Number that is not 0 if it is the response.
    pub until: NumberPlace,
}

/// The possible responses to a request.
#[derive(Clone, Copy, Debug)]
pub struct Exchange {
    /// Numbers of the telecommand that responses repeat, at most [`Exchange::SOURCES`]: places in
    /// its id, as 4 bytes with the most significant first, followed by its data. The last
    /// `in_header` of them are places in the header of its packet.
    pub sources: &'static [NumberPlace],
    /// Number of sources in the header.
    pub in_header: usize,
    /// The responses.
    pub responses: &'static [Response],
    /// The time-out; 0: that of the client.
    pub timeout_ms: u32,
    /// How the response is polled; None: it comes by itself.
    pub poll: Option<Poll>,
}

/// The possible responses on a bus.
#[derive(Clone, Copy, Debug)]
pub struct BusExchanges {
    /// To telecommands that are acknowledged.
    pub command: Option<Exchange>,
    /// To requests of telemetry.
    pub request: Exchange,
}

impl Exchange {
    /// Largest number of sources.
    pub const SOURCES: usize = 4;
}

/// What packets of a format carry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Messages.
    Message,
    /// Requests of telemetry.
    Request,
    /// Telemetry that was requested; only the request has its id.
    Requested,
    /// No message: the packet itself is a response.
    Nothing,
}

/// A packet format: header and trailer around the data of a message.
#[derive(Clone, Copy, Debug)]
pub struct PacketForm {
    /// Name of the format in the ICD.
    pub name: &'static str,
    /// Whether the host sends such packets.
    pub from_host: bool,
    /// Whether the device sends such packets.
    pub from_device: bool,
    /// Size of the header in bytes.
    pub header_bytes: usize,
    /// Size of the trailer in bytes.
    pub trailer_bytes: usize,
    /// The fields.
    pub fields: &'static [PacketField],
    /// The checksum.
    pub check: Option<CheckForm>,
    /// What it carries.
    pub content: Content,
    /// The data bytes of packets without a message: zeros.
    pub reserved: &'static [u8],
}

/// Packets that request telemetry.
#[derive(Clone, Copy, Debug)]
pub struct RequestForm {
    /// Index of the packet format in [`Stream::packets`].
    pub packet: usize,
    /// Index of the responses in [`Stream::exchanges`].
    pub exchange: usize,
}

/// Framing of messages in a stream of bytes or in packets of the transport.
#[derive(Clone, Copy, Debug)]
pub struct Stream {
    /// How messages are delimited.
    pub delimited_by: Delimiter,
    /// Whether each id has its own sequence counter.
    pub per_id: bool,
    /// The packet formats.
    pub packets: &'static [PacketForm],
    /// The telecommands, in ascending order of the ids.
    pub telecommands: &'static [StreamRow],
    /// The telemetry, in ascending order of the ids.
    pub telemetry: &'static [StreamRow],
    /// The exchanges of the telecommands, and of requests of telemetry.
    pub exchanges: &'static [Exchange],
    /// Ids of telemetry that only responds to telecommands, and is not requested.
    pub confirming: &'static [u32],
    /// Packets that request telemetry.
    pub request: Option<RequestForm>,
}
