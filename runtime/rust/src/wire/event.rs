//! Events of a client.

use super::stream::Values;
use super::{Direction, Refusals, TelemetryOf};
use core::fmt;
use core::marker::PhantomData;
use core::ops::Deref;

/// An event of a client. Each request ends with exactly one of `Done`, `Sent`, `Refused`, `Busy` and
/// `Timeout`, unless it is cancelled.
///
/// A response that is a packet without a message has an index, `packet`. On framed links it is the
/// index of its format in `Stream::packets` of the link, and the data are the whole packet. On UART
/// and CAN it is [`ACKNOWLEDGE`](super::ACKNOWLEDGE), [`REFUSAL`](super::REFUSAL),
/// [`REQUEST_REFUSAL`](super::REQUEST_REFUSAL), or [`OTHER`](super::OTHER) for any other message
/// that is not telemetry of the device; the data are the bytes behind the id.
///
/// ```
/// use icdgen_runtime::wire::{Direction, Event};
///
/// let direction = Direction::Telemetry;
/// let event = Event::Timeout { direction, id: 146, attempts: 3 };
/// assert!(matches!(event, Event::Timeout { id: 146, .. }));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Event<'a> {
    /// The device executed the request.
    Done {
        /// Direction of the request.
        direction: Direction,
        /// Id of the request.
        id: u32,
        /// Number of times the request was sent.
        attempts: u16,
        /// Id of the response that completed it; 0 for a packet without id.
        reply: u32,
        /// Index of the format of a response that is a packet without a message.
        packet: Option<usize>,
        /// Data of the response; the whole packet if it has no message.
        data: &'a [u8],
        /// Values of the header and trailer fields of the response.
        values: &'a Values,
    },
    /// The telecommand was sent, and nothing responds to it.
    Sent {
        /// Direction of the request.
        direction: Direction,
        /// Id of the request.
        id: u32,
        /// Number of times the request was sent.
        attempts: u16,
    },
    /// The device refused the request.
    Refused {
        /// Direction of the request.
        direction: Direction,
        /// Id of the request.
        id: u32,
        /// Number of times the request was sent.
        attempts: u16,
        /// The reason, if the response has one; see [`NodeEvent::reason`].
        code: Option<u32>,
        /// UART and I2C: whether the enumeration of the codes does not have the code.
        may_be_damaged: bool,
        /// Number that says more: on I2C the index of the invalid parameter.
        detail: Option<u32>,
        /// Id of the response; 0 for a packet without id.
        reply: u32,
        /// Index of the format of a response that is a packet without a message.
        packet: Option<usize>,
        /// Data of the response; the whole packet if it has no message.
        data: &'a [u8],
    },
    /// The device was busy each time, so the request was not executed.
    Busy {
        /// Direction of the request.
        direction: Direction,
        /// Id of the request.
        id: u32,
        /// Number of times the request was sent.
        attempts: u16,
        /// The reason, if the response has one.
        code: Option<u32>,
        /// Id of the response; 0 for a packet without id.
        reply: u32,
        /// Index of the format of a response that is a packet without a message.
        packet: Option<usize>,
        /// Data of the response; the whole packet if it has no message.
        data: &'a [u8],
    },
    /// No response in time, so it is not known whether the request was executed.
    Timeout {
        /// Direction of the request.
        direction: Direction,
        /// Id of the request.
        id: u32,
        /// Number of times the request was sent.
        attempts: u16,
    },
    /// A response that does not end the request: the device is still executing it, is busy,
    /// or has accepted it and its reply is still missing.
    Progress {
        /// Direction of the request.
        direction: Direction,
        /// Id of the request.
        id: u32,
        /// Id of the response; 0 for a packet without id.
        reply: u32,
        /// Index of the format of a response that is a packet without a message.
        packet: Option<usize>,
        /// Data of the response; the whole packet if it has no message.
        data: &'a [u8],
    },
    /// The requested telemetry, before the acknowledge of its request.
    Reply {
        /// Direction of the request.
        direction: Direction,
        /// Id of the request.
        id: u32,
        /// Id of the telemetry.
        reply: u32,
        /// Data of the telemetry.
        data: &'a [u8],
        /// Values of the header and trailer fields of the telemetry.
        values: &'a Values,
    },
    /// Telemetry that the device sends without a request.
    Arrived {
        /// Id of the telemetry.
        id: u32,
        /// Its data.
        data: &'a [u8],
        /// Values of the header and trailer fields of the telemetry.
        values: &'a Values,
    },
    /// UART: an unsolicited log message.
    Log {
        /// The message; starts with its id.
        message: &'a [u8],
    },
    /// A response to a request that has ended. I2C: the result of a transaction that came too late.
    Late {
        /// Id of the response; 0 for a packet without id. I2C: of the transaction.
        id: u32,
        /// Index of the format of a response that is a packet without a message.
        packet: Option<usize>,
        /// Data of the response; the whole packet if it has no message. I2C: empty if nothing
        /// was read.
        data: &'a [u8],
    },
    /// A response to none of the requests.
    Stray {
        /// Id of the response; 0 for a packet without id. I2C: None, and the bytes are of no
        /// transaction.
        id: Option<u32>,
        /// Index of the format of a response that is a packet without a message.
        packet: Option<usize>,
        /// Data of the response; the whole packet if it has no message.
        data: &'a [u8],
    },
    /// Framed links: messages were lost before this one; 0: this message is a repetition.
    Gap {
        /// Id of the received message; 0 if the packet has none.
        id: u32,
        /// Number of missing messages.
        missing: u32,
    },
    /// Wrong checksum; the request continues.
    Checksum {
        /// Id in the message.
        id: u32,
    },
    /// Telemetry without the required checksum; the request continues.
    Unchecked {
        /// The id.
        id: u32,
    },
    /// Dropped: wrong length of the message; the request continues.
    Length {
        /// Id, if it could be read.
        id: Option<u32>,
    },
    /// Framed links: the node has no such message.
    UnknownId {
        /// The id.
        id: u32,
    },
    /// Dropped: the message is longer than the buffer.
    Overrun,
    /// Framed links: dropped because of a wrong constant or delimiter.
    Framing,
    /// UART: a message started before the previous one ended, which is dropped.
    UnexpectedStart,
    /// UART: invalid byte after the escape byte.
    ProtocolError,
    /// UART: an empty message, without an id.
    Empty,
    /// CAN: an invalid packet of this message.
    Malformed {
        /// The id.
        id: u32,
    },
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
    Dropped {
        /// The id.
        id: u32,
    },
    /// CAN: the ICD has no such message type.
    UnknownType {
        /// The id.
        id: u32,
    },
}

impl<'a> Event<'a> {
    /// Return direction and id of the request that the event is about.
    pub(super) const fn request(&self) -> Option<(Direction, u32)> {
        match *self {
            Self::Done { direction, id, .. }
            | Self::Sent { direction, id, .. }
            | Self::Refused { direction, id, .. }
            | Self::Busy { direction, id, .. }
            | Self::Timeout { direction, id, .. }
            | Self::Progress { direction, id, .. }
            | Self::Reply { direction, id, .. } => Some((direction, id)),
            _ => None,
        }
    }

    /// Return id and data of the telemetry that the event is about.
    const fn telemetry(&self) -> Option<(u32, &'a [u8])> {
        match *self {
            Self::Arrived { id, data, .. }
            | Self::Late {
                id,
                packet: None,
                data,
            }
            | Self::Stray {
                id: Some(id),
                packet: None,
                data,
            } => Some((id, data)),
            Self::Done {
                reply,
                packet: None,
                data,
                ..
            }
            | Self::Refused {
                reply,
                packet: None,
                data,
                ..
            }
            | Self::Busy {
                reply,
                packet: None,
                data,
                ..
            }
            | Self::Progress {
                reply,
                packet: None,
                data,
                ..
            }
            | Self::Reply { reply, data, .. } => Some((reply, data)),
            _ => None,
        }
    }
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

    /// Return the telemetry `M`: unsolicited, a reply or any other response; None if the event
    /// contains no such message.
    #[must_use]
    pub fn message<M: TelemetryOf<T>>(&self) -> Option<M> {
        match self.event.telemetry() {
            Some((id, data)) if id == M::TELEMETRY_ID => M::read(data).ok(),
            _ => None,
        }
    }
}

impl<T: Refusals> NodeEvent<'_, T> {
    /// Return why the device refused a request or was busy; None for other events, and if the
    /// response has no reason.
    #[must_use]
    pub fn reason(&self) -> Option<T::Reason> {
        match self.event {
            Event::Refused { code, .. } | Event::Busy { code, .. } => code.map(T::reason),
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
