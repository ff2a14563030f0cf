//! What can be asked of a node.

/// What kind of request it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Something is sent and acknowledged.
    Telecommand,
    /// A frame is asked for.
    Telemetry,
}

/// A request. Times and lengths are looked up by its id.
///
/// ```
/// use icdgen_runtime::wire::{Direction, Request};
///
/// let request = Request { repeat: true, ..Request::telecommand(13, &[3, 0, 0]) };
/// assert_eq!((request.direction, request.data.len()), (Direction::Telecommand, 3));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request<'a> {
    /// What kind of request it is.
    pub direction: Direction,
    /// The id of the message.
    pub id: u8,
    /// The data of a telecommand.
    pub data: &'a [u8],
    /// Whether it may be sent again although it may have arrived; telemetry and configuration always
    /// may.
    pub repeat: bool,
}

impl<'a> Request<'a> {
    /// A frame is asked for.
    #[must_use]
    pub const fn telemetry(id: u8) -> Self {
        Self {
            direction: Direction::Telemetry,
            id,
            data: &[],
            repeat: true,
        }
    }

    /// A telecommand, which is sent again only if it did not arrive for certain.
    #[must_use]
    pub const fn telecommand(id: u8, data: &'a [u8]) -> Self {
        Self {
            direction: Direction::Telecommand,
            id,
            data,
            repeat: false,
        }
    }
}

/// How a request began.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Started {
    /// An event will tell how it ended.
    Waiting,
    /// It is over: nothing will answer. It counts as done, in one attempt.
    Done,
}
