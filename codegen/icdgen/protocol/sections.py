"""Parts of a node's protocol, with the facts of each declared once
(`icdgen.protocol.declared`).

A part stands for a section of the ICD (`SECTIONS`). Times are milliseconds, sizes
bytes. Most classes have the same name as their counterpart in the runtimes, because
`icdgen.link_calls` writes the initializers of generated links by class name.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any

from icdgen.frozen import dataclass
from icdgen.icd.model import CAN_DATA_BYTES, CAN_PACKETS, Message
from icdgen.protocol.declared import (
    BYTE,
    U32,
    buses,
    code,
    flag,
    number,
    octet,
    octets,
    span,
    time,
)

_BITS = ("lsb0", "msb0")
_MSB0 = "whether bit 0 is the most significant bit of a byte"
CAN_WITH_DATA = ("telecommand", "reply")  # other kinds have no data
CAN_KINDS = (
    "telecommand",
    "acknowledge",
    "refusal",
    "request",
    "reply",
    "request_refusal",
)


@dataclass(frozen=True, eq=False, repr=False)
class IdRange:
    """Range of the ids of one direction."""

    first: int
    last: int


@dataclass(frozen=True, eq=False, repr=False)
class Framing:
    """Framing of messages on the UART.

    The escape byte precedes each of the other three bytes.
    """

    escape: int = octet("escape", "the escape byte")
    start: int = octet("start", "follows the escape byte at the beginning of a message")
    end: int = octet("end", "follows the escape byte at the end of a message")
    escaped: int = octet(
        "data", "follows the escape byte if the escape byte itself is data"
    )
    escapes_id: bool = flag(
        "escaped_in", "whether the id is escaped like the data", True, ("data", "id"), "id",
        "the parts of a message in which the escape byte is doubled",
    )  # fmt: skip
    ignores_other: bool = flag(
        "other", "whether an escape byte and an unknown byte are skipped; otherwise it is an error", False,
        ("error", "ignore"), key_about="handling of any other byte after the escape byte",
    )  # fmt: skip


@dataclass(frozen=True, eq=False, repr=False)
class Crc:
    """Parameters of a CRC in the notation of common catalogues."""

    # The Rocksoft model names them WIDTH, POLY, INIT, REFIN, REFOUT and XOROUT.
    width: int = number("width", "bits of the checksum", 1, 32, holds=U32)
    polynomial: int = code(
        "polynomial",
        "generator polynomial, most significant bit first, without the leading term",
    )
    init: int = code("init", "initial value of the register")
    reflect_in: bool = flag(
        "reflect_in", "whether each byte enters least significant bit first"
    )
    reflect_out: bool = flag(
        "reflect_out", "whether the bits of the register are reversed at the end"
    )
    xor_out: int = code(
        "xor_out", "final XOR value: combined with the register at the end"
    )
    empty: int | None = code(
        "empty", "checksum of no bytes, if it is not the result of the algorithm", None
    )


@dataclass(frozen=True, eq=False, repr=False)
class CheckValue:
    """Check value of a CRC, by which catalogues verify the parameters.

    Rule ICD091 compares it with the computed CRC. Generated links do not use it.
    """

    check: int | None = code(
        "check", 'checksum of the nine ASCII bytes "123456789"', None
    )


@dataclass(frozen=True, eq=False, repr=False)
class ChecksumAlgorithm:
    """Algorithm of a checksum.

    Kinds other than a CRC use only ``init``, ``xor_out`` and ``width`` of `crc`.
    """

    name: str  # in `link: checksums`
    kind: str  # one of `icdgen.icd.checksum.KINDS`
    crc: Crc
    # By message: a byte that the checksum of a packet covers after all others
    seeds: Mapping[str, int]

    @property
    def section(self) -> str:
        """Section of the ICD that declares it."""
        return f"link.checksums.{self.name}"


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Checksum:
    """Checksum behind the data of telecommands and telemetry frames on buses: a trailer
    of `link: packets`.
    """

    algorithm: ChecksumAlgorithm
    covers_id: bool = flag("", "whether the checksum covers the id byte", False)
    telecommand_buses: tuple[str, ...] = buses(
        "buses on which telecommands may have a checksum"
    )
    telemetry_buses: tuple[str, ...] = buses(
        "buses on which telemetry may have a checksum"
    )
    telecommand_always: tuple[str, ...] = buses(
        "buses on which telecommands must have a checksum"
    )
    telemetry_always: tuple[str, ...] = buses(
        "buses on which telemetry always has a checksum"
    )
    bytes: int = octets("", "length of the checksum", 1, BYTE)


@dataclass(frozen=True, eq=False, repr=False)
class CanPart:
    """Part of the CAN identifier."""

    bits: int
    shift: int


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Extended:
    """Extended CAN messages, which consist of several packets."""

    # ISO 11898-1: a classical frame has at most 8 data bytes.
    data_bytes: int = octets("data_bytes", "data bytes of a packet", 1, 8)
    left_at: int = octets(
        "packets_left_byte",
        "index of the byte with the number of packets that follow",
        0,
        7,
    )
    left_in_last: int = number(
        "packets_left_in_last",
        "value of that byte in the last packet",
        0,
        default=0,
        holds=BYTE,
    )
    packets: int = number(
        "max_packets", "maximum number of packets of a message", 1, default=CAN_PACKETS
    )
    bytes: int = octets(
        "max_bytes",
        "maximum number of bytes of a message",
        1,
        U32,
        lambda preceding: preceding["data_bytes"] * preceding["packets"],
    )
    fill: int = octet("fill", "value of unused bytes of the last packet", 0)
    packet_timeout: int = time(
        "packet_timeout_ms", "longest time between two packets of a message", 1000
    )


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Can:
    """CAN messages: parts of the identifier by role (type, channel, source,
    destination), and types by kind of message.
    """

    node_address: int = octet("node_address", "address of the node")
    data_bytes: int = octets(
        "max_data_bytes",
        "maximum number of data bytes of one packet; CAN 2.0 allows 8",
        1,
        CAN_DATA_BYTES,
        CAN_DATA_BYTES,
    )
    parts: dict[str, CanPart]
    types: dict[str, int]  # kind -> message type; see `CAN_KINDS`
    extended_types: dict[str, int]
    extended: Extended | None


@dataclass(frozen=True, eq=False, repr=False)
class LogBit:
    """Bit of the log mask and the frame that it selects.

    An unassigned bit has neither ``id`` nor ``name`` (None).
    """

    bit: int
    id: int | None
    length: int  # bytes of the frame, at most those of a slot
    name: str | None


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class LogMask:
    """Mask of a log.

    Frames are stored in slots, in ascending order of their mask bits.
    """

    size: int = octets("bytes", "length of the mask", 1, BYTE)
    msb0: bool = flag(
        "bit_order", _MSB0, False, _BITS, key_about="which bit of byte 0 is bit 0"
    )
    slot_bytes: int = octets("frame_bytes", "length of each frame in a log")
    fill: int = octet("fill", "value of the bytes after a short frame", 0)
    bits: dict[int, LogBit]  # assigned bits only

    def selected(self, mask: bytes) -> list[LogBit]:
        """Return the slots of an entry, in order."""
        slots = []
        for bit in range(self.size * 8):
            weight = 7 - bit % 8 if self.msb0 else bit % 8
            if mask[bit // 8] >> weight & 1:
                # An entry has a slot for an unassigned bit, too.
                slots.append(
                    self.bits.get(bit) or LogBit(bit, None, self.slot_bytes, None)
                )
        return slots


@dataclass(frozen=True, eq=False, repr=False)
class LogFile:
    """Log as a file."""

    mask_at: int = octets("", "offset of the mask in the header")
    header_bytes: int = octets("", "length of the header")
    seconds: tuple[int, int] = span("offset and length of the Unix time in an entry")
    milliseconds: tuple[int, int] = span(
        "offset and length of the milliseconds in an entry"
    )
    frames_at: int = octets(
        "frames_byte", "offset of the selected frames in an entry", 0
    )
    file_type: int | None = number(
        "file_type.value", "type of a log file", 0, BYTE, None
    )


@dataclass(frozen=True, eq=False, repr=False)
class LogMessage:
    """Log as an unsolicited message. Positions count from the id."""

    id: int = number("id", "id of the message", most=BYTE)
    mask_at: int = octets("", "offset of the mask")
    frames_at: int = octets("frames_byte", "offset of the selected frames", 0)


@dataclass(frozen=True, eq=False, repr=False)
class TimePart:
    at: int
    bits: int
    # MS-DOS time counts seconds in steps of 2, and years from 1980.
    factor: int
    offset: int


@dataclass(frozen=True, eq=False, repr=False)
class IndexField:
    at: int
    bytes: int


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Index:
    """Entries of the index file: fields by role (type, counter, checksum, size, time,
    meta).
    """

    entry_bytes: int = octets("entry_bytes", "length of an entry")
    file_type: int | None = number(
        "file_type.value", "type of the index file", 0, BYTE, None
    )
    fields: dict[str, IndexField]


@dataclass(frozen=True, eq=False, repr=False)
class Report:
    """Telemetry that a link reads, and its fields by role."""

    message: Message
    fields: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, repr=False)
class Settings:
    """Time limits and retries of a client; the defaults of generated clients."""

    reply_timeout: int = time("reply_timeout_ms", "time-out of a reply", 1000)
    retries: int = number("retries", "number of retries of a request", 0, BYTE, 3)
    poll_interval: int = time(
        "poll_interval_ms", "time between two polls for an acknowledge", 20
    )
    poll_timeout: int = time(
        "poll_timeout_ms", "longest processing time of a telecommand", 5000
    )
    late: int = time(
        "late_ms", "time after a time-out in which a response can still come", 1000
    )
    busy_pause: int = time(
        "busy_pause_ms", "pause before a request is sent to a busy device again", 100
    )
    gap: int = time("gap_ms", "shortest time between two transmissions", 0, least=0)
    in_flight: int = number(
        "in_flight", "number of requests that the device handles at a time", 1, 8, 1
    )
    progress_for: int = time(
        "progress_for_ms",
        "longest time by which reports of progress extend a time-out",
        60000,
    )


SECTIONS: dict[type[Any], str] = {
    Settings: "link.client",
    Framing: "link.buses.uart.framing",
    Can: "link.buses.can",
    Extended: "link.buses.can.segments",
    Checksum: "link.packets",
    LogMask: "log_mask",
    LogFile: "telemetry_log",
    LogMessage: "unsolicited_log",
    Index: "index_file",
    Crc: "link.checksums.*",
    CheckValue: "link.checksums.*",
}
"""Section of the protocol of an ICD that has the facts of each part; `*` is any name."""
