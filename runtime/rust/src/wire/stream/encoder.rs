//! Encoder of messages with header and trailer.

use super::check;
use crate::wire::bits::head;
use crate::wire::link::{
    Content, Delimiter, Escaping, FieldRole, Link, PacketForm, Stream, StreamRow,
};
use crate::wire::{Direction, Error};

pub(super) const SLIP_END: u8 = 0xc0;
pub(super) const SLIP_ESCAPE: u8 = 0xdb;
pub(super) const SLIP_ESCAPED_END: u8 = 0xdc;
pub(super) const SLIP_ESCAPED_ESCAPE: u8 = 0xdd;
pub(super) const HDLC_FLAG: u8 = 0x7e;
pub(super) const HDLC_ESCAPE: u8 = 0x7d;
pub(super) const HDLC_FLIP: u8 = 0x20;
/// A block of COBS that has no zero behind it.
pub(super) const COBS_WHOLE: u8 = 0xff;
/// Bytes of a header or trailer, at most.
const HEADER_BYTES: usize = 64;

/// A header, followed by zeros.
pub(in crate::wire) type Header = [u8; HEADER_BYTES];

/// Values of the header and trailer fields that the sender chooses.
///
/// In a message to send, None stands for the default of the ICD, and values of fields that its
/// packet does not have are ignored. In a received message, None means that its packet does not have
/// the field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Values {
    /// Counts messages.
    pub sequence: Option<u32>,
    /// Who sends.
    pub source: Option<u32>,
    /// Who it is for.
    pub destination: Option<u32>,
    /// What kind of message it is.
    pub kind: Option<u32>,
    /// Bits of any meaning.
    pub flags: Option<u32>,
    /// When it was sent.
    pub time: Option<u32>,
    /// Result of a request.
    pub status: Option<u32>,
    /// Reason of a refusal.
    pub reason: Option<u32>,
}

impl Values {
    /// No values.
    pub(in crate::wire) const NONE: Self = Self {
        sequence: None,
        source: None,
        destination: None,
        kind: None,
        flags: None,
        time: None,
        status: None,
        reason: None,
    };

    /// Return these values, and those of `other` for the fields without a value.
    pub(super) fn or(self, other: Self) -> Self {
        Self {
            sequence: self.sequence.or(other.sequence),
            source: self.source.or(other.source),
            destination: self.destination.or(other.destination),
            kind: self.kind.or(other.kind),
            flags: self.flags.or(other.flags),
            time: self.time.or(other.time),
            status: self.status.or(other.status),
            reason: self.reason.or(other.reason),
        }
    }

    /// Check that each value fits its field in the packets of the host.
    pub(in crate::wire) fn check(mut self, form: &Stream) -> Result<(), Error> {
        let packets = form.packets_of(Direction::Telecommand);
        for field in packets.flat_map(|(_, packet)| packet.fields) {
            let value = self.place(field.role).and_then(|value| *value);
            if value.map_or(false, |value| value > field.mask()) {
                return Err(Error::range(name(field.role)));
            }
        }
        Ok(())
    }

    pub(super) fn place(&mut self, role: FieldRole) -> Option<&mut Option<u32>> {
        match role {
            FieldRole::Sequence => Some(&mut self.sequence),
            FieldRole::Source => Some(&mut self.source),
            FieldRole::Destination => Some(&mut self.destination),
            FieldRole::Type => Some(&mut self.kind),
            FieldRole::Flags => Some(&mut self.flags),
            FieldRole::Time => Some(&mut self.time),
            FieldRole::Status => Some(&mut self.status),
            FieldRole::Reason => Some(&mut self.reason),
            _ => None,
        }
    }
}

/// Encode a message with header, trailer and delimiters, and return the number of bytes written to
/// `out`.
///
/// # Errors
///
/// [`Error::Unsupported`] if the ICD describes no framing, [`Error::UnknownId`] if there is no such
/// message, [`Error::Length`] if the data have the wrong length or `out` is too small,
/// [`Error::Range`] if a value does not fit into its field.
///
/// ```
/// use icdgen_runtime::wire::stream::{encode, Values};
/// use icdgen_runtime::wire::{Direction, Error, Link};
///
/// fn sent(link: &Link, id: u32, data: &[u8], port: &mut Vec<u8>) -> Result<(), Error> {
///     let mut line = [0; 600];
///     let values = Values { time: Some(12), ..Values::default() };
///     let size = encode(link, Direction::Telecommand, id, data, &values, &mut line)?;
///     port.extend_from_slice(&line[..size]);
///     Ok(())
/// }
/// ```
pub fn encode(
    link: &Link,
    direction: Direction,
    id: u32,
    data: &[u8],
    values: &Values,
    out: &mut [u8],
) -> Result<usize, Error> {
    encoded(link, direction, id, data, values, out).map(|(size, _)| size)
}

/// As [`encode`]; also return the header.
pub(super) fn encoded(
    link: &Link,
    direction: Direction,
    id: u32,
    data: &[u8],
    values: &Values,
    out: &mut [u8],
) -> Result<(usize, Header), Error> {
    let form = link.stream.as_ref().ok_or(Error::Unsupported)?;
    let (_, row) = form.row(direction, id).ok_or(Error::UnknownId { id })?;
    if data.len() < row.least || data.len() > row.most {
        return Err(Error::Length {
            expected: if data.len() > row.most {
                row.most
            } else {
                row.least
            },
            actual: data.len(),
        });
    }
    let data = if row.cuts_zeros {
        without_zeros(data)
    } else {
        data
    };
    let packet = form
        .packets
        .get(usize::from(row.packet))
        .ok_or(Error::Unsupported)?;
    let message = Message {
        packet,
        direction,
        id,
        row: Some(row),
        data,
    };
    message.encode(form.delimited_by, values, out)
}

/// Encode a request of the telemetry with this id, and return the number of bytes written to `out`.
///
/// # Errors
///
/// [`Error::Unsupported`] if no packet requests telemetry, [`Error::UnknownId`] if none requests
/// this, [`Error::Length`] if `out` is too small, [`Error::Range`] if a value does not fit into its
/// field.
pub fn encode_request(
    link: &Link,
    id: u32,
    values: &Values,
    out: &mut [u8],
) -> Result<usize, Error> {
    encoded_request(link, id, values, out).map(|(size, _)| size)
}

/// As [`encode_request`]; also return the header.
pub(super) fn encoded_request(
    link: &Link,
    id: u32,
    values: &Values,
    out: &mut [u8],
) -> Result<(usize, Header), Error> {
    let form = link.stream.as_ref().ok_or(Error::Unsupported)?;
    let request = form.request.as_ref().ok_or(Error::Unsupported)?;
    let row = form.row(Direction::Telemetry, id).map(|(_, row)| row);
    let row = row.filter(|row| row.is_requested);
    let packet = form.packets.get(request.packet).ok_or(Error::Unsupported)?;
    let message = Message {
        packet,
        direction: Direction::Telecommand,
        id,
        row: Some(row.ok_or(Error::UnknownId { id })?),
        data: packet.reserved,
    };
    message.encode(form.delimited_by, values, out)
}

/// Encode a packet without a message, such as an acknowledge or a refusal, as a device sends it, and
/// return the number of bytes written to `out`.
///
/// `packet` is the index of its format in [`Stream::packets`], `id` the value of its id field.
///
/// # Errors
///
/// [`Error::Unsupported`] if the ICD describes no framing, [`Error::Range`] if there is no such
/// packet without a message in this direction, or if the id or a value does not fit into its field,
/// [`Error::Length`] if `out` is too small.
pub fn encode_packet(
    link: &Link,
    direction: Direction,
    packet: usize,
    id: u32,
    values: &Values,
    out: &mut [u8],
) -> Result<usize, Error> {
    encoded_packet(link, direction, packet, id, values, out).map(|(size, _)| size)
}

/// As [`encode_packet`]; also return the header.
pub(super) fn encoded_packet(
    link: &Link,
    direction: Direction,
    packet: usize,
    id: u32,
    values: &Values,
    out: &mut [u8],
) -> Result<(usize, Header), Error> {
    let form = link.stream.as_ref().ok_or(Error::Unsupported)?;
    let mut packets = form.packets_of(direction);
    let found = packets.find(|(index, _)| *index == packet);
    let found = found.filter(|(_, packet)| packet.content == Content::Nothing);
    let (_, packet) = found.ok_or_else(|| Error::range("packet"))?;
    let message = Message {
        packet,
        direction,
        id,
        row: None,
        data: packet.reserved,
    };
    message.encode(form.delimited_by, values, out)
}

/// A packet to encode.
struct Message<'a> {
    packet: &'a PacketForm,
    direction: Direction,
    id: u32,
    row: Option<&'a StreamRow>, // the message, or the telemetry that is requested
    data: &'a [u8],
}

impl Message<'_> {
    fn encode(
        &self,
        delimited_by: Delimiter,
        values: &Values,
        out: &mut [u8],
    ) -> Result<(usize, Header), Error> {
        let (packet, data) = (self.packet, self.data);
        let (mut header, mut trailer) = ([0; HEADER_BYTES], [0; HEADER_BYTES]);
        let mut values = *values;
        for field in packet.fields {
            let value = match field.role {
                FieldRole::Checksum => continue,
                FieldRole::Id => i64::from(packet.part(field, self.id)),
                FieldRole::Length => field.counted(data.len()),
                FieldRole::ResponseLength => self.row.map_or_else(
                    || i64::from(field.value(self.direction)),
                    |row| field.counted(row.most),
                ),
                role => {
                    let chosen = values.place(role).and_then(|value| *value);
                    i64::from(chosen.unwrap_or_else(|| field.value(self.direction)))
                }
            };
            let fitting = u32::try_from(value).ok();
            let value = fitting.filter(|value| *value <= field.mask());
            let value = value.ok_or_else(|| Error::range(name(field.role)))?;
            let into = if field.in_trailer {
                &mut trailer
            } else {
                &mut header
            };
            field.put(into, value);
        }
        if let (Some(field), Some(check)) = (packet.field(FieldRole::Checksum), &packet.check) {
            let sum = check::whole(packet, check, self.row, [&header, data, &trailer]);
            let into = if field.in_trailer {
                &mut trailer
            } else {
                &mut header
            };
            field.put(into, sum);
        }
        let front = head(&header, packet.header_bytes);
        let trailer = head(&trailer, packet.trailer_bytes);
        let size = line(delimited_by, [front, data, trailer], out)?;
        Ok((size, header))
    }
}

/// The data without the zeros at their end, but for one.
fn without_zeros(data: &[u8]) -> &[u8] {
    let mut left = data;
    while let [rest @ .., 0] = left {
        if rest.is_empty() {
            break;
        }
        left = rest;
    }
    left
}

pub(super) const fn name(role: FieldRole) -> &'static str {
    match role {
        FieldRole::Sequence => "sequence",
        FieldRole::Source => "source",
        FieldRole::Destination => "destination",
        FieldRole::Type => "type",
        FieldRole::Flags => "flags",
        FieldRole::Time => "time",
        FieldRole::Status => "status",
        FieldRole::Reason => "reason",
        FieldRole::Constant => "constant",
        FieldRole::Id => "id",
        FieldRole::Length => "length",
        FieldRole::ResponseLength => "response_length",
        FieldRole::Checksum => "checksum",
    }
}

/// Writes the pieces of a message with what delimits it.
fn line(delimited_by: Delimiter, pieces: [&[u8]; 3], out: &mut [u8]) -> Result<usize, Error> {
    let [header, data, trailer] = pieces;
    let actual = out.len();
    let mut line = Line {
        out,
        count: 0,
        block: 0,
        is_whole: false,
    };
    match delimited_by {
        Delimiter::Slip => line.byte(SLIP_END),
        Delimiter::Hdlc => line.byte(HDLC_FLAG),
        Delimiter::Cobs => line.byte(0),
        Delimiter::Escape(escaping) => line.start(escaping),
        Delimiter::Length | Delimiter::Datagram => (),
    }
    for byte in header.iter().chain(data).chain(trailer) {
        match delimited_by {
            Delimiter::Slip => line.slip(*byte),
            Delimiter::Hdlc => line.hdlc(*byte),
            Delimiter::Cobs => line.cobs(*byte),
            Delimiter::Escape(escaping) => line.escape(*byte, escaping),
            Delimiter::Length | Delimiter::Datagram => line.byte(*byte),
        }
    }
    match delimited_by {
        Delimiter::Slip => line.byte(SLIP_END),
        Delimiter::Hdlc => line.byte(HDLC_FLAG),
        Delimiter::Cobs => line.end(),
        Delimiter::Escape(escaping) => {
            line.byte(escaping.escape);
            line.byte(escaping.end);
        }
        Delimiter::Length | Delimiter::Datagram => (),
    }
    let expected = line.count;
    if expected > actual {
        return Err(Error::Length { expected, actual });
    }
    Ok(expected)
}

/// Where a message is written; it counts on where there is no more room.
struct Line<'a> {
    out: &'a mut [u8],
    count: usize,
    block: usize, // of COBS: where its length stands
    is_whole: bool,
}

impl Line<'_> {
    fn byte(&mut self, byte: u8) {
        if let Some(place) = self.out.get_mut(self.count) {
            *place = byte;
        }
        self.count = self.count.saturating_add(1);
    }

    fn slip(&mut self, byte: u8) {
        match byte {
            SLIP_END => {
                self.byte(SLIP_ESCAPE);
                self.byte(SLIP_ESCAPED_END);
            }
            SLIP_ESCAPE => {
                self.byte(SLIP_ESCAPE);
                self.byte(SLIP_ESCAPED_ESCAPE);
            }
            _ => self.byte(byte),
        }
    }

    fn hdlc(&mut self, byte: u8) {
        if matches!(byte, HDLC_FLAG | HDLC_ESCAPE) {
            self.byte(HDLC_ESCAPE);
            self.byte(byte ^ HDLC_FLIP);
        } else {
            self.byte(byte);
        }
    }

    fn start(&mut self, escaping: Escaping) {
        self.byte(escaping.escape);
        if let Some(start) = escaping.start {
            self.byte(start);
        }
    }

    fn escape(&mut self, byte: u8, escaping: Escaping) {
        self.byte(byte);
        if byte == escaping.escape {
            self.byte(escaping.data);
        }
    }

    fn cobs(&mut self, byte: u8) {
        if self.is_whole {
            self.byte(0);
            self.is_whole = false;
        }
        if byte == 0 {
            self.close();
            self.byte(0);
        } else {
            self.byte(byte);
            if self.count.wrapping_sub(self.block) == usize::from(COBS_WHOLE) {
                self.close();
                self.is_whole = true;
            }
        }
    }

    /// Ends a block, whose length stands before it.
    fn close(&mut self) {
        let length = u8::try_from(self.count.wrapping_sub(self.block)).unwrap_or(0);
        if let Some(place) = self.out.get_mut(self.block) {
            *place = length;
        }
        self.block = self.count;
    }

    fn end(&mut self) {
        if !self.is_whole {
            self.close();
        }
        self.byte(0);
    }
}
