"""What a client tells. Every request ends in one of `Done`, `Refused` and `Timeout`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Generic, Optional, TypeVar, Union, cast

from .._base import Message
from .logs import LogMessage

MessageClass = type[Message]
M = TypeVar("M", bound=Message)
MessageClassOf = type[M]
R_co = TypeVar("R_co", bound=Optional[Message], covariant=True)


@dataclass(frozen=True)
class Done(Generic[R_co]):
    """A request was executed: a telecommand, or telemetry with the frame in ``data``.

    ``Done[EstimatedAttitudeAngles]`` has such a message, ``Done[None]`` none. ``reply``: in
    envelopes, the id of the telemetry that answered.
    """

    id: int
    attempts: int
    data: bytes = b""
    type: Optional[MessageClass] = None
    reply: Optional[int] = None

    @property
    def message(self) -> R_co:
        """The frame as a message; None for a telecommand."""
        found = self.type.from_bytes(self.data) if self.type else None
        return cast(R_co, found)

    def of(self, message: MessageClassOf[M]) -> Optional[M]:
        """The message, if it is one of these."""
        found: Optional[Message] = self.message
        return found if isinstance(found, message) else None


@dataclass(frozen=True)
class Refused:
    """The node refused a request.

    ``reason`` is the role that the ICD gives the code: ``unknown_id``, ``length``,
    ``parameter`` or ``checksum``. CAN has no code, and only I2C tells which parameter.
    """

    id: int
    attempts: int
    code: Optional[int] = None
    reason: Optional[str] = None
    parameter: Optional[int] = None


@dataclass(frozen=True)
class Timeout:
    """A request had no reply; in envelopes, ``reply`` is the id of what was waited for."""

    id: int
    attempts: int
    reply: Optional[int] = None


@dataclass(frozen=True)
class Malformed:
    """A reply has not the length of the message; it is waited on."""

    id: int


@dataclass(frozen=True)
class Packet:
    """A packet of a download came."""

    number: int
    data: bytes


@dataclass(frozen=True)
class Log:
    """The node sent a log of its own accord; ``data`` is the message with its id."""

    data: bytes
    log: LogMessage


@dataclass(frozen=True)
class Stray:
    """A message that nobody waits for, with its id; on I2C, what was read."""

    data: bytes


@dataclass(frozen=True)
class LineError:
    """What a decoder or the CAN joiner found wrong; on CAN and in envelopes, with the id.

    ``checksum``: that of a frame is wrong; ``unchecked``: it has none, though it must. With
    the id; the frame is waited on. In envelopes, `StreamEvent` has the others.
    """

    error: str
    id: Optional[int] = None


@dataclass(frozen=True)
class Arrived:
    """Telemetry that came unasked in an envelope, with what its sender chose of that."""

    id: int
    data: bytes
    values: Mapping[str, int]
    type: Optional[MessageClass] = None

    @property
    def message(self) -> Optional[Message]:
        """The message; None if it is none of those that share its id."""
        return self.type.from_bytes(self.data) if self.type else None

    def of(self, message: MessageClassOf[M]) -> Optional[M]:
        """The message, if it is one of these."""
        return message.from_bytes(self.data) if self.type is message else None


@dataclass(frozen=True)
class Gap:
    """In envelopes: ``missing`` messages did not come before the next; none: one came again."""

    id: Optional[int]
    missing: int


AnyDone = Done[Optional[Message]]
Outcome = Union[AnyDone, Refused, Timeout]
OutcomeOf = Union[Done[R_co], Refused, Timeout]
Event = Union[Outcome, Malformed, Packet, Log, Stray, LineError, Arrived, Gap]
