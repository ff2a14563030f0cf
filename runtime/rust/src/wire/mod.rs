//! How messages travel: UART, I2C, CAN, checksums, a client, file transfer and logs.
//!
//! Nothing here opens a port, sleeps or looks at a clock: bytes go in, bytes and events come out, the
//! time is passed in, in milliseconds that may wrap. Nothing allocates or panics. What differs from node
//! to node is in its [`Link`], the `LINK` of the node's module, which also tells a client whose messages
//! it takes: those of another node do not compile.
//!
//! With the feature `std` there is also a `Session`, for programs that may wait: a client over any port
//! that reads and writes, and a `stream::Session` over envelopes. With `embedded-io` and `embedded-hal`
//! clients have a `poll` and a `poll_i2c` over the ports of embedded programs.

mod bits;
pub mod can;
mod client;
mod crc;
mod error;
mod event;
pub mod files;
pub mod i2c;
mod identity;
pub mod link;
pub(crate) mod links;
pub mod log;
mod message;
#[cfg(feature = "embedded-io")]
mod port;
mod request;
#[cfg(feature = "std")]
pub mod session;
pub mod stream;
mod time;
pub mod uart;

pub use self::client::{Client, Transaction};
pub use self::crc::{crc16, crc8, Crc, Table};
pub use self::error::Error;
pub use self::event::{Event, NodeEvent};
pub use self::identity::{identify, Identity};
pub use self::link::{Bus, Link, Reason, Settings};
pub use self::message::{Linked, NodeLink, TelecommandOf, TelemetryOf};
#[cfg(feature = "embedded-io")]
pub use self::port::PortError;
pub use self::request::{Direction, Request, Started};
#[cfg(feature = "std")]
pub use self::session::{Failure, Session};
pub use self::time::DosTime;
