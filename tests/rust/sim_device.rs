//! A node at the end of a TCP connection: requests that wait for their outcome, and procedures that run to their end.

use icd::wire::files::{End, Procedure};
use icd::wire::{Client, Error, Event, Link, Reason, Settings, Started, Telecommand, Telemetry};
use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// For a device that is never slow.
const SETTINGS: Settings = Settings {
    reply_timeout_ms: 150,
    retries: 4,
    poll_interval_ms: 5,
    poll_timeout_ms: 2000,
};
/// How often a telecommand is sent whose acknowledge may have been lost or spoilt.
const TRIES: u32 = 5;
const LONGEST_WAIT_MS: i32 = 1000;

/// What went wrong.
pub struct Failure(pub String);

impl<E: std::fmt::Display> From<E> for Failure {
    fn from(error: E) -> Self {
        Self(error.to_string())
    }
}

/// What became of a request.
#[derive(Debug)]
pub enum Outcome {
    Done(Vec<u8>),
    Refused(Option<Reason>),
    Timeout,
}

impl Outcome {
    fn of(event: &Event<'_>) -> Option<Self> {
        match event {
            Event::Done { data, .. } => Some(Self::Done(data.to_vec())),
            Event::Refused { reason, .. } => Some(Self::Refused(*reason)),
            Event::Timeout { .. } => Some(Self::Timeout),
            _ => None,
        }
    }
}

pub struct Device<const N: usize> {
    pub link: &'static Link,
    port: TcpStream,
    client: Client<N>,
    began: Instant,
}

impl<const N: usize> Device<N> {
    pub fn connect(place: &str, link: &Link) -> Result<Self, Failure> {
        let port = TcpStream::connect(place)?;
        port.set_nodelay(true)?;
        let link: &'static Link = Box::leak(Box::new(hasty(*link)));
        let client = Client::uart(link)?.with_settings(SETTINGS);
        let began = Instant::now();
        Ok(Self { link, port, client, began })
    }

    /// The message as the node has it now.
    pub fn get<M: Telemetry>(&mut self) -> Result<M, Failure> {
        self.client.request::<M>(self.now())?;
        match self.outcome()? {
            Outcome::Done(frame) => Ok(M::from_frame(&frame)?),
            other => Err(format!("telemetry {}: {other:?}", M::TELEMETRY_ID).into()),
        }
    }

    /// Sends a telecommand until it is acknowledged, or is refused each time: an acknowledge may be lost or spoilt.
    pub fn send<M: Telecommand>(&mut self, message: &M) -> Result<Outcome, Failure> {
        let mut outcome = Outcome::Timeout;
        for _ in 0..TRIES {
            outcome = match self.client.send(self.now(), message)? {
                Started::Done => self.flush().map(|()| Outcome::Done(Vec::new()))?,
                Started::Waiting => self.outcome()?,
            };
            if let Outcome::Done(_) = outcome {
                break;
            }
        }
        Ok(outcome)
    }

    /// Runs a procedure to its end.
    pub fn run(&mut self, procedure: &mut dyn Procedure) -> Result<End, Failure> {
        loop {
            while self.client.advance(self.now(), procedure)? {
                self.flush()?;
            }
            if let Some(end) = procedure.result() {
                return Ok(end);
            }
            let until = procedure.deadline();
            self.wait(until, |now, event| procedure.event(now, event))?;
        }
    }

    fn outcome(&mut self) -> Result<Outcome, Failure> {
        let mut found = None;
        while found.is_none() {
            self.wait(None, |_, event| found = found.take().or_else(|| Outcome::of(event)))?;
        }
        found.ok_or_else(|| "no outcome".into())
    }

    /// Waits until something comes, or until then.
    fn wait(&mut self, until: Option<u32>, mut on_event: impl FnMut(u32, &Event<'_>)) -> Result<(), Failure> {
        self.flush()?;
        let (now, times) = (self.now(), [until, self.client.deadline()]);
        let left = times.iter().flatten().map(|time| time.wrapping_sub(now) as i32);
        let left = left.fold(LONGEST_WAIT_MS, i32::min).max(1); // 0 would be for ever
        self.port.set_read_timeout(Some(Duration::from_millis(left as u64)))?;
        let mut input = [0; 4096];
        let count = match self.port.read(&mut input) {
            Ok(0) => return Err("the connection is closed".into()),
            Ok(count) => count,
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => 0,
            Err(error) => return Err(error.into()),
        };
        let now = self.now();
        self.client.received(now, &input[..count], |event| on_event(now, &event));
        self.flush()
    }

    fn flush(&mut self) -> Result<(), Failure> {
        let mut line = Vec::new();
        while let Some(bytes) = self.client.output() {
            line.extend_from_slice(bytes);
        }
        Ok(self.port.write_all(&line)?)
    }

    fn now(&self) -> u32 {
        self.began.elapsed().as_millis() as u32
    }
}

/// The data of a message.
pub fn data_of<M: Telecommand>(message: &M) -> Result<Vec<u8>, Error> {
    let mut buffer = vec![0; 1 << 16];
    let size = message.write_frame(&mut buffer)?;
    buffer.truncate(size);
    Ok(buffer)
}

/// The facts with short waits, for a device that is never slow.
fn hasty(mut link: Link) -> Link {
    if let Some(files) = &mut link.files {
        if let Some(download) = &mut files.download {
            download.silence_ms = 60;
            download.poll_interval_ms = 5;
        }
        if let Some(upload) = &mut files.upload {
            upload.poll_interval_ms = 5;
        }
    }
    link
}
