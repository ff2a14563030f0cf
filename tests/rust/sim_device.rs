//! A session with a simulated node: in a hurry, and patient with what happens to acknowledges.

use icd::wire::session::{Failure, Outcome};
use icd::wire::{uart, NodeLink, Session, Settings, TelecommandOf};
use icd::{Error, Telecommand};
use std::net::TcpStream;
use std::ops::{Deref, DerefMut};
use std::time::Duration;

/// For a device that is never slow, on a machine that may be.
const SETTINGS: Settings = Settings {
    reply_timeout_ms: 150,
    retries: 9,
    poll_interval_ms: 5,
    poll_timeout_ms: 2000,
    late_ms: 150,
    busy_pause_ms: 1,
    gap_ms: 0,
    in_flight: 1,
    progress_for_ms: 1,
};
/// How often something is tried that fails, for the acknowledge may have been lost or spoilt.
pub const TRIES: u32 = 10;

pub type Problem = Box<dyn std::error::Error>;

pub struct Device<const N: usize, T: 'static> {
    pub link: &'static NodeLink<T>,
    port: TcpStream,
    session: Session<T, TcpStream, uart::Line<N>>,
}

impl<const N: usize, T: 'static> Device<N, T> {
    pub fn connect(place: &str, link: &'static NodeLink<T>) -> Result<Self, Problem> {
        let port = TcpStream::connect(place)?;
        port.set_nodelay(true)?;
        port.set_read_timeout(Some(Duration::from_millis(5)))?;
        Self::over(port, link)
    }

    /// The same device, while the program of that link runs.
    pub fn running<U: 'static>(&self, link: &'static NodeLink<U>) -> Result<Device<N, U>, Problem> {
        Device::over(self.port.try_clone()?, link)
    }

    fn over(port: TcpStream, link: &'static NodeLink<T>) -> Result<Self, Problem> {
        let session = Session::uart(link, port.try_clone()?)?.with_settings(SETTINGS);
        Ok(Self { link, port, session })
    }

    /// Sends a telecommand until it is acknowledged, or refused twice: an acknowledge may be lost or spoilt.
    pub fn insist<M: TelecommandOf<T>>(&mut self, message: &M) -> Result<Outcome, Failure> {
        let mut refused = false;
        for _ in 1..TRIES {
            match self.send(message) {
                Err(Failure::Refused { may_be_damaged: false, .. }) if !refused => refused = true,
                Err(Failure::Refused { may_be_damaged: true, .. } | Failure::Timeout { .. }) => {}
                outcome => return outcome,
            }
        }
        self.send(message)
    }
}

impl<const N: usize, T> Deref for Device<N, T> {
    type Target = Session<T, TcpStream, uart::Line<N>>;

    fn deref(&self) -> &Self::Target {
        &self.session
    }
}

impl<const N: usize, T> DerefMut for Device<N, T> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.session
    }
}

/// The data of a message.
pub fn data_of<M: Telecommand>(message: &M) -> Result<Vec<u8>, Error> {
    Ok(message.to_bytes()?.as_ref().to_vec())
}
