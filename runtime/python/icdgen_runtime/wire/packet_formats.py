"""Packet formats that the ICD describes by header and trailer fields with roles.

The ``LINK`` of a node has these objects; `stream` encodes and decodes packets by them.
"""

from __future__ import annotations

from typing import Literal, NamedTuple, Optional

Delimiter = Literal["length", "slip", "cobs", "hdlc", "escape", "datagram"]
CheckKind = Literal["crc", "fletcher", "fletcher_255", "sum", "xor"]
Direction = Literal["telecommand", "telemetry"]
Content = Literal["message", "request", "requested", "none"]
"""Content of a packet: a message, a request of telemetry, the telemetry that was
requested, whose id the packet does not have, or no message.
"""
CHOSEN_ROLES = (
    "sequence",
    "source",
    "destination",
    "type",
    "flags",
    "time",
    "status",
    "reason",
)
"""Roles of the frame fields whose values the sender chooses."""
Verdict = Literal["ack", "reply", "nak", "busy", "progress", "again"]
"""A response confirms the telecommand, is the telemetry that it requested, refuses it,
defers it because the device is busy, reports that it is still being executed, or that
it was damaged on the line and can be sent again at once.
"""


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


class PacketField(NamedTuple):
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
    id_shift: int = 0
    """Role ``id``: number of bits of the id in the fields after this part of it."""
    unit: int = 1
    """Role ``length``: number of bytes that it counts as one."""
    plus: int = 0
    """Role ``length``: number that is added to the bytes of the data, before it counts."""

    def counted(self, count: int) -> int:
        """Return the value of a length for so many bytes of data."""
        return (count + self.plus) // self.unit

    def bytes_of(self, value: int) -> int:
        """Return the bytes of data that a value of a length says."""
        return value * self.unit - self.plus


class ChecksumAlgorithm(NamedTuple):
    """A checksum; kinds other than a CRC use init, xor_out and width of the form."""

    kind: CheckKind
    crc: CrcForm


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


class NumberPlace(NamedTuple):
    """The place of a number: the ``size`` bytes at byte ``at``, shifted right, of
    ``bits`` bits. Bytes that a message does not have are 0.
    """

    at: int
    size: int
    shift: int
    bits: int
    little: bool

    def of(self, data: bytes) -> int:
        """Return the number in a message."""
        taken = data[self.at : self.at + self.size].ljust(self.size, b"\0")
        number = int.from_bytes(taken, "little" if self.little else "big")
        return number >> self.shift & ((1 << self.bits) - 1)

    def put(self, number: int, data: bytearray) -> None:
        """Write the number into a message, which zeros lengthen if it is too short."""
        data.extend(bytes(max(0, self.at + self.size - len(data))))
        taken = slice(self.at, self.at + self.size)
        order: Literal["little", "big"] = "little" if self.little else "big"
        mask = ((1 << self.bits) - 1) << self.shift
        others = int.from_bytes(data[taken], order) & ~mask
        data[taken] = (others | number << self.shift & mask).to_bytes(self.size, order)


class Echo(NamedTuple):
    """A number of a response that repeats a number of the telecommand."""

    place: NumberPlace
    source: int
    """Index in the sources of the exchange."""


class Response(NamedTuple):
    """Telemetry, or a packet without a message, that can end, refuse, defer or prolong
    a telecommand.
    """

    telemetry: Optional[int]
    """Id of the telemetry; None for the telemetry that was requested, and for a packet.
    """
    verdict: Verdict
    """Its meaning; with a status, the meaning of a value that ``meanings`` lacks."""
    echoes: tuple[Echo, ...] = ()
    status: Optional[NumberPlace] = None
    meanings: tuple[tuple[int, Verdict], ...] = ()
    """Values of the status, and what each means."""
    reason: Optional[NumberPlace] = None
    """The place of the reason of a refusal."""
    reasons: tuple[tuple[int, str], ...] = ()
    """Names of the reasons."""
    packet: Optional[int] = None
    """Index of the packet. Its places count from the first byte of the header."""
    detail: Optional[NumberPlace] = None
    """The place of a number that says more about a refusal."""

    def verdict_of(self, data: bytes) -> Verdict:
        """Return what these data say."""
        if self.status is None:
            return self.verdict
        return dict(self.meanings).get(self.status.of(data), self.verdict)

    def can_be(self, verdict: Verdict) -> bool:
        """Return whether it can mean ``verdict``."""
        return verdict == self.verdict or verdict in dict(self.meanings).values()


class ResponsePoll(NamedTuple):
    """Telemetry that a client requests again and again until it is the response: until
    the number ``until`` is not 0, and all echoes are right.
    """

    telemetry: int
    until: NumberPlace


class Exchange(NamedTuple):
    """The possible responses to a telecommand."""

    sources: tuple[NumberPlace, ...]
    """Numbers of the telecommand that responses repeat: places in its id, as 4 bytes
    with the most significant first, followed by its data. The last ``in_header`` of
    them are places in the header of its packet.
    """
    responses: tuple[Response, ...]
    timeout: int = 0
    """The time-out in milliseconds; 0: that of the client."""
    in_header: int = 0
    """Number of sources in the header."""
    poll: Optional[ResponsePoll] = None
    """None: the response comes by itself."""

    def numbers(self, telecommand: bytes) -> tuple[int, ...]:
        """Return the numbers of a telecommand, given as its id, as 4 bytes, and its
        data.
        """
        end = len(self.sources) - self.in_header
        return tuple(place.of(telecommand) for place in self.sources[:end])

    def numbers_in(self, header: bytes) -> tuple[int, ...]:
        """Return the numbers of the header of a telecommand."""
        end = len(self.sources) - self.in_header
        return tuple(place.of(header) for place in self.sources[end:])


class BusExchanges(NamedTuple):
    """The exchanges on a bus. Packets without a message have an index of
    `bus_lines`; their bytes are the id, as one byte, and the data.
    """

    request: Exchange
    """Of telemetry."""
    command: Optional[Exchange] = None
    """Of all telecommands that are acknowledged; None if the bus has no acknowledge."""


class StreamRow(NamedTuple):
    """A message: its id, the valid lengths of its data, and its seed."""

    id: int
    least: int
    most: int
    cuts_zeros: bool
    """Whether zeros at the end of the data are not sent, except for the first byte."""
    seed: int
    exchange: Optional[int] = None
    """Index in `Stream.exchanges`; None if nothing responds to a telecommand."""
    repeats: bool = False
    """Whether a telecommand may be sent again after a time-out."""
    requests: Optional[int] = None
    """The id of the telemetry that a telecommand of zeros requests."""
    packet: int = 0
    """Index in `Stream.packets`."""
    is_requested: bool = False
    """Whether telemetry is requested by the packet of `Stream.request`."""


class PacketForm(NamedTuple):
    """A packet format: header, data, trailer."""

    header_bytes: int
    trailer_bytes: int
    fields: tuple[PacketField, ...]
    check: Optional[CheckForm] = None
    name: str = ""
    directions: tuple[Direction, ...] = ("telecommand", "telemetry")
    content: Content = "message"
    reserved: int = 0
    """Bytes of data, which are zeros, if the packet has no message."""

    @property
    def tells_message(self) -> bool:
        """Whether the packet identifies its message."""
        return self.content in ("message", "request")

    def of(self, role: str) -> Optional[PacketField]:
        """Return the first field of a role, or None."""
        return next((field for field in self.fields if field.role == role), None)

    @property
    def overhead(self) -> int:
        """Bytes of header and trailer."""
        return self.header_bytes + self.trailer_bytes


class Escaping(NamedTuple):
    """The escape byte that delimits packets, and what follows it."""

    escape: int
    """The escape byte."""
    end: int
    """Follows the escape byte at the end of a packet."""
    data: int
    """Follows the escape byte if the escape byte itself is data."""
    start: Optional[int] = None
    """Follows the escape byte at the beginning of a packet; None: the first byte of the
    packet does.
    """
    ignores_other: bool = False
    """Whether an escape byte and any other byte are skipped within a packet; otherwise
    it is an error.
    """

    def begins(self, byte: int) -> bool:
        """Return whether a byte that follows the escape byte begins a packet."""
        if self.start is None:
            return byte not in (self.escape, self.end, self.data)
        return byte == self.start


class TelemetryRequest(NamedTuple):
    """The request of telemetry by a packet with its id."""

    packet: int
    """Index in `Stream.packets`."""
    exchange: int
    """Index in `Stream.exchanges`."""


class Stream(NamedTuple):
    """Messages in a byte stream or in packets, with header and trailer."""

    delimited_by: Delimiter
    per_id: bool
    """Whether each id has its own sequence counter."""
    packets: tuple[PacketForm, ...]
    """Packet formats. If two fit, the first is received."""
    telecommands: tuple[StreamRow, ...]
    telemetry: tuple[StreamRow, ...]
    request: Optional[TelemetryRequest] = None
    """None: only telecommands request telemetry."""
    exchanges: tuple[Exchange, ...] = ()
    confirming: tuple[int, ...] = ()
    """Ids of telemetry that only responds to telecommands, and is not requested."""
    escaping: Optional[Escaping] = None
    """If escape characters delimit packets."""

    def rows(self, direction: Direction) -> tuple[StreamRow, ...]:
        """Return the messages of a direction."""
        return self.telemetry if direction == "telemetry" else self.telecommands

    def row(self, direction: Direction, id: int) -> Optional[StreamRow]:
        """Return the message of an id, or None."""
        return next((row for row in self.rows(direction) if row.id == id), None)

    def packets_of(self, direction: Direction) -> tuple[PacketForm, ...]:
        """Return the packets of a direction."""
        return tuple(each for each in self.packets if direction in each.directions)

    def chosen(self, direction: Direction) -> dict[str, PacketField]:
        """Return the fields whose values the sender chooses, by role."""
        fields: dict[str, PacketField] = {}
        for packet in self.packets_of(direction):
            for field in packet.fields:
                if field.role in CHOSEN_ROLES:
                    fields.setdefault(field.role, field)
        return fields
