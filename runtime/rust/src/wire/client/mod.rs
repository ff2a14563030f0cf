//! Client that sends requests and reports their outcomes, on any link.

mod awaited;
pub(super) mod bus;
pub(super) mod can;
pub(super) mod framed;
pub(super) mod i2c;
mod line;
mod machine;
pub(super) mod uart;

use self::line::Buffer;
use self::machine::Machine;
use super::event::{Event, NodeEvent};
use super::link::{Bus, Link, Settings};
use super::procedure::{Procedure, Sink};
use super::{Direction, Error, Request, TelecommandOf, TelemetryOf};
use core::marker::PhantomData;

#[cfg(feature = "std")]
pub(super) use self::line::{Buffer as LineBuffer, Transport};
pub use self::line::{ByteLine, Line};

/// A client of node `T`, the type `Node` of the module of the node. `L` is its line:
/// [`uart::Line`](super::uart::Line), [`i2c::Line`](super::i2c::Line),
/// [`can::Line`](super::can::Line) or [`stream::Line`](super::stream::Line) for framed links. Up to
/// `R` requests may be in progress or wait to be sent.
///
/// The application passes received bytes, packets or results of transactions to the client, takes
/// its output after each call, and calls [`Client::tick`] at the [`Client::deadline`]. All times
/// `now` are in milliseconds and may wrap around; between two calls must be less than 24 days.
///
/// Requests are sent in the order in which they began. A request waits while as many are in progress
/// as the device handles, or while a response to another request could be taken for a response to
/// it.
///
/// Every request ends with one event: [`Event::Sent`] if nothing responds to it, otherwise
/// [`Event::Done`], [`Event::Refused`], [`Event::Busy`] or [`Event::Timeout`]. Unsolicited telemetry
/// is reported as [`Event::Arrived`], a response to a request that has ended as [`Event::Late`], any
/// other response as [`Event::Stray`].
///
/// ```
/// use icdgen_runtime::wire::{ByteLine, Client, Error, TelemetryOf};
///
/// /// Requests telemetry. `port` sends bytes and returns the bytes that were received.
/// fn asked<T, M: TelemetryOf<T>, L: ByteLine>(
///     client: &mut Client<T, L, 2>,
///     mut port: impl FnMut(&[u8]) -> Vec<u8>,
/// ) -> Result<Option<M>, Error> {
///     let (mut line, mut input, mut found) = ([0; 600], Vec::new(), None);
///     client.request::<M>(0)?;
///     while let Some(bytes) = client.output(&mut line)? {
///         input.extend(port(bytes));
///     }
///     client.received(1, &input, |event| found = found.or(event.message()));
///     Ok(found)
/// }
/// ```
#[derive(Clone, Debug)]
pub struct Client<T, L: Line, const R: usize> {
    line: L,
    machine: Machine<L::Buffer, R>,
    node: PhantomData<fn() -> T>,
}

impl<T, L: Line, const R: usize> Client<T, L, R> {
    fn over(link: &'static Link, line: L) -> Result<Self, Error> {
        let (expected, actual) = (link.longest, L::Buffer::EMPTY.as_ref().len());
        if actual < expected {
            return Err(Error::Length { expected, actual });
        }
        let machine = Machine::new(link, L::BUS == Some(Bus::I2c));
        let node = PhantomData;
        Ok(Self {
            line,
            machine,
            node,
        })
    }

    /// Replace the timeouts and retries of the ICD.
    #[must_use]
    pub fn with_settings(mut self, settings: Settings) -> Self {
        self.machine.settings = settings;
        self
    }

    /// Return the time in milliseconds at which [`Client::tick`] must be called at the latest.
    /// None: no request is in progress.
    #[must_use]
    pub fn deadline(&self) -> Option<u32> {
        self.machine.deadline()
    }

    /// Request telemetry, or read a configuration. `now` is in milliseconds.
    ///
    /// # Errors
    ///
    /// See [`Client::start`].
    pub fn request<M: TelemetryOf<T>>(&mut self, now: u32) -> Result<(), Error> {
        self.start(now, &Request::telemetry(M::TELEMETRY_ID))
    }

    /// Send a telecommand, or set a configuration. The ICD describes the responses. `now` is in
    /// milliseconds.
    ///
    /// # Errors
    ///
    /// See [`Client::start`]; also [`Error::Range`] if a value does not fit into its field.
    pub fn send<M: TelecommandOf<T>>(&mut self, now: u32, message: &M) -> Result<(), Error> {
        let data = message.to_bytes()?;
        self.start(now, &Request::telecommand(M::TELECOMMAND_ID, data.as_ref()))
    }

    /// Framed links: send a telecommand to which telemetry `A` replies, although the ICD does not
    /// describe that. `now` is in milliseconds.
    ///
    /// # Errors
    ///
    /// See [`Client::start`]; also [`Error::Range`] if a value does not fit into its field.
    pub fn ask<A: TelemetryOf<T>, M: TelecommandOf<T>>(
        &mut self,
        now: u32,
        message: &M,
    ) -> Result<(), Error> {
        let data = message.to_bytes()?;
        let request = Request::telecommand(M::TELECOMMAND_ID, data.as_ref());
        let reply = Some(A::TELEMETRY_ID);
        self.start(now, &Request { reply, ..request })
    }

    /// Start a request. The data are copied; the output has the message when it may be sent. `now`
    /// is in milliseconds.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownId`] if the node has no such message, [`Error::Busy`] if `R` requests are in
    /// progress or wait to be sent, [`Error::Length`] if the data have the wrong length,
    /// [`Error::Unsupported`] if nothing requests this telemetry on a framed link, or if a request
    /// names a reply on another link.
    pub fn start(&mut self, now: u32, request: &Request<'_>) -> Result<(), Error> {
        let plan = self.line.plan(request)?;
        self.machine.start(now, request, plan)
    }

    /// Start the next request of a procedure if there is one, and room for it. Return whether a
    /// request was started.
    ///
    /// # Errors
    ///
    /// See [`Client::start`].
    pub fn advance<'p, W: Sink>(
        &mut self,
        now: u32,
        procedure: &mut impl AsMut<Procedure<'p, W>>,
    ) -> Result<bool, Error> {
        let procedure = procedure.as_mut();
        if self.machine.is_full() {
            return Ok(false);
        }
        procedure.set_bus(L::BUS);
        match procedure.next(now) {
            Some(request) => self.start(now, &request).map(|()| true),
            None => Ok(false),
        }
    }

    /// Process timeouts: send again or end the requests whose time is up. Call at the deadline at
    /// the latest; calling more often is harmless. `now` is in milliseconds.
    pub fn tick(&mut self, now: u32, mut on_event: impl FnMut(NodeEvent<'_, T>)) {
        let on_event = &mut |event: Event<'_>| on_event(NodeEvent::new(event));
        self.line.expire(now, on_event);
        self.machine.tick(now, on_event);
    }

    /// Cancel all requests without events. Those that were not sent yet are not sent; the remaining
    /// packets of a message are not sent either. A late response is reported as [`Event::Late`].
    pub fn cancel(&mut self) {
        self.machine.cancel(None);
    }

    /// Cancel only the requests of this message.
    pub fn cancel_request(&mut self, direction: Direction, id: u32) {
        self.machine.cancel(Some((direction, id)));
    }
}

impl<T, L: ByteLine, const R: usize> Client<T, L, R> {
    /// UART and framed links: encode the next message to send into `line`. Return None if there is
    /// none. Its times count from the `now` of the previous call of another method.
    ///
    /// # Errors
    ///
    /// [`Error::Length`] if `line` is too small; call again with a larger one.
    pub fn output<'a>(&mut self, line: &'a mut [u8]) -> Result<Option<&'a [u8]>, Error> {
        let encoder = &mut self.line;
        let put = |sent, data: &[u8]| encoder.encode(sent, data, line);
        let size = self.machine.output(put)?;
        Ok(size.and_then(move |size| line.get(..size)))
    }

    /// UART and framed links: pass received bytes, a piece of the stream of any size, or one packet.
    pub fn received(&mut self, now: u32, bytes: &[u8], mut on_event: impl FnMut(NodeEvent<'_, T>)) {
        self.tick(now, &mut on_event);
        let on_event = &mut |event: Event<'_>| on_event(NodeEvent::new(event));
        self.line.feed(bytes, &mut self.machine, on_event);
    }
}
