//! Blocking client over a port that implements `Read` and `Write`. Feature `std`.

use super::client::{LineBuffer, Transport};
use super::link::Settings;
use super::procedure::{End, Procedure, Sink};
use super::stream::Values;
use super::{
    stream, uart, ByteLine, Client, Error, Event, Linked, NodeEvent, Refusals, Request,
    TelecommandOf, TelemetryOf,
};
use std::boxed::Box;
use std::fmt;
use std::io::{self, ErrorKind, Read, Write};
use std::time::Instant;
use std::vec;
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
        /// The error code; see [`Failure::reason`].
        code: Option<u32>,
        /// UART: whether the enumeration of the codes does not have the code.
        may_be_damaged: bool,
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
            Self::Refused { id, code, .. } => {
                write!(out, "request {id} is refused")?;
                code.map_or(Ok(()), |code| write!(out, ", code {code}"))
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
struct Waiting<P> {
    port: P,
    began: Instant,
}

impl<P: Read + Write> Waiting<P> {
    fn new(port: P) -> Self {
        let began = Instant::now();
        Self { port, began }
    }

    /// Milliseconds, which may wrap.
    #[allow(clippy::cast_possible_truncation)]
    fn now(&self) -> u32 {
        self.began.elapsed().as_millis() as u32
    }

    /// What has come after as long as the port's `read` waits.
    fn read<'a>(&mut self, input: &'a mut [u8; 512]) -> io::Result<&'a [u8]> {
        match self.port.read(input) {
            Ok(0) => Err(ErrorKind::UnexpectedEof.into()),
            Ok(count) => Ok(super::bits::head(input, count)),
            Err(error) if came_to_nothing(&error) => Ok(&[]),
            Err(error) => Err(error),
        }
    }

    fn write(&mut self, line: &[u8]) -> io::Result<()> {
        if !line.is_empty() {
            self.port.write_all(line)?;
            self.port.flush()?;
        }
        Ok(())
    }
}

type OnEvent<T> = Box<dyn FnMut(&NodeEvent<'_, T>)>;

/// Blocking client of a UART or a framed link, over any port for its bytes. `T` is the type `Node`
/// of the module of the node. `L` is the line: [`uart::Line`] or [`stream::Line`].
///
/// The application opens the port. Set a read timeout of some milliseconds: `read` must return
/// regularly, even without data (`WouldBlock` or `TimedOut`), because the session checks its clock
/// between reads.
///
/// ```
/// use icdgen_runtime::wire::{ByteLine, Failure, Session, TelemetryOf};
/// use std::io::{Read, Write};
///
/// fn show<T, P: Read + Write, L: ByteLine, M: TelemetryOf<T>>(
///     session: &mut Session<T, P, L>,
/// ) -> Result<(), Failure> {
///     println!("{}", session.get::<M>()?);
///     while let Some(unasked) = session.message::<M>(1000)? {
///         println!("{unasked}");
///     }
///     Ok(())
/// }
/// ```
pub struct Session<T, P, L: ByteLine> {
    client: Client<T, L, 1>,
    port: Waiting<P>,
    line: Vec<u8>,
    on_event: OnEvent<T>,
}

impl<T, P: Read + Write, const N: usize> Session<T, P, uart::Line<N>> {
    /// Create a session with a node on the UART.
    ///
    /// # Errors
    ///
    /// See [`Client::uart`].
    pub fn uart(link: &'static impl Linked<Node = T>, port: P) -> Result<Self, Error> {
        Ok(Self::over(Client::uart(link)?, port))
    }

    /// Enable optional checksums. Checksums that the ICD requires are always used.
    #[must_use]
    pub fn with_checksums(mut self) -> Self {
        self.client = self.client.with_checksums();
        self
    }
}

impl<T, P: Read + Write, const N: usize, const S: usize> Session<T, P, stream::Line<N, S>> {
    /// Create a session with a node of a framed link.
    ///
    /// # Errors
    ///
    /// See [`Client::new`].
    pub fn new(link: &'static impl Linked<Node = T>, port: P) -> Result<Self, Error> {
        Ok(Self::over(Client::new(link)?, port))
    }

    /// Set the header and trailer values of the following messages.
    ///
    /// # Errors
    ///
    /// See [`Client::set_values`].
    pub fn set_values(&mut self, values: Values) -> Result<(), Error> {
        self.client.set_values(values)
    }
}

impl<T, P: Read + Write, L: ByteLine> Session<T, P, L> {
    fn over(client: Client<T, L, 1>, port: P) -> Self {
        let longest = <L as Transport>::Buffer::EMPTY.as_ref().len();
        Self {
            client,
            port: Waiting::new(port),
            line: vec![0; 2 * longest + 4], // each byte escaped, between delimiters
            on_event: Box::new(|_| {}),
        }
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

    /// Request telemetry or read a configuration, and wait for the reply.
    ///
    /// # Errors
    ///
    /// [`Failure`]
    pub fn get<M: TelemetryOf<T>>(&mut self) -> Result<M, Failure> {
        self.client.request::<M>(self.port.now())?;
        Ok(M::read(&self.outcome()?.1)?)
    }

    /// Send a telecommand or set a configuration, and wait for the responses that the ICD describes.
    ///
    /// # Errors
    ///
    /// [`Failure`]; for the reason of a refusal see [`Failure::reason`].
    pub fn send<M: TelecommandOf<T>>(&mut self, message: &M) -> Result<Outcome, Failure> {
        self.client.send(self.port.now(), message)?;
        Ok(self.outcome()?.0)
    }

    /// Framed links: send a telecommand and wait for telemetry `A`, although the ICD does not describe that reply.
    ///
    /// # Errors
    ///
    /// [`Failure`]
    pub fn ask<A: TelemetryOf<T>, M: TelecommandOf<T>>(
        &mut self,
        message: &M,
    ) -> Result<A, Failure> {
        self.client.ask::<A, M>(self.port.now(), message)?;
        Ok(A::read(&self.outcome()?.1)?)
    }

    /// Send any request and wait for its outcome. Return the data of the requested telemetry, or of
    /// the response that confirmed the request; no data if nothing responds to it.
    ///
    /// # Errors
    ///
    /// [`Failure`]
    pub fn start(&mut self, request: &Request<'_>) -> Result<Vec<u8>, Failure> {
        self.client.start(self.port.now(), request)?;
        Ok(self.outcome()?.1)
    }

    /// Run a procedure to its end.
    ///
    /// # Errors
    ///
    /// [`Failure`]
    pub fn run<'p, W: Sink>(
        &mut self,
        procedure: &mut impl AsMut<Procedure<'p, W>>,
    ) -> Result<(), Failure> {
        let ended = self.driven(procedure.as_mut());
        if ended.is_err() {
            self.client.cancel();
        }
        ended
    }

    fn driven<W: Sink>(&mut self, procedure: &mut Procedure<'_, W>) -> Result<(), Failure> {
        loop {
            let is_started = self.client.advance(self.port.now(), procedure)?;
            match procedure.result() {
                Some(End::Done) => return Ok(()),
                Some(end) => return Err(Failure::Procedure(end)),
                None => {}
            }
            if is_started {
                self.flush()?;
                // One to which nothing responds has ended now.
                self.process(&[], |now, event| procedure.event(now, event));
            } else {
                self.wait(|now, event| procedure.event(now, event))?;
            }
        }
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
            self.wait(|_, event| found = found.take().or_else(|| event.message()))?;
        }
        Ok(found)
    }

    /// Process unsolicited messages. Returns after one `read` of the port.
    ///
    /// # Errors
    ///
    /// [`Failure::Port`]
    pub fn listen(&mut self) -> Result<(), Failure> {
        self.wait(|_, _| {})
    }

    /// Wait until the request has ended. One that failed with its port must not be in the way of the
    /// next.
    fn outcome(&mut self) -> Result<(Outcome, Vec<u8>), Failure> {
        let outcome = self.ended();
        if outcome.is_err() {
            self.client.cancel();
        }
        outcome
    }

    fn ended(&mut self) -> Result<(Outcome, Vec<u8>), Failure> {
        let mut ending = Ending::default();
        self.flush()?;
        // One to which nothing responds has ended now.
        self.process(&[], |_, event| ending.hear(event));
        loop {
            if let Some(outcome) = ending.outcome.take() {
                let (outcome, data) = outcome?;
                return Ok((outcome, ending.reply.unwrap_or(data)));
            }
            self.wait(|_, event| ending.hear(event))?;
        }
    }

    fn wait(&mut self, on_event: impl FnMut(u32, &NodeEvent<'_, T>)) -> Result<(), Failure> {
        self.flush()?;
        let mut input = [0; 512];
        let bytes = self.port.read(&mut input)?;
        self.process(bytes, on_event);
        self.flush()
    }

    fn process(&mut self, bytes: &[u8], mut on_event: impl FnMut(u32, &NodeEvent<'_, T>)) {
        let (now, told) = (self.port.now(), &mut self.on_event);
        let both = |event: NodeEvent<'_, T>| {
            on_event(now, &event);
            told(&event);
        };
        if bytes.is_empty() {
            self.client.tick(now, both);
        } else {
            self.client.received(now, bytes, both);
        }
    }

    fn flush(&mut self) -> Result<(), Failure> {
        while let Some(bytes) = self.client.output(&mut self.line)? {
            self.port.write(bytes)?;
        }
        Ok(())
    }
}

/// The events of a request until it has ended.
#[derive(Default)]
struct Ending {
    reply: Option<Vec<u8>>, // the requested telemetry, if it came before the acknowledge
    outcome: Option<Result<(Outcome, Vec<u8>), Failure>>,
}

impl Ending {
    fn hear(&mut self, event: &Event<'_>) {
        let outcome = match *event {
            Event::Done { data, .. } => Ok((Outcome::Done, data.to_vec())),
            Event::Sent { .. } => Ok((Outcome::Sent, Vec::new())),
            Event::Refused {
                id,
                code,
                may_be_damaged,
                ..
            } => Err(Failure::Refused {
                id,
                code,
                may_be_damaged,
            }),
            Event::Busy {
                id, attempts, code, ..
            } => Err(Failure::Busy { id, attempts, code }),
            Event::Timeout { id, attempts, .. } => Err(Failure::Timeout { id, attempts }),
            Event::Reply { data, .. } => {
                self.reply = Some(data.to_vec());
                return;
            }
            _ => return,
        };
        self.outcome = self.outcome.take().or(Some(outcome));
    }
}

fn came_to_nothing(error: &io::Error) -> bool {
    use ErrorKind::{Interrupted, TimedOut, WouldBlock};
    matches!(error.kind(), Interrupted | TimedOut | WouldBlock)
}
