//! What procedures take from a client, and what they give to the application.

use crate::wire::{self, stream, Direction};
use crate::Telemetry;
use core::marker::PhantomData;

/// What an event of a client means for a procedure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome<'a> {
    /// The request was executed. The data are those of the requested telemetry.
    Done(&'a [u8]),
    /// The requested telemetry, before the acknowledge of its request.
    Reply(&'a [u8]),
    /// The node refused the request.
    Refused {
        /// Whether the acknowledge may be damaged, as the ICD does not have its code.
        may_be_damaged: bool,
    },
    /// The device was busy each time.
    Busy,
    /// No response in time.
    Timeout,
    /// Telemetry that was not requested.
    Arrived {
        /// Its id.
        id: u32,
        /// Its data.
        data: &'a [u8],
    },
    /// Nothing.
    Unrelated,
}

/// An event of any client, as procedures use it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Happened<'a> {
    pub(super) request: Option<(Direction, u32)>, // of a client that can have several
    pub(super) outcome: Outcome<'a>,
}

impl<'a> From<Outcome<'a>> for Happened<'a> {
    fn from(outcome: Outcome<'a>) -> Self {
        let request = None;
        Self { request, outcome }
    }
}

impl<'a> From<&wire::Event<'a>> for Happened<'a> {
    fn from(event: &wire::Event<'a>) -> Self {
        Self::from(match *event {
            wire::Event::Done { data, .. } => Outcome::Done(data),
            wire::Event::Sent { .. } => Outcome::Done(&[]),
            wire::Event::Refused { code, reason, .. } => Outcome::Refused {
                may_be_damaged: code.is_some() && reason.is_none(),
            },
            wire::Event::Timeout { .. } => Outcome::Timeout,
            wire::Event::Arrived { id, data } => Outcome::Arrived { id, data },
            _ => Outcome::Unrelated,
        })
    }
}

impl<'a> From<&stream::Event<'a>> for Happened<'a> {
    fn from(event: &stream::Event<'a>) -> Self {
        use stream::Event::{Busy, Done, Message, Refused, Reply, Sent, Timeout};
        let outcome = match *event {
            Done { data, .. } => Outcome::Done(data),
            Reply { data, .. } => Outcome::Reply(data),
            Sent { .. } => Outcome::Done(&[]),
            // Packets have a checksum: no refusal is damaged.
            Refused { .. } => Outcome::Refused {
                may_be_damaged: false,
            },
            Busy { .. } => Outcome::Busy,
            Timeout { .. } => Outcome::Timeout,
            Message { id, data, .. } => Outcome::Arrived { id, data },
            _ => Outcome::Unrelated,
        };
        let request = event.request();
        Self { request, outcome }
    }
}

impl<'a, T> From<&wire::NodeEvent<'a, T>> for Happened<'a> {
    fn from(event: &wire::NodeEvent<'a, T>) -> Self {
        Self::from(&**event)
    }
}

impl<'a, T> From<&stream::NodeEvent<'a, T>> for Happened<'a> {
    fn from(event: &stream::NodeEvent<'a, T>) -> Self {
        Self::from(&**event)
    }
}

/// Where a procedure delivers what it received.
pub trait Sink {
    /// Process a block: its offset in the file, and its bytes.
    fn block(&mut self, offset: u32, data: &[u8]) {
        let _ = (offset, data);
    }

    /// Process the frame of an entry.
    fn entry(&mut self, frame: &[u8]) {
        let _ = frame;
    }
}

/// Of a procedure that receives nothing.
impl Sink for () {}

impl<S: Sink + ?Sized> Sink for &mut S {
    fn block(&mut self, offset: u32, data: &[u8]) {
        (**self).block(offset, data);
    }

    fn entry(&mut self, frame: &[u8]) {
        (**self).entry(frame);
    }
}

/// Function to which a procedure passes the offset and the bytes of each received block.
#[derive(Clone, Copy, Debug)]
pub struct Received<F>(pub F);

impl<F: FnMut(u32, &[u8])> Sink for Received<F> {
    fn block(&mut self, offset: u32, data: &[u8]) {
        (self.0)(offset, data);
    }
}

/// Function to which a procedure passes each entry, which is telemetry `M`.
#[derive(Clone, Copy, Debug)]
pub struct Entries<M, F> {
    on_entry: F,
    entry: PhantomData<fn() -> M>,
}

impl<M: Telemetry, F: FnMut(M)> Entries<M, F> {
    /// Create the sink with this function.
    pub const fn new(on_entry: F) -> Self {
        let entry = PhantomData;
        Self { on_entry, entry }
    }
}

impl<M: Telemetry, F: FnMut(M)> Sink for Entries<M, F> {
    fn entry(&mut self, frame: &[u8]) {
        // The client has checked the length of the frame.
        if let Ok(entry) = M::from_bytes(frame) {
            (self.on_entry)(entry);
        }
    }
}
