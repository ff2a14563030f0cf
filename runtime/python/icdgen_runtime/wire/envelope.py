"""Frame format that the ICD describes by header and trailer fields with roles."""

from __future__ import annotations

from typing import Literal, NamedTuple, Optional

Delimiter = Literal["length", "slip", "cobs", "hdlc", "none"]
CheckKind = Literal["crc", "fletcher", "fletcher_255", "sum", "xor"]
Direction = Literal["telecommand", "telemetry"]


class CrcForm(NamedTuple):
    """Parameters of a CRC, as in CRC catalogues."""

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
    """A field of the header or trailer: a number in some bytes, shifted, of ``bits``
    bits.
    """

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
    """The first byte of the header that it covers."""
    covered_trailer: int
    """Bytes of the trailer that it covers."""
    is_seeded: bool
    """Whether the seed of the message is covered, as a byte after all others."""


class StreamRow(NamedTuple):
    """A message: its id, the valid lengths of its data, and its seed."""

    id: int
    least: int
    most: int
    cuts_zeros: bool
    """Whether zeros at the end of the data are not sent, except for the first byte."""
    seed: int
    reply: Optional[int] = None
    """For a telecommand: the id of the telemetry that responds to it."""


class Stream(NamedTuple):
    """Frame format of messages in a byte stream or in packets."""

    delimited_by: Delimiter
    header_bytes: int
    trailer_bytes: int
    length_plus: int
    """Number that the length field adds to the bytes of the data."""
    per_id: bool
    """Whether each id has its own sequence counter."""
    fields: tuple[EnvelopeField, ...]
    telecommands: tuple[StreamRow, ...]
    telemetry: tuple[StreamRow, ...]
    check: Optional[CheckForm] = None

    def rows(self, direction: Direction) -> tuple[StreamRow, ...]:
        """Return the messages of a direction."""
        return self.telemetry if direction == "telemetry" else self.telecommands

    def of(self, role: str) -> Optional[EnvelopeField]:
        """Return the field of a role that occurs at most once, or None."""
        return next((field for field in self.fields if field.role == role), None)
