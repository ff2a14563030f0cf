//! Check of received frames, and their events.

use super::check;
use super::encoder::Values;
use crate::wire::link::{EnvelopeField, EnvelopeRole, Stream, StreamRow};
use crate::wire::Direction;

/// A message, a dropped message, or the outcome of a request of a client.
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
        values: Values,
    },
    /// Messages were lost before this one; 0: this message is a repetition.
    Gap {
        /// Id of the received message.
        id: u32,
        /// Number of missing messages.
        missing: u32,
    },
    /// Wrong checksum.
    Checksum {
        /// Id in the message.
        id: u32,
    },
    /// Dropped: wrong length of the message.
    Length {
        /// Id, if it could be read.
        id: Option<u32>,
    },
    /// The node has no such message.
    UnknownId {
        /// The id.
        id: u32,
    },
    /// Dropped: the message is longer than the buffer.
    Overrun,
    /// Dropped: wrong constant or delimiter.
    Framing,
    /// Client: the device executed the request.
    Done {
        /// Direction of the request.
        direction: Direction,
        /// Id of the request.
        id: u32,
        /// Number of times the request was sent.
        attempts: u16,
        /// Id of the response that completed it.
        reply: u32,
        /// Data of the response.
        data: &'a [u8],
        /// Values of the header and trailer fields of the response.
        values: Values,
    },
    /// Client: the telecommand was sent, and nothing responds to it.
    Sent {
        /// Direction of the request.
        direction: Direction,
        /// Id of the request.
        id: u32,
        /// Number of times the request was sent.
        attempts: u16,
    },
    /// Client: the device refused the request.
    Refused {
        /// Direction of the request.
        direction: Direction,
        /// Id of the request.
        id: u32,
        /// Number of times the request was sent.
        attempts: u16,
        /// The reason, if the response has one.
        code: Option<u32>,
        /// Id of the response.
        reply: u32,
        /// Data of the response.
        data: &'a [u8],
    },
    /// Client: the device was busy each time, so the request was not executed.
    Busy {
        /// Direction of the request.
        direction: Direction,
        /// Id of the request.
        id: u32,
        /// Number of times the request was sent.
        attempts: u16,
        /// The reason, if the response has one.
        code: Option<u32>,
        /// Id of the response.
        reply: u32,
        /// Data of the response.
        data: &'a [u8],
    },
    /// Client: no response in time, so it is not known whether the request was executed.
    Timeout {
        /// Direction of the request.
        direction: Direction,
        /// Id of the request.
        id: u32,
        /// Number of times the request was sent.
        attempts: u16,
    },
    /// Client: a response that does not end the request: the device is still executing it, is busy,
    /// or has accepted it and its reply is still missing.
    Progress {
        /// Direction of the request.
        direction: Direction,
        /// Id of the request.
        id: u32,
        /// Id of the response.
        reply: u32,
        /// Data of the response.
        data: &'a [u8],
    },
    /// Client: the requested telemetry, before the acknowledge of its request.
    Reply {
        /// Direction of the request.
        direction: Direction,
        /// Id of the request.
        id: u32,
        /// Id of the telemetry.
        reply: u32,
        /// Data of the telemetry.
        data: &'a [u8],
        /// Values of the header and trailer fields of the telemetry.
        values: Values,
    },
    /// Client: a response to a request that has ended.
    Late {
        /// Id of the response.
        id: u32,
        /// Data of the response.
        data: &'a [u8],
    },
    /// Client: a response to none of the requests.
    Stray {
        /// Id of the response.
        id: u32,
        /// Data of the response.
        data: &'a [u8],
    },
}

impl<'a> Event<'a> {
    /// Return id and data of the telemetry that the event is about.
    pub(super) const fn telemetry(&self) -> Option<(u32, &'a [u8])> {
        match *self {
            Self::Message { id, data, .. } | Self::Late { id, data } | Self::Stray { id, data } => {
                Some((id, data))
            }
            Self::Done { reply, data, .. }
            | Self::Refused { reply, data, .. }
            | Self::Busy { reply, data, .. }
            | Self::Progress { reply, data, .. }
            | Self::Reply { reply, data, .. } => Some((reply, data)),
            _ => None,
        }
    }
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

/// The sequence numbers of a decoder; `S` is how many it remembers.
#[derive(Clone, Debug)]
pub(super) struct Sequences<const S: usize>([Option<u32>; S]);

impl<const S: usize> Sequences<S> {
    pub(super) const fn new() -> Self {
        Self([None; S])
    }
}

/// Says what frames are.
#[derive(Clone, Copy)]
pub(super) struct Judge {
    form: &'static Stream,
    direction: Direction,
}

impl Judge {
    pub(super) const fn new(form: &'static Stream, direction: Direction) -> Self {
        Self { form, direction }
    }

    /// Whether the constants of the header are right, as far as it came.
    pub(super) fn header_is_right(self, frame: &[u8]) -> bool {
        let fields = self.form.fields.iter();
        let mut came =
            fields.filter(|field| !field.in_trailer && field.at + field.size <= frame.len());
        came.all(|field| self.is_right(field, frame))
    }

    fn is_right(self, field: &EnvelopeField, frame: &[u8]) -> bool {
        field.role != EnvelopeRole::Constant
            || field.get(self.form, frame) == field.value(self.direction)
    }

    /// Bytes of data that a length means; none if it means none.
    pub(super) fn length(self, value: u32) -> Option<usize> {
        let length = i64::from(value).checked_sub(i64::from(self.form.length_plus))?;
        usize::try_from(length).ok()
    }

    fn id(self, frame: &[u8]) -> u32 {
        self.form.field(EnvelopeRole::Id).map_or_else(
            || {
                self.form
                    .rows(self.direction)
                    .first()
                    .map_or(0, |row| row.id)
            },
            |field| field.get(self.form, frame),
        )
    }

    /// Tells of a frame.
    pub(super) fn judge<const S: usize>(
        self,
        frame: &[u8],
        sequences: &mut Sequences<S>,
        on_event: &mut dyn FnMut(Event<'_>),
    ) -> Verdict {
        let form = self.form;
        let behind = frame.len().wrapping_sub(form.trailer_bytes);
        let parts = (
            frame.get(..form.header_bytes),
            frame.get(form.header_bytes..behind),
            frame.get(behind..),
        );
        let (header, data, trailer) = if let (Some(header), Some(data), Some(trailer)) = parts {
            (header, data, trailer)
        } else {
            on_event(Event::Length { id: None });
            return Verdict::Doubtful;
        };
        if !form.fields.iter().all(|field| self.is_right(field, frame)) {
            on_event(Event::Framing);
            return Verdict::Doubtful;
        }
        if let Some(field) = form.field(EnvelopeRole::Length) {
            if self.length(field.get(form, frame)) != Some(data.len()) {
                on_event(Event::Length { id: None });
                return Verdict::Doubtful;
            }
        }
        let id = self.id(frame);
        let known = form.row(self.direction, id);
        if let (Some(field), Some(check)) = (form.field(EnvelopeRole::Checksum), &form.check) {
            if check.is_seeded && known.is_none() {
                on_event(Event::UnknownId { id });
                return Verdict::Doubtful;
            }
            let row = known.map(|(_, row)| row);
            let sum = check::whole(form, check, row, [header, data, trailer]);
            if field.get(form, frame) != sum {
                on_event(Event::Checksum { id });
                return Verdict::Doubtful;
            }
        }
        let (place, row) = if let Some(known) = known {
            known
        } else {
            on_event(Event::UnknownId { id });
            return Verdict::Proven;
        };
        if data.len() < row.least || data.len() > row.most {
            on_event(Event::Length { id: Some(id) });
            return Verdict::Proven;
        }
        self.message(place, row, frame, data, sequences, on_event);
        Verdict::Taken
    }

    fn message<const S: usize>(
        self,
        place: usize,
        row: &StreamRow,
        frame: &[u8],
        data: &[u8],
        sequences: &mut Sequences<S>,
        on_event: &mut dyn FnMut(Event<'_>),
    ) {
        let mut values = Values::default();
        for field in self.form.fields {
            if let Some(value) = values.place(field.role) {
                *value = field.get(self.form, frame);
            }
        }
        let id = row.id;
        if let Some(field) = self.form.field(EnvelopeRole::Sequence) {
            let key = if self.form.per_id { place } else { 0 };
            if let Some(known) = sequences.0.get_mut(key) {
                let number = values.sequence;
                if let Some(last) = known.replace(number) {
                    let missing = number.wrapping_sub(last).wrapping_sub(1) & field.mask();
                    if missing != 0 {
                        let missing = if number == last { 0 } else { missing };
                        on_event(Event::Gap { id, missing });
                    }
                }
            }
        }
        on_event(Event::Message { id, data, values });
    }
}
