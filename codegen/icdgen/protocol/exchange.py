"""Exchanges on a link: the telemetry that responds to a telecommand, and what
each response means.

All languages match responses by numbers in fixed bytes, so that a client need not
decode messages. `icdgen.protocol.responding` creates the exchanges from the ICD.
"""

from __future__ import annotations

from icdgen.frozen import dataclass
from icdgen.icd.enumeration import Enum
from icdgen.icd.responses import REPLY


@dataclass(frozen=True, slots=True)
class NumberPlace:
    """Place of a number of up to 32 bits.

    The ``size`` bytes at byte ``at`` form a number, which is shifted right by ``shift``
    and masked to ``bits``. Bytes that a message does not have are 0.
    """

    at: int
    size: int
    shift: int
    bits: int
    little: bool


@dataclass(frozen=True, slots=True)
class Echo:
    """Number of a response that repeats a number of the telecommand.

    ``source`` is an index of `Exchange.sources`.
    """

    place: NumberPlace
    source: int


@dataclass(frozen=True, slots=True)
class Response:
    """Telemetry or packet that can end, refuse, defer or prolong a telecommand."""

    telemetry: int | None  # id; None: the requested telemetry, or a packet
    # Meaning; with `status`, the meaning of a status that `meanings` does not list
    verdict: str  # one of `icdgen.icd.responses.KINDS`, or `AGAIN`
    echoes: tuple[Echo, ...]  # all must be equal to the telecommand
    status: NumberPlace | None
    meanings: tuple[tuple[int, str], ...]  # verdict of each listed status
    reason: NumberPlace | None
    reasons: tuple[tuple[int, str], ...]  # values of the reason and their names
    # Index of a packet without a message, whose places count from the first byte of the
    # header; None: telemetry
    packet: int | None = None
    enum: Enum | None = None  # of the reason
    detail: NumberPlace | None = None  # number that says more about a refusal

    @property
    def is_reply(self) -> bool:
        """Whether it can be the telemetry that the telecommand requests."""
        return REPLY in (self.verdict, *(verdict for _, verdict in self.meanings))


@dataclass(frozen=True, slots=True)
class ResponsePoll:
    """Telemetry that a client requests again and again until it is the response to a
    telecommand: until it has the right echo, and the number ``until`` is not 0.
    """

    telemetry: int  # id
    until: NumberPlace


@dataclass(frozen=True, slots=True)
class Exchange:
    """Telecommand and its possible responses.

    ``sources`` are the numbers of a telecommand that responses repeat. They are places
    in its id, as 4 bytes with the most significant first, followed by its data. The
    last ``in_header`` of them are places in the header of its packet.
    """

    sources: tuple[NumberPlace, ...]
    responses: tuple[Response, ...]
    timeout: int  # time-out in milliseconds; 0: that of the client
    in_header: int = 0
    poll: ResponsePoll | None = None  # None: the response comes by itself

    def is_in_header(self, source: int) -> bool:
        """Return whether a source is a place in the header."""
        return source >= len(self.sources) - self.in_header

    @property
    def reply(self) -> int | None:
        """Id of the telemetry that the telecommand requests; None without a reply."""
        return next((row.telemetry for row in self.responses if row.is_reply), None)


@dataclass(frozen=True, slots=True)
class BusExchanges:
    """Exchanges on UART, I2C or CAN.

    ``command``: of all telecommands that are acknowledged; None if nothing responds to
    them. ``request``: of telemetry.
    """

    command: Exchange | None
    request: Exchange
