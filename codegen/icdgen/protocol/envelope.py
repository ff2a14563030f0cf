"""The envelope of a link that the ICD describes as data: a header and a trailer of fields with roles, around the data.

Everything a decoder computes with is decided here, once for all languages: a field is some bytes in an order, a shift and a width.
"""

from __future__ import annotations

from icdgen.frozen import dataclass
from icdgen.icd import checksum
from icdgen.protocol.sections import Crc

LENGTH, SLIP, COBS, HDLC, PACKET = DELIMITERS = ("length", "slip", "cobs", "hdlc", "none")
"""Delimiters of messages; `none`: the packet that carries the message."""

GIVEN = ("sequence", "source", "destination", "type", "flags", "time")
"""Roles of fields whose values the sender chooses."""

ROLES = ("constant", "id", "length", "checksum", *GIVEN)
"""Roles as code knows them: a `sync` is a constant."""

CRC, FLETCHER, FLETCHER_255, SUM, XOR = CHECKS = checksum.KINDS
DIRECTIONS = ("telecommand", "telemetry")
DATA = "data"  # in `covers`: what the envelope is around
WORD = 32  # bits of the numbers that are computed with


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class EnvelopeField:
    """A field: ``size`` bytes at byte ``at`` of the header or trailer are a number, shifted and cut to ``bits``."""

    role: str  # one of `ROLES`
    in_trailer: bool
    at: int
    size: int
    shift: int
    bits: int
    little: bool
    values: tuple[int, int]  # of a constant, or unless another is chosen: in telecommands, in telemetry

    @property
    def mask(self) -> int:
        """The greatest value."""
        return (1 << self.bits) - 1


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Check:
    """The checksum: what it is computed over, beside the data, and how. Kinds other than a CRC use init, xor_out and width."""

    kind: str  # one of `CHECKS`
    crc: Crc
    covered_from: int  # byte of the header from which on it is computed
    covered_trailer: int  # bytes of the trailer that it covers
    is_seeded: bool  # whether the seed of the message is covered, as a byte after all others


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class StreamRow:
    """A message under its id in one direction, and the lengths that its data can have."""

    id: int
    least: int
    most: int
    cuts_zeros: bool  # whether zeros at the end of the data are not sent, but for one byte
    seed: int
    reply: int | None  # id of the telemetry that a telecommand is answered with
    name: str


@dataclass(frozen=True, slots=True, eq=False, repr=False, kw_only=True)
class Stream:
    """How messages are put into a stream of bytes, or into packets."""

    delimited_by: str  # one of `DELIMITERS`
    header_bytes: int
    trailer_bytes: int
    length_plus: int  # what the field of the length has more than the data have bytes
    per_id: bool  # whether each id counts its own sequence
    fields: tuple[EnvelopeField, ...]
    check: Check | None
    telecommands: tuple[StreamRow, ...]  # by rising id
    telemetry: tuple[StreamRow, ...]

    def rows(self, direction: str) -> tuple[StreamRow, ...]:
        """The messages of a direction."""
        return self.telemetry if direction == "telemetry" else self.telecommands

    def of(self, role: str) -> EnvelopeField | None:
        """The field of a role that there is at most once."""
        return next((field for field in self.fields if field.role == role), None)

    @property
    def longest_data(self) -> int:
        """Most bytes of data."""
        return max((row.most for row in (*self.telecommands, *self.telemetry)), default=0)

    @property
    def longest_request(self) -> int:
        """Most bytes of data of a telecommand."""
        return max((row.most for row in self.telecommands), default=0)

    @property
    def longest(self) -> int:
        """Bytes of the longest message, with its envelope but without what delimits it."""
        return self.header_bytes + self.longest_data + self.trailer_bytes

    @property
    def sequences(self) -> int:
        """Numbers that a decoder remembers to notice gaps."""
        if self.of("sequence") is None:
            return 0
        return max(1, len(self.telecommands), len(self.telemetry)) if self.per_id else 1

    @property
    def longest_line(self) -> int:
        """Most bytes of a message with what delimits it."""
        if self.delimited_by in (SLIP, HDLC):
            return 2 * self.longest + 2
        return self.longest + (self.longest // 254 + 2 if self.delimited_by == COBS else 0)
