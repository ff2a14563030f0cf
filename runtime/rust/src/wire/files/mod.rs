//! File transfer: procedures over a client, hole maps, and the entries of the index file.
//!
//! A [`Procedure`] says which request comes next and is told what became of it.
//!
//! A refusal with a code that the ICD does not have is taken for a damaged acknowledge, which tells
//! nothing: what may be repeated is asked again, as often as the client would.

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
