"""What a client tells. Every request ends in one of `Done`, `Refused` and `Timeout`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional, Union

from .._base import Message
from .logs import LogMessage

MessageClass = type[Message]


@dataclass(frozen=True)
class Done:
    """A request was executed: a telecommand, or telemetry with the frame in ``data``."""

    id: int
    attempts: int
    data: bytes = b""
    type: Optional[MessageClass] = None

    @property
    def message(self) -> Optional[Message]:
        """The frame as a message; None for a telecommand."""
        return self.type.from_bytes(self.data) if self.type else None


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
    """A request had no reply."""

    id: int
    attempts: int


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
    """What the UART decoder or the CAN joiner found wrong; on CAN, with the id."""

    error: str
    id: Optional[int] = None


Outcome = Union[Done, Refused, Timeout]
Event = Union[Done, Refused, Timeout, Malformed, Packet, Log, Stray, LineError]
