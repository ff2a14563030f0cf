//! Client for messages with header and trailer. Several requests may be in progress.

use super::decoder::Decoder;
use super::encoder::Values;
use super::judge::Event;
use super::sender::Sender;
use super::slots::Slots;
use super::Request;
use crate::wire::link::Settings;
use crate::wire::procedure::{Procedure, Sink};
use crate::wire::{Direction, Error, Linked, Refusals, TelecommandOf, TelemetryOf};
use core::fmt;
use core::marker::PhantomData;
use core::ops::Deref;

/// A client of node `T` for messages with header and trailer. `N` is the constant `LONGEST` and `S`
/// the constant `SEQUENCES` of the module of the node. Up to `R` requests may be in progress or wait
/// to be sent.
///
/// The application passes received bytes to the client, takes its output after each call, and calls
/// [`Client::tick`] at the [`Client::deadline`]. All times `now` are in milliseconds and may wrap
/// around; between two calls must be less than 24 days.
///
/// Requests are sent in the order in which they began. A request waits while as many are in progress
/// as the device handles, or while a response to another request could be taken for a response to
/// it.
///
/// Every request ends with one event: [`Event::Sent`] if nothing responds to it, otherwise
/// [`Event::Done`], [`Event::Refused`], [`Event::Busy`] or [`Event::Timeout`]. Unsolicited telemetry
/// is reported as [`Event::Message`], a response to a request that has ended as [`Event::Late`], any
/// other response as [`Event::Stray`].
///
/// ```
/// use icdgen_runtime::wire::stream::Client;
/// use icdgen_runtime::wire::{Error, TelemetryOf};
///
/// /// Requests telemetry. `port` sends bytes and returns the bytes that were received.
/// fn asked<T, M: TelemetryOf<T>, const N: usize>(
///     client: &mut Client<T, N, 1, 2>,
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
pub struct Client<T, const N: usize, const S: usize, const R: usize> {
    sender: Sender<T, S>,
    decoder: Decoder<N, S>,
    slots: Slots<N, R>,
}

impl<T, const N: usize, const S: usize, const R: usize> Client<T, N, S, R> {
    /// Create a client with the timeouts and values of the ICD.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD describes no framing, [`Error::Length`] if `N` is too
    /// small.
    pub fn new(link: &'static impl Linked<Node = T>) -> Result<Self, Error> {
        let sender = Sender::new(link)?;
        let link = link.link();
        let (expected, actual) = (link.longest, N);
        if actual < expected {
            return Err(Error::Length { expected, actual });
        }
        let form = link.stream.as_ref().ok_or(Error::Unsupported)?;
        Ok(Self {
            sender,
            decoder: Decoder::with_limit(link, Direction::Telemetry, link.longest)?,
            slots: Slots::new(form, link.client),
        })
    }

    /// Replace the timeouts and retries of the ICD.
    #[must_use]
    pub fn with_settings(mut self, settings: Settings) -> Self {
        self.slots.settings = settings;
        self
    }

    /// Set the header and trailer values of the following messages. `sequence` is the number of the
    /// first message.
    ///
    /// # Errors
    ///
    /// [`Error::Range`] if a value does not fit into its field.
    pub fn set_values(&mut self, values: Values) -> Result<(), Error> {
        values.check(self.slots.form)?;
        self.sender.values = values;
        Ok(())
    }

    /// Return the time in milliseconds at which [`Client::tick`] must be called at the latest.
    /// None: no request is in progress.
    #[must_use]
    pub fn deadline(&self) -> Option<u32> {
        self.slots.deadline()
    }

    /// Return the number of received bytes that are not part of a message.
    #[must_use]
    pub const fn discarded(&self) -> u64 {
        self.decoder.discarded()
    }

    /// Request telemetry by the telecommand that it replies to, or by the packet of requests. `now`
    /// is in milliseconds.
    ///
    /// # Errors
    ///
    /// See [`Client::start`].
    pub fn request<M: TelemetryOf<T>>(&mut self, now: u32) -> Result<(), Error> {
        self.start(now, &Request::telemetry(M::TELEMETRY_ID))
    }

    /// Send a telecommand. The ICD describes the responses. `now` is in milliseconds.
    ///
    /// # Errors
    ///
    /// See [`Client::start`]; also [`Error::Range`] if a value does not fit into its field.
    pub fn send<M: TelecommandOf<T>>(&mut self, now: u32, message: &M) -> Result<(), Error> {
        let data = message.to_bytes()?;
        self.start(now, &Request::telecommand(M::TELECOMMAND_ID, data.as_ref()))
    }

    /// Send a telecommand to which telemetry `A` replies, although the ICD does not describe that.
    /// `now` is in milliseconds.
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

    /// Start a request. The data are copied; [`Client::output`] returns the message when it may be
    /// sent. `now` is in milliseconds.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownId`] if the node has no such message, [`Error::Busy`] if `R` requests are in
    /// progress or wait to be sent, [`Error::Length`] if the data have the wrong length,
    /// [`Error::Unsupported`] if neither a telecommand without parameters nor a packet requests this
    /// telemetry.
    pub fn start(&mut self, now: u32, request: &Request<'_>) -> Result<(), Error> {
        self.slots.start(now, request)
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
        if self.slots.is_full() {
            return Ok(false);
        }
        match procedure.next(now) {
            Some(request) => self.start(now, &request).map(|()| true),
            None => Ok(false),
        }
    }

    /// Encode the next message to send into `line`. Return None if there is none. Its times count
    /// from the `now` of the previous call of another method.
    ///
    /// # Errors
    ///
    /// [`Error::Length`] if `line` is too small; call again with a larger one.
    pub fn output<'a>(&mut self, line: &'a mut [u8]) -> Result<Option<&'a [u8]>, Error> {
        let sender = &mut self.sender;
        let put = |sent, data: &[u8]| sender.put_sent(sent, data, line);
        let size = self.slots.output(put)?;
        Ok(size.and_then(move |size| line.get(..size)))
    }

    /// Pass received bytes: a piece of the stream of any size, or one packet.
    pub fn received(&mut self, now: u32, bytes: &[u8], mut on_event: impl FnMut(NodeEvent<'_, T>)) {
        self.tick(now, &mut on_event);
        let slots = &mut self.slots;
        self.decoder.feed(bytes, |found| {
            on_event(NodeEvent::new(slots.found(found)));
        });
    }

    /// Process timeouts: send again or end the requests whose time is up. Call at the deadline at
    /// the latest; calling more often is harmless. `now` is in milliseconds.
    pub fn tick(&mut self, now: u32, mut on_event: impl FnMut(NodeEvent<'_, T>)) {
        let told = &mut |event: Event<'_>| on_event(NodeEvent::new(event));
        self.slots.tick(now, told);
    }

    /// Cancel all requests without events. Those that were not sent yet are not sent.
    pub fn cancel(&mut self) {
        self.slots.cancel(None);
    }

    /// Cancel only the requests of this message.
    pub fn cancel_request(&mut self, direction: Direction, id: u32) {
        self.slots.cancel(Some((direction, id)));
    }
}

/// An event of a client of node `T`. It dereferences to [`Event`].
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct NodeEvent<'a, T> {
    event: Event<'a>,
    node: PhantomData<fn() -> T>,
}

impl<'a, T> NodeEvent<'a, T> {
    const fn new(event: Event<'a>) -> Self {
        let node = PhantomData;
        Self { event, node }
    }

    /// Return the telemetry `M`: unsolicited, a reply or any other response; None if the event
    /// contains no such message.
    #[must_use]
    pub fn message<M: TelemetryOf<T>>(&self) -> Option<M> {
        match self.event.telemetry() {
            Some((id, data)) if id == M::TELEMETRY_ID => M::read(data).ok(),
            _ => None,
        }
    }
}

impl<T: Refusals> NodeEvent<'_, T> {
    /// Return why the device refused a request or was busy; None for other events, and if the
    /// response has no reason.
    #[must_use]
    pub fn reason(&self) -> Option<T::Reason> {
        match self.event {
            Event::Refused { code, .. } | Event::Busy { code, .. } => code.map(T::reason),
            _ => None,
        }
    }
}

impl<'a, T> Deref for NodeEvent<'a, T> {
    type Target = Event<'a>;

    #[inline]
    fn deref(&self) -> &Event<'a> {
        &self.event
    }
}

impl<T> fmt::Debug for NodeEvent<'_, T> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.event.fmt(out)
    }
}
