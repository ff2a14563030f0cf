//! What a frame is, and what is told of it.

use super::check;
use super::encoder::Values;
use crate::wire::link::{EnvelopeField, EnvelopeRole, Stream, StreamRow};
use crate::wire::Direction;

/// A message, or what was dropped and why; and how a request of a client ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Event<'a> {
    /// A message.
    Message {
        /// Its id.
        id: u32,
        /// Its data.
        data: &'a [u8],
        /// The fields that the sender chose.
        values: Values,
    },
    /// Messages before this one did not come; none: it came again.
    Gap {
        /// The id of the message that came.
        id: u32,
        /// How many are missing.
        missing: u32,
    },
    /// The checksum is wrong.
    Checksum {
        /// The id that was read.
        id: u32,
    },
    /// No message, or not this one, has such a length.
    Length {
        /// The id, if so much of it could be read.
        id: Option<u32>,
    },
    /// The node has no such message.
    UnknownId {
        /// The id.
        id: u32,
    },
    /// Longer than the buffer.
    Overrun,
    /// A constant or a delimiter is not what it must be.
    Framing,
    /// Client: the reply came.
    Done {
        /// What was asked.
        direction: Direction,
        /// The id of that.
        id: u32,
        /// How often it was sent.
        attempts: u16,
        /// The id of the telemetry that answered.
        reply: u32,
        /// Its data.
        data: &'a [u8],
        /// The fields that its sender chose.
        values: Values,
    },
    /// Client: no reply came.
    Timeout {
        /// What was asked.
        direction: Direction,
        /// The id of that.
        id: u32,
        /// How often it was sent.
        attempts: u16,
    },
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
