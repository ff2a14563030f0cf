//! Telemetry logs: the file form and the unsolicited form.

use super::bits::{copy, head, number, part, part_mut, put_number};
use super::link::{Link, LogFile, LogMask, LogMessage, Span};
use super::message::octet;
use super::Error;
use crate::Telemetry;

/// A selected bit of a log mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot {
    /// The bit.
    pub bit: u16,
    /// The telemetry id; None if the ICD assigns no frame to the bit.
    pub id: Option<u8>,
    /// Bytes of the frame, or of the slot.
    pub length: usize,
    /// What the ICD calls the frame.
    pub name: Option<&'static str>,
}

impl LogMask {
    /// The slots of an entry, in order.
    pub fn selected<'a>(&'a self, mask: &'a [u8]) -> impl Iterator<Item = Slot> + 'a {
        let bits = (0..8).map(move |bit| if self.msb0 { 7 - bit } else { bit });
        let all = head(mask, self.size).iter();
        let all = all.flat_map(move |byte| bits.clone().map(move |bit| (byte >> bit) & 1 == 1));
        (0..)
            .zip(all)
            .filter(|(_, set)| *set)
            .map(|(bit, _)| self.slot(bit))
    }

    fn slot(&self, bit: u16) -> Slot {
        let found = self.bits.binary_search_by_key(&bit, |row| row.bit);
        match found.ok().and_then(|place| self.bits.get(place)) {
            Some(row) => Slot {
                bit,
                id: Some(row.id),
                length: row.length,
                name: Some(row.name),
            },
            None => Slot {
                bit,
                id: None,
                length: self.slot_bytes,
                name: None,
            },
        }
    }

    fn checked(&self, mask: &[u8]) -> Result<(), Error> {
        let (expected, actual) = (self.size, mask.len());
        if expected == actual {
            Ok(())
        } else {
            Err(Error::Length { expected, actual })
        }
    }

    fn slots_bytes(&self, mask: &[u8]) -> usize {
        self.selected(mask).count().wrapping_mul(self.slot_bytes)
    }

    /// Fills the slots, which are all of `out`.
    fn write(&self, mask: &[u8], frames: &[&[u8]], out: &mut [u8]) -> Result<(), Error> {
        let (expected, actual) = (self.selected(mask).count(), frames.len());
        if expected != actual {
            return Err(Error::Length { expected, actual });
        }
        for ((index, slot), frame) in self.selected(mask).enumerate().zip(frames) {
            let (expected, actual) = (slot.length, frame.len());
            if expected != actual {
                return Err(Error::Length { expected, actual });
            }
            let place = part_mut(out, index.wrapping_mul(self.slot_bytes), self.slot_bytes);
            place.fill(self.fill);
            copy(place, frame);
        }
        Ok(())
    }
}

/// A frame of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// The bit of the mask.
    pub bit: u16,
    /// The telemetry id; None if the ICD assigns no frame to the bit.
    pub id: Option<u8>,
    /// The frame, or the whole slot where no frame is assigned.
    pub data: &'a [u8],
}

impl Frame<'_> {
    /// The frame as a message; None if it is another one.
    #[must_use]
    pub fn message<M: Telemetry>(&self) -> Option<M> {
        if self.id == Some(octet(M::TELEMETRY_ID)) {
            M::from_bytes(self.data).ok()
        } else {
            None
        }
    }
}

/// Return the frames in the slots, which fill `data`.
fn frames<'a>(
    layout: &'a LogMask,
    mask: &'a [u8],
    data: &'a [u8],
) -> impl Iterator<Item = Frame<'a>> + 'a {
    layout
        .selected(mask)
        .enumerate()
        .map(move |(index, slot)| Frame {
            bit: slot.bit,
            id: slot.id,
            data: part(data, index.wrapping_mul(layout.slot_bytes), slot.length),
        })
}

/// An entry of a log file.
#[derive(Clone, Copy, Debug)]
pub struct Entry<'a> {
    /// Unix time.
    pub seconds: u64,
    /// Milliseconds of the second.
    pub milliseconds: u64,
    layout: &'static LogMask,
    mask: &'a [u8],
    slots: &'a [u8],
}

impl<'a> Entry<'a> {
    /// The frames in the order of the mask bits.
    pub fn frames(&self) -> impl Iterator<Item = Frame<'a>> + 'a {
        frames(self.layout, self.mask, self.slots)
    }
}

/// Reader of a log file in pieces of any size. `N` bytes must be enough for the header and for an
/// entry.
///
/// ```
/// use icdgen_runtime::wire::{log, Error, Link};
///
/// /// Entries of a log file.
/// fn count(link: &'static Link, file: &[u8]) -> Result<usize, Error> {
///     let (mut reader, mut found) = (log::Reader::<2048>::new(link)?, 0);
///     reader.feed(file, |_| found += 1);
///     Ok(found)
/// }
/// ```
#[derive(Clone, Debug)]
pub struct Reader<const N: usize> {
    form: &'static LogFile,
    layout: &'static LogMask,
    little: bool,
    mask: [u8; N],
    entry_bytes: Option<usize>, // known when the mask is
    buffer: [u8; N],
    length: usize,
}

impl<const N: usize> Reader<N> {
    /// Create a reader at the beginning of a file.
    ///
    /// # Errors
    ///
    /// [`Error::Length`] if `N` is too small, [`Error::Unsupported`] if the ICD does not describe logs.
    pub fn new(link: &'static Link) -> Result<Self, Error> {
        let form = link.log_file.as_ref().ok_or(Error::Unsupported)?;
        let layout = link.mask.as_ref().ok_or(Error::Unsupported)?;
        let slots = layout.size.wrapping_mul(8).wrapping_mul(layout.slot_bytes);
        let expected = (form.frames_at + slots).max(form.header_bytes);
        if N < expected {
            let actual = N;
            return Err(Error::Length { expected, actual });
        }
        Ok(Self {
            form,
            layout,
            little: link.little,
            mask: [0; N],
            entry_bytes: None,
            buffer: [0; N],
            length: 0,
        })
    }

    /// The mask; None if the header is incomplete.
    #[must_use]
    pub fn mask(&self) -> Option<&[u8]> {
        self.entry_bytes.map(|_| head(&self.mask, self.layout.size))
    }

    /// At the end of the file: bytes that belong to no whole entry.
    #[must_use]
    pub const fn truncated(&self) -> usize {
        self.length
    }

    /// Takes the next bytes of the file, and gives the entries that are complete now.
    pub fn feed(&mut self, bytes: &[u8], mut on_entry: impl FnMut(Entry<'_>)) {
        let mut rest = bytes;
        loop {
            let wanted = self.entry_bytes.unwrap_or(self.form.header_bytes).max(1);
            if self.length == 0 && rest.len() >= wanted {
                self.part(head(rest, wanted), &mut on_entry);
                rest = rest.get(wanted..).unwrap_or(&[]);
                continue;
            }
            let taken = rest.len().min(wanted.saturating_sub(self.length));
            copy(part_mut(&mut self.buffer, self.length, taken), rest);
            self.length += taken;
            rest = rest.get(taken..).unwrap_or(&[]);
            if self.length < wanted {
                return;
            }
            let buffer = self.buffer;
            self.length = 0;
            self.part(head(&buffer, wanted), &mut on_entry);
        }
    }

    /// Takes the header or an entry.
    fn part(&mut self, bytes: &[u8], on_entry: &mut dyn FnMut(Entry<'_>)) {
        if self.entry_bytes.is_none() {
            let mask = part(bytes, self.form.mask_at, self.layout.size);
            self.entry_bytes = Some(self.form.frames_at + self.layout.slots_bytes(mask));
            copy(&mut self.mask, mask);
            return;
        }
        let read = |span: Span| number(part(bytes, span.at, span.bytes), self.little);
        on_entry(Entry {
            seconds: read(self.form.seconds),
            milliseconds: read(self.form.milliseconds),
            layout: self.layout,
            mask: head(&self.mask, self.layout.size),
            slots: bytes.get(self.form.frames_at..).unwrap_or(&[]),
        });
    }
}

/// Writes a log file.
#[derive(Clone, Copy, Debug)]
pub struct Writer<'a> {
    form: &'static LogFile,
    layout: &'static LogMask,
    little: bool,
    mask: &'a [u8],
}

impl<'a> Writer<'a> {
    /// A writer of entries with the frames of the mask.
    ///
    /// # Errors
    ///
    /// [`Error::Length`] if the mask has another length, [`Error::Unsupported`] if the ICD does not
    /// describe logs.
    pub fn new(link: &'static Link, mask: &'a [u8]) -> Result<Self, Error> {
        let form = link.log_file.as_ref().ok_or(Error::Unsupported)?;
        let layout = link.mask.as_ref().ok_or(Error::Unsupported)?;
        layout.checked(mask)?;
        let little = link.little;
        Ok(Self {
            form,
            layout,
            little,
            mask,
        })
    }

    /// Bytes of an entry.
    #[must_use]
    pub fn entry_bytes(&self) -> usize {
        self.form.frames_at + self.layout.slots_bytes(self.mask)
    }

    /// Writes the header to the beginning of `out`, and says how many bytes it has.
    ///
    /// # Errors
    ///
    /// [`Error::Length`] if `out` is too small.
    pub fn header(&self, out: &mut [u8]) -> Result<usize, Error> {
        let out = begun(out, self.form.header_bytes)?;
        copy(part_mut(out, self.form.mask_at, self.mask.len()), self.mask);
        Ok(self.form.header_bytes)
    }

    /// Writes an entry to the beginning of `out`, and says how many bytes it has.
    ///
    /// # Errors
    ///
    /// [`Error::Length`] if there are not as many frames as the mask says, if one has another length, or
    /// `out` is too small; [`Error::Range`] if a time does not fit.
    pub fn entry(
        &self,
        seconds: u64,
        milliseconds: u64,
        frames: &[&[u8]],
        out: &mut [u8],
    ) -> Result<usize, Error> {
        let size = self.entry_bytes();
        let out = begun(out, size)?;
        for (field, span, value) in [
            ("seconds", self.form.seconds, seconds),
            ("milliseconds", self.form.milliseconds, milliseconds),
        ] {
            if !put_number(part_mut(out, span.at, span.bytes), value, self.little) {
                return Err(Error::range(field));
            }
        }
        let slots = out.get_mut(self.form.frames_at..).unwrap_or(&mut []);
        self.layout.write(self.mask, frames, slots)?;
        Ok(size)
    }
}

/// The first `size` bytes, made 0.
fn begun(out: &mut [u8], size: usize) -> Result<&mut [u8], Error> {
    let (expected, actual) = (size, out.len());
    let error = Error::Length { expected, actual };
    let out = out.get_mut(..size).ok_or(error)?;
    out.fill(0);
    Ok(out)
}

/// An unsolicited log.
///
/// ```
/// use icdgen_runtime::wire::{log, Error, Link};
///
/// /// The ids of the frames in an unsolicited log.
/// fn ids(link: &'static Link, message: &[u8]) -> Result<Vec<Option<u8>>, Error> {
///     let message = log::Message::decode(link, message)?;
///     Ok(message.frames().map(|frame| frame.id).collect())
/// }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Message<'a> {
    layout: &'static LogMask,
    mask: &'a [u8],
    slots: &'a [u8],
}

impl<'a> Message<'a> {
    /// Reads a message, which begins with its id.
    ///
    /// # Errors
    ///
    /// [`Error::Length`] if it has not the length that its mask demands, [`Error::Unsupported`] if the
    /// ICD does not describe such messages.
    pub fn decode(link: &'static Link, message: &'a [u8]) -> Result<Self, Error> {
        let (form, layout) = message_forms(link)?;
        let actual = message.len();
        if actual < form.frames_at {
            let expected = form.frames_at;
            return Err(Error::Length { expected, actual });
        }
        let mask = part(message, form.mask_at, layout.size);
        let expected = form.frames_at + layout.slots_bytes(mask);
        if actual != expected {
            return Err(Error::Length { expected, actual });
        }
        let slots = message.get(form.frames_at..).unwrap_or(&[]);
        Ok(Self {
            layout,
            mask,
            slots,
        })
    }

    /// The mask.
    #[must_use]
    pub const fn mask(&self) -> &'a [u8] {
        self.mask
    }

    /// The frames in the order of the mask bits.
    pub fn frames(&self) -> impl Iterator<Item = Frame<'a>> + 'a {
        frames(self.layout, self.mask, self.slots)
    }

    /// Writes a message with its id to the beginning of `out`, and says how many bytes it has.
    ///
    /// # Errors
    ///
    /// [`Error::Length`] if the mask or a frame has another length, if there are not as many frames as the
    /// mask says, or `out` is too small; [`Error::Unsupported`] if the ICD does not describe such
    /// messages.
    pub fn encode(
        link: &'static Link,
        mask: &[u8],
        frames: &[&[u8]],
        out: &mut [u8],
    ) -> Result<usize, Error> {
        let (form, layout) = message_forms(link)?;
        layout.checked(mask)?;
        let size = form.frames_at + layout.slots_bytes(mask);
        let out = begun(out, size)?;
        copy(out, &[form.id]);
        copy(part_mut(out, form.mask_at, mask.len()), mask);
        let slots = out.get_mut(form.frames_at..).unwrap_or(&mut []);
        layout.write(mask, frames, slots)?;
        Ok(size)
    }
}

fn message_forms(link: &'static Link) -> Result<(&'static LogMessage, &'static LogMask), Error> {
    let form = link.log_message.as_ref().ok_or(Error::Unsupported)?;
    let layout = link.mask.as_ref().ok_or(Error::Unsupported)?;
    Ok((form, layout))
}
