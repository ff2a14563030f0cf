//! Blocking client over a port that implements `Read` and `Write`. Feature `std`.

use super::link::{Reason, Settings};
use super::procedure::{End, Procedure, Sink};
use super::{
    Client, Error, Event, Linked, NodeEvent, Refusals, Request, Started, TelecommandOf, TelemetryOf,
};
use std::boxed::Box;
use std::fmt;
use std::io::{self, ErrorKind, Read, Write};
use std::time::Instant;
use std::vec::Vec;

/// How a request ended that did not fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The device executed it.
    Done,
    /// It was sent, and nothing responds to it.
    Sent,
}

/// Failure of a request or procedure.
#[derive(Debug)]
#[non_exhaustive]
pub enum Failure {
    /// The port failed.
    Port(io::Error),
    /// The request is invalid, or the reply cannot be decoded.
    Wire(Error),
    /// The node rejected the request (negative acknowledge).
    Refused {
        /// The id.
        id: u32,
        /// The error code.
        code: Option<u32>,
        /// Meaning of the code in the ICD. With header and trailer see [`Failure::reason`].
        reason: Option<Reason>,
    },
    /// The device was busy each time, so the request was not executed.
    Busy {
        /// The id.
        id: u32,
        /// Number of times the request was sent.
        attempts: u16,
        /// The error code.
        code: Option<u32>,
    },
    /// The node did not reply in time.
    Timeout {
        /// The id.
        id: u32,
        /// Number of times the request was sent.
        attempts: u16,
    },
    /// The procedure failed in this way.
    Procedure(End),
}

impl Failure {
    /// Return why node `T` refused a request or was busy; None for other failures, and if the
    /// response has no reason.
    #[must_use]
    pub fn reason<T: Refusals>(&self) -> Option<T::Reason> {
        match self {
            Self::Refused { code, .. } | Self::Busy { code, .. } => code.map(T::reason),
            _ => None,
        }
    }
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
            Self::Busy { id, attempts, .. } => {
                let times = if *attempts == 1 { "" } else { "s" };
                write!(
                    out,
                    "the device is still busy after {attempts} attempt{times} at request {id}"
                )
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

/// Blocking client over a UART, or any other port for its bytes. `N` is the constant `LONGEST` and
/// `T` the type `Node` of the module of the node.
///
/// The application opens the port. Set a read timeout of some milliseconds: `read` must return
/// regularly, even without data (`WouldBlock` or `TimedOut`), because the session checks its clock
/// between reads.
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
    /// Create a session with the node.
    ///
    /// # Errors
    ///
    /// See [`Client::uart`].
    pub fn new<L: Linked<Node = T>>(link: &'static L, port: P) -> Result<Self, Error> {
        Ok(Self {
            client: Client::uart(link)?,
            port: Waiting::new(port),
            on_event: Box::new(|_| {}),
        })
    }

    /// Enable optional checksums. Checksums that the ICD requires are always used.
    #[must_use]
    pub fn with_checksums(mut self) -> Self {
        self.client = self.client.with_checksums();
        self
    }

    /// Replace the timeouts and retries of the ICD.
    #[must_use]
    pub fn with_settings(mut self, settings: Settings) -> Self {
        self.client = self.client.with_settings(settings);
        self
    }

    /// Set a callback for all events, such as unsolicited logs.
    #[must_use]
    pub fn with_events(mut self, on_event: impl FnMut(&NodeEvent<'_, T>) + 'static) -> Self {
        self.on_event = Box::new(on_event);
        self
    }

    /// Request telemetry or read a configuration, and wait for the reply.
    ///
    /// # Errors
    ///
    /// [`Failure`]
    pub fn get<M: TelemetryOf<T>>(&mut self) -> Result<M, Failure> {
        self.client.request::<M>(self.port.now())?;
        Ok(M::read(&self.outcome(Started::Waiting)?.1)?)
    }

    /// Send a telecommand or set a configuration, and wait for the acknowledge if it has one.
    ///
    /// # Errors
    ///
    /// [`Failure`]
    pub fn send<M: TelecommandOf<T>>(&mut self, message: &M) -> Result<Outcome, Failure> {
        let started = self.client.send(self.port.now(), message)?;
        Ok(self.outcome(started)?.0)
    }

    /// Send any request, wait for its outcome, and return the received frame.
    ///
    /// # Errors
    ///
    /// [`Failure`]
    pub fn start(&mut self, request: &Request<'_>) -> Result<Vec<u8>, Failure> {
        let started = self.client.start(self.port.now(), request)?;
        Ok(self.outcome(started)?.1)
    }

    /// Run a procedure to its end.
    ///
    /// # Errors
    ///
    /// [`Failure`]
    pub fn run<'p, S: Sink>(
        &mut self,
        procedure: &mut impl AsMut<Procedure<'p, S>>,
    ) -> Result<(), Failure> {
        let ended = self.driven(procedure.as_mut());
        self.cancelled(ended)
    }

    fn driven<S: Sink>(&mut self, procedure: &mut Procedure<'_, S>) -> Result<(), Failure> {
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

    /// Process unsolicited messages. Returns after one `read` of the port.
    ///
    /// # Errors
    ///
    /// [`Failure::Port`]
    pub fn listen(&mut self) -> Result<(), Failure> {
        self.wait(|_, _| {})
    }

    fn outcome(&mut self, started: Started) -> Result<(Outcome, Vec<u8>), Failure> {
        let outcome = match started {
            Started::Sent => self.flush().map(|()| (Outcome::Sent, Vec::new())),
            Started::Waiting => self.awaited(),
        };
        self.cancelled(outcome)
    }

    fn awaited(&mut self) -> Result<(Outcome, Vec<u8>), Failure> {
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
fn outcome_of(event: &Event<'_>) -> Option<Result<(Outcome, Vec<u8>), Failure>> {
    match *event {
        Event::Done { data, .. } => Some(Ok((Outcome::Done, data.to_vec()))),
        Event::Sent { .. } => Some(Ok((Outcome::Sent, Vec::new()))),
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
