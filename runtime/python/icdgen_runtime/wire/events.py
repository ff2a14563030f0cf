"""Events of a client.

Every request ends with one of `Done`, `Sent`, `Refused`, `Busy` and `Timeout`; before
it, there may be `Progress` and `Reply`. `Arrived`, `Log`, `Late`, `Stray`, `Lost` and
`Gap` come without a waiting request. `LineError` is an error that a decoder detected.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Generic, Optional, TypeVar, Union, cast

from .._base import Message
from .logs import LogMessage

MessageClass = type[Message]
M = TypeVar("M", bound=Message)
MessageClassOf = type[M]
R_co = TypeVar("R_co", bound=Optional[Message], covariant=True)


@dataclass(frozen=True)
class Done(Generic[R_co]):
    """A request was executed.

    ``data`` is the frame of requested telemetry, or the data of the acknowledge.
    ``Done[EstimatedAttitudeAngles]`` has a message of this class, ``Done[None]`` has
    none. ``reply``: id of the telemetry that responded. ``handle`` identifies the
    request: `Client.begun` after it began.
    """

    id: int
    attempts: int
    data: bytes = b""
    type: Optional[MessageClass] = None
    reply: Optional[int] = None
    handle: int = field(default=0, compare=False, repr=False)

    @property
    def message(self) -> R_co:
        """The frame as a message; None for a telecommand."""
        message = self.type.from_bytes(self.data) if self.type else None
        return cast(R_co, message)

    def of(self, message: MessageClassOf[M]) -> Optional[M]:
        """Return the message if it has this class, otherwise None."""
        own: Optional[Message] = self.message
        return own if isinstance(own, message) else None


@dataclass(frozen=True)
class Refused:
    """The node rejected a request.

    ``reason`` is the name of the code in its enumeration. CAN has no code. Only I2C
    reports the parameter. ``data`` is the data of the response, ``type`` its class if
    it is a message. ``may_be_damaged``: on UART and I2C, whether the enumeration does
    not have the code.
    """

    id: int
    attempts: int
    code: Optional[int] = None
    reason: Optional[str] = None
    parameter: Optional[int] = None
    data: bytes = field(default=b"", repr=False)
    type: Optional[MessageClass] = field(default=None, repr=False)
    handle: int = field(default=0, compare=False, repr=False)
    may_be_damaged: bool = field(default=False, compare=False, repr=False)

    @property
    def message(self) -> Optional[Message]:
        """The response on a framed link; None on other links."""
        return self.type.from_bytes(self.data) if self.type else None


@dataclass(frozen=True)
class Timeout:
    """A request had no response, so it is not known whether it was executed."""

    id: int
    attempts: int
    handle: int = field(default=0, compare=False, repr=False)


@dataclass(frozen=True)
class Sent:
    """A telecommand without a response was sent."""

    id: int
    attempts: int = 1
    handle: int = field(default=0, compare=False, repr=False)


@dataclass(frozen=True)
class Busy:
    """The device was busy at the last attempt.

    If an earlier attempt had no response, it may have been executed. ``code`` and
    ``reason``: see `Refused`.
    """

    id: int
    attempts: int
    code: Optional[int] = None
    reason: Optional[str] = None
    handle: int = field(default=0, compare=False, repr=False)


@dataclass(frozen=True)
class Progress:
    """The device reports that it is still executing a request."""

    id: int
    data: bytes
    type: Optional[MessageClass] = None
    handle: int = field(default=0, compare=False, repr=False)


@dataclass(frozen=True)
class Reply:
    """The requested telemetry arrived before the acknowledge of its request.

    ``reply`` is the id of the telemetry.
    """

    id: int
    data: bytes
    type: Optional[MessageClass]
    reply: int
    handle: int = field(default=0, compare=False, repr=False)


@dataclass(frozen=True)
class Late:
    """A response to a request that has ended.

    ``id`` is the id of the response, ``data`` its data without the id; ``type`` is the
    class of telemetry. On I2C, the result of a transaction that came too late: ``data``
    is empty if nothing was read.
    """

    id: int
    data: bytes
    type: Optional[MessageClass] = None


@dataclass(frozen=True)
class Log:
    """The node sent an unsolicited log. ``data`` is the message with its id."""

    data: bytes
    log: LogMessage


@dataclass(frozen=True)
class Stray:
    """A response that no request can have caused.

    On I2C, ``data`` are bytes that no transaction has read, and there is no ``id``.
    """

    data: bytes
    id: Optional[int] = None
    type: Optional[MessageClass] = None


@dataclass(frozen=True)
class LineError:
    """An error that a decoder or the CAN joiner detected.

    ``id`` is the id of the message, if it is known. ``length``: the length of telemetry
    is wrong. ``checksum``: the checksum of a frame is wrong. ``unchecked``: a required
    checksum is missing. After these, the client still waits for the frame. For the other
    errors see `StreamEvent`, `UartEvent` and `CanEvent`.
    """

    error: str
    id: Optional[int] = None


@dataclass(frozen=True)
class Arrived:
    """Unsolicited telemetry, with the values of the frame fields that its sender chose."""

    id: int
    data: bytes
    values: Mapping[str, int]
    type: Optional[MessageClass] = None

    @property
    def message(self) -> Optional[Message]:
        """The message; None if no message of its id matches the data."""
        return self.type.from_bytes(self.data) if self.type else None

    def of(self, message: MessageClassOf[M]) -> Optional[M]:
        """Return the message if it has this class, otherwise None."""
        return message.from_bytes(self.data) if self.type is message else None


@dataclass(frozen=True)
class Lost:
    """`AsyncSession.messages` discarded ``count`` messages, the oldest first, because the
    program did not take them in time.
    """

    count: int


@dataclass(frozen=True)
class Gap:
    """``missing`` messages were lost before the next one; 0 if a message was repeated."""

    id: Optional[int]
    missing: int


AnyDone = Done[Optional[Message]]
Outcome = Union[AnyDone, Sent, Refused, Busy, Timeout]
OutcomeOf = Union[Done[R_co], Sent, Refused, Busy, Timeout]
OUTCOMES = (Done, Sent, Refused, Busy, Timeout)
Event = Union[
    Outcome,
    Progress,
    Reply,
    Late,
    Log,
    Stray,
    LineError,
    Arrived,
    Gap,
    Lost,
]
