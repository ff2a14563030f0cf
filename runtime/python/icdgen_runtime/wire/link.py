"""The facts of a node's link, as the ICD has them. Sizes are bytes, times milliseconds.

A part that the ICD does not describe is None.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple, Union

if TYPE_CHECKING:
    from .._lazy import Messages

Bus = Literal["uart", "i2c", "can"]
CanKind = Literal[
    "telecommand", "acknowledge", "refusal", "request", "reply", "request_refusal"
]
Number = Union[int, float]


class Assumption(NamedTuple):
    """Something that the manual leaves open, what the ICD holds of it, and why."""

    section: str
    key: str
    value: object
    why: str


class Settings(NamedTuple):
    """How a client waits and tries again, in milliseconds."""

    reply_timeout: Number
    retries: int
    poll_interval: Number
    poll_timeout: Number


class Sent(NamedTuple):
    """A telecommand: its length, and whether it is acknowledged and is a setting."""

    length: int
    acknowledged: bool = True
    setting: bool = False


class Framing(NamedTuple):
    """How messages are delimited on the UART: escape byte and one of the others."""

    escape: int
    start: int
    end: int
    escaped: int
    escapes_id: bool
    ignores_other: bool


class Acknowledge(NamedTuple):
    """The acknowledge on the UART, with its first byte."""

    length: int
    id_at: int
    error_at: int


class Polled(NamedTuple):
    """The frame that tells what became of a telecommand, and its attributes."""

    telemetry: int
    id: str
    processed: str
    error: str
    parameter: str


class CrcForm(NamedTuple):
    """Parameters of a CRC, as catalogues give them. ``empty``: of no bytes at all."""

    width: int
    polynomial: int
    init: int
    reflect_in: bool
    reflect_out: bool
    xor_out: int
    empty: int | None = None


class Checksum(NamedTuple):
    """The optional checksum of telecommands and frames."""

    crc: CrcForm
    covers_id: bool
    telecommand_buses: tuple[str, ...]
    telemetry_buses: tuple[str, ...]
    bytes: int


class CanPart(NamedTuple):
    """A part of the CAN identifier."""

    bits: int
    shift: int


class Extended(NamedTuple):
    """CAN messages of several packets."""

    data_bytes: int
    left_at: int
    left_in_last: int
    packets: int
    bytes: int
    fill: int
    packet_timeout: int


class Can(NamedTuple):
    """Parts of the identifier by role, and message types by kind."""

    parts: dict[str, CanPart]
    node_address: int
    data_bytes: int
    types: dict[CanKind, int]
    extended_types: dict[CanKind, int]
    extended: Extended | None = None


class LogBit(NamedTuple):
    """A bit of the log mask and its frame; an unassigned bit has no id."""

    bit: int
    id: int | None
    length: int
    name: str = ""


class LogMask(NamedTuple):
    """The mask of a log, and the slots of an entry."""

    size: int
    msb0: bool
    slot_bytes: int
    fill: int
    bits: dict[int, LogBit]

    def selected(self, mask: bytes) -> list[LogBit]:
        """The slots of an entry, in order."""
        found = []
        for bit in range(8 * self.size):
            if mask[bit >> 3] >> (bit & 7 ^ (7 if self.msb0 else 0)) & 1:
                unassigned = LogBit(bit, None, self.slot_bytes)
                found.append(self.bits.get(bit, unassigned))
        return found


class LogFileForm(NamedTuple):
    """The file form of a log. Times are (offset in the entry, bytes)."""

    mask_at: int
    header_bytes: int
    seconds: tuple[int, int]
    milliseconds: tuple[int, int]
    frames_at: int
    file_type: int | None = None


class LogMessageForm(NamedTuple):
    """The unsolicited form of a log. Offsets count from the id."""

    id: int
    mask_at: int
    frames_at: int


class TimePart(NamedTuple):
    """A part of a packed time: bits, and what one of them stands for."""

    at: int
    bits: int
    factor: int = 1
    offset: int = 0


class Index(NamedTuple):
    """Entries of the index file: by role, offset and bytes."""

    entry_bytes: int
    fields: dict[str, tuple[int, int]]
    file_type: int | None = None


class HoleMapForm(NamedTuple):
    """A bit for each packet of a block, in messages that have a set and a get id."""

    bytes: int
    message_bytes: int
    msb0: bool
    received: int
    beyond_end: int
    telecommands: tuple[int, ...]
    telemetry: tuple[int, ...]
    attribute: str


class Step(NamedTuple):
    """A message that plays a part in a procedure, and its attributes by role."""

    fields: dict[str, str]
    telecommand: int | None = None
    telemetry: int | None = None


class Files(NamedTuple):
    """File transfer: messages, numbers and truth values by their path in the ICD."""

    packet_bytes: int
    counter_bytes: int
    first_packet: int
    fill: int
    block_packets: int
    block_bytes: int
    steps: dict[str, Step]
    numbers: dict[str, int]
    packet_ids: dict[str, int]
    destinations: tuple[int, ...] = ()
    """Those of uploads; none: all."""

    def packets_of(self, size: int) -> int:
        """Packets of a block of so many bytes."""
        return -(-size // self.packet_bytes)


class Operation(NamedTuple):
    """What a telecommand starts, and a frame tells the end of. Times in milliseconds."""

    request: Step
    progress: Step
    poll_interval: int
    timeout: int
    programs: tuple[int, ...] = ()
    """Those that it may be asked for; none: all."""


class Link(NamedTuple):
    """Everything that the wire layer has to know of a node."""

    node: str
    order: Literal["little", "big"]
    node_type: int | None
    interface_version: int | None
    longest: int
    """Bytes of the longest message of either direction, with id and checksum."""
    longest_data: int
    """Bytes of the longest message of either direction, without."""
    telemetry_ids: tuple[int, int]
    """First and last."""
    settings: Settings
    """How a client waits by default."""
    errors: dict[str, int]
    """Error codes by role."""
    commands: dict[int, Sent]
    frames: dict[int, int]
    """Lengths of telemetry frames by id."""
    TELECOMMANDS: Messages
    TELEMETRY: Messages
    framing: Framing | None = None
    acknowledge: Acknowledge | None = None
    polled: Polled | None = None
    i2c_address: int | None = None
    can: Can | None = None
    checksum: Checksum | None = None
    crc16: CrcForm | None = None
    mask: LogMask | None = None
    log_file: LogFileForm | None = None
    log_message: LogMessageForm | None = None
    time: dict[str, TimePart] | None = None
    index_file: Index | None = None
    hole_map: HoleMapForm | None = None
    files: Files | None = None
    program_copy: Operation | None = None
    program_information: Operation | None = None
    identification: Step | None = None
    statistics: Step | None = None
    boot_time: int | None = None
    assumptions: tuple[Assumption, ...] = ()
    """What the manual leaves open, and what is held of it."""
