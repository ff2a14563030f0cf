"""Protocol of a node, from the ICD. Sizes are in bytes, times in milliseconds.

Attributes have the value None for parts that the ICD does not describe.
"""

from __future__ import annotations

from typing import Generic, Literal, NamedTuple, Optional, Union

from .._hints import N
from .._lazy import Messages
from .packet_formats import BusExchanges as BusExchanges  # noqa: PLC0414
from .packet_formats import CheckForm as CheckForm  # noqa: PLC0414
from .packet_formats import ChecksumAlgorithm as ChecksumAlgorithm  # noqa: PLC0414
from .packet_formats import CrcForm as CrcForm  # noqa: PLC0414
from .packet_formats import Echo as Echo  # noqa: PLC0414
from .packet_formats import Escaping as Escaping  # noqa: PLC0414
from .packet_formats import Exchange as Exchange  # noqa: PLC0414
from .packet_formats import NumberPlace as NumberPlace  # noqa: PLC0414
from .packet_formats import PacketField as PacketField  # noqa: PLC0414
from .packet_formats import PacketForm as PacketForm  # noqa: PLC0414
from .packet_formats import Response as Response  # noqa: PLC0414
from .packet_formats import ResponsePoll as ResponsePoll  # noqa: PLC0414
from .packet_formats import Stream as Stream  # noqa: PLC0414
from .packet_formats import StreamRow as StreamRow  # noqa: PLC0414
from .packet_formats import TelemetryRequest as TelemetryRequest  # noqa: PLC0414
from .procedure_forms import Blocks as Blocks  # noqa: PLC0414
from .procedure_forms import Collect as Collect  # noqa: PLC0414
from .procedure_forms import EndIfZeros as EndIfZeros  # noqa: PLC0414
from .procedure_forms import Get as Get  # noqa: PLC0414
from .procedure_forms import GetMap as GetMap  # noqa: PLC0414
from .procedure_forms import Input as Input  # noqa: PLC0414
from .procedure_forms import Jump as Jump  # noqa: PLC0414
from .procedure_forms import NextBlock as NextBlock  # noqa: PLC0414
from .procedure_forms import NextPacket as NextPacket  # noqa: PLC0414
from .procedure_forms import NextRound as NextRound  # noqa: PLC0414
from .procedure_forms import Output as Output  # noqa: PLC0414
from .procedure_forms import PacketDone as PacketDone  # noqa: PLC0414
from .procedure_forms import PacketMap as PacketMap  # noqa: PLC0414
from .procedure_forms import Poll as Poll  # noqa: PLC0414
from .procedure_forms import ProcedureForm as ProcedureForm  # noqa: PLC0414
from .procedure_forms import Put as Put  # noqa: PLC0414
from .procedure_forms import Receive as Receive  # noqa: PLC0414
from .procedure_forms import Send as Send  # noqa: PLC0414
from .procedure_forms import SendMap as SendMap  # noqa: PLC0414
from .procedure_forms import SetLength as SetLength  # noqa: PLC0414
from .procedure_forms import SkipUnless as SkipUnless  # noqa: PLC0414
from .procedure_forms import Take as Take  # noqa: PLC0414
from .procedure_forms import Test as Test  # noqa: PLC0414
from .procedure_forms import Value as Value  # noqa: PLC0414
from .procedure_forms import Verify as Verify  # noqa: PLC0414
from .procedure_forms import VerifyChecksum as VerifyChecksum  # noqa: PLC0414

Bus = Literal["uart", "i2c", "can"]
CanKind = Literal[
    "telecommand", "acknowledge", "refusal", "request", "reply", "request_refusal"
]
Number = Union[int, float]


class Assumption(NamedTuple):
    """An assumption of the ICD where the manual is incomplete, and its reason."""

    section: str
    key: str
    value: object
    why: str


class Settings(NamedTuple):
    """Timeouts and retries of a client, in milliseconds."""

    reply_timeout: Number = 1000
    """Time-out of a reply, in milliseconds."""
    retries: int = 3
    """Number of retries of a request."""
    poll_interval: Number = 20
    """Time between two polls for an acknowledge, in milliseconds."""
    poll_timeout: Number = 5000
    """Longest processing time of a telecommand, in milliseconds."""
    late: Number = 1000
    """Time after a time-out in which a response can still come, in milliseconds."""
    busy_pause: Number = 100
    """Pause before a request is sent to a busy device again, in milliseconds."""
    gap: Number = 0
    """Shortest time between two transmissions, in milliseconds."""
    in_flight: int = 1
    """Number of requests that the device handles at a time."""
    progress_for: Number = 60000
    """Longest time by which reports of progress extend a time-out, in milliseconds."""


class Sent(NamedTuple):
    """A telecommand: its length, whether it is acknowledged, and whether it is a
    setting.
    """

    length: int
    acknowledged: bool = True
    setting: bool = False


class Framing(NamedTuple):
    """Delimiters of messages on the UART: the escape byte and one of the other bytes."""

    escape: int
    """The escape byte."""
    start: int
    """Follows the escape byte at the beginning of a message."""
    end: int
    """Follows the escape byte at the end of a message."""
    escaped: int
    """Follows the escape byte if the escape byte itself is data."""
    escapes_id: bool
    """Whether the id is escaped like the data."""
    ignores_other: bool
    """Whether an escape byte and an unknown byte are skipped; otherwise it is an
    error."""


class Checksum(NamedTuple):
    """The optional checksum of telecommands and frames."""

    covers_id: bool
    """Whether the checksum covers the id byte."""
    telecommand_buses: tuple[str, ...]
    """Buses on which telecommands may have a checksum."""
    telemetry_buses: tuple[str, ...]
    """Buses on which telemetry may have a checksum."""
    telecommand_always: tuple[str, ...]
    """Buses on which telecommands must have a checksum."""
    telemetry_always: tuple[str, ...]
    """Buses on which telemetry always has a checksum."""
    bytes: int
    """Length of the checksum."""
    name: str
    """Its name in the checksums of the link."""


class CanPart(NamedTuple):
    """A part of the CAN identifier."""

    bits: int
    shift: int


class Extended(NamedTuple):
    """CAN messages of several packets."""

    data_bytes: int
    """Data bytes of a packet."""
    left_at: int
    """Index of the byte with the number of packets that follow."""
    left_in_last: int
    """Value of that byte in the last packet."""
    packets: int
    """Maximum number of packets of a message."""
    bytes: int
    """Maximum number of bytes of a message."""
    fill: int
    """Value of unused bytes of the last packet."""
    packet_timeout: int
    """Longest time between two packets of a message, in milliseconds."""


class Can(NamedTuple):
    """Parts of the identifier by role, and message types by kind."""

    node_address: int
    """Address of the node."""
    data_bytes: int
    """Maximum number of data bytes of one packet; CAN 2.0 allows 8."""
    parts: dict[str, CanPart]
    types: dict[CanKind, int]
    extended_types: dict[CanKind, int]
    extended: Optional[Extended] = None


class LogBit(NamedTuple):
    """A bit of the log mask and its frame. An unassigned bit has no id."""

    bit: int
    id: Optional[int]
    length: int
    name: str = ""


class LogMask(NamedTuple):
    """The mask of a log, and the frame slots of an entry."""

    size: int
    """Length of the mask."""
    msb0: bool
    """Whether bit 0 is the most significant bit of a byte."""
    slot_bytes: int
    """Length of each frame in a log."""
    fill: int
    """Value of the bytes after a short frame."""
    bits: dict[int, LogBit]

    def selected(self, mask: bytes) -> list[LogBit]:
        """Return the slots of an entry, in order."""
        slots = []
        for bit in range(8 * self.size):
            if mask[bit >> 3] >> (bit & 7 ^ (7 if self.msb0 else 0)) & 1:
                unassigned = LogBit(bit, None, self.slot_bytes)
                slots.append(self.bits.get(bit, unassigned))
        return slots


class LogFileForm(NamedTuple):
    """The file form of a log. Times are (offset in the entry, bytes)."""

    mask_at: int
    """Offset of the mask in the header."""
    header_bytes: int
    """Length of the header."""
    seconds: tuple[int, int]
    """Offset and length of the Unix time in an entry."""
    milliseconds: tuple[int, int]
    """Offset and length of the milliseconds in an entry."""
    frames_at: int
    """Offset of the selected frames in an entry."""
    file_type: Optional[int] = None
    """Type of a log file."""


class LogMessageForm(NamedTuple):
    """The unsolicited form of a log. Offsets count from the id."""

    id: int
    """Id of the message."""
    mask_at: int
    """Offset of the mask."""
    frames_at: int
    """Offset of the selected frames."""


class TimePart(NamedTuple):
    """A part of a packed time: bits, and scale and offset of their number."""

    at: int
    bits: int
    factor: int = 1
    offset: int = 0


class Index(NamedTuple):
    """Entries of the index file. Each field has offset and bytes, by role."""

    entry_bytes: int
    """Length of an entry."""
    fields: dict[str, tuple[int, int]]
    file_type: Optional[int] = None
    """Type of the index file."""


class Report(NamedTuple):
    """A message, and its attributes by role."""

    fields: dict[str, str]
    telecommand: Optional[int] = None
    telemetry: Optional[int] = None


class Facts(NamedTuple):
    """All facts of a node that the wire layer uses."""

    node: str
    order: Literal["little", "big"]
    node_type: Optional[int]
    interface_version: Optional[int]
    longest: int
    """Length of the longest message of either direction, with id and checksum."""
    longest_data: int
    """Length of the longest message of either direction, without id and checksum."""
    telemetry_ids: tuple[int, int]
    """First and last id."""
    settings: Settings
    """Default timeouts and retries of a client."""
    commands: dict[int, Sent]
    frames: dict[int, int]
    """Lengths of telemetry frames by id."""
    TELECOMMANDS: Messages
    TELEMETRY: Messages
    framing: Optional[Framing] = None
    acknowledge_bytes: Optional[int] = None
    """Length of the acknowledge on the UART."""
    i2c_address: Optional[int] = None
    i2c_repeated_start: bool = True
    """Whether a read may follow its write without a stop."""
    can: Optional[Can] = None
    checksums: dict[str, ChecksumAlgorithm] = {}  # noqa: RUF012
    """Checksums by their names in the ICD."""
    checksum: Optional[Checksum] = None
    """Checksum of messages on UART, I2C and CAN."""
    mask: Optional[LogMask] = None
    log_file: Optional[LogFileForm] = None
    log_message: Optional[LogMessageForm] = None
    time: Optional[dict[str, TimePart]] = None
    index_file: Optional[Index] = None
    identification: Optional[Report] = None
    statistics: Optional[Report] = None
    boot_time: Optional[int] = None
    stream: Optional[Stream] = None
    procedures: dict[str, ProcedureForm] = {}  # noqa: RUF012
    """Procedures by their names in the ICD."""
    unsolicited: dict[int, int] = {}  # noqa: RUF012
    """UART: telemetry in an unsolicited message, by the id at its beginning."""
    bus_exchanges: dict[str, BusExchanges] = {}  # noqa: RUF012
    """Responses on UART, I2C and CAN, by bus."""
    assumptions: tuple[Assumption, ...] = ()
    """Facts that the manual does not state, and what the ICD assumes."""


class Link(Facts, Generic[N]):
    """Protocol of a node.

    Type checkers use ``N`` to check that the node has a message.
    """

    __slots__ = ()

    def __repr__(self) -> str:
        return f"Link(node={self.node!r}, ...)"
