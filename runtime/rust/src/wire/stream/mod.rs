//! Messages in the envelope that the ICD describes, in a stream of bytes or in packets.

mod check;
mod decoder;
mod encoder;
mod field;

pub use self::decoder::{Decoder, Event};
pub use self::encoder::{encode, Values};
