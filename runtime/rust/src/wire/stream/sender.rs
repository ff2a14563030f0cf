//! Sender that does not wait for replies.

use super::encoder::{encoded, encoded_packet, encoded_request, Header, Values};
use crate::wire::link::{FieldRole, Link};
use crate::wire::{Direction, Error, Linked, TelecommandOf};
use core::marker::PhantomData;

/// Encodes telecommands of node `T` with header and trailer; for the tests of a driver also
/// telemetry and packets without a message, as the device sends them. `S` is the number of sequence
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
    /// Values of the header and trailer fields that the sender chooses. `sequence` is the first
    /// number.
    pub values: Values,
    pub(super) link: &'static Link,
    pub(super) direction: Direction,
    next: [Option<u32>; S],
    node: PhantomData<fn() -> T>,
}

impl<T, const S: usize> Sender<T, S> {
    /// Create a sender of telecommands with the values of the ICD.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD describes no framing.
    pub fn new(link: &'static impl Linked<Node = T>) -> Result<Self, Error> {
        Self::with_direction(link, Direction::Telecommand)
    }

    /// Create a sender with the values of the ICD. A device sends [`Direction::Telemetry`].
    ///
    /// # Errors
    ///
    /// See [`Sender::new`].
    pub fn with_direction(
        link: &'static impl Linked<Node = T>,
        direction: Direction,
    ) -> Result<Self, Error> {
        let link = link.link();
        if link.stream.is_none() {
            return Err(Error::Unsupported);
        }
        Ok(Self {
            values: Values::default(),
            link,
            direction,
            next: [None; S],
            node: PhantomData,
        })
    }

    /// Encode a telecommand and return the number of bytes written to `out`.
    ///
    /// # Errors
    ///
    /// See [`Sender::put`]; also [`Error::Range`] if a value does not fit into its field, and
    /// [`Error::UnknownId`] if the sender sends telemetry.
    pub fn send<M: TelecommandOf<T>>(
        &mut self,
        message: &M,
        out: &mut [u8],
    ) -> Result<usize, Error> {
        if self.direction != Direction::Telecommand {
            let id = M::TELECOMMAND_ID;
            return Err(Error::UnknownId { id });
        }
        let data = message.to_bytes()?;
        self.put(M::TELECOMMAND_ID, data.as_ref(), out)
    }

    /// Encode the message with this id and these data, and return the number of bytes written to
    /// `out`. It is a message of the direction of the sender.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownId`] if there is no such message, [`Error::Length`] if the data have the
    /// wrong length or `out` is too small, [`Error::Range`] if a header or trailer value does not
    /// fit into its field.
    pub fn put(&mut self, id: u32, data: &[u8], out: &mut [u8]) -> Result<usize, Error> {
        self.message(id, data, out).map(|(size, _)| size)
    }

    /// Encode a request of the telemetry with this id and return the number of bytes written to
    /// `out`.
    ///
    /// # Errors
    ///
    /// See [`crate::wire::stream::encode_request`].
    pub fn put_request(&mut self, id: u32, out: &mut [u8]) -> Result<usize, Error> {
        self.request(id, out).map(|(size, _)| size)
    }

    /// Encode a packet without a message, such as an acknowledge or a refusal, and return the number
    /// of bytes written to `out`.
    ///
    /// `packet` is the index of its format in [`Stream::packets`](crate::wire::link::Stream), `id`
    /// the value of its id field. `values` take precedence over those of the sender, except for the
    /// sequence if the sender counts the packet.
    ///
    /// # Errors
    ///
    /// See [`crate::wire::stream::encode_packet`].
    pub fn put_packet(
        &mut self,
        packet: usize,
        id: u32,
        values: &Values,
        out: &mut [u8],
    ) -> Result<usize, Error> {
        let (link, direction) = (self.link, self.direction);
        let sent = self.numbered(packet, None, values, |values| {
            encoded_packet(link, direction, packet, id, values, out)
        });
        sent.map(|(size, _)| size)
    }

    /// Encode a message. Return its size and its header.
    pub(in crate::wire) fn message(
        &mut self,
        id: u32,
        data: &[u8],
        out: &mut [u8],
    ) -> Result<(usize, Header), Error> {
        let (link, direction) = (self.link, self.direction);
        let form = link.stream.as_ref().ok_or(Error::Unsupported)?;
        let row = form.row(direction, id);
        let (place, row) = row.ok_or(Error::UnknownId { id })?;
        let (packet, none) = (usize::from(row.packet), Values::default());
        self.numbered(packet, Some(place), &none, |values| {
            encoded(link, direction, id, data, values, out)
        })
    }

    /// Encode a request of telemetry. Return its size and its header.
    pub(in crate::wire) fn request(
        &mut self,
        id: u32,
        out: &mut [u8],
    ) -> Result<(usize, Header), Error> {
        let link = self.link;
        let form = link.stream.as_ref().ok_or(Error::Unsupported)?;
        let request = form.request.as_ref().ok_or(Error::Unsupported)?;
        self.numbered(request.packet, None, &Values::default(), |values| {
            encoded_request(link, id, values, out)
        })
    }

    /// Encode a packet with the next sequence number, if the sender counts it. `place`: index of a
    /// message among those of its direction.
    fn numbered(
        &mut self,
        packet: usize,
        place: Option<usize>,
        values: &Values,
        encode: impl FnOnce(&Values) -> Result<(usize, Header), Error>,
    ) -> Result<(usize, Header), Error> {
        let form = self.link.stream.as_ref().ok_or(Error::Unsupported)?;
        let packet = form.packets.get(packet);
        let field = packet.and_then(|packet| packet.field(FieldRole::Sequence));
        // Only messages have a counter for each id.
        let key = if form.per_id { place } else { Some(0) };
        let counter = key.and_then(|key| self.next.get_mut(key));
        let mut values = values.or(self.values);
        if let Some(next) = &counter {
            values.sequence = next.or(self.values.sequence);
        }
        let written = encode(&values)?;
        if let (Some(field), Some(counter)) = (field, counter) {
            let default = field.value(self.direction);
            let number = values.sequence.unwrap_or(default);
            *counter = Some(number.wrapping_add(1) & field.mask());
        }
        Ok(written)
    }
}
