//! Requests for messages with header and trailer.

use crate::wire::Direction;

/// A request for messages with header and trailer. As [`crate::wire::Request`], with ids of up to
/// 32 bits.
///
/// ```
/// use icdgen_runtime::wire::stream::Request;
///
/// let request = Request { reply: Some(0x0121), ..Request::telecommand(0x0106, &[1, 2]) };
/// assert_eq!((request.data.len(), request.repeat), (2, false));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request<'a> {
    /// Kind of the request.
    pub direction: Direction,
    /// The id of the message.
    pub id: u32,
    /// The data of a telecommand.
    pub data: &'a [u8],
    /// Whether the client may send it again if the node may already have received it. Telemetry
    /// requests are always repeated.
    pub repeat: bool,
    /// Id of the telemetry that replies to a telecommand; None: the reply of the ICD.
    pub reply: Option<u32>,
}

impl<'a> Request<'a> {
    /// Request telemetry by the telecommand that it replies to.
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

    /// Create a telecommand that is sent once and has the reply of the ICD.
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
