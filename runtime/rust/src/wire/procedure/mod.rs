//! Procedures: steps that a client runs one after another, such as a file transfer.
//!
//! The module `procedures` of a node has its procedures. A [`Procedure`] returns the next request
//! and processes its outcome.

mod blocks;
mod engine;
mod sink;
mod tables;

pub use self::engine::{End, Procedure};
pub use self::sink::{Entries, Received, Sink};
pub use self::tables::{Blocks, Form, Input, PacketMap, Put, Step, Take, Test, Value};
