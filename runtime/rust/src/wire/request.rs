//! Requests to a node.

/// Kind of the request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Direction {
    /// A telecommand is sent.
    Telecommand,
    /// Telemetry is requested.
    Telemetry,
}

/// A request to a node.
///
/// ```
/// use icdgen_runtime::wire::{Direction, Request};
///
/// let request = Request { repeat: true, ..Request::telecommand(13, &[3, 0, 0]) };
/// assert_eq!((request.direction, request.data.len()), (Direction::Telecommand, 3));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request<'a> {
    /// Kind of the request.
    pub direction: Direction,
    /// The id of the message.
    pub id: u8,
    /// The data of a telecommand.
    pub data: &'a [u8],
    /// Whether the client may send it again if the node may already have received it. Telemetry and
    /// configuration requests are always repeated.
    pub repeat: bool,
}

impl<'a> Request<'a> {
    /// Telemetry is requested.
    #[must_use]
    pub const fn telemetry(id: u8) -> Self {
        Self {
            direction: Direction::Telemetry,
            id,
            data: &[],
            repeat: true,
        }
    }

    /// Create a telecommand. It is sent again only if the node certainly did not receive it.
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

/// Result of starting a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Started {
    /// The outcome is reported by an event.
    Waiting,
    /// The request has ended, because nothing responds to it.
    Sent,
}
