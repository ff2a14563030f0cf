//! Blocking client for messages with header and trailer, over a port that implements `Read` and
//! `Write`. Feature `std`.

use super::{Client, Event, NodeEvent, Request, Values};
use crate::wire::link::Settings;
use crate::wire::procedure::{End, Procedure, Sink};
use crate::wire::session::{Failure, Outcome, Waiting};
use crate::wire::{Error, Linked, TelecommandOf, TelemetryOf};
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
            line: vec![0; 2 * N + 4], // each byte escaped, between delimiters
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
        Ok(M::read(&self.outcome()?.1)?)
    }

    /// Send a telecommand and wait for the responses that the ICD describes.
    ///
    /// # Errors
    ///
    /// [`Failure`]; for the reason of a refusal see [`Failure::reason`].
    pub fn send<M: TelecommandOf<T>>(&mut self, message: &M) -> Result<Outcome, Failure> {
        self.client.send(self.port.now(), message)?;
        Ok(self.outcome()?.0)
    }

    /// Send a telecommand and wait for telemetry `A`, although the ICD does not describe that reply.
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
            Event::Refused { id, code, .. } => Err(Failure::Refused {
                id,
                code,
                reason: None,
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
