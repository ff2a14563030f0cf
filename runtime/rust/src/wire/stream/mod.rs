//! Messages with header and trailer, in a stream of bytes or in packets.

mod check;
mod decoder;
mod encoder;
mod field;
mod judge;
mod respond;
mod sender;

pub use self::decoder::Decoder;
pub use self::encoder::{encode, encode_packet, encode_request, Values};
pub use self::judge::Event;
pub use self::respond::Answer;
pub use self::sender::Sender;
pub use super::client::framed::Line;

pub(super) use self::encoder::Header;
