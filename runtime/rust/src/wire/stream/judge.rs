//! Check of received frames, and their events.

use super::check;
use super::encoder::Values;
use crate::wire::link::{Content, FieldRole, PacketField, PacketForm, Stream, StreamRow};
use crate::wire::Direction;

/// An event of the decoder: a message, or a dropped message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Event<'a> {
    /// A message.
    Message {
        /// Its id.
        id: u32,
        /// Its data.
        data: &'a [u8],
        /// Values of the header and trailer fields that the sender chose.
        values: &'a Values,
        /// Header of the packet.
        header: &'a [u8],
    },
    /// A request of telemetry.
    Request {
        /// Id of the telemetry.
        id: u32,
        /// Values of the header and trailer fields that the sender chose.
        values: &'a Values,
        /// Header of the packet.
        header: &'a [u8],
    },
    /// A packet without a message, or with requested telemetry that only the request names.
    Packet {
        /// Index of its format in `Stream::packets` of the link.
        packet: usize,
        /// Its id; 0 if it has none.
        id: u32,
        /// The whole packet: header, data and trailer.
        data: &'a [u8],
        /// Values of the header and trailer fields that the sender chose.
        values: &'a Values,
    },
    /// Messages were lost before this one; 0: this message is a repetition.
    Gap {
        /// Id of the received message; 0 if the packet has none.
        id: u32,
        /// Number of missing messages.
        missing: u32,
    },
    /// Wrong checksum.
    Checksum {
        /// Id in the message.
        id: u32,
        /// Header of the packet; empty if it is not known.
        header: &'a [u8],
        /// Whether the packet has the format of requests of telemetry.
        is_request: bool,
    },
    /// Dropped: wrong length of the message.
    Length {
        /// Id, if it could be read.
        id: Option<u32>,
        /// Header of the packet; empty if it is not known.
        header: &'a [u8],
        /// Whether the packet has the format of requests of telemetry.
        is_request: bool,
    },
    /// The node has no such message.
    UnknownId {
        /// The id.
        id: u32,
        /// Header of the packet; empty if it is not known.
        header: &'a [u8],
        /// Whether the packet has the format of requests of telemetry.
        is_request: bool,
    },
    /// Dropped: the message is longer than the buffer.
    Overrun,
    /// Dropped: wrong constant or delimiter.
    Framing,
}

impl Event<'static> {
    /// A packet whose length fields are wrong, so that its id is not known.
    pub(super) const WRONG_LENGTH: Self = Event::Length {
        id: None,
        header: &[],
        is_request: false,
    };
}

/// What a frame turned out to be.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    Taken,
    /// One beyond doubt, though of no use.
    Proven,
    /// Perhaps none at all.
    Doubtful,
}

/// Last sequence numbers, of each message or of all.
pub(super) type Sequences = [Option<u32>];

/// Check of frames of a packet format.
#[derive(Clone, Copy)]
pub(super) struct Judge {
    form: &'static Stream,
    direction: Direction,
    index: usize, // of the packet format
    pub(super) packet: &'static PacketForm,
}

impl Judge {
    /// Return the checks of all packet formats of a direction.
    pub(super) fn all(
        form: &'static Stream,
        direction: Direction,
    ) -> impl Iterator<Item = Self> + Clone {
        let packets = form.packets_of(direction);
        packets.map(move |(index, packet)| Self {
            form,
            direction,
            index,
            packet,
        })
    }

    /// Return whether the constants of the header are right, as far as they have arrived.
    pub(super) fn header_is_right(&self, frame: &[u8]) -> bool {
        let fields = self.packet.fields.iter();
        let mut came =
            fields.filter(|field| !field.in_trailer && field.at + field.size <= frame.len());
        came.all(|field| self.is_right(field, frame))
    }

    fn is_right(&self, field: &PacketField, frame: &[u8]) -> bool {
        field.role != FieldRole::Constant
            || field.get(self.packet, frame) == field.value(self.direction)
    }

    /// Return whether these bytes can be a packet of this format.
    fn can_be(&self, frame: &[u8]) -> bool {
        let mut fields = self.packet.fields.iter();
        frame.len() >= self.packet.around() && fields.all(|field| self.is_right(field, frame))
    }

    /// Return the number of data bytes that a field says; None if it is invalid.
    fn stated_length(&self, field: &PacketField, frame: &[u8]) -> Option<usize> {
        field.bytes_of(field.get(self.packet, frame))
    }

    /// Return the number of data bytes by the first length field; otherwise the id of the unknown message, or
    /// None if the length field is invalid.
    pub(super) fn length(&self, frame: &[u8]) -> Result<usize, Option<u32>> {
        if let Some(field) = self.packet.field(FieldRole::Length) {
            return self.stated_length(field, frame).ok_or(None);
        }
        let id = self.id(frame);
        match self.packet.content {
            Content::Requested => Ok(self.sizes().1),
            Content::Nothing | Content::Request => Ok(self.packet.reserved.len()),
            Content::Message => match self.message(id) {
                Some((_, row)) => Ok(row.most),
                None if self.requested(id).is_some() => Ok(self.packet.reserved.len()),
                None => Err(Some(id)),
            },
        }
    }

    /// Return the least and most data bytes of telemetry in packets without its id.
    fn sizes(&self) -> (usize, usize) {
        let sizes = self.own_rows().map(|row| (row.least, row.most));
        let both = sizes.reduce(|(least, most), (low, high)| (least.min(low), most.max(high)));
        both.unwrap_or((0, 0))
    }

    /// Return whether all length fields say the number of data bytes.
    fn length_is_right(&self, frame: &[u8]) -> bool {
        let length = frame.len().checked_sub(self.packet.around());
        let fields = self.packet.fields.iter();
        let mut lengths = fields.filter(|field| field.role == FieldRole::Length);
        lengths.all(|field| self.stated_length(field, frame) == length)
    }

    /// Return the messages that are sent in this packet format.
    fn own_rows(&self) -> impl Iterator<Item = &'static StreamRow> {
        let (rows, index) = (self.form.rows(self.direction).iter(), self.index);
        rows.filter(move |row| usize::from(row.packet) == index)
    }

    /// Return the id; of a packet without id, that of its only message.
    fn id(&self, frame: &[u8]) -> u32 {
        let only = || {
            let first = self.own_rows().next();
            let only = first.filter(|_| self.packet.tells_message());
            only.map_or(0, |row| row.id)
        };
        self.packet.id(frame).unwrap_or_else(only)
    }

    /// Return a message of this packet format, and its place in the table.
    fn message(&self, id: u32) -> Option<(usize, &'static StreamRow)> {
        let row = self.form.row(self.direction, id);
        let is_own = |row: &StreamRow| usize::from(row.packet) == self.index;
        row.filter(|(_, row)| self.packet.tells_message() && is_own(row))
    }

    /// Return the telemetry that a packet of this format requests.
    fn requested(&self, id: u32) -> Option<&'static StreamRow> {
        let request = self.form.request.as_ref()?;
        let is_request = self.direction == Direction::Telecommand && request.packet == self.index;
        let (_, row) = self.form.row(Direction::Telemetry, id)?;
        Some(row).filter(|row| is_request && row.is_requested)
    }

    /// Check a frame whose size comes from its header, which is right, and report its events.
    pub(super) fn judge(
        &self,
        frame: &[u8],
        sequences: &mut Sequences,
        on_event: &mut dyn FnMut(Event<'_>),
    ) -> Verdict {
        let mut trailer = self.packet.fields.iter().filter(|field| field.in_trailer);
        if !trailer.all(|field| self.is_right(field, frame)) {
            on_event(Event::Framing);
            return Verdict::Doubtful;
        }
        if !self.length_is_right(frame) {
            on_event(Event::WRONG_LENGTH);
            return Verdict::Doubtful;
        }
        self.judge_contents(frame, sequences, on_event)
    }

    /// Check a frame whose constants and length fields are right, and report its events.
    fn judge_contents(
        &self,
        frame: &[u8],
        sequences: &mut Sequences,
        on_event: &mut dyn FnMut(Event<'_>),
    ) -> Verdict {
        let packet = self.packet;
        let behind = frame.len().saturating_sub(packet.trailer_bytes);
        let (front, trailer) = frame.split_at(behind);
        let (header, data) = front.split_at(packet.header_bytes.min(behind));
        let id = self.id(frame);
        let is_request = packet.content == Content::Request;
        let message = self.message(id);
        let row = message.map_or_else(|| self.requested(id), |(_, row)| Some(row));
        if let (Some(field), Some(check)) = (packet.field(FieldRole::Checksum), &packet.check) {
            if check.is_seeded && row.is_none() && packet.tells_message() {
                on_event(Event::UnknownId {
                    id,
                    header,
                    is_request,
                });
                return Verdict::Doubtful;
            }
            let sum = check::whole(packet, check, row, [header, data, trailer]);
            if field.get(packet, frame) != sum {
                on_event(Event::Checksum {
                    id,
                    header,
                    is_request,
                });
                return Verdict::Doubtful;
            }
        }
        let length = data.len();
        let is_right = match (message, row) {
            _ if packet.content == Content::Nothing => length == packet.reserved.len(),
            _ if packet.content == Content::Requested => {
                let (least, most) = self.sizes();
                (least..=most).contains(&length)
            }
            (Some((_, row)), _) => (row.least..=row.most).contains(&length),
            (None, Some(row)) => length == packet.reserved.len() && self.awaits(row, frame),
            (None, None) => {
                on_event(Event::UnknownId {
                    id,
                    header,
                    is_request,
                });
                return Verdict::Proven;
            }
        };
        if !is_right {
            on_event(Event::Length {
                id: Some(id),
                header,
                is_request,
            });
            return Verdict::Proven;
        }
        let values = &self.values(frame);
        let place = message.map(|(place, _)| place);
        self.check_sequence(place, id, values, sequences, on_event);
        on_event(if !packet.tells_message() {
            Event::Packet {
                packet: self.index,
                id,
                data: frame,
                values,
            }
        } else if message.is_some() {
            Event::Message {
                id,
                data,
                values,
                header,
            }
        } else {
            Event::Request { id, values, header }
        });
        Verdict::Taken
    }

    /// Return whether a request says the length of the telemetry, if it says one.
    fn awaits(&self, row: &StreamRow, frame: &[u8]) -> bool {
        let field = self.packet.field(FieldRole::ResponseLength);
        field.map_or(true, |field| {
            self.stated_length(field, frame) == Some(row.most)
        })
    }

    fn values(&self, frame: &[u8]) -> Values {
        let mut values = Values::default();
        for field in self.packet.fields {
            if let Some(value) = values.place(field.role) {
                *value = Some(field.get(self.packet, frame));
            }
        }
        values
    }

    /// Report a gap before this packet. `place` is that of its message in the table.
    fn check_sequence(
        &self,
        place: Option<usize>,
        id: u32,
        values: &Values,
        sequences: &mut Sequences,
        on_event: &mut dyn FnMut(Event<'_>),
    ) {
        // Only messages have a counter for each id.
        let key = if self.form.per_id { place } else { Some(0) };
        let counter = key.and_then(|key| sequences.get_mut(key));
        let field = self.packet.field(FieldRole::Sequence);
        if let (Some(field), Some(counter), Some(number)) = (field, counter, values.sequence) {
            if let Some(last) = counter.replace(number) {
                let missing = number.wrapping_sub(last).wrapping_sub(1) & field.mask();
                if missing != 0 {
                    let missing = if number == last { 0 } else { missing };
                    on_event(Event::Gap { id, missing });
                }
            }
        }
    }
}

/// Check a frame that is delimited on both sides by the first packet format that it can be, and
/// report its events.
pub(super) fn judge_delimited(
    judges: impl Iterator<Item = Judge> + Clone,
    frame: &[u8],
    sequences: &mut Sequences,
    on_event: &mut dyn FnMut(Event<'_>),
) -> Verdict {
    let (mut first, mut possible) = (judges.clone(), judges);
    let fault = match possible.find(|judge| judge.can_be(frame)) {
        Some(judge) if judge.length_is_right(frame) => {
            return judge.judge_contents(frame, sequences, on_event);
        }
        None if first
            .next()
            .map_or(false, |it| it.packet.around() <= frame.len()) =>
        {
            Event::Framing
        }
        _ => Event::WRONG_LENGTH,
    };
    on_event(fault);
    Verdict::Doubtful
}
