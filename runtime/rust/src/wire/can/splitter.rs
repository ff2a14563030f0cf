//! Splitting of messages into CAN packets.

use super::super::bits::{copy, index, low, part, part_mut, pieces};
use super::super::link::{Extended, Link};
use super::super::Error;
use super::{Message, Packet, PACKET_BYTES};

/// Iterator over the packets of a message, in the order of sending.
///
/// ```
/// use icdgen_runtime::wire::can::{Message, Packet, Splitter};
/// use icdgen_runtime::wire::{Error, Link};
///
/// fn packets(link: &'static Link, message: &Message<'_>) -> Result<Vec<Packet>, Error> {
///     Ok(Splitter::new(link, message)?.collect())
/// }
/// ```
#[derive(Clone, Debug)]
pub struct Splitter<'a> {
    data: &'a [u8],
    id: u32,
    extended: Option<&'static Extended>,
    count: usize,
    next: usize,
}

impl<'a> Splitter<'a> {
    /// Create the iterator for a message.
    ///
    /// # Errors
    ///
    /// [`Error::TooLong`] if its data do not fit, [`Error::Range`] if an address does not,
    /// [`Error::Unsupported`] if the ICD has no such messages.
    pub fn new(link: &'static Link, message: &Message<'a>) -> Result<Self, Error> {
        let can = link.can.as_ref().ok_or(Error::Unsupported)?;
        let (kind, actual) = (message.kind, message.data.len());
        let room = can.room(kind);
        let single = actual <= room;
        let extended = match &can.extended {
            _ if single => None,
            Some(form) if form.types.of(kind).is_some() => Some(form),
            _ => return Err(Error::TooLong { most: room, actual }),
        };
        let (number, count) = match extended {
            None => (can.types.of(kind), 1),
            Some(form) if actual > form.bytes => {
                let most = form.bytes;
                return Err(Error::TooLong { most, actual });
            }
            Some(form) => (form.types.of(kind), pieces(actual, form.data_bytes)),
        };
        let number = number.ok_or(Error::Unsupported)?;
        let id = can.identifier(number, message);
        Ok(Self {
            data: message.data,
            id: id.ok_or(Error::range("identifier"))?,
            extended,
            count,
            next: 0,
        })
    }
}

impl Iterator for Splitter<'_> {
    type Item = Packet;

    fn next(&mut self) -> Option<Packet> {
        if self.next >= self.count {
            return None;
        }
        let number = self.next;
        self.next += 1;
        let form = match self.extended {
            None => return Packet::new(self.id, self.data),
            Some(form) => form,
        };
        let mut data = [form.fill; PACKET_BYTES];
        let size = form.data_bytes;
        let at = number.wrapping_mul(size);
        let rest = self.data.len().saturating_sub(at);
        copy(&mut data, part(self.data, at, rest.min(size)));
        let left = index(form.left_in_last.into()) + self.count - self.next;
        let left = low(u64::try_from(left).unwrap_or(0));
        copy(part_mut(&mut data, form.left_at, 1), &[left]);
        Packet::new(self.id, data.get(..=form.left_at)?)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = self.count.saturating_sub(self.next);
        (left, Some(left))
    }
}

impl ExactSizeIterator for Splitter<'_> {}
