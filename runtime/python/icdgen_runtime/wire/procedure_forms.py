"""Steps of procedures, from the ICD.

After a step, the procedure continues with the next step, or with the step at index
``to``. The index after the last step ends the procedure. Times are in milliseconds,
sizes in bytes.

Registers of 32 bits store the numbers of a procedure. The first registers are
``BLOCK_OFFSET`` to ``PACKET_OFFSET``. The next registers are for inputs that are
numbers, the last for fields of telemetry that steps use.
"""

from __future__ import annotations

from typing import NamedTuple, Optional, Union

from .packet_formats import NumberPlace

BLOCK_OFFSET, BLOCK_LENGTH, BLOCK_IS_EMPTY, PACKET_NUMBER, PACKET_OFFSET = range(5)
FIRST_INPUT = 5
"""Register of the first input that is a number."""
UNKNOWN = 0xFFFFFFFF
"""Value of an optional input that is not given."""


class Value(NamedTuple):
    """A number that a step uses: a constant, or the content of a register."""

    number: int
    """The constant, or the index of the register."""
    in_register: bool

    def of(self, registers: list[int]) -> int:
        """Return the number."""
        return registers[self.number] if self.in_register else self.number


class Put(NamedTuple):
    """A field of a telecommand that gets a value."""

    place: NumberPlace
    value: Value


class Take(NamedTuple):
    """A field of telemetry whose value a register stores."""

    place: NumberPlace
    register: int


class Test(NamedTuple):
    """Comparison of a register with a value."""

    register: int
    value: Value

    def holds(self, registers: list[int]) -> bool:
        """Return whether both are equal."""
        return registers[self.register] == self.value.of(registers)


class Send(NamedTuple):
    """Send a telecommand. It must end with `Done` or `Sent`; otherwise its outcome ends
    the procedure.
    """

    telecommand: int
    data: bytes
    """Data before ``puts``."""
    puts: tuple[Put, ...] = ()
    packet_at: Optional[int] = None
    """Offset of the bytes of the packet; None if it has none."""
    repeats: bool = False
    """Whether it may be sent again after a time-out."""
    ignores_timeout: bool = False
    """Whether a time-out counts as done."""


class Get(NamedTuple):
    """Request telemetry, and keep some of its fields."""

    telemetry: int
    takes: tuple[Take, ...] = ()


class Poll(NamedTuple):
    """Request telemetry every ``interval``, until all tests of ``until`` hold.

    The procedure ends with ``failed`` if a test of ``fails`` holds, and with
    ``timeout`` after ``timeout``.
    """

    telemetry: int
    takes: tuple[Take, ...]
    until: tuple[Test, ...]
    fails: tuple[Test, ...]
    interval: int
    timeout: int


class NextBlock(NamedTuple):
    """Begin the next block. Without one, continue at ``to``."""

    to: int


class SetLength(NamedTuple):
    """Set the length of the block, which is then at most the requested one."""

    value: Value


class NextRound(NamedTuple):
    """Begin a round for the missing packets. Without one, continue at ``to``."""

    to: int


class NextPacket(NamedTuple):
    """Select the next missing packet of the round. Without one, continue at ``to``."""

    to: int


class PacketDone(NamedTuple):
    """The selected packet is no longer missing."""


class SendMap(NamedTuple):
    """Send the map of received packets, as many messages as the block needs."""


class GetMap(NamedTuple):
    """Request the map of received packets, as many messages as the block needs."""


class Receive(NamedTuple):
    """Receive packets until all are there, or none is new for ``silence``."""

    telemetry: int
    number: NumberPlace
    data_at: int
    silence: int
    requested_on: tuple[str, ...] = ()
    """Buses on which the packets are requested one by one."""


class VerifyChecksum(NamedTuple):
    """Compare the checksum of the block, or of the whole input, with a value.

    If they differ, transfer the block again, or end with ``checksum``.
    """

    checksum: str
    """Its name in the checksums of the link."""
    of_block: bool
    covers_fill: bool
    """Whether it covers the fill of the last packet."""
    value: Value
    again: bool


class Verify(NamedTuple):
    """Check that a test holds. Otherwise transfer the block again, or end with
    ``failed``.
    """

    test: Test
    again: bool


class Collect(NamedTuple):
    """Add the telemetry to the entries, unless it is equal to the last entry."""


class EndIfZeros(NamedTuple):
    """End with ``done`` if all bytes of the telemetry are zero."""


class SkipUnless(NamedTuple):
    """Continue at ``to`` unless the test holds."""

    test: Test
    to: int


class Jump(NamedTuple):
    """Continue at ``to``."""

    to: int


ProcedureStep = Union[
    Send,
    Get,
    Poll,
    NextBlock,
    SetLength,
    NextRound,
    NextPacket,
    PacketDone,
    SendMap,
    GetMap,
    Receive,
    VerifyChecksum,
    Verify,
    Collect,
    EndIfZeros,
    SkipUnless,
    Jump,
]


class Input(NamedTuple):
    """An input of a procedure: bytes to send, or a number in the next register."""

    name: str
    is_bytes: bool = False
    most: int = UNKNOWN
    """Largest number, or largest number of bytes."""
    values: tuple[int, ...] = ()
    """Supported numbers; empty if all are supported."""
    is_optional: bool = False


class Output(NamedTuple):
    """A number that a procedure reports: the content of a register at its end."""

    name: str
    register: int


class PacketMap(NamedTuple):
    """Map of the received packets of a block, with one bit for each packet."""

    telecommands: tuple[int, ...]
    """Ids of the messages that send the map."""
    telemetry: tuple[int, ...]
    """Ids of the messages that report the map."""
    length: int
    """Length of each message."""
    at: int
    """Offset of the bytes of the map in each message."""
    bytes: int
    """Bytes of the map in each message."""
    msb0: bool
    """Whether bit 0 is the most significant bit of a byte."""
    received: bool
    """Value of the bit of a received packet."""
    beyond_end: bool
    """Value of the bits of packets beyond the end of the block."""

    def place(self, bit: int) -> tuple[int, int]:
        """Return the byte of a bit in its message, and the mask of the bit."""
        return self.at + (bit >> 3), 0x80 >> bit % 8 if self.msb0 else 1 << bit % 8


class Blocks(NamedTuple):
    """Blocks of the bytes that a procedure sends or receives, and their packets."""

    sends: bool
    """Whether it sends the input that has bytes; otherwise it receives."""
    total: Optional[int]
    """Register with the number of bytes; None if a shorter block is the last."""
    size: int
    """Largest number of bytes of a block."""
    begin: int
    """Index of the first step of each block, where it begins again."""
    packet_bytes: int
    """Bytes of a packet."""
    first_packet: int
    """Number of the first packet of a block."""
    fill: int
    """Value of the bytes of the last packet beyond the end of the block."""
    rounds: int
    """Largest number of rounds of a block."""
    most: int
    """Largest number of bytes in all."""
    map: Optional[PacketMap] = None


class ProcedureForm(NamedTuple):
    """A procedure of a node."""

    inputs: tuple[Input, ...]
    outputs: tuple[Output, ...]
    registers: int
    """Number of registers."""
    time: int
    """Longest duration, in milliseconds."""
    requests: int
    """Largest number of requests."""
    steps: tuple[ProcedureStep, ...]
    blocks: Optional[Blocks] = None
    entry: Optional[int] = None
    """Id of the telemetry that `Collect` adds to the entries."""
    most_entries: int = 0
    """Largest number of entries."""
