//! Wire layer: transport of messages over UART, I2C and CAN, checksums, clients, procedures and
//! logs.
//!
//! The functions perform no input or output: the application passes received bytes in, and takes
//! bytes to send and events out. They do not open ports, sleep, read a clock, allocate memory or
//! panic. The application provides the current time `now` in milliseconds, which may wrap around.
//!
//! The [`Link`] of a node describes its protocol. It is the `LINK` of the module of the node. A
//! client that is created with it accepts only messages of this node at compile time.
//!
//! Feature `std` adds `Session`: a blocking client over any port that implements `Read` and `Write`.
//! Features `embedded-io` and `embedded-hal` add the methods `poll` and `poll_i2c` of clients.

mod bits;
pub mod can;
mod checksum;
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
pub mod procedure;
mod request;
#[cfg(feature = "std")]
pub mod session;
pub mod stream;
mod time;
pub mod uart;

pub use self::checksum::checksum;
pub use self::client::bus::{ACKNOWLEDGE, OTHER, REFUSAL, REQUEST_REFUSAL};
pub use self::client::{ByteLine, Client, Line};
pub use self::crc::{Crc, Table};
pub use self::error::Error;
pub use self::event::{Event, NodeEvent};
pub use self::identity::{identify, Identity};
pub use self::link::{Bus, Link, Settings};
pub use self::message::{Linked, NodeLink, Refusals, TelecommandOf, TelemetryOf};
#[cfg(feature = "embedded-io")]
pub use self::port::PortError;
pub use self::request::{Direction, Request};
#[cfg(feature = "std")]
pub use self::session::{Failure, Outcome, Session};
pub use self::time::DosTime;
