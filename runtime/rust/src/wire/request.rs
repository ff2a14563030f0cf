//! Requests to a node.

/// Kind of the request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
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
    pub id: u32,
    /// The data of a telecommand.
    pub data: &'a [u8],
    /// Whether the client may send it again if the node may already have received it. Telemetry and
    /// configuration requests are always repeated.
    pub repeat: bool,
    /// Framed links: id of the telemetry that replies to a telecommand; None: the reply of the ICD.
    pub reply: Option<u32>,
}

impl<'a> Request<'a> {
    /// Request telemetry. On a framed link, a telecommand or packet requests it.
    #[must_use]
    pub const fn telemetry(id: u32) -> Self {
        Self {
            direction: Direction::Telemetry,
            id,
            data: &[],
            repeat: true,
            reply: None,
        }
    }

    /// Create a telecommand that has the responses of the ICD. It is sent again only if the node
    /// certainly did not receive it.
    #[must_use]
    pub const fn telecommand(id: u32, data: &'a [u8]) -> Self {
        Self {
            direction: Direction::Telecommand,
            id,
            data,
            repeat: false,
            reply: None,
        }
    }
}
