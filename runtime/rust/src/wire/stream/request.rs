//! What can be asked over an envelope.

use crate::wire::Direction;

/// A request over an envelope: as [`crate::wire::Request`], with ids of up to 32 bits.
///
/// ```
/// use icdgen_runtime::wire::stream::Request;
///
/// let request = Request { reply: Some(0x0121), ..Request::telecommand(0x0106, &[1, 2]) };
/// assert_eq!((request.data.len(), request.repeat), (2, false));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request<'a> {
    /// What kind of request it is.
    pub direction: Direction,
    /// The id of the message.
    pub id: u32,
    /// The data of a telecommand.
    pub data: &'a [u8],
    /// Whether it may be sent again although it may have arrived; telemetry always may.
    pub repeat: bool,
    /// The id of the telemetry that answers a telecommand; None: what the ICD says.
    pub reply: Option<u32>,
}

impl<'a> Request<'a> {
    /// Telemetry is asked for, by the telecommand that it answers.
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

    /// A telecommand, which is sent once and answered as the ICD says.
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
