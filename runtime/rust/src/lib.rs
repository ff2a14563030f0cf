//! Runtime of generated messages. Its modules are copied into every generated crate.

#![no_std]
#![forbid(unsafe_code)]
#![warn(missing_docs)]
// What clippy's pedantic lints would have otherwise, and why it is so:
#![allow(
    // a user sees most names without the module's, which re-exports them (pedantic until Rust 1.85);
    clippy::module_name_repetitions,
    // `put` puts into `out`;
    clippy::similar_names,
    // a state says what it does, whatever others do;
    clippy::match_same_arms,
    // flags of a client are not states of a machine;
    clippy::struct_excessive_bools,
    // without an allocator a large variant cannot be boxed;
    clippy::large_enum_variant,
    // functions that only name some bytes must vanish when optimising for size, too.
    clippy::inline_always
)]

#[cfg(feature = "std")]
extern crate std;

mod support;
pub mod wire;

pub use support::is_special;
pub use support::{Coded, Enumeration, Error, Field, Message, Telecommand, Telemetry};
