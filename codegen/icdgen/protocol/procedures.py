"""Procedures of a node: steps that a client runs one after another, such as a file
transfer.

The steps of an ICD are nested (`icdgen.protocol.procedure_steps` reads them). Here they
are one list, which the engine of each language runs. After a step, the engine continues
with the next step, or with the step at index ``to``. Index ``len(steps)`` ends the
procedure with ``done``. Times are in milliseconds, sizes in bytes.

Registers of 32 bits store the numbers of a procedure. The first registers have a fixed
meaning (`icdgen.icd.procedures.FIXED_NAMES`). The next registers are for inputs that
are numbers, the last for fields of telemetry that later steps use.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from icdgen.frozen import dataclass
from icdgen.icd.enumeration import Enum
from icdgen.icd.model import Message
from icdgen.icd.procedures import FIXED_NAMES
from icdgen.protocol.exchange import NumberPlace
from icdgen.protocol.sections import ChecksumAlgorithm

# Registers with a fixed meaning. `BLOCK_IS_EMPTY` is 1 until a packet of the block has
# been received.
BLOCK_OFFSET, BLOCK_LENGTH, BLOCK_IS_EMPTY, PACKET_NUMBER, PACKET_OFFSET = range(
    len(FIXED_NAMES)
)
# Value of an optional input that is not given: the number of bytes to receive, which is
# smaller.
UNKNOWN = 0xFFFF_FFFF

Result = Literal[
    "done", "refused", "busy", "timeout", "failed", "length", "checksum", "rounds", "limit"
]  # fmt: skip
"""How a procedure ends.

``failed``: the device reports an error. ``length``: a block has another length than
requested. ``checksum`` and ``rounds``: the checksum of a block is wrong, or packets are
missing, after the largest number of rounds. ``limit``: the device exceeds a limit of the
ICD.
"""


@dataclass(frozen=True, slots=True)
class Value:
    """Number that a step uses: a constant, or the content of a register."""

    number: int  # constant, or index of the register
    in_register: bool


@dataclass(frozen=True, slots=True)
class Put:
    """Field of a telecommand that gets a value."""

    place: NumberPlace
    value: Value


@dataclass(frozen=True, slots=True)
class Take:
    """Field of telemetry whose value a register stores."""

    place: NumberPlace
    register: int


@dataclass(frozen=True, slots=True)
class Test:
    """Comparison of a register with a value: whether both are equal."""

    register: int
    value: Value


@dataclass(frozen=True, slots=True)
class Send:
    """Send a telecommand. It must end with ``done`` or ``sent``; otherwise the procedure
    ends with its outcome.
    """

    message: Message
    data: bytes  # of the telecommand, before `puts`
    puts: tuple[Put, ...]
    packet_at: int | None  # where the bytes of the packet stand (`packet.data`)
    repeats: bool  # whether it may be sent again after a time-out
    ignores_timeout: bool  # whether a time-out counts as done


@dataclass(frozen=True, slots=True)
class Get:
    """Request telemetry, and keep some of its fields."""

    message: Message
    takes: tuple[Take, ...]


@dataclass(frozen=True, slots=True)
class Poll:
    """Request telemetry every ``interval``, until all tests hold.

    If a test of ``fails`` holds, the procedure ends with ``failed``; after ``timeout``
    with ``timeout``.
    """

    message: Message
    takes: tuple[Take, ...]
    until: tuple[Test, ...]
    fails: tuple[Test, ...]
    interval: int
    timeout: int


@dataclass(frozen=True, slots=True)
class NextBlock:
    """Begin the next block. Without one, continue at ``to``."""

    to: int


@dataclass(frozen=True, slots=True)
class SetLength:
    """Set the length of the block, which is then at most the requested one."""

    value: Value


@dataclass(frozen=True, slots=True)
class NextRound:
    """Begin a round for the missing packets. Without one, continue at ``to``."""

    to: int


@dataclass(frozen=True, slots=True)
class NextPacket:
    """Select the next missing packet of this round. Without one, continue at ``to``."""

    to: int


# Classes without fields have `eq=False`, because `icdgen.frozen` compares fields.
@dataclass(frozen=True, slots=True, eq=False)
class PacketDone:
    """The packet is no longer missing."""


@dataclass(frozen=True, slots=True, eq=False)
class SendMap:
    """Send the map of received packets, as many messages as the block needs."""


@dataclass(frozen=True, slots=True, eq=False)
class GetMap:
    """Request the map of received packets, as many messages as the block needs."""


@dataclass(frozen=True, slots=True)
class Receive:
    """Receive packets until all are there, or none is new for ``silence``.

    On the buses ``requested_on`` they are requested one by one.
    """

    message: Message
    number: NumberPlace
    data_at: int
    silence: int
    requested_on: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class VerifyChecksum:
    """Compare the checksum of the block, or of the whole input, with a value.

    If it differs, transfer the block again (``again``), or end with ``checksum``.
    """

    algorithm: ChecksumAlgorithm
    of_block: bool
    covers_fill: bool  # whether it covers the fill of the last packet
    value: Value
    again: bool


@dataclass(frozen=True, slots=True)
class Verify:
    """Check that a test holds. Otherwise transfer the block again (``again``), or end
    with ``failed``.
    """

    test: Test
    again: bool


@dataclass(frozen=True, slots=True, eq=False)
class Collect:
    """Add the telemetry to the entries. If it is equal to the last entry, the
    telecommand that advances was lost.
    """


@dataclass(frozen=True, slots=True, eq=False)
class EndIfZeros:
    """End with ``done`` if all bytes of the telemetry are zero."""


@dataclass(frozen=True, slots=True)
class SkipUnless:
    """Continue at ``to`` unless the test holds."""

    test: Test
    to: int


@dataclass(frozen=True, slots=True)
class Jump:
    """Continue at ``to``."""

    to: int


Step = (
    Send | Get | Poll | NextBlock | SetLength | NextRound | NextPacket | PacketDone | SendMap | GetMap | Receive
    | VerifyChecksum | Verify | Collect | EndIfZeros | SkipUnless | Jump
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Input:
    """Input of a procedure."""

    name: str  # as in the ICD
    is_bytes: bool  # bytes to send; otherwise a number in the next register
    is_flag: bool
    enum: Enum | None
    most: int  # largest number, or largest number of bytes
    values: tuple[int, ...]  # the supported values; empty: all
    is_optional: bool  # it may be left out: it is `UNKNOWN`
    summary: str


@dataclass(frozen=True, slots=True)
class Output:
    """Number that a procedure reports: the content of a register at its end."""

    name: str
    register: int
    enum: Enum | None
    is_flag: bool


@dataclass(frozen=True, slots=True)
class PacketMap:
    """Map of the received packets of a block, with one bit for each packet.

    The messages have a telecommand and a telemetry id each, and the same layout.
    """

    messages: tuple[Message, ...]
    at: int  # of the bytes of the map in each message
    bytes: int  # of the map in each message
    msb0: bool  # whether bit 0 is the most significant bit of a byte
    received: bool  # value of the bit of a received packet
    beyond_end: bool  # value of the bits of packets beyond the end of the block


@dataclass(frozen=True, slots=True)
class Blocks:
    """Blocks of the bytes that a procedure sends or receives, and their packets."""

    sends: bool  # the input that has bytes; otherwise the blocks are received
    total: int | None  # register with the number of bytes; None: until a shorter block
    size: int  # largest number of bytes of a block
    begin: int  # index of the first step of each block, where it begins again
    packet_bytes: int
    first_packet: int  # number of the first packet of a block
    fill: int  # value of the bytes after the end of the block
    rounds: int  # largest number of rounds of a block
    most: int  # largest number of bytes in all
    map: PacketMap | None

    @property
    def packets(self) -> int:
        """Largest number of packets of a block."""
        return -(-self.size // self.packet_bytes)


@dataclass(frozen=True, slots=True)
class Effect:
    """Effect of a procedure on the objects of the device, such as files. Simulated
    devices use it; clients do not.

    An object has a kind, and a key of numbers that identifies it within its kind.
    ``fields`` are numbers of the last requested telemetry, which describe an object: a
    number of its key, ``size``, ``time`` or ``checksum``.
    """

    verb: str  # one of `icdgen.icd.procedures.EFFECTS`; "" for none
    kind: str
    key: tuple[int, ...]  # registers of the inputs that are the key
    names: tuple[str, ...]  # of these inputs
    all_if: Test | None = None  # all objects are erased if it holds, or without a key
    to: tuple[int, ...] = ()  # key of the object that a copy becomes
    fields: tuple[tuple[str, NumberPlace], ...] = ()


@dataclass(frozen=True, slots=True)
class Procedure:
    """Procedure of a node."""

    name: str  # as in the ICD, such as `program_copy`
    summary: str
    inputs: tuple[Input, ...]
    outputs: tuple[Output, ...]
    entry: Message | None  # telemetry that `Collect` adds to the entries
    most_entries: int
    blocks: Blocks | None
    register_names: tuple[str, ...]  # as in the ICD; of a field, its own name
    time: int  # longest duration
    requests: int  # largest number of requests
    steps: tuple[Step, ...]
    source: Mapping[str, Any]  # table or section of the manual, as in the ICD
    effect: Effect | None  # None: not described

    @property
    def registers(self) -> int:
        """Number of registers."""
        return len(self.register_names)

    @property
    def first_input(self) -> int:
        """Register of the first input that is a number."""
        return len(FIXED_NAMES)

    @property
    def numbers(self) -> tuple[Input, ...]:
        """Inputs that are numbers, in the order of their registers."""
        return tuple(each for each in self.inputs if not each.is_bytes)

    @property
    def content(self) -> Input | None:
        """Input with the bytes to send; None if the procedure sends none."""
        return next((each for each in self.inputs if each.is_bytes), None)

    @property
    def messages(self) -> tuple[Message, ...]:
        """Messages of the steps, each once."""
        messages = [
            step.message
            for step in self.steps
            if isinstance(step, (Send, Get, Poll, Receive))
        ]
        if self.blocks and self.blocks.map:
            messages += self.blocks.map.messages
        return tuple({message.name: message for message in messages}.values())
