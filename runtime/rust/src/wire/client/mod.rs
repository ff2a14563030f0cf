//! The client: one request at a time, from sending to its outcome, over any bus.

#[cfg(feature = "embedded-hal")]
mod i2c;
mod machine;

use self::machine::Machine;
use super::bits::head;
use super::can::{self, Joiner, Packet};
use super::event::{Event, NodeEvent};
use super::files::Procedure;
use super::link::{Bus, Link, Settings};
use super::message::{octet, Linked};
use super::request::{Request, Started};
use super::uart::{self, Decoder, Encoder};
use super::{Error, TelecommandOf, TelemetryOf};
use core::marker::PhantomData;

/// An I2C transaction: a write, then a read of so many bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transaction<'a> {
    /// What is written.
    pub write: &'a [u8],
    /// How many bytes are read.
    pub read: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Idle,
    /// The reply to the request before may still come.
    Hold,
    /// Sent.
    Wait,
    /// I2C: before the next poll, or before it is sent again.
    Pause,
    /// I2C: the acknowledge frame is requested.
    Poll,
}

/// What is to be sent.
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

/// A client of node `T` on a bus; `N` is the node's `LONGEST`. It is made for the `LINK` of the node,
/// `T` is the type `Node` of the same module: `Client::<Node, LONGEST>::uart(&LINK)`.
///
/// Bytes, packets or transactions that came are handed over, output is taken, and [`Client::tick`] is
/// called at the [`Client::deadline`].
///
/// ```
/// use icdgen_runtime::wire::{Client, Error, TelemetryOf};
///
/// /// Asks for a frame and hands over what `port` answers to the bytes that it is given.
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
    /// A client on the UART.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD does not describe it, [`Error::Length`] if `N` is too small.
    pub fn uart<L: Linked<Node = T>>(link: &'static L) -> Result<Self, Error> {
        let link = link.link();
        Self::new(
            link,
            Bus::Uart,
            Port::Uart(Decoder::with_limit(link, link.longest)?),
            0,
        )
    }

    /// A client on I2C, as the master.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD does not describe it, [`Error::Length`] if `N` is too small.
    pub fn i2c<L: Linked<Node = T>>(link: &'static L) -> Result<Self, Error> {
        let link = link.link();
        link.i2c_address.ok_or(Error::Unsupported)?;
        link.polled.as_ref().ok_or(Error::Unsupported)?;
        Self::new(link, Bus::I2c, Port::I2c, 0)
    }

    /// A client on CAN, with its own address.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD does not describe it, [`Error::Length`] if `N` is too small.
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

    /// The same with checksums where the ICD leaves the choice for the bus. Where it demands them, they are
    /// used in any case.
    #[must_use]
    pub fn with_checksums(mut self) -> Self {
        if let Some(form) = &self.machine.link.checksum {
            self.machine.checks_telecommands = form.telecommand_buses.of(self.machine.bus);
            self.machine.checks_telemetry = form.telemetry_buses.of(self.machine.bus);
        }
        self
    }

    /// The same with other times than those of the ICD.
    #[must_use]
    pub const fn with_settings(mut self, settings: Settings) -> Self {
        self.machine.settings = settings;
        self
    }

    /// When [`Client::tick`] wants to be called at the latest; None: not at all.
    #[must_use]
    pub fn deadline(&self) -> Option<u32> {
        (self.machine.state != State::Idle).then_some(self.machine.until)
    }

    /// Requests telemetry, or configuration, of the node.
    ///
    /// # Errors
    ///
    /// As [`Client::start`].
    pub fn request<M: TelemetryOf<T>>(&mut self, now: u32) -> Result<(), Error> {
        self.start(now, &Request::telemetry(octet(M::TELEMETRY_ID)))?;
        Ok(())
    }

    /// Sends a telecommand, or configuration, of the node.
    ///
    /// # Errors
    ///
    /// As [`Client::start`]; [`Error::Range`] if a value does not fit.
    pub fn send<M: TelecommandOf<T>>(&mut self, now: u32, message: &M) -> Result<Started, Error> {
        let data = message.to_bytes()?;
        let id = octet(M::TELECOMMAND_ID);
        self.start(now, &Request::telecommand(id, data.as_ref()))
    }

    /// Begins a request.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownId`] if the node has no such message, [`Error::Busy`] while another request is going
    /// on or its output has not been taken, [`Error::Length`] if the data have another length.
    pub fn start(&mut self, now: u32, request: &Request<'_>) -> Result<Started, Error> {
        self.machine.start(now, request)
    }

    /// Begins the next request of a procedure, if it has one and no other is going on; says whether it
    /// did. What nothing will answer, the procedure is told at once.
    ///
    /// # Errors
    ///
    /// As [`Client::start`].
    pub fn advance(
        &mut self,
        now: u32,
        procedure: &mut (impl Procedure + ?Sized),
    ) -> Result<bool, Error> {
        if self.machine.is_busy() {
            return Ok(false);
        }
        let request = match procedure.next(now) {
            Some(request) => request,
            None => return Ok(false),
        };
        let (id, attempts, data) = (request.id, 1, &[]);
        if self.start(now, &request)? == Started::Done {
            let done = Event::Done { id, attempts, data };
            procedure.event(now, &done);
        }
        Ok(true)
    }

    /// UART: the next bytes to send, until there are none. No piece holds bytes of two messages.
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

    /// CAN: the next packet to send, until there is none.
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

    /// I2C: the next transaction, if there is one; [`Client::transferred`] is told what came of each, once
    /// and in this order.
    pub fn output_transaction(&mut self) -> Option<Transaction<'_>> {
        let machine = &mut self.machine;
        if machine.bus != Bus::I2c {
            return None;
        }
        let output = machine.first()?;
        machine.sent();
        machine.owed = machine.owed.saturating_add(1);
        Some(machine.transaction(output))
    }

    /// Gives up the request, without an event, and what of it has not been taken: the next one may begin. A
    /// late reply to this one is [`Event::Stray`].
    pub fn cancel(&mut self) {
        self.machine.cancel();
    }

    /// Lets time pass.
    pub fn tick(&mut self, now: u32, mut on_event: impl FnMut(NodeEvent<'_, T>)) {
        self.pass(now, &mut |event| on_event(NodeEvent::new(event)));
    }

    /// UART: takes the next bytes of the stream.
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
        }
    }

    /// CAN: takes a packet.
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
        }
    }

    /// I2C: takes what was read in the oldest transaction that was taken and not told of; None: it failed.
    /// What a request owed that is over is [`Event::Stray`].
    pub fn transferred(
        &mut self,
        now: u32,
        bytes: Option<&[u8]>,
        mut on_event: impl FnMut(NodeEvent<'_, T>),
    ) {
        let mut on_event = |event: Event<'_>| on_event(NodeEvent::new(event));
        let awaited = self.machine.owed == 1 && self.machine.awaits_transfer();
        self.machine.owed = self.machine.owed.saturating_sub(1);
        self.pass(now, &mut on_event); // may end that request
        let awaited = awaited && self.machine.awaits_transfer();
        self.machine.transferred(now, bytes, awaited, &mut on_event);
    }

    fn pass(&mut self, now: u32, on_event: &mut dyn FnMut(Event<'_>)) {
        if let Port::Can(joiner) = &mut self.port {
            joiner.expire(now, |found| on_event(trouble(&found)));
        }
        self.machine.tick(now, on_event);
    }
}

/// An event of the joiner that tells of an error.
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
