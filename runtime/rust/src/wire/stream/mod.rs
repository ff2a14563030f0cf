//! Messages with header and trailer, in a stream of bytes or in packets.

mod awaited;
mod check;
mod client;
mod decoder;
mod encoder;
mod field;
mod judge;
mod request;
mod sender;
#[cfg(feature = "std")]
mod session;
mod slots;

pub use self::client::{Client, NodeEvent};
pub use self::decoder::Decoder;
pub use self::encoder::{encode, encode_packet, encode_request, Values};
pub use self::judge::Event;
pub use self::request::Request;
pub use self::sender::Sender;
#[cfg(feature = "std")]
pub use self::session::Session;
#[cfg(feature = "std")]
pub use super::session::Outcome;
