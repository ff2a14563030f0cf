//! The index file.

mod index;

pub use self::index::{IndexEntries, IndexEntry};
