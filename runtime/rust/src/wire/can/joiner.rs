//! Assembly of messages from CAN packets, in any order and from several senders at once.

use super::super::bits::{part, pieces, reached};
use super::super::link::{Can, Extended, Link};
use super::super::Error;
use super::transaction::{Key, Transaction};
use super::{Kind, Message, Packet};

/// An event of the joiner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event<'a> {
    /// A message.
    Message(Message<'a>),
    /// A packet was received twice and is dropped.
    Duplicate {
        /// The id of the message.
        id: u32,
        /// The sender's address.
        source: u32,
    },
    /// A message is discarded because packets are missing.
    Incomplete {
        /// The id of the message.
        id: u32,
        /// The sender's address.
        source: u32,
        /// Number of missing packets.
        missing: usize,
    },
    /// An invalid packet of this message.
    Malformed {
        /// The id of the message.
        id: u32,
        /// The sender's address.
        source: u32,
    },
    /// No free slot for another message; the packet is dropped.
    Busy {
        /// The id of the message.
        id: u32,
        /// The sender's address.
        source: u32,
    },
    /// The ICD has no such message type.
    UnknownType {
        /// The id of the message.
        id: u32,
        /// The sender's address.
        source: u32,
    },
}

/// Assembles messages of at most `N` bytes from CAN packets, up to `SENDERS` messages at the same
/// time.
///
/// ```
/// use icdgen_runtime::wire::can::{Event, Joiner, Packet};
///
/// /// Returns the number of data bytes in all messages of these packets.
/// fn bytes<const N: usize, const SENDERS: usize>(
///     joiner: &mut Joiner<N, SENDERS>,
///     now: u32,
///     packets: &[Packet],
/// ) -> usize {
///     let mut count = 0;
///     for packet in packets {
///         joiner.feed(now, packet, |event| {
///             if let Event::Message(message) = event {
///                 count += message.data.len();
///             }
///         });
///     }
///     count
/// }
/// ```
#[derive(Clone, Debug)]
pub struct Joiner<const N: usize, const SENDERS: usize> {
    link: &'static Link,
    can: &'static Can,
    address: Option<u32>,
    senders: usize,
    room: usize, // packets of the longest message
    begun: u32,
    open: [Option<Transaction<N>>; SENDERS],
}

impl<const N: usize, const SENDERS: usize> Joiner<N, SENDERS> {
    const FREE: Option<Transaction<N>> = None;

    /// Create a joiner for messages with this destination address; None: any destination.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD does not describe CAN.
    pub fn new(link: &'static Link, address: Option<u32>) -> Result<Self, Error> {
        Self::with_senders(link, address, SENDERS)
    }

    /// Create a joiner that uses only part of its memory.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD does not describe CAN.
    pub fn with_senders(
        link: &'static Link,
        address: Option<u32>,
        senders: usize,
    ) -> Result<Self, Error> {
        let can = link.can.as_ref().ok_or(Error::Unsupported)?;
        let extended = can.extended.as_ref();
        Ok(Self {
            link,
            can,
            address,
            senders: senders.min(SENDERS),
            room: extended.map_or(0, |form| pieces(link.longest_data, form.data_bytes)),
            begun: 0,
            open: [Self::FREE; SENDERS],
        })
    }

    /// Discard messages whose next packet is overdue, oldest first, and report each as
    /// [`Event::Incomplete`]. `now` is in milliseconds.
    pub fn expire(&mut self, now: u32, mut on_event: impl FnMut(Event<'_>)) {
        self.late(now, &mut on_event);
    }

    /// Pass one received packet to the joiner. `now` is in milliseconds.
    pub fn feed(&mut self, now: u32, packet: &Packet, mut on_event: impl FnMut(Event<'_>)) {
        self.late(now, &mut on_event);
        self.take(now, packet, &mut on_event);
    }

    fn late(&mut self, now: u32, on_event: &mut dyn FnMut(Event<'_>)) {
        let timeout = match &self.can.extended {
            Some(form) => form.packet_timeout_ms,
            None => return,
        };
        for _ in 0..SENDERS {
            let late = |one: &Transaction<N>| reached(now, one.last.wrapping_add(timeout));
            match self.oldest(late) {
                Some(slot) => self.give_up(slot, on_event),
                None => return,
            }
        }
    }

    fn take(&mut self, now: u32, packet: &Packet, on_event: &mut dyn FnMut(Event<'_>)) {
        let can = self.can;
        let (number, id) = (can.kind.get(packet.id), can.id.get(packet.id));
        let source = can.source.get(packet.id);
        let destination = can.destination.get(packet.id);
        if self.address.map_or(false, |ours| ours != destination) {
            return;
        }
        let data = packet.data();
        if let Some(kind) = can.types.kind(number) {
            if data.len() > can.room(kind) {
                return on_event(Event::Malformed { id, source });
            }
            return on_event(Event::Message(Message {
                kind,
                id,
                source,
                destination,
                data,
            }));
        }
        let form = can.extended.as_ref();
        match form.and_then(|form| Some((form, form.types.kind(number)?))) {
            Some((form, kind)) => {
                let key = (number, id, source, destination);
                self.extended(form, key, kind, data, now, on_event);
            }
            None => on_event(Event::UnknownType { id, source }),
        }
    }

    fn extended(
        &mut self,
        form: &'static Extended,
        key: Key,
        kind: Kind,
        data: &[u8],
        now: u32,
        on_event: &mut dyn FnMut(Event<'_>),
    ) {
        let (_, id, source, _) = key;
        let old = self.oldest(|one| one.key == key);
        let (number, count, length) = if let Some(found) = self.position(form, kind, id, data, old)
        {
            found
        } else {
            if let Some(slot) = old {
                self.give_up(slot, on_event);
            }
            return on_event(Event::Malformed { id, source });
        };
        let piece = part(data, 0, form.data_bytes);
        if let Some(one) = self.at(old) {
            let known = one.has(number) && one.piece(number, form) == piece;
            if known && one.done.map_or(true, |last| last == number) {
                one.came(number, now);
                return on_event(Event::Duplicate { id, source });
            }
        }
        let slot = match self.slot(key, old, number, count, on_event) {
            Some(slot) => slot,
            None => return on_event(Event::Busy { id, source }),
        };
        if let Some(one) = self.at(Some(slot)) {
            one.count = count;
            one.length = length;
            one.put(number, piece, form);
            one.came(number, now);
            if one.missing() == 0 {
                one.done = Some(number);
                let (_, id, source, destination) = key;
                on_event(Event::Message(Message {
                    kind,
                    id,
                    source,
                    destination,
                    data: one.joined(form),
                }));
            }
        }
    }

    /// Which packet it is, of how many, and the bytes of the message, where the ICD knows them.
    fn position(
        &mut self,
        form: &Extended,
        kind: Kind,
        id: u32,
        data: &[u8],
        old: Option<usize>,
    ) -> Option<(usize, usize, Option<usize>)> {
        if data.len() != form.left_at + 1 {
            return None;
        }
        let left = data.get(form.left_at)?.checked_sub(form.left_in_last)?;
        let left = usize::from(left);
        let length = self.length(kind, id);
        let going = self
            .at(old)
            .filter(|one| one.done.is_none() && left < one.count);
        let count = match (length, going) {
            (Some(length), _) => pieces(length, form.data_bytes),
            (None, Some(one)) => one.count,
            (None, None) => left + 1, // the first packet that comes tells how many there are
        };
        let fits = count <= self.room && Transaction::<N>::fits(count, form);
        let number = count.checked_sub(1)?.checked_sub(left)?;
        fits.then_some((number, count, length))
    }

    /// Bytes of the message, if the ICD knows it and it needs several packets.
    fn length(&self, kind: Kind, id: u32) -> Option<usize> {
        let id = u8::try_from(id).ok()?;
        let known = if kind == Kind::Telecommand {
            self.link.telecommand(id)
        } else {
            self.link.telemetry(id)
        };
        let length = known?.length;
        (length > self.can.data_bytes).then_some(length)
    }

    /// Where the packet goes; None if there is no room.
    fn slot(
        &mut self,
        key: Key,
        old: Option<usize>,
        number: usize,
        count: usize,
        on_event: &mut dyn FnMut(Event<'_>),
    ) -> Option<usize> {
        self.begun = self.begun.wrapping_add(1);
        let begun = self.begun;
        if let (Some(slot), Some(one)) = (old, self.at(old)) {
            if one.done.is_none() && one.count == count && !one.has(number) {
                return old;
            }
            // Another message has begun, maybe with the same packets as the old one up to here.
            let (_, id, source, _) = key;
            let missing = one.missing();
            let complete = one.done.is_some();
            let kept = if !complete && number == one.run {
                number
            } else {
                0
            };
            one.keep(kept);
            one.run = kept;
            one.done = None;
            one.began = begun;
            if !complete {
                on_event(Event::Incomplete {
                    id,
                    source,
                    missing,
                });
            }
            return Some(slot);
        }
        let places = self.open.iter().take(self.senders);
        let free = places.enumerate().find(|(_, one)| one.is_none());
        let slot = match free {
            Some((slot, _)) => slot,
            None => self.oldest(|one| one.done.is_some())?,
        };
        let mut new = Transaction::new(key);
        new.began = begun;
        *self.open.get_mut(slot)? = Some(new);
        Some(slot)
    }

    fn at(&mut self, slot: Option<usize>) -> Option<&mut Transaction<N>> {
        self.open.get_mut(slot?)?.as_mut()
    }

    /// The one that began first among those that are wanted.
    fn oldest(&self, wanted: impl Fn(&Transaction<N>) -> bool) -> Option<usize> {
        let open = self.open.iter().enumerate();
        let known = open.filter_map(|(slot, one)| Some((slot, one.as_ref()?)));
        let found = known.filter(|(_, one)| wanted(one));
        let now = self.begun;
        found
            .max_by_key(|(_, one)| now.wrapping_sub(one.began))
            .map(|(slot, _)| slot)
    }

    /// Forgets a message. One that is complete leaves no event: it was kept to know repeated packets.
    fn give_up(&mut self, slot: usize, on_event: &mut dyn FnMut(Event<'_>)) {
        let one = match self.open.get_mut(slot) {
            Some(place) => place.take(),
            None => None,
        };
        if let Some(one) = one.filter(|one| one.done.is_none()) {
            let (_, id, source, _) = one.key;
            let missing = one.missing();
            on_event(Event::Incomplete {
                id,
                source,
                missing,
            });
        }
    }
}
