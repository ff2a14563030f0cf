//! File transfer: procedures over a client, hole maps, and the entries of the index file.
//!
//! A [`Procedure`] returns the next request and processes its outcome.
//!
//! A negative acknowledge with a code that the ICD does not have is treated as damaged: a request
//! that may be repeated is sent again, as often as the client would.

mod download;
mod erase;
mod hole_map;
mod index;
mod list;
mod poll;
mod procedure;
mod program;
mod upload;

pub use self::download::Download;
pub use self::erase::{Erase, Format};
pub use self::hole_map::HoleMap;
pub use self::index::{IndexEntries, IndexEntry};
pub use self::list::{Entry, List};
pub use self::procedure::{End, Procedure};
pub use self::program::{ProgramCopy, ProgramInformation};
pub use self::upload::Upload;
