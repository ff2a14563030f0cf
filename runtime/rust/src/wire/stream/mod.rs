//! Messages in the envelope that the ICD describes, in a stream of bytes or in packets.

mod check;
mod decoder;
mod encoder;
mod field;
mod judge;
mod sender;

pub use self::decoder::Decoder;
pub use self::encoder::{encode, Values};
pub use self::judge::Event;
pub use self::sender::Sender;
