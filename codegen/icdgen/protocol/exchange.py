"""Exchanges on a framed link: the telemetry that responds to a telecommand, and what
each response means.

All languages match responses by numbers in fixed bytes, so that a client need not
decode messages.
"""

from __future__ import annotations

from typing import Literal

from icdgen.frozen import dataclass
from icdgen.icd.responses import NEEDED, REPLY

ID_BYTES = 4  # of the id in front of the data, in `Exchange.sources`


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

    def of(self, data: bytes) -> int:
        """Return the number in a message."""
        number = self._number(data[self.at :].ljust(self.size, b"\0"))
        return number >> self.shift & (1 << self.bits) - 1

    def put(self, into: bytearray, number: int) -> None:
        """Write the lowest bits of a number into a message that has all bytes."""
        mask = (1 << self.bits) - 1 << self.shift
        kept = self._number(bytes(into[self.at :])) & ~mask
        whole = kept | number << self.shift & mask
        end = self.at + self.size
        into[self.at : end] = whole.to_bytes(self.size, self._order)

    @property
    def _order(self) -> Literal["little", "big"]:
        return "little" if self.little else "big"

    def _number(self, data: bytes) -> int:
        return int.from_bytes(data[: self.size], self._order)


@dataclass(frozen=True, slots=True)
class Echo:
    """Number of a response that repeats a number of the telecommand.

    ``source`` is an index of `Exchange.sources`.
    """

    place: NumberPlace
    source: int


@dataclass(frozen=True, slots=True)
class Response:
    """Telemetry that can end, refuse, defer or prolong a telecommand."""

    telemetry: int  # id
    # Meaning; with `status`, the meaning of a status that `meanings` does not list
    verdict: str  # one of `icdgen.icd.responses.KINDS`
    echoes: tuple[Echo, ...]  # all must be equal to the telecommand
    status: NumberPlace | None
    meanings: tuple[tuple[int, str], ...]  # verdict of each listed status
    reason: NumberPlace | None
    reasons: tuple[tuple[int, str], ...]  # values of the reason and their names


@dataclass(frozen=True, slots=True)
class Exchange:
    """Telecommand and its possible responses.

    ``sources`` are the numbers of a telecommand that responses repeat. They are places
    in its id, as 4 bytes with the most significant first, followed by its data.
    """

    sources: tuple[NumberPlace, ...]
    responses: tuple[Response, ...]
    timeout: int  # time-out in milliseconds; 0: that of the client

    @property
    def needed(self) -> frozenset[str]:
        """Verdicts that must arrive before the telecommand is done: `ACK`, `REPLY`."""
        verdicts = {response.verdict for response in self.responses}
        verdicts |= {
            verdict for response in self.responses for _, verdict in response.meanings
        }
        return frozenset(verdicts.intersection(NEEDED))

    @property
    def reply(self) -> int | None:
        """Id of the telemetry that the telecommand requests; None without a reply."""
        return next(
            (row.telemetry for row in self.responses if row.verdict == REPLY), None
        )
