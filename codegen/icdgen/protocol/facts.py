"""Protocol facts of a node, read from its ICD and from included ICDs, in a form for
generators.

None stands for a part that the ICD does not describe. Times are in milliseconds, sizes
in bytes.
"""

from __future__ import annotations

from typing import TypeVar

from icdgen.frozen import dataclass
from icdgen.icd.buses import CAN, I2C, UART
from icdgen.icd.model import Enum, Icd, Message, Node
from icdgen.icd.node_cache import cached_by_node
from icdgen.protocol.exchange import BusExchanges, Exchange
from icdgen.protocol.packet_formats import PacketFormat, Stream
from icdgen.protocol.procedures import Procedure, VerifyChecksum
from icdgen.protocol.reading import Assumption, ProtocolReader
from icdgen.protocol.sections import (
    SECTIONS,
    Can,
    Checksum,
    ChecksumAlgorithm,
    Framing,
    IdRange,
    Index,
    LogFile,
    LogMask,
    LogMessage,
    Report,
    Settings,
    TimePart,
)

T = TypeVar("T")


class Unsupported(LookupError):
    """ICD does not describe this part of the protocol."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Facts:
    """All facts of the protocol layer of a node."""

    node: Node
    little: bool  # byte order of numbers
    telemetry_ids: IdRange
    telecommands: dict[int, Message]
    telemetry: dict[int, Message]
    client: Settings
    framing: Framing | None
    acknowledge: PacketFormat | None  # on the UART
    i2c_address: int | None
    i2c_repeated_start: bool  # otherwise a read is a separate transaction
    can: Can | None
    bus_exchanges: dict[str, BusExchanges]  # on UART, I2C and CAN; not framed links
    reasons: dict[str, int]  # codes of refusals on buses by cause, such as `checksum`
    checksums: dict[str, ChecksumAlgorithm]  # all, in the order of the ICD
    checksum: Checksum | None  # of messages on UART, I2C and CAN
    mask: LogMask | None
    log_file: LogFile | None
    log_message: LogMessage | None
    time: dict[str, TimePart]
    index: Index | None
    identification: Report | None
    statistics: Report | None
    boot_ms: int | None
    # If present, ids have up to 32 bits and the other parts of the link are None
    stream: Stream | None
    procedures: tuple[Procedure, ...]
    # UART: telemetry that the node sends unasked, by the id that heads it
    unsolicited: dict[int, int]
    assumptions: tuple[Assumption, ...]

    @property
    def checksum_of_files(self) -> ChecksumAlgorithm | None:
        """Checksum of files: the first that the procedures verify; None without one."""
        for procedure in self.procedures:
            for step in procedure.steps:
                if isinstance(step, VerifyChecksum):
                    return step.algorithm
        return None

    @property
    def exchanges(self) -> tuple[Exchange, ...]:
        """Exchanges on all links."""
        exchanges = [*self.stream.exchanges] if self.stream else []
        for on_bus in self.bus_exchanges.values():
            if on_bus.command is not None:
                exchanges.append(on_bus.command)
            exchanges.append(on_bus.request)
        return tuple(exchanges)

    @property
    def reason_enums(self) -> list[Enum]:
        """Enumerations of the reasons of refusals, each once."""
        enums: dict[str, Enum] = {}
        for exchange in self.exchanges:
            for response in exchange.responses:
                if response.enum is not None:
                    enums[response.enum.name] = response.enum
        return list(enums.values())

    @property
    def polled(self) -> Message | None:
        """Telemetry that is polled on I2C for the response to a telecommand."""
        on = self.bus_exchanges.get(I2C)
        poll = on.command.poll if on and on.command else None
        return self.telemetry[poll.telemetry] if poll else None

    @property
    def parts(self) -> dict[str, object]:
        """Described parts with declared facts, by their sections of the ICD."""
        segments = self.can and self.can.extended
        parts = (
            *(self.client, self.framing, self.can, segments, self.checksum),
            *(self.mask, self.log_file, self.log_message, self.index),
        )
        return {SECTIONS[type(part)]: part for part in parts if part is not None}

    @property
    def owners(self) -> list[str]:
        """Names of the nodes that define the messages: the node itself, then included
        nodes.
        """
        messages = (*self.telecommands.values(), *self.telemetry.values())
        nodes = {message.node for message in messages}
        return [self.node.name, *sorted(nodes - {self.node.name})]

    @property
    def longest_telecommand(self) -> int:
        """Bytes of the longest telecommand with its id and checksum."""
        # The leading 1 is the id byte.
        extra = self.checksum.bytes if self.checksum else 0
        longest = max((m.length for m in self.telecommands.values()), default=0)
        return 1 + extra + longest

    @property
    def longest_reply(self) -> int:
        """Bytes of the longest message of the node with its id and checksum."""
        extra = self.checksum.bytes if self.checksum else 0
        # The leading 1 is the id byte.
        sizes = [1 + extra + m.length for m in self.telemetry.values()]
        if self.acknowledge:
            sizes.append(self.acknowledge.overhead)
        # Positions count from the id, and each bit of the mask can select a slot.
        if self.log_message and self.mask:
            sizes.append(
                self.log_message.frames_at + self.mask.size * 8 * self.mask.slot_bytes
            )
        return max(sizes, default=1)

    @property
    def longest_data(self) -> int:
        """Largest number of data bytes of a message in either direction, without id and
        checksum.
        """
        messages = (*self.telecommands.values(), *self.telemetry.values())
        return max((message.length for message in messages), default=0)

    @property
    def longest(self) -> int:
        """Bytes of the longest message in either direction."""
        if self.stream:
            return self.stream.longest
        return max(self.longest_telecommand, self.longest_reply)

    def bytes_of(self, number: int, size: int) -> bytes:
        """Return a number as bytes in the byte order of the node.

        Raises `OverflowError` if it does not fit.
        """
        return number.to_bytes(size, "little" if self.little else "big")


def need(part: T | None, name: str) -> T:
    """Return the part.

    Raises `Unsupported` if the ICD does not describe it.
    """
    if part is None or part == {}:
        raise Unsupported(f"the ICD says nothing about `{name}`")
    return part


@cached_by_node
def of(icd: Icd, node: Node) -> Facts:
    """Return the protocol facts of a node."""
    reader = ProtocolReader(icd, node)
    boot = reader.section("boot").get("bootloader_s")
    framing = reader.part(Framing)
    address, can = reader.i2c_address(), reader.can()
    described = {UART: framing, I2C: address, CAN: can}
    exchanges = reader.bus_exchanges(
        bus for bus, part in described.items() if part is not None
    )
    return Facts(
        node=node,
        little=node.byte_order == "little",
        telemetry_ids=reader.telemetry_ids(),
        telecommands=reader.telecommands,
        telemetry=reader.telemetry,
        client=reader.part(Settings) or Settings(),
        framing=framing,
        acknowledge=reader.acknowledge(),
        i2c_address=address,
        i2c_repeated_start=reader.i2c_repeated_start(),
        can=can,
        bus_exchanges=exchanges,
        reasons=reader.reasons(exchanges),
        checksums=reader.checksums,
        checksum=reader.checksum(),
        mask=reader.mask(),
        log_file=reader.log_file(),
        log_message=reader.log_message(),
        time=reader.time(),
        index=reader.index(),
        identification=reader.report(reader.section("identification")),
        statistics=reader.report(reader.section("statistics")),
        boot_ms=None if boot is None else boot * 1000,
        stream=reader.stream(),
        procedures=tuple(reader.procedures()),
        unsolicited=reader.unsolicited(),
        assumptions=tuple(reader.assumptions()),
    )
