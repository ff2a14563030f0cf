//! Client that sends one request at a time and reports its outcome, for UART, I2C and CAN.

#[cfg(feature = "embedded-hal")]
mod i2c;
mod machine;

use self::machine::Machine;
use super::bits::head;
use super::can::{self, Joiner, Packet};
use super::event::{Event, NodeEvent};
use super::link::{Bus, Link, Settings};
use super::message::{octet, Linked};
use super::procedure::{Outcome, Procedure, Sink};
use super::request::{Request, Started};
use super::uart::{self, Decoder, Encoder};
use super::{Error, TelecommandOf, TelemetryOf};
use core::marker::PhantomData;

/// An I2C transaction: a write, followed by a read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transaction<'a> {
    /// Bytes to write.
    pub write: &'a [u8],
    /// Number of bytes to read; 0: write only.
    pub read: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Idle,
    /// A late response could be taken for that of this request.
    Hold,
    /// Sent.
    Wait,
    /// I2C: waits before the next poll or the next attempt.
    Pause,
    /// I2C: waits for the acknowledge frame.
    Poll,
}

/// Output to be sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Output {
    Request,
    Poll,
}

#[derive(Clone, Debug)]
enum Port<const N: usize> {
    Uart(Decoder<N>),
    I2c,
    Can(Joiner<N, 1>),
}

/// A client of node `T` on a bus. `T` is the type `Node` and `N` the constant `LONGEST` of the
/// module of the node: `Client::<Node, LONGEST>::uart(&LINK)`.
///
/// The application passes received bytes, packets or results of transactions to the client, takes
/// its output, and calls [`Client::tick`] at the [`Client::deadline`]. All times `now` are in
/// milliseconds and may wrap around.
///
/// ```
/// use icdgen_runtime::wire::{Client, Error, TelemetryOf};
///
/// /// Requests a frame. `port` sends bytes and returns the bytes that were received.
/// fn asked<T, M: TelemetryOf<T>, const N: usize>(
///     client: &mut Client<T, N>,
///     mut port: impl FnMut(&[u8]) -> Vec<u8>,
/// ) -> Result<Option<M>, Error> {
///     let (mut input, mut found) = (Vec::new(), None);
///     client.request::<M>(0)?;
///     while let Some(bytes) = client.output() {
///         input.extend(port(bytes));
///     }
///     client.received(1, &input, |event| found = found.or(event.message()));
///     Ok(found)
/// }
/// ```
#[derive(Clone, Debug)]
pub struct Client<T, const N: usize> {
    port: Port<N>,
    machine: Machine<N>,
    node: PhantomData<fn() -> T>,
}

impl<T, const N: usize> Client<T, N> {
    /// Create a client on the UART with the timeouts of the ICD.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the node is not on this bus, [`Error::Length`] if `N` is too
    /// small.
    pub fn uart<L: Linked<Node = T>>(link: &'static L) -> Result<Self, Error> {
        let link = link.link();
        Self::new(
            link,
            Bus::Uart,
            Port::Uart(Decoder::with_limit(link, link.longest)?),
            0,
        )
    }

    /// Create a client on I2C, which is the master.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the node is not on this bus, [`Error::Length`] if `N` is too
    /// small.
    pub fn i2c<L: Linked<Node = T>>(link: &'static L) -> Result<Self, Error> {
        let link = link.link();
        link.i2c_address.ok_or(Error::Unsupported)?;
        link.polled.as_ref().ok_or(Error::Unsupported)?;
        Self::new(link, Bus::I2c, Port::I2c, 0)
    }

    /// Create a client on CAN. `address` is the CAN address of the client, to which the node
    /// replies.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the node is not on this bus, [`Error::Length`] if `N` is too
    /// small.
    pub fn can<L: Linked<Node = T>>(link: &'static L, address: u8) -> Result<Self, Error> {
        let link = link.link();
        let address = address.into();
        Self::new(
            link,
            Bus::Can,
            Port::Can(Joiner::new(link, Some(address))?),
            address,
        )
    }

    fn new(link: &'static Link, bus: Bus, port: Port<N>, address: u32) -> Result<Self, Error> {
        let (expected, actual) = (link.longest, N);
        if actual < expected {
            return Err(Error::Length { expected, actual });
        }
        let machine = Machine::new(link, bus, address);
        let node = PhantomData;
        Ok(Self {
            port,
            machine,
            node,
        })
    }

    /// Enable optional checksums. Checksums that the ICD requires on the bus are always used.
    #[must_use]
    pub fn with_checksums(mut self) -> Self {
        if let Some(form) = &self.machine.link.checksum {
            self.machine.checks_telecommands = form.telecommand_buses.of(self.machine.bus);
            self.machine.checks_telemetry = form.telemetry_buses.of(self.machine.bus);
        }
        self
    }

    /// Replace the timeouts and retries of the ICD.
    #[must_use]
    pub const fn with_settings(mut self, settings: Settings) -> Self {
        self.machine.settings = settings;
        self
    }

    /// Return the time in milliseconds at which [`Client::tick`] must be called at the latest.
    /// None: no request is in progress.
    #[must_use]
    pub fn deadline(&self) -> Option<u32> {
        (self.machine.state != State::Idle).then_some(self.machine.until)
    }

    /// Request telemetry, or read a configuration.
    ///
    /// # Errors
    ///
    /// See [`Client::start`].
    pub fn request<M: TelemetryOf<T>>(&mut self, now: u32) -> Result<(), Error> {
        self.start(now, &Request::telemetry(octet(M::TELEMETRY_ID)))?;
        Ok(())
    }

    /// Send a telecommand, or set a configuration.
    ///
    /// # Errors
    ///
    /// See [`Client::start`]; also [`Error::Range`] if a value does not fit into its field.
    pub fn send<M: TelecommandOf<T>>(&mut self, now: u32, message: &M) -> Result<Started, Error> {
        let data = message.to_bytes()?;
        let id = octet(M::TELECOMMAND_ID);
        self.start(now, &Request::telecommand(id, data.as_ref()))
    }

    /// Start a request. The data are copied. `now` is in milliseconds.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownId`] if the node has no such message, [`Error::Busy`] if another request is
    /// in progress or its output has not been taken completely, [`Error::Length`] if the data have
    /// the wrong length.
    pub fn start(&mut self, now: u32, request: &Request<'_>) -> Result<Started, Error> {
        self.machine.start(now, request)
    }

    /// Start the next request of a procedure if there is one and the client is idle. Return whether
    /// a request was started. A request without acknowledge is reported to the procedure at once.
    ///
    /// # Errors
    ///
    /// See [`Client::start`].
    pub fn advance<'p, S: Sink>(
        &mut self,
        now: u32,
        procedure: &mut impl AsMut<Procedure<'p, S>>,
    ) -> Result<bool, Error> {
        let procedure = procedure.as_mut();
        if self.machine.is_busy() {
            return Ok(false);
        }
        procedure.set_bus(self.machine.bus);
        let request = match procedure.next(now) {
            Some(request) => Request {
                direction: request.direction,
                id: octet(request.id),
                data: request.data,
                repeat: request.repeat,
            },
            None => return Ok(false),
        };
        if self.start(now, &request)? == Started::Sent {
            procedure.event(now, Outcome::Done(&[]));
        }
        Ok(true)
    }

    /// UART: return the next bytes to send; None if there is nothing to send. A piece never
    /// contains bytes of two messages.
    pub fn output(&mut self) -> Option<&[u8]> {
        let machine = &mut self.machine;
        if machine.bus != Bus::Uart {
            return None;
        }
        loop {
            machine.first()?;
            let framing = machine.link.framing.as_ref()?;
            let mut encoder = machine.encoder.unwrap_or_else(|| Encoder::new(framing));
            let message = head(&machine.message, machine.length);
            let size = encoder.next(message, &mut machine.piece);
            if size > 0 {
                machine.encoder = Some(encoder);
                return machine.piece.get(..size);
            }
            machine.sent();
        }
    }

    /// CAN: return the next packet to send; None if there is nothing to send.
    pub fn output_packet(&mut self) -> Option<Packet> {
        let machine = &mut self.machine;
        if machine.bus != Bus::Can {
            return None;
        }
        loop {
            machine.first()?;
            let packets = machine.packets();
            match packets.and_then(|mut packets| packets.nth(machine.begun)) {
                Some(packet) => {
                    machine.begun += 1;
                    return Some(packet);
                }
                None => machine.sent(),
            }
        }
    }

    /// I2C: return the next transaction; None if there is none. Call [`Client::transferred`]
    /// exactly once for each transaction, in the same order. There is none while the results of
    /// eight transactions are missing.
    pub fn output_transaction(&mut self) -> Option<Transaction<'_>> {
        let machine = &mut self.machine;
        if machine.bus != Bus::I2c {
            return None;
        }
        let output = machine.first()?;
        let taken = machine.taken_as(output);
        machine.taken.push(taken)?;
        machine.sent();
        Some(machine.transaction(output))
    }

    /// Cancel the request without an event, and drop its remaining output. Another request may then
    /// be started; it waits if a late response to the cancelled one could be taken for its own. The
    /// late response is reported as [`Event::Late`].
    pub fn cancel(&mut self) {
        self.machine.cancel();
    }

    /// Process timeouts: send again or end the request whose time is up. Call at the deadline at
    /// the latest; calling more often is harmless. `now` is in milliseconds.
    pub fn tick(&mut self, now: u32, mut on_event: impl FnMut(NodeEvent<'_, T>)) {
        self.pass(now, &mut |event| on_event(NodeEvent::new(event)));
    }

    /// UART: pass received bytes to the client, in pieces of any size.
    pub fn received(&mut self, now: u32, bytes: &[u8], mut on_event: impl FnMut(NodeEvent<'_, T>)) {
        let mut on_event = |event: Event<'_>| on_event(NodeEvent::new(event));
        self.pass(now, &mut on_event);
        let machine = &mut self.machine;
        if let Port::Uart(decoder) = &mut self.port {
            decoder.feed(bytes, |found| match found {
                uart::Event::Message(message) => machine.heard(now, message, &mut on_event),
                uart::Event::UnexpectedStart => on_event(Event::UnexpectedStart),
                uart::Event::ProtocolError => on_event(Event::ProtocolError),
                uart::Event::Overrun => on_event(Event::Overrun),
                uart::Event::Empty => on_event(Event::Empty),
            });
            machine.no_longer_held(now, &mut on_event);
        }
    }

    /// CAN: pass a received packet to the client.
    pub fn packet(
        &mut self,
        now: u32,
        packet: &Packet,
        mut on_event: impl FnMut(NodeEvent<'_, T>),
    ) {
        let mut on_event = |event: Event<'_>| on_event(NodeEvent::new(event));
        self.pass(now, &mut on_event);
        let machine = &mut self.machine;
        if let Port::Can(joiner) = &mut self.port {
            joiner.feed(now, packet, |found| match found {
                can::Event::Message(message) => machine.joined(now, &message, &mut on_event),
                other => on_event(trouble(&other)),
            });
            machine.no_longer_held(now, &mut on_event);
        }
    }

    /// I2C: pass the result of the oldest unfinished transaction to the client: the bytes that were
    /// read, or None if the transaction failed. If the time-out of the transaction has passed or its
    /// request has ended, the result is reported as [`Event::Late`].
    pub fn transferred(
        &mut self,
        now: u32,
        bytes: Option<&[u8]>,
        mut on_event: impl FnMut(NodeEvent<'_, T>),
    ) {
        let mut on_event = |event: Event<'_>| on_event(NodeEvent::new(event));
        let awaited = self.machine.taken.is_single() && self.machine.awaits_transfer();
        let transaction = self.machine.taken.pop();
        self.pass(now, &mut on_event); // may end this request
        let awaited = awaited && self.machine.awaits_transfer();
        match transaction {
            Some(_) if awaited => self.machine.transferred(now, bytes, &mut on_event),
            Some(late) => self.machine.transferred_late(late, bytes, &mut on_event),
            None => {
                let (id, data) = (None, bytes.unwrap_or(&[]));
                on_event(Event::Stray { id, data });
            }
        }
    }

    fn pass(&mut self, now: u32, on_event: &mut dyn FnMut(Event<'_>)) {
        if let Port::Can(joiner) = &mut self.port {
            joiner.expire(now, |found| on_event(trouble(&found)));
        }
        self.machine.tick(now, on_event);
    }
}

/// Convert an error event of the joiner.
fn trouble(found: &can::Event<'_>) -> Event<'static> {
    match *found {
        can::Event::Message(can::Message { id, .. }) | can::Event::Malformed { id, .. } => {
            Event::Malformed { id }
        }
        can::Event::Duplicate { id, .. } => Event::Duplicate { id },
        can::Event::Incomplete { id, .. } => Event::Incomplete { id },
        can::Event::Busy { id, .. } => Event::Busy { id },
        can::Event::UnknownType { id, .. } => Event::UnknownType { id },
    }
}
