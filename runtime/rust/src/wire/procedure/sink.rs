//! What procedures give to the application.

use crate::Telemetry;
use core::marker::PhantomData;

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
