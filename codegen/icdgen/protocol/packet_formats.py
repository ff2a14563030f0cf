"""Packet format of a link as the ICD describes it: fields with roles in a header and a
trailer around the data.

All quantities of the decoder are computed here, once for all languages: a field is a
range of bytes in a byte order, a shift and a width.
"""

from __future__ import annotations

from typing import Literal

from icdgen.frozen import dataclass
from icdgen.icd import checksum
from icdgen.protocol.exchange import Exchange
from icdgen.protocol.sections import ChecksumAlgorithm

LENGTH, SLIP, COBS, HDLC, ESCAPE, DATAGRAM = DELIMITERS = (
    "length",
    "slip",
    "cobs",
    "hdlc",
    "escape",
    "datagram",
)
"""Delimiters of messages; `datagram`: the packet that carries the message."""

GIVEN = ("sequence", "source", "destination", "type", "flags", "time", "status", "reason")  # fmt: skip
"""Roles of fields whose values the sender chooses."""

ROLES = ("constant", "id", "length", "response_length", "checksum", *GIVEN)
"""Roles as code knows them: a `sync` is a constant."""

CRC, FLETCHER, FLETCHER_255, SUM, XOR = CHECKS = checksum.KINDS
Direction = Literal["telecommand", "telemetry"]
DIRECTIONS: tuple[Direction, ...] = ("telecommand", "telemetry")
DATA = "data"  # in `covers`: the data between header and trailer
WORD = 32  # bits of the decoder's arithmetic


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class PacketField:
    """Field of the header or trailer.

    The ``size`` bytes at byte ``at`` form a number, which is shifted right by ``shift``
    and masked to ``bits``.
    """

    role: str  # one of `ROLES`
    in_trailer: bool
    at: int
    size: int
    shift: int
    bits: int
    little: bool
    # Value of a constant, or default: in telecommands, in telemetry
    values: tuple[int, int]
    id_shift: int = 0  # number of bits of the id below the part in this field
    # Of a length: the data have value * unit - plus bytes. `plus` is the number of
    # bytes that the length counts in addition to the data. (`plus` of
    # `icdgen.icd.layout.Counted` has the opposite sign.)
    unit: int = 1
    plus: int = 0

    @property
    def mask(self) -> int:
        """Largest value of the field."""
        return (1 << self.bits) - 1


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Check:
    """Checksum of a packet format: its algorithm, and the bytes that it covers in
    addition to the data.
    """

    algorithm: ChecksumAlgorithm
    covered_from: int  # first covered byte of the header
    covered_trailer: int  # number of covered bytes of the trailer
    is_seeded: bool  # whether the seed of the message is covered, as the last byte


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class StreamRow:
    """Message of one direction: its id and the range of its data length in bytes."""

    id: int
    least: int
    most: int
    # Whether trailing zeros of the data are not sent (at least one byte is)
    cuts_zeros: bool
    # Byte that the checksum covers last, such as CRC_EXTRA of MAVLink.
    seed: int
    name: str
    # Of a telecommand: its responses; None if nothing responds to it
    exchange: Exchange | None = None
    repeats: bool = False  # whether it may be sent again after a time-out
    # Id of the telemetry that it requests if it is sent as `least` zero bytes
    requests: int | None = None
    packet: int = 0  # index of `Stream.packets`
    # Of telemetry: whether the packet of `Stream.request` can request it
    is_requested: bool = False


MESSAGE, REQUEST, REQUESTED, NOTHING = CONTENTS = (
    "message",
    "request",
    "requested",
    "none",
)
"""Content of a packet: a message, a request of telemetry, the telemetry that was
requested, which no field names, no message.
"""


@dataclass(frozen=True, slots=True, eq=False, repr=False, kw_only=True)
class PacketFormat:
    """Format of the packets of one or both directions."""

    name: str  # empty if the link has one format
    directions: tuple[str, ...]
    content: str  # one of `CONTENTS`
    header_bytes: int
    trailer_bytes: int
    reserved: int  # bytes of data without meaning, in packets without a message
    fields: tuple[PacketField, ...]
    check: Check | None

    def of(self, role: str) -> PacketField | None:
        """Return the first field of a role; None without such a field."""
        return next((field for field in self.fields if field.role == role), None)

    @property
    def overhead(self) -> int:
        """Bytes of header and trailer."""
        return self.header_bytes + self.trailer_bytes


@dataclass(frozen=True, slots=True, repr=False, kw_only=True)
class Escaping:
    """Escape byte that delimits packets, and the bytes that follow it."""

    escape: int
    end: int
    data: int  # stands for the escape byte itself
    start: int | None  # None: the first byte of a packet begins it
    ignores_other: bool  # whether an escape byte and any other byte are skipped


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class TelemetryRequest:
    """Request of telemetry by a packet with its id."""

    packet: int  # index of `Stream.packets`
    exchange: Exchange


@dataclass(frozen=True, slots=True, eq=False, repr=False, kw_only=True)
class Stream:
    """Messages in a byte stream or in packets, with header and trailer."""

    delimited_by: str  # one of `DELIMITERS`
    per_id: bool  # whether each id has its own sequence counter
    packets: tuple[PacketFormat, ...]  # an earlier one precedes if both fit
    telecommands: tuple[StreamRow, ...]  # in ascending order of ids
    telemetry: tuple[StreamRow, ...]
    request: TelemetryRequest | None = None  # None: only telecommands request
    escaping: Escaping | None = None  # if escape characters delimit packets

    @property
    def exchanges(self) -> tuple[Exchange, ...]:
        """Return the different exchanges of the telecommands and of requests of
        telemetry, in order.
        """
        exchanges = [row.exchange for row in self.telecommands if row.exchange]
        if self.request:
            exchanges.append(self.request.exchange)
        # Equal exchanges share a row in the tables of generated code.
        return tuple(dict.fromkeys(exchanges))

    @property
    def confirming(self) -> tuple[int, ...]:
        """Return the ids of the telemetry that responds to telecommands or requests,
        and is the reply to none of them.
        """
        ids: set[int] = set()
        replies: set[int] = set()
        for exchange in self.exchanges:
            for response in exchange.responses:
                if response.telemetry is not None:
                    ids.add(response.telemetry)
                    if response.is_reply:
                        replies.add(response.telemetry)
        return tuple(sorted(ids - replies))

    @property
    def requested_ids(self) -> frozenset[int]:
        """Return the ids of the telemetry that a client can request."""
        ids = {row.requests for row in self.telecommands if row.requests is not None}
        ids |= {row.id for row in self.telemetry if row.is_requested}
        return frozenset(ids)

    def exchange_of(self, row: StreamRow) -> Exchange | None:
        """Return the responses to a telecommand, or to the request of telemetry by a
        packet; None if nothing responds.
        """
        if row.is_requested and self.request:
            return self.request.exchange
        return row.exchange

    def rows(self, direction: str) -> tuple[StreamRow, ...]:
        """Return the messages of a direction."""
        return self.telemetry if direction == "telemetry" else self.telecommands

    def packets_of(self, direction: str) -> tuple[PacketFormat, ...]:
        """Return the packets of a direction."""
        return tuple(each for each in self.packets if direction in each.directions)

    def chosen(self, direction: str) -> dict[str, PacketField]:
        """Return the fields of a direction whose values the sender chooses, by role: of
        several packets, the field of the first.
        """
        fields: dict[str, PacketField] = {}
        for packet in self.packets_of(direction):
            for field in packet.fields:
                if field.role in GIVEN:
                    fields.setdefault(field.role, field)
        return fields

    @property
    def longest_data(self) -> int:
        """Largest number of data bytes of a message."""
        return max(
            (row.most for row in (*self.telecommands, *self.telemetry)), default=0
        )

    @property
    def longest_request(self) -> int:
        """Largest number of data bytes of a telecommand or a request of telemetry."""
        sizes = [row.most for row in self.telecommands]
        if self.request:
            sizes.append(self.packets[self.request.packet].reserved)
        return max(sizes, default=0)

    @property
    def longest(self) -> int:
        """Bytes of the longest message with header and trailer, without delimiters and
        byte stuffing.
        """
        sizes = [each.overhead + each.reserved for each in self.packets]
        for row in (*self.telecommands, *self.telemetry):
            sizes.append(self.packets[row.packet].overhead + row.most)
        return max(sizes)

    @property
    def sequences(self) -> int:
        """Number of sequence counters that a decoder stores to detect gaps."""
        if not any(packet.of("sequence") for packet in self.packets):
            return 0
        # A decoder handles one direction; its table has a row for each id.
        return max(1, len(self.telecommands), len(self.telemetry)) if self.per_id else 1

    @property
    def longest_line(self) -> int:
        """Largest number of transmitted bytes of a message, with delimiters and byte
        stuffing.
        """
        # Worst case: each byte is escaped (SLIP, HDLC, escape characters), or a code
        # byte for each 254 bytes (COBS).
        if self.escaping:
            # Without a start byte, the first byte of a packet is not escaped.
            return 2 * self.longest + (2 if self.escaping.start is None else 4)
        # A delimiter on each side, although the first is optional in RFC 1055, and two
        # frames may share one in RFC 1662.
        if self.delimited_by in (SLIP, HDLC):
            return 2 * self.longest + 2
        if self.delimited_by == COBS:
            return self.longest + self.longest // 254 + 2
        return self.longest
