//! Blocking client for messages with header and trailer, over a port that implements `Read` and
//! `Write`. Feature `std`.

use super::{Client, Event, NodeEvent, Request, Values};
use crate::wire::link::Settings;
use crate::wire::session::{Failure, Waiting};
use crate::wire::{Error, Linked, Started, TelecommandOf, TelemetryOf};
use std::boxed::Box;
use std::io::{Read, Write};
use std::vec;
use std::vec::Vec;

type OnEvent<T> = Box<dyn FnMut(&NodeEvent<'_, T>)>;

/// Blocking client. `N` is the constant `LONGEST`, `S` the constant `SEQUENCES` and `T` the type
/// `Node` of the module of the node.
///
/// The application opens the port. Set a read timeout of some milliseconds: `read` must return
/// regularly, even without data (`WouldBlock` or `TimedOut`), because the session checks its clock
/// between reads.
///
/// ```
/// use icdgen_runtime::wire::{stream::Session, Failure, TelemetryOf};
/// use std::io::{Read, Write};
///
/// fn show<T, P: Read + Write, M: TelemetryOf<T>, const N: usize, const S: usize>(
///     session: &mut Session<T, P, N, S>,
/// ) -> Result<(), Failure> {
///     println!("{}", session.get::<M>()?);
///     while let Some(unasked) = session.message::<M>(1000)? {
///         println!("{unasked}");
///     }
///     Ok(())
/// }
/// ```
pub struct Session<T, P, const N: usize, const S: usize> {
    client: Client<T, N, S, 1>,
    port: Waiting<P>,
    line: Vec<u8>,
    on_event: OnEvent<T>,
}

impl<T, P: Read + Write, const N: usize, const S: usize> Session<T, P, N, S> {
    /// Create a session with the node.
    ///
    /// # Errors
    ///
    /// See [`Client::new`].
    pub fn new(link: &'static impl Linked<Node = T>, port: P) -> Result<Self, Error> {
        Ok(Self {
            client: Client::new(link)?,
            port: Waiting::new(port),
            line: vec![0; 2 * N + 2], // each byte escaped, between delimiters
            on_event: Box::new(|_| {}),
        })
    }

    /// Replace the timeouts and retries of the ICD.
    #[must_use]
    pub fn with_settings(mut self, settings: Settings) -> Self {
        self.client = self.client.with_settings(settings);
        self
    }

    /// Set a callback for all events, including dropped messages.
    #[must_use]
    pub fn with_events(mut self, on_event: impl FnMut(&NodeEvent<'_, T>) + 'static) -> Self {
        self.on_event = Box::new(on_event);
        self
    }

    /// Set the header and trailer values of the following messages.
    ///
    /// # Errors
    ///
    /// See [`Client::set_values`].
    pub fn set_values(&mut self, values: Values) -> Result<(), Error> {
        self.client.set_values(values)
    }

    /// Request telemetry by sending the telecommand that it replies to.
    ///
    /// # Errors
    ///
    /// [`Failure`]
    pub fn get<M: TelemetryOf<T>>(&mut self) -> Result<M, Failure> {
        self.client.request::<M>(self.port.now())?;
        Ok(M::read(&self.outcome(Started::Waiting)?)?)
    }

    /// Send a telecommand and wait for its reply, if the ICD defines one.
    ///
    /// # Errors
    ///
    /// [`Failure`]
    pub fn send<M: TelecommandOf<T>>(&mut self, message: &M) -> Result<(), Failure> {
        let started = self.client.send(self.port.now(), message)?;
        self.outcome(started).map(|_| ())
    }

    /// Send a telecommand and wait for telemetry `A`, regardless of the ICD.
    ///
    /// # Errors
    ///
    /// [`Failure`]
    pub fn ask<A: TelemetryOf<T>, M: TelecommandOf<T>>(
        &mut self,
        message: &M,
    ) -> Result<A, Failure> {
        self.client.ask::<A, M>(self.port.now(), message)?;
        Ok(A::read(&self.outcome(Started::Waiting)?)?)
    }

    /// Send any request, wait for its outcome, and return the data of the reply, if it has one.
    ///
    /// # Errors
    ///
    /// [`Failure`]
    pub fn start(&mut self, request: &Request<'_>) -> Result<Vec<u8>, Failure> {
        let started = self.client.start(self.port.now(), request)?;
        self.outcome(started)
    }

    /// Wait for the next telemetry `M`, unsolicited or not. Return None if none arrives within this
    /// number of milliseconds.
    ///
    /// # Errors
    ///
    /// [`Failure::Port`]
    pub fn message<M: TelemetryOf<T>>(&mut self, milliseconds: u32) -> Result<Option<M>, Failure> {
        let (began, mut found) = (self.port.now(), None);
        while found.is_none() && self.port.now().wrapping_sub(began) < milliseconds {
            self.wait(|event| found = found.take().or_else(|| event.message()))?;
        }
        Ok(found)
    }

    /// Process unsolicited messages. Returns after one `read` of the port.
    ///
    /// # Errors
    ///
    /// [`Failure::Port`]
    pub fn listen(&mut self) -> Result<(), Failure> {
        self.wait(|_| {})
    }

    /// What became of the request; one that failed with its port must not be in the way of the next.
    fn outcome(&mut self, started: Started) -> Result<Vec<u8>, Failure> {
        let outcome = match started {
            Started::Done => self.flush().map(|()| Vec::new()),
            Started::Waiting => self.awaited(),
        };
        if outcome.is_err() {
            self.client.cancel();
        }
        outcome
    }

    fn awaited(&mut self) -> Result<Vec<u8>, Failure> {
        let mut found = None;
        loop {
            self.wait(|event| found = found.take().or_else(|| outcome_of(event)))?;
            if let Some(outcome) = found {
                return outcome;
            }
        }
    }

    fn wait(&mut self, mut on_event: impl FnMut(&NodeEvent<'_, T>)) -> Result<(), Failure> {
        self.flush()?;
        let mut input = [0; 512];
        let bytes = self.port.read(&mut input)?;
        let now = self.port.now();
        let told = &mut self.on_event;
        self.client.received(now, bytes, |event| {
            on_event(&event);
            told(&event);
        });
        self.flush()
    }

    fn flush(&mut self) -> Result<(), Failure> {
        while let Some(bytes) = self.client.output(&mut self.line)? {
            self.port.write(bytes)?;
        }
        Ok(())
    }
}

/// What the event says of the request.
fn outcome_of(event: &Event<'_>) -> Option<Result<Vec<u8>, Failure>> {
    match *event {
        Event::Done { data, .. } => Some(Ok(data.to_vec())),
        Event::Timeout { id, attempts, .. } => Some(Err(Failure::Timeout { id, attempts })),
        _ => None,
    }
}
