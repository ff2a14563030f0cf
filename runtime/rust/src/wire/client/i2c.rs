//! The line of an I2C bus, of which the client is the master.

use super::bus::Messages;
use super::line::{Arrival, Buffer, Plan, Sent, Transport};
use super::Client;
use crate::wire::bits::head;
use crate::wire::link::{Bus, MOST_AWAITED};
use crate::wire::message::octet;
use crate::wire::{i2c, Error, Event, Linked, NodeEvent, Request};
#[cfg(feature = "embedded-hal")]
use embedded_hal::i2c::I2c;

/// An I2C transaction: a write, followed by a read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transaction<'a> {
    /// Bytes to write.
    pub write: &'a [u8],
    /// Number of bytes to read; 0: write only.
    pub read: usize,
}

/// A transaction.
#[derive(Clone, Copy, Debug)]
struct Encoded {
    transmission: u32,
    id: u32,
    write: usize,        // number of bytes
    read: Option<usize>, // number of bytes of telemetry with this id
}

/// The line of a client on I2C. `N` is the constant `LONGEST` of the module of the node.
#[derive(Clone, Debug)]
pub struct Line<const N: usize> {
    messages: Messages,
    taken: [Option<Encoded>; MOST_AWAITED], // whose results are missing, the oldest first
    pending: Option<Encoded>,               // that was not taken yet
    written: [u8; N],                       // by the last transaction
}

impl<T, const N: usize, const R: usize> Client<T, Line<N>, R> {
    /// Create a client on I2C, which is the master.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the node is not on this bus, [`Error::Length`] if `N` is too
    /// small.
    pub fn i2c(link: &'static impl Linked<Node = T>) -> Result<Self, Error> {
        let link = link.link();
        link.i2c_address.ok_or(Error::Unsupported)?;
        let line = Line {
            messages: Messages::new(link, Bus::I2c)?,
            taken: [None; MOST_AWAITED],
            pending: None,
            written: Buffer::EMPTY,
        };
        Self::over(link, line)
    }

    /// Enable optional checksums. Checksums that the ICD requires on the bus are always used.
    #[must_use]
    pub fn with_checksums(mut self) -> Self {
        self.line.messages.enable_checksums();
        self
    }

    /// Return the next transaction; None if there is none. Its times count from the `now` of the
    /// previous call of another method. Call [`Client::transferred`] exactly once for each
    /// transaction, in the same order. There is none while the results of eight transactions are
    /// missing.
    pub fn output_transaction(&mut self) -> Option<Transaction<'_>> {
        let (line, machine) = (&mut self.line, &mut self.machine);
        let pending = line.pending.take();
        let pending = pending.filter(|it| machine.waiting(it.transmission).is_some());
        let transmission = machine.transmissions();
        let put = |sent, data: &[u8]| Ok((line.encode(sent, data, transmission)?, []));
        line.pending = match pending {
            None => machine.output::<_, [u8; 0]>(put).ok().flatten(),
            some => some,
        };
        let free = line.taken.iter_mut().find(|entry| entry.is_none())?;
        let encoded = line.pending.take()?;
        *free = Some(encoded);
        machine.taken(encoded.transmission);
        Some(Transaction {
            write: head(&line.written, encoded.write),
            read: encoded.read.unwrap_or(0),
        })
    }

    /// Pass the result of the oldest unfinished transaction to the client: the bytes that were
    /// read, or None if the transaction failed. If the time-out of the transaction has passed or its
    /// request has ended, the result is reported as [`Event::Late`].
    pub fn transferred(
        &mut self,
        now: u32,
        bytes: Option<&[u8]>,
        mut on_event: impl FnMut(NodeEvent<'_, T>),
    ) {
        let [oldest, ..] = self.line.taken;
        if oldest.is_some() {
            self.line.taken.rotate_left(1);
            if let Some(last) = self.line.taken.last_mut() {
                *last = None;
            }
        }
        self.tick(now, &mut on_event); // may end the request of this transaction
        let (line, machine) = (&self.line, &mut self.machine);
        let mut report = |event: Option<Event<'_>>| {
            if let Some(event) = event {
                on_event(NodeEvent::new(event));
            }
        };
        let transaction = if let Some(transaction) = oldest {
            transaction
        } else {
            let data = bytes.unwrap_or(&[]);
            let (id, packet) = (None, None);
            return report(Some(Event::Stray { id, packet, data }));
        };
        let place = machine.waiting(transaction.transmission);
        let read = bytes.filter(|_| transaction.read.is_some());
        let read = read.map(|bytes| line.telemetry(transaction.id, bytes));
        match (place, read) {
            (Some(place), _) if bytes.is_none() => report(machine.failed(place)),
            (Some(place), None) => report(machine.written(place)),
            (Some(place), Some(Ok(arrival))) => report(machine.read(place, &arrival)),
            (Some(place), Some(Err(fault))) => {
                report(Some(fault));
                report(machine.unanswered(place));
            }
            (None, Some(Ok(arrival))) => report(Some(arrival.late())),
            (None, Some(Err(fault))) => report(Some(fault)),
            (None, None) => report(Some(Event::Late {
                id: transaction.id,
                packet: None,
                data: &[],
            })),
        }
    }

    /// Process timeouts and perform the pending transactions. A read follows its write with a
    /// repeated start, or after a stop if the ICD requires it. A failed transaction is passed to
    /// the client, which tries again. Feature `embedded-hal`.
    ///
    /// # Errors
    ///
    /// Bus error of the last failed transaction.
    #[cfg(feature = "embedded-hal")]
    pub fn poll_i2c<P: I2c>(
        &mut self,
        now: u32,
        bus: &mut P,
        mut on_event: impl FnMut(NodeEvent<'_, T>),
    ) -> Result<(), P::Error> {
        self.tick(now, &mut on_event);
        let link = self.line.messages.link;
        let address = link.i2c_address.unwrap_or(0);
        let mut result = Ok(());
        let mut input = [0; N];
        while let Some(transaction) = self.output_transaction() {
            let size = transaction.read;
            let made = match input.get_mut(..size) {
                Some(read) if size > 0 && link.i2c_repeated_start => {
                    bus.write_read(address, transaction.write, read)
                }
                Some(read) if size > 0 => bus
                    .write(address, transaction.write)
                    .and_then(|()| bus.read(address, read)),
                _ => bus.write(address, transaction.write),
            };
            let bytes = made.is_ok().then(|| head(&input, size));
            self.transferred(now, bytes, &mut on_event);
            if made.is_err() {
                result = made;
            }
        }
        result
    }
}

impl<const N: usize> Line<N> {
    fn encode(&mut self, sent: Sent, data: &[u8], transmission: u32) -> Result<Encoded, Error> {
        let messages = &self.messages;
        let write = messages.write(sent, data, &mut self.written)?;
        let (link, checks) = (messages.link, messages.checks_telemetry);
        let (id, read) = match sent {
            Sent::Telecommand(id) => (id, None),
            Sent::Request(id) => (id, Some(i2c::read_length(link, octet(id), checks)?)),
        };
        Ok(Encoded {
            transmission,
            id,
            write,
            read,
        })
    }

    /// Return the telemetry in the bytes that were read, or the error if it is damaged.
    fn telemetry<'a>(&self, id: u32, bytes: &'a [u8]) -> Result<Arrival<'a>, Event<'static>> {
        let Messages {
            link,
            checks_telemetry,
            ..
        } = self.messages;
        match i2c::reply(link, octet(id), bytes, checks_telemetry) {
            Ok(data) => Ok(Arrival::of_telemetry(id, data)),
            Err(Error::Checksum { .. }) => Err(Event::Checksum { id }),
            Err(_) => Err(Event::Length { id: Some(id) }),
        }
    }
}

impl<const N: usize> Transport for Line<N> {
    type Buffer = [u8; N];

    const BUS: Option<Bus> = Some(Bus::I2c);

    fn plan(&self, request: &Request<'_>) -> Result<Plan, Error> {
        self.messages.plan(request)
    }
}
