//! Sender that does not wait for replies.

use super::encoder::{encode, Values};
use crate::wire::link::{EnvelopeField, EnvelopeRole, Link};
use crate::wire::{Direction, Error, Linked, TelecommandOf};
use core::marker::PhantomData;

/// Encodes telecommands of node `T` with header and trailer. `S` is the number of sequence
/// counters: `SEQUENCES` of the module of the node.
///
/// ```
/// use icdgen_runtime::wire::stream::Sender;
/// use icdgen_runtime::wire::{Error, Link};
///
/// fn sent(sender: &mut Sender<(), 1>, id: u32, data: &[u8], port: &mut Vec<u8>) -> Result<(), Error> {
///     let mut line = [0; 600];
///     let size = sender.put(id, data, &mut line)?;
///     port.extend_from_slice(&line[..size]);
///     Ok(())
/// }
/// ```
#[derive(Clone, Debug)]
pub struct Sender<T, const S: usize> {
    /// Values of the header and trailer fields that the sender chooses. Initially those of the ICD;
    /// `sequence` is the first number.
    pub values: Values,
    link: &'static Link,
    next: [Option<u32>; S],
    node: PhantomData<fn() -> T>,
}

impl<T, const S: usize> Sender<T, S> {
    /// Create a sender with the values of the ICD.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD describes no framing.
    pub fn new(link: &'static impl Linked<Node = T>) -> Result<Self, Error> {
        let link = link.link();
        if link.stream.is_none() {
            return Err(Error::Unsupported);
        }
        Ok(Self {
            values: Values::new(link, Direction::Telecommand),
            link,
            next: [None; S],
            node: PhantomData,
        })
    }

    /// Encode a telecommand and return the number of bytes written to `out`.
    ///
    /// # Errors
    ///
    /// See [`Sender::put`]; also [`Error::Range`] if a value does not fit into its field.
    pub fn send<M: TelecommandOf<T>>(
        &mut self,
        message: &M,
        out: &mut [u8],
    ) -> Result<usize, Error> {
        let data = message.to_bytes()?;
        self.put(M::TELECOMMAND_ID, data.as_ref(), out)
    }

    /// Encode a telecommand with these data and return the number of bytes written to `out`.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownId`] if there is no such telecommand, [`Error::Length`] if the data have the
    /// wrong length or `out` is too small, [`Error::Range`] if a header or trailer value does not
    /// fit into its field.
    pub fn put(&mut self, id: u32, data: &[u8], out: &mut [u8]) -> Result<usize, Error> {
        let form = self.link.stream.as_ref().ok_or(Error::Unsupported)?;
        let row = form.row(Direction::Telecommand, id);
        let place = row.map_or(0, |(at, _)| if form.per_id { at } else { 0 });
        let mut values = self.values;
        if let Some(Some(next)) = self.next.get(place) {
            values.sequence = *next;
        }
        let size = encode(self.link, Direction::Telecommand, id, data, &values, out)?;
        let field = form.field(EnvelopeRole::Sequence);
        let mask = field.map_or(0, EnvelopeField::mask);
        if let Some(next) = self.next.get_mut(place) {
            *next = Some(values.sequence.wrapping_add(1) & mask);
        }
        Ok(size)
    }
}
