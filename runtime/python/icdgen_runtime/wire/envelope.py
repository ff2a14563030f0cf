"""The envelope of a link that the ICD describes as fields with roles around the data."""

from __future__ import annotations

from typing import Literal, NamedTuple, Optional

Delimiter = Literal["length", "slip", "cobs", "hdlc", "none"]
CheckKind = Literal["crc", "fletcher", "fletcher_255", "sum", "xor"]
Direction = Literal["telecommand", "telemetry"]


class CrcForm(NamedTuple):
    """Parameters of a CRC, as catalogues give them. ``empty``: of no bytes at all."""

    width: int
    """Bits of the checksum."""
    polynomial: int
    """Generator polynomial, most significant bit first, without the leading term."""
    init: int
    """Initial value of the register."""
    reflect_in: bool
    """Whether each byte enters least significant bit first."""
    reflect_out: bool
    """Whether the bits of the register are reversed at the end."""
    xor_out: int
    """Final XOR value: combined with the register at the end."""
    empty: Optional[int] = None
    """Checksum of no bytes, if it is not the result of the algorithm."""


class EnvelopeField(NamedTuple):
    """Some bytes of the header or trailer are a number, shifted and cut to ``bits``."""

    role: str
    in_trailer: bool
    at: int
    size: int
    shift: int
    bits: int
    little: bool
    values: tuple[int, int]
    """Constant or default value: in telecommands, in telemetry."""


class CheckForm(NamedTuple):
    """A checksum; kinds other than a CRC use init, xor_out and width of the form."""

    kind: CheckKind
    crc: CrcForm
    covered_from: int
    """The byte of the header from which on it is computed."""
    covered_trailer: int
    """Bytes of the trailer that it covers."""
    is_seeded: bool
    """Whether the seed of the message is covered, as a byte after all others."""


class StreamRow(NamedTuple):
    """A message: its id, the lengths that its data can have, and its seed."""

    id: int
    least: int
    most: int
    cuts_zeros: bool
    """Whether zeros at the end of the data are not sent, but for one byte."""
    seed: int
    reply: Optional[int] = None
    """For a telecommand: the id of the telemetry that responds to it."""


class Stream(NamedTuple):
    """How messages are put into a stream of bytes, or into packets."""

    delimited_by: Delimiter
    header_bytes: int
    trailer_bytes: int
    length_plus: int
    """Number that the length field adds to the bytes of the data."""
    per_id: bool
    """Whether each id counts its own sequence."""
    fields: tuple[EnvelopeField, ...]
    telecommands: tuple[StreamRow, ...]
    telemetry: tuple[StreamRow, ...]
    check: Optional[CheckForm] = None

    def rows(self, direction: Direction) -> tuple[StreamRow, ...]:
        """The messages of a direction."""
        return self.telemetry if direction == "telemetry" else self.telecommands

    def of(self, role: str) -> Optional[EnvelopeField]:
        """The field of a role that there is at most once."""
        return next((field for field in self.fields if field.role == role), None)
