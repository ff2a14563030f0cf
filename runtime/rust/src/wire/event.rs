//! What a client tells.

use super::link::Reason;
use super::message::octet;
use super::TelemetryOf;
use core::fmt;
use core::marker::PhantomData;
use core::ops::Deref;

/// What came, or what became of the request. Each request ends in exactly one of the first three.
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
    /// The request is done.
    Done {
        /// The id.
        id: u8,
        /// How often it was sent.
        attempts: u16,
        /// The frame.
        data: &'a [u8],
    },
    /// The node refused the request.
    Refused {
        /// The id.
        id: u8,
        /// How often it was sent.
        attempts: u16,
        /// The error code; CAN has none.
        code: Option<u32>,
        /// What the ICD says of the code.
        reason: Option<Reason>,
        /// The parameter that is wrong; only I2C tells.
        parameter: Option<u32>,
    },
    /// The node did not answer.
    Timeout {
        /// The id.
        id: u8,
        /// How often it was sent.
        attempts: u16,
    },
    /// A reply or a packet that cannot be right.
    Malformed {
        /// The id.
        id: u32,
    },
    /// The checksum of a frame is wrong; it is waited on.
    Checksum {
        /// The id.
        id: u32,
    },
    /// A frame has no checksum, though it must; it is waited on.
    Unchecked {
        /// The id.
        id: u32,
    },
    /// A packet of a file.
    Packet {
        /// Its number.
        number: u32,
        /// What it holds.
        data: &'a [u8],
    },
    /// An unsolicited log, with its id.
    Log {
        /// The message.
        message: &'a [u8],
    },
    /// What nobody waits for, such as a late acknowledge.
    Stray {
        /// Its id, where the bus tells it.
        id: Option<u32>,
        /// Its data.
        data: &'a [u8],
    },
    /// UART: a message began within another one, which is dropped.
    UnexpectedStart,
    /// UART: the escape byte before a byte that has no meaning there.
    ProtocolError,
    /// UART: a message longer than the buffer.
    Overrun,
    /// UART: a message without an id.
    Empty,
    /// CAN: a packet that was there already.
    Duplicate {
        /// The id.
        id: u32,
    },
    /// CAN: a message that was given up for want of packets.
    Incomplete {
        /// The id.
        id: u32,
    },
    /// CAN: more messages at once than there is room for.
    Busy {
        /// The id.
        id: u32,
    },
    /// CAN: a message type that the ICD does not have.
    UnknownType {
        /// The id.
        id: u32,
    },
}

/// An event of a client of node `T`; it is used as an [`Event`].
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

    /// The frame as the message that was requested; None if the event is not that it came.
    #[must_use]
    pub fn message<M: TelemetryOf<T>>(&self) -> Option<M> {
        match self.event {
            Event::Done { id, data, .. } if id == octet(M::TELEMETRY_ID) => M::read(data).ok(),
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
