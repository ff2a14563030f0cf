//! The client over envelopes: requests that different telemetry answers, and what comes unasked.

use super::decoder::Decoder;
use super::encoder::Values;
use super::judge::Event;
use super::sender::Sender;
use super::slots::Slots;
use super::Request;
use crate::wire::link::{Settings, Stream};
use crate::wire::request::Started;
use crate::wire::{Direction, Error, Linked, TelecommandOf, TelemetryOf};
use core::fmt;
use core::marker::PhantomData;
use core::ops::Deref;

/// A client of node `T` whose messages travel in envelopes; `N` is the node's `LONGEST`, `S` its `SEQUENCES`.
/// `R` requests may be under way together, if they wait for telemetry of different ids: that tells them apart.
///
/// Bytes that came are handed over, output is taken, and [`Client::tick`] is called at the
/// [`Client::deadline`]. Telemetry that nobody waits for is [`Event::Message`].
///
/// ```
/// use icdgen_runtime::wire::stream::Client;
/// use icdgen_runtime::wire::{Error, TelemetryOf};
///
/// /// Asks for telemetry and hands over what `port` answers to the bytes that it is given.
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
    form: &'static Stream,
    sender: Sender<T, S>,
    decoder: Decoder<N, S>,
    slots: Slots<N, R>,
}

impl<T, const N: usize, const S: usize, const R: usize> Client<T, N, S, R> {
    /// A client with the times and the values of the ICD.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD describes no envelope, [`Error::Length`] if `N` is too small.
    pub fn new(link: &'static impl Linked<Node = T>) -> Result<Self, Error> {
        let sender = Sender::new(link)?;
        let link = link.link();
        let (expected, actual) = (link.longest, N);
        if actual < expected {
            return Err(Error::Length { expected, actual });
        }
        Ok(Self {
            form: link.stream.as_ref().ok_or(Error::Unsupported)?,
            sender,
            decoder: Decoder::with_limit(link, Direction::Telemetry, link.longest)?,
            slots: Slots::new(link.client),
        })
    }

    /// The same with other times than those of the ICD.
    #[must_use]
    pub fn with_settings(mut self, settings: Settings) -> Self {
        self.slots.settings = settings;
        self
    }

    /// Chooses the values of the envelope of what is sent from now on; `sequence` is that of the first message.
    ///
    /// # Errors
    ///
    /// [`Error::Range`] if one does not fit its field.
    pub fn set_values(&mut self, values: Values) -> Result<(), Error> {
        values.check(self.form)?;
        self.sender.values = values;
        Ok(())
    }

    /// When [`Client::tick`] wants to be called at the latest; None: not at all.
    #[must_use]
    pub fn deadline(&self) -> Option<u32> {
        self.slots.deadline()
    }

    /// Bytes of the stream that became part of no message.
    #[must_use]
    pub const fn discarded(&self) -> u64 {
        self.decoder.discarded()
    }

    /// Asks for telemetry of the node, by the telecommand that it answers.
    ///
    /// # Errors
    ///
    /// As [`Client::start`].
    pub fn request<M: TelemetryOf<T>>(&mut self, now: u32) -> Result<(), Error> {
        self.start(now, &Request::telemetry(M::TELEMETRY_ID))?;
        Ok(())
    }

    /// Sends a telecommand of the node, which is answered as the ICD says.
    ///
    /// # Errors
    ///
    /// As [`Client::start`]; [`Error::Range`] if a value does not fit.
    pub fn send<M: TelecommandOf<T>>(&mut self, now: u32, message: &M) -> Result<Started, Error> {
        let data = message.to_bytes()?;
        self.start(now, &Request::telecommand(M::TELECOMMAND_ID, data.as_ref()))
    }

    /// Sends a telecommand of the node that telemetry `A` answers, whatever the ICD says.
    ///
    /// # Errors
    ///
    /// As [`Client::start`]; [`Error::Range`] if a value does not fit.
    pub fn ask<A: TelemetryOf<T>, M: TelecommandOf<T>>(
        &mut self,
        now: u32,
        message: &M,
    ) -> Result<(), Error> {
        let data = message.to_bytes()?;
        let request = Request::telecommand(M::TELECOMMAND_ID, data.as_ref());
        let reply = Some(A::TELEMETRY_ID);
        self.start(now, &Request { reply, ..request })?;
        Ok(())
    }

    /// Begins a request.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownId`] if the node has no such message, [`Error::Busy`] while another request waits for
    /// the same reply or `R` are under way, [`Error::Length`] if the data have another length,
    /// [`Error::Unsupported`] for telemetry that no telecommand without parameters is answered with.
    pub fn start(&mut self, now: u32, request: &Request<'_>) -> Result<Started, Error> {
        self.slots.start(self.form, now, request)
    }

    /// Writes the next message to be sent, until there is none.
    ///
    /// # Errors
    ///
    /// [`Error::Length`] if it does not fit the `line`; it is still to be sent.
    pub fn output<'a>(&mut self, line: &'a mut [u8]) -> Result<Option<&'a [u8]>, Error> {
        let sender = &mut self.sender;
        let put = |id, data: &[u8]| sender.put(id, data, line);
        let size = self.slots.output(put)?;
        Ok(size.and_then(move |size| line.get(..size)))
    }

    /// Takes the next bytes of the stream, or a packet.
    pub fn received(&mut self, now: u32, bytes: &[u8], mut on_event: impl FnMut(NodeEvent<'_, T>)) {
        self.tick(now, &mut on_event);
        let slots = &mut self.slots;
        self.decoder.feed(bytes, |found| {
            on_event(NodeEvent::new(slots.found(now, found)));
        });
    }

    /// Lets time pass.
    pub fn tick(&mut self, now: u32, mut on_event: impl FnMut(NodeEvent<'_, T>)) {
        let told = &mut |event: Event<'_>| on_event(NodeEvent::new(event));
        self.slots.tick(now, told);
    }

    /// Gives up all requests, without events, and what of them has not been taken. A late reply is
    /// [`Event::Message`].
    pub fn cancel(&mut self) {
        self.slots.cancel(None);
    }

    /// Gives up the requests of that message only.
    pub fn cancel_request(&mut self, direction: Direction, id: u32) {
        self.slots.cancel(Some((direction, id)));
    }
}

/// An event of a client of node `T`; it is used as an [`Event`].
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

    /// The telemetry that came, as a reply or unasked; None if it is another one, or none.
    #[must_use]
    pub fn message<M: TelemetryOf<T>>(&self) -> Option<M> {
        match self.event {
            Event::Done { reply, data, .. } if reply == M::TELEMETRY_ID => M::read(data).ok(),
            Event::Message { id, data, .. } if id == M::TELEMETRY_ID => M::read(data).ok(),
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
