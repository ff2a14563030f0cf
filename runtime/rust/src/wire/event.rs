//! Events of a client.

use super::link::Reason;
use super::message::octet;
use super::TelemetryOf;
use core::fmt;
use core::marker::PhantomData;
use core::ops::Deref;

/// An event of a client. Each request ends with exactly one of `Done`, `Sent`, `Refused` and
/// `Timeout`, unless it is cancelled. A telecommand without acknowledge that is sent at once is
/// reported as [`Started::Sent`](super::Started::Sent) instead.
///
/// ```
/// use icdgen_runtime::wire::Event;
///
/// let event = Event::Timeout { id: 146, attempts: 3 };
/// assert!(matches!(event, Event::Timeout { id: 146, .. }));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Event<'a> {
    /// The request succeeded.
    Done {
        /// The id.
        id: u8,
        /// Number of times the request was sent.
        attempts: u16,
        /// The telemetry frame; empty for a telecommand.
        data: &'a [u8],
    },
    /// The telecommand was sent, and nothing responds to it.
    Sent {
        /// The id.
        id: u8,
        /// Number of times the request was sent.
        attempts: u16,
    },
    /// The node rejected the request (negative acknowledge).
    Refused {
        /// The id.
        id: u8,
        /// Number of times the request was sent.
        attempts: u16,
        /// The error code; CAN has none.
        code: Option<u32>,
        /// Meaning of the code in the ICD.
        reason: Option<Reason>,
        /// Index of the invalid parameter; only I2C reports it.
        parameter: Option<u32>,
    },
    /// The node did not reply in time.
    Timeout {
        /// The id.
        id: u8,
        /// Number of times the request was sent.
        attempts: u16,
    },
    /// CAN: an invalid packet of this message.
    Malformed {
        /// The id.
        id: u32,
    },
    /// Telemetry of the wrong length; the request continues.
    Length {
        /// The id.
        id: u32,
    },
    /// A frame with a wrong checksum; the request continues.
    Checksum {
        /// The id.
        id: u32,
    },
    /// A frame without the required checksum; the request continues.
    Unchecked {
        /// The id.
        id: u32,
    },
    /// Telemetry that the node sends without a request, such as a packet of a file.
    Arrived {
        /// Id of the telemetry.
        id: u32,
        /// Its data.
        data: &'a [u8],
    },
    /// An unsolicited log message.
    Log {
        /// The message; starts with its id.
        message: &'a [u8],
    },
    /// A response to a request that has ended. I2C: the result of a transaction that came too late.
    Late {
        /// Id of the response; I2C: of the transaction.
        id: u32,
        /// Its data; I2C: empty if nothing was read.
        data: &'a [u8],
    },
    /// A response without a request.
    Stray {
        /// Id of the response. I2C: None, and the bytes are of no transaction.
        id: Option<u32>,
        /// Its data.
        data: &'a [u8],
    },
    /// UART: a message started before the previous one ended, which is dropped.
    UnexpectedStart,
    /// UART: invalid byte after the escape byte.
    ProtocolError,
    /// UART: a message is longer than the buffer.
    Overrun,
    /// UART: an empty message, without an id.
    Empty,
    /// CAN: a packet was received twice.
    Duplicate {
        /// The id.
        id: u32,
    },
    /// CAN: a message is discarded because packets are missing.
    Incomplete {
        /// The id.
        id: u32,
    },
    /// CAN: no free slot for another message; the packet is dropped.
    Busy {
        /// The id.
        id: u32,
    },
    /// CAN: the ICD has no such message type.
    UnknownType {
        /// The id.
        id: u32,
    },
}

/// An event of a client of node `T`. It dereferences to [`Event`].
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct NodeEvent<'a, T> {
    event: Event<'a>,
    node: PhantomData<fn() -> T>,
}

impl<'a, T> NodeEvent<'a, T> {
    pub(super) const fn new(event: Event<'a>) -> Self {
        let node = PhantomData;
        Self { event, node }
    }

    /// Return the requested or unsolicited message; None if the event contains no message `M`.
    #[must_use]
    pub fn message<M: TelemetryOf<T>>(&self) -> Option<M> {
        match self.event {
            Event::Done { id, data, .. } if id == octet(M::TELEMETRY_ID) => M::read(data).ok(),
            Event::Arrived { id, data } if id == M::TELEMETRY_ID => M::read(data).ok(),
            _ => None,
        }
    }
}

impl<'a, T> Deref for NodeEvent<'a, T> {
    type Target = Event<'a>;

    #[inline]
    fn deref(&self) -> &Event<'a> {
        &self.event
    }
}

impl<T> fmt::Debug for NodeEvent<'_, T> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.event.fmt(out)
    }
}
