"""The protocol facts of a node, read from its ICD and what it includes, in a form that code can be made from.

A part that the ICD does not describe is None. Times are milliseconds, sizes bytes.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import ceil

from icdgen.icd.model import Icd, Message, Node

UART, I2C, CAN = "uart", "i2c", "can"


class Unsupported(LookupError):
    """The ICD does not describe this part of the protocol."""


@dataclass(frozen=True, slots=True)
class Assumption:
    """Something that the manual leaves open: where it stands, what we hold, and why."""

    section: str  # "can.extended", or "message Reset"
    key: str
    value: object
    why: str


@dataclass(frozen=True, slots=True)
class Direction:
    """Ids of one direction."""

    first: int
    last: int


@dataclass(frozen=True, slots=True)
class Framing:
    """How messages are delimited on the UART. The escape byte comes before each of the other three."""

    escape: int
    start: int
    end: int
    escaped: int  # after the escape byte: the escape byte itself as data
    escapes_id: bool  # whether the id is escaped like the data
    ignores_other: bool  # whether an escape byte before any other byte is skipped, or an error


@dataclass(frozen=True, slots=True)
class Acknowledge:
    """The acknowledge as a message on the UART: where the id of the telecommand and the error code stand."""

    length: int  # with its first byte
    id_at: int
    error_at: int


@dataclass(frozen=True, slots=True)
class Polled:
    """The frame that tells what became of a telecommand, with the names of its fields."""

    message: Message
    id: str
    processed: str
    error: str
    parameter: str


@dataclass(frozen=True, slots=True)
class Crc:
    """Parameters of a CRC in the notation of the usual catalogues. ``empty``: the value for no bytes at all."""

    width: int
    polynomial: int
    init: int
    reflect_in: bool
    reflect_out: bool
    xor_out: int
    empty: int | None = None


@dataclass(frozen=True, slots=True)
class Checksum:
    """The optional checksum of telecommands and frames."""

    crc: Crc
    covers_id: bool
    telecommand_buses: tuple[str, ...]
    telemetry_buses: tuple[str, ...]
    bytes: int  # that it adds to a message


@dataclass(frozen=True, slots=True)
class CanPart:
    """A part of the CAN identifier."""

    bits: int
    shift: int


@dataclass(frozen=True, slots=True)
class Extended:
    """CAN messages of several packets."""

    data_bytes: int
    left_at: int  # where the count of packets still to come stands
    left_in_last: int
    packets: int  # most of them
    bytes: int  # most of them
    fill: int
    packet_timeout: int


@dataclass(frozen=True, slots=True)
class Can:
    """CAN: parts of the identifier by role (type, channel, source, destination), and types by kind of message."""

    parts: dict[str, CanPart]
    node_address: int
    data_bytes: int  # most of a packet
    types: dict[str, int]  # kind -> message type; see `KINDS` of `icdgen.protocol.can`
    extended_types: dict[str, int]
    extended: Extended | None


@dataclass(frozen=True, slots=True)
class LogBit:
    """A bit of the log mask and the frame that it selects; ``id`` and ``name`` are None for an unassigned bit."""

    bit: int
    id: int | None
    length: int  # bytes of the frame, at most those of a slot
    name: str | None


@dataclass(frozen=True, slots=True)
class LogMask:
    """The mask of a log. Frames stand in slots of ``slot_bytes``, in the order of rising bits."""

    size: int  # bytes of the mask
    msb0: bool
    slot_bytes: int
    fill: int
    bits: dict[int, LogBit]  # the assigned ones

    def selected(self, mask: bytes) -> list[LogBit]:
        """The slots of an entry, in order."""
        found = []
        for bit in range(self.size * 8):
            weight = 7 - bit % 8 if self.msb0 else bit % 8
            if mask[bit // 8] >> weight & 1:
                found.append(self.bits.get(bit) or LogBit(bit, None, self.slot_bytes, None))
        return found


@dataclass(frozen=True, slots=True)
class LogFile:
    """The file form of a log."""

    mask_at: int
    header_bytes: int
    seconds: tuple[int, int]  # offset in the entry, bytes
    milliseconds: tuple[int, int]
    frames_at: int
    file_type: int | None


@dataclass(frozen=True, slots=True)
class LogMessage:
    """The unsolicited form of a log."""

    id: int
    mask_at: int  # counted from the id, as is ``frames_at``
    frames_at: int


@dataclass(frozen=True, slots=True)
class TimePart:
    at: int
    bits: int
    factor: int
    offset: int


@dataclass(frozen=True, slots=True)
class IndexField:
    at: int
    bytes: int


@dataclass(frozen=True, slots=True)
class Index:
    """Entries of the index file: fields by role (type, counter, checksum, size, time, meta)."""

    entry_bytes: int
    fields: dict[str, IndexField]
    file_type: int | None


@dataclass(frozen=True, slots=True)
class HoleMap:
    """A bit for each packet of a block."""

    bytes: int
    message_bytes: int
    msb0: bool
    received: int
    beyond_end: int
    messages: tuple[Message, ...]
    field: str


@dataclass(frozen=True, slots=True)
class Step:
    """A message that plays a part in a procedure, and its fields by role."""

    message: Message
    fields: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Files:
    """File transfer. Steps by path: ``list.reset``, ``download.load``, ``upload.packet``, ``erase.request`` ..."""

    packet_bytes: int
    counter_bytes: int
    first_packet: int
    fill: int
    block_packets: int
    block_bytes: int
    steps: dict[str, Step]
    numbers: dict[str, int]  # ``download.silence_ms`` and the like; truth values as 0 and 1
    packet_ids: dict[str, int]  # bus -> id that heads a download packet there
    destinations: tuple[int, ...]  # of uploads; none: all


@dataclass(frozen=True, slots=True)
class Operation:
    """What a telecommand starts; its frame says when it is done: ``busy`` is clear, or ``ready`` is set."""

    request: Step
    progress: Step
    poll_interval: int
    timeout: int
    programs: tuple[int, ...]  # that it may be asked for; none: all


@dataclass(frozen=True, slots=True)
class Client:
    """How a client waits and tries again by default, in milliseconds."""

    reply_timeout: int = 1000
    retries: int = 3
    poll_interval: int = 20
    poll_timeout: int = 5000


@dataclass(frozen=True, slots=True)
class Facts:
    """Everything that the protocol layer of a node is made from."""

    node: Node
    little: bool  # byte order of numbers
    telecommand_ids: Direction
    telemetry_ids: Direction
    telecommands: dict[int, Message]
    telemetry: dict[int, Message]
    client: Client
    framing: Framing | None
    acknowledge: Acknowledge | None
    polled: Polled | None
    i2c_address: int | None
    can: Can | None
    errors: dict[str, int]  # none, unknown_id, length, parameter, checksum
    checksum: Checksum | None
    crc16: Crc | None
    mask: LogMask | None
    log_file: LogFile | None
    log_message: LogMessage | None
    time: dict[str, TimePart]
    index: Index | None
    hole_map: HoleMap | None
    files: Files | None
    program_copy: Operation | None
    program_information: Operation | None
    identification: Step | None
    statistics: Step | None
    boot_ms: int | None
    assumptions: tuple[Assumption, ...]

    @property
    def owners(self) -> list[str]:
        """The nodes whose messages the node has: itself first, then those that it includes."""
        others = {message.node for message in (*self.telecommands.values(), *self.telemetry.values())}
        return [self.node.name, *sorted(others - {self.node.name})]

    @property
    def longest_telecommand(self) -> int:
        """Bytes of the longest telecommand with its id and checksum."""
        extra = self.checksum.bytes if self.checksum else 0
        return 1 + extra + max((m.length for m in self.telecommands.values()), default=0)

    @property
    def longest_reply(self) -> int:
        """Bytes of the longest message that the node sends, with its id and checksum."""
        extra = self.checksum.bytes if self.checksum else 0
        sizes = [1 + extra + m.length for m in self.telemetry.values()]
        if self.acknowledge:
            sizes.append(self.acknowledge.length)
        if self.log_message and self.mask:
            sizes.append(self.log_message.frames_at + self.mask.size * 8 * self.mask.slot_bytes)
        if self.files:
            sizes.append(1 + self.files.counter_bytes + self.files.packet_bytes)
        return max(sizes, default=1)

    @property
    def longest_data(self) -> int:
        """Bytes of the longest message of either direction without id and checksum."""
        return max((m.length for m in (*self.telecommands.values(), *self.telemetry.values())), default=0)

    @property
    def longest(self) -> int:
        """Bytes of the longest message of either direction."""
        return max(self.longest_telecommand, self.longest_reply)

    def number(self, data: bytes) -> int:
        """A number of several bytes in the node's byte order."""
        return int.from_bytes(data, "little" if self.little else "big")

    def bytes_of(self, number: int, size: int) -> bytes:
        """The reverse of `number`. Raises `OverflowError`."""
        return number.to_bytes(size, "little" if self.little else "big")

    def packets_of(self, size: int) -> int:
        """Packets of a file block of that many bytes."""
        return ceil(size / need(self.files, "file_transfer").packet_bytes)


def need(part, name: str):
    """The part of the facts, or `Unsupported` if the ICD does not have it."""
    if part is None or part == {}:
        raise Unsupported(f"the ICD says nothing about `{name}`")
    return part


def of(icd: Icd, node: Node) -> Facts:
    """The protocol facts that hold for a node."""
    from icdgen.protocol.reading import Reader

    return Reader(icd, node).facts()
