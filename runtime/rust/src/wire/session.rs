//! A client over a port that reads and writes, for programs that may wait. Feature `std`.

use super::files::{End, Procedure};
use super::link::{Reason, Settings};
use super::{
    Client, Error, Event, Linked, NodeEvent, Request, Started, TelecommandOf, TelemetryOf,
};
use std::boxed::Box;
use std::fmt;
use std::io::{self, ErrorKind, Read, Write};
use std::time::Instant;
use std::vec::Vec;

/// Why a request or a procedure failed.
#[derive(Debug)]
#[non_exhaustive]
pub enum Failure {
    /// The port did.
    Port(io::Error),
    /// It cannot be asked, or what came is no such message.
    Wire(Error),
    /// The node refused the request.
    Refused {
        /// The id.
        id: u32,
        /// The error code.
        code: Option<u32>,
        /// What the ICD says of the code.
        reason: Option<Reason>,
    },
    /// The node did not answer.
    Timeout {
        /// The id.
        id: u32,
        /// How often it was asked.
        attempts: u16,
    },
    /// How a procedure ended that was not done.
    Procedure(End),
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Port(error)
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Wire(error)
    }
}

impl From<crate::Error> for Failure {
    fn from(error: crate::Error) -> Self {
        Self::Wire(error.into())
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Port(error) => write!(out, "the port failed: {error}"),
            Self::Wire(error) => error.fmt(out),
            Self::Refused { id, code, reason } => {
                write!(out, "request {id} is refused")?;
                code.map_or(Ok(()), |code| write!(out, ", code {code}"))?;
                reason.map_or(Ok(()), |reason| write!(out, ": {reason:?}"))
            }
            Self::Timeout { id, attempts: 1 } => {
                write!(out, "no answer to request {id}, asked once")
            }
            Self::Timeout { id, attempts } => {
                write!(out, "no answer to request {id}, asked {attempts} times")
            }
            Self::Procedure(end) => write!(out, "the procedure failed: {end:?}"),
        }
    }
}

impl std::error::Error for Failure {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Port(error) => Some(error),
            Self::Wire(error) => Some(error),
            _ => None,
        }
    }
}

/// A port, and the time since it was handed over.
pub(super) struct Waiting<P> {
    port: P,
    began: Instant,
}

impl<P: Read + Write> Waiting<P> {
    pub(super) fn new(port: P) -> Self {
        let began = Instant::now();
        Self { port, began }
    }

    /// Milliseconds, which may wrap.
    #[allow(clippy::cast_possible_truncation)]
    pub(super) fn now(&self) -> u32 {
        self.began.elapsed().as_millis() as u32
    }

    /// What has come after as long as the port's `read` waits.
    pub(super) fn read<'a>(&mut self, input: &'a mut [u8; 512]) -> io::Result<&'a [u8]> {
        match self.port.read(input) {
            Ok(0) => Err(ErrorKind::UnexpectedEof.into()),
            Ok(count) => Ok(super::bits::head(input, count)),
            Err(error) if came_to_nothing(&error) => Ok(&[]),
            Err(error) => Err(error),
        }
    }

    pub(super) fn write(&mut self, line: &[u8]) -> io::Result<()> {
        if !line.is_empty() {
            self.port.write_all(line)?;
            self.port.flush()?;
        }
        Ok(())
    }
}

type OnEvent<T> = Box<dyn FnMut(&NodeEvent<'_, T>)>;

/// Asks, and waits for the outcome, over a UART or whatever carries its bytes; `N` is the node's
/// `LONGEST`, `T` its `Node`.
///
/// The port is yours. Its `read` must come back after a while, be it with nothing (`WouldBlock` or
/// `TimedOut`), for the clock is looked at in between: set a time-out of some milliseconds.
///
/// ```
/// use icdgen_runtime::wire::{session::Failure, Session, TelemetryOf};
/// use std::io::{Read, Write};
///
/// fn show<T, P: Read + Write, M: TelemetryOf<T>, const N: usize>(
///     session: &mut Session<T, P, N>,
/// ) -> Result<(), Failure> {
///     println!("{}", session.get::<M>()?);
///     Ok(())
/// }
/// ```
pub struct Session<T, P, const N: usize> {
    client: Client<T, N>,
    port: Waiting<P>,
    on_event: OnEvent<T>,
}

impl<T, P: Read + Write, const N: usize> Session<T, P, N> {
    /// A session with the node.
    ///
    /// # Errors
    ///
    /// As [`Client::uart`].
    pub fn new<L: Linked<Node = T>>(link: &'static L, port: P) -> Result<Self, Error> {
        Ok(Self {
            client: Client::uart(link)?,
            port: Waiting::new(port),
            on_event: Box::new(|_| {}),
        })
    }

    /// The same with checksums, where the ICD has them for the bus.
    #[must_use]
    pub fn with_checksums(mut self) -> Self {
        self.client = self.client.with_checksums();
        self
    }

    /// The same with other times than those of the ICD.
    #[must_use]
    pub fn with_settings(mut self, settings: Settings) -> Self {
        self.client = self.client.with_settings(settings);
        self
    }

    /// The same with someone to tell all that comes, such as logs.
    #[must_use]
    pub fn with_events(mut self, on_event: impl FnMut(&NodeEvent<'_, T>) + 'static) -> Self {
        self.on_event = Box::new(on_event);
        self
    }

    /// Requests telemetry, or reads a setting.
    ///
    /// # Errors
    ///
    /// [`Failure`]
    pub fn get<M: TelemetryOf<T>>(&mut self) -> Result<M, Failure> {
        self.client.request::<M>(self.port.now())?;
        Ok(M::read(&self.outcome(Started::Waiting)?)?)
    }

    /// Sends a telecommand or a setting, and waits until it is acknowledged, if it is at all.
    ///
    /// # Errors
    ///
    /// [`Failure`]
    pub fn send<M: TelecommandOf<T>>(&mut self, message: &M) -> Result<(), Failure> {
        let started = self.client.send(self.port.now(), message)?;
        self.outcome(started).map(|_| ())
    }

    /// Makes any request; the frame that came.
    ///
    /// # Errors
    ///
    /// [`Failure`]
    pub fn start(&mut self, request: &Request<'_>) -> Result<Vec<u8>, Failure> {
        let started = self.client.start(self.port.now(), request)?;
        self.outcome(started)
    }

    /// Runs a procedure to its end.
    ///
    /// # Errors
    ///
    /// [`Failure`]
    pub fn run(&mut self, procedure: &mut (impl Procedure + ?Sized)) -> Result<(), Failure> {
        let ended = self.driven(procedure);
        self.cancelled(ended)
    }

    fn driven(&mut self, procedure: &mut (impl Procedure + ?Sized)) -> Result<(), Failure> {
        loop {
            while self.client.advance(self.port.now(), procedure)? {
                self.flush()?;
            }
            match procedure.result() {
                Some(End::Done) => return Ok(()),
                Some(end) => return Err(Failure::Procedure(end)),
                None => self.wait(|now, event| procedure.event(now, event))?,
            }
        }
    }

    /// Takes what has come unasked, after as long as the port's `read` waits.
    ///
    /// # Errors
    ///
    /// [`Failure::Port`]
    pub fn listen(&mut self) -> Result<(), Failure> {
        self.wait(|_, _| {})
    }

    fn outcome(&mut self, started: Started) -> Result<Vec<u8>, Failure> {
        let outcome = match started {
            Started::Done => self.flush().map(|()| Vec::new()),
            Started::Waiting => self.awaited(),
        };
        self.cancelled(outcome)
    }

    fn awaited(&mut self) -> Result<Vec<u8>, Failure> {
        let mut found = None;
        loop {
            self.wait(|_, event| found = found.take().or_else(|| outcome_of(event)))?;
            if let Some(outcome) = found {
                return outcome;
            }
        }
    }

    /// A request that failed with its port must not be in the way of the next one.
    fn cancelled<R>(&mut self, result: Result<R, Failure>) -> Result<R, Failure> {
        if result.is_err() {
            self.client.cancel();
        }
        result
    }

    fn wait(&mut self, mut on_event: impl FnMut(u32, &Event<'_>)) -> Result<(), Failure> {
        self.flush()?;
        let mut input = [0; 512];
        let bytes = self.port.read(&mut input)?;
        let now = self.port.now();
        let told = &mut self.on_event;
        self.client.received(now, bytes, |event| {
            on_event(now, &event);
            told(&event);
        });
        self.flush()
    }

    fn flush(&mut self) -> Result<(), Failure> {
        let mut line = Vec::new();
        while let Some(bytes) = self.client.output() {
            line.extend_from_slice(bytes);
        }
        self.port.write(&line)?;
        Ok(())
    }
}

fn came_to_nothing(error: &io::Error) -> bool {
    use ErrorKind::{Interrupted, TimedOut, WouldBlock};
    matches!(error.kind(), Interrupted | TimedOut | WouldBlock)
}

/// What the event says of the request.
fn outcome_of(event: &Event<'_>) -> Option<Result<Vec<u8>, Failure>> {
    match *event {
        Event::Done { data, .. } => Some(Ok(data.to_vec())),
        Event::Refused {
            id, code, reason, ..
        } => {
            let id = id.into();
            Some(Err(Failure::Refused { id, code, reason }))
        }
        Event::Timeout { id, attempts } => {
            let id = id.into();
            Some(Err(Failure::Timeout { id, attempts }))
        }
        _ => None,
    }
}
