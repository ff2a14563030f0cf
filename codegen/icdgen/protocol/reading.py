"""Reader of the protocol section of a checked ICD, into the classes of
`icdgen.protocol.facts`.

Simple facts are read by their declarations (`icdgen.protocol.declared`). This module
reads lists by role, messages by name, and values that depend on other sections.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, TypeVar

from icdgen.frozen import NamedTuple
from icdgen.icd.buses import (
    BUSES,
    CAN,
    UART,
    BusLink,
    bus_link,
    buses_with,
    can_packets,
)
from icdgen.icd.enumeration import Enum
from icdgen.icd.model import (
    TELECOMMAND,
    TELEMETRY,
    Icd,
    Message,
    Node,
    framed_link,
)
from icdgen.icd.packets import ID_ROLE, declared_packets, value_of
from icdgen.icd.responses import ACK, number_of
from icdgen.icd.variants import ids_of
from icdgen.once import cached_property
from icdgen.protocol.declared import read_part
from icdgen.protocol.exchange import BusExchanges
from icdgen.protocol.framed_links import packet_format_of, stream_of
from icdgen.protocol.packet_formats import PacketFormat, Stream
from icdgen.protocol.procedure_steps import ProcedureReader
from icdgen.protocol.procedures import Procedure
from icdgen.protocol.responding import Sources, bus_exchanges
from icdgen.protocol.sections import (
    CAN_WITH_DATA,
    SECTIONS,
    Can,
    CanPart,
    Checksum,
    ChecksumAlgorithm,
    Crc,
    Extended,
    IdRange,
    Index,
    IndexField,
    LogBit,
    LogFile,
    LogMask,
    LogMessage,
    Report,
    TimePart,
)

T = TypeVar("T")


class Assumption(NamedTuple):
    """Interpretation of an open point of the manual: its place in the ICD, the assumed
    value and the reason.
    """

    section: str  # "link.client", or "message Reset"
    key: str
    value: object
    why: str


class ProtocolReader:
    """Reader of the protocol parts of one node."""

    def __init__(self, icd: Icd, node: Node) -> None:
        self.icd, self.node = icd, node
        self.protocol = icd.protocol_of(node)
        messages = icd.messages_of(node)
        self.messages = {m.name: m for m in messages}
        self.telecommands = {
            m.telecommand_id: m for m in messages if m.telecommand_id is not None
        }
        self.telemetry = {
            m.telemetry_id: m for m in messages if m.telemetry_id is not None
        }

    def section(self, *path: str) -> dict[str, Any]:
        """Return a section, empty if it does not exist."""
        section: object = self.protocol
        for key in path:
            section = section.get(key) if isinstance(section, dict) else None
        return section if isinstance(section, dict) else {}

    def bus(self, *path: str) -> dict[str, Any]:
        """Return the section of a bus, or a section in it; empty if it does not exist."""
        return self.section("link", "buses", *path)

    def part(self, part: type[T], **computed: object) -> T | None:
        """Return a part as declared; None if the ICD does not describe it.

        ``computed``: values that follow from other keys.
        """
        section = self.section(*SECTIONS[part].split("."))
        result: T | None = read_part(part, section, **computed) if section else None
        return result

    def telemetry_ids(self) -> IdRange:
        """Return the range of telemetry ids on buses, which tells replies from
        acknowledges.
        """
        ids = self.section("link", "ids", "telemetry")
        if framed_link(self.protocol):
            # Empty: framed links have no range of ids for telemetry.
            return IdRange(1, 0)
        # Without telemetry the range is empty (first above last), and no received
        # message is a reply.
        return IdRange(
            ids.get("first", min(self.telemetry, default=1)),
            ids.get("last", max(self.telemetry, default=0)),
        )

    @cached_property
    def buses(self) -> dict[str, BusLink]:
        """Packets and responses of the buses that the ICD describes."""
        link = self.section("link")
        return {bus: bus_link(link, bus) for bus in BUSES if self.bus(bus)}

    def acknowledge(self) -> PacketFormat | None:
        """Return the packet that acknowledges telecommands on the UART; None without
        one.
        """
        bus = self.buses.get(UART)
        is_packet = bus and bus.responding(bus.commands.get(ACK))
        return self._sources(bus).formats[0] if bus and is_packet else None

    def bus_exchanges(self, buses: Iterable[str]) -> dict[str, BusExchanges]:
        """Return the exchanges on buses."""
        links = {bus: self.buses[bus] for bus in buses}
        return {
            bus: bus_exchanges(self._sources(link), link) for bus, link in links.items()
        }

    def _sources(self, bus: BusLink) -> Sources:
        """Return the messages and packets that respond on a bus."""
        packets = bus.responses
        return Sources(
            self.node,
            packets,
            tuple(
                packet_format_of(self.node, packets, each, {}) for each in packets.all
            ),
            self.enums,
            {message.name: (id, message) for id, message in self.telemetry.items()},
        )

    def reasons(self, exchanges: Mapping[str, BusExchanges]) -> dict[str, int]:
        """Return the codes of refusals on buses by their causes."""
        commands = (each.command for each in exchanges.values() if each.command)
        responses = [each for command in commands for each in command.responses]
        enum = next((each.enum for each in responses if each.enum), None)
        reasons = self.section("link", "commands", "reasons") if responses else {}
        codes = {cause: number_of(value, enum) for cause, value in reasons.items()}
        # Rule ICD105 reports a value that is no member.
        return {cause: code for cause, code in codes.items() if code is not None}

    @cached_property
    def enums(self) -> dict[str, Enum]:
        """Enumerations of the node and of the nodes that it includes, by name."""
        owners = (*self.icd.included(self.node), self.node)
        return {enum.name: enum for owner in owners for enum in owner.enums}

    def i2c_address(self) -> int | None:
        """Return the 7-bit address.

        The 8-bit form of the ICD has the direction bit appended.
        """
        given = self.bus("i2c", "write")
        eight = given.get("address_8bit")
        # UM10204, 3.1.10: the R/W bit follows the seven bits of the address.
        return given.get("address_7bit", None if eight is None else eight >> 1)

    def i2c_repeated_start(self) -> bool:
        """Return whether a read can follow its write without a stop condition."""
        return "repeated start" in self.bus("i2c").get(
            "telemetry_request", ("repeated start",)
        )

    def can(self) -> Can | None:
        """Return the packets on CAN; None without an identifier or packets."""
        given, bus = self.bus(CAN), self.buses.get(CAN)
        packets = can_packets(bus) if bus else {}
        if bus is None or "identifier" not in given or not packets:
            return None
        # The identifier is listed from its most significant part on.
        parts, shift = {}, sum(part["bits"] for part in given["identifier"])
        for part in given["identifier"]:
            shift -= part["bits"]
            parts[part.get("role", part["name"])] = CanPart(part["bits"], shift)
        segments = {kind: bus.segment_of(packets.get(kind)) for kind in CAN_WITH_DATA}
        return self.part(
            Can,
            parts=parts,
            types={kind: packet.section["type"] for kind, packet in packets.items()},
            extended_types={
                kind: packet.section["type"]
                for kind, packet in segments.items()
                if packet is not None
            },
            extended=self.part(Extended),
        )

    @cached_property
    def checksums(self) -> dict[str, ChecksumAlgorithm]:
        """Checksums of the node by name, in the order of the ICD."""
        declared = self.section("link", "checksums")
        return {name: declared_algorithm(name, each) for name, each in declared.items()}

    def checksum(self) -> Checksum | None:
        """Return the checksum of messages on buses; None without one."""
        link = self.section("link")
        packets = () if framed_link(self.protocol) else declared_packets(link).all
        places = [
            (packet, row)
            for packet in packets
            for row in packet.fields_of_role("checksum")
        ]
        if not places:
            return None
        # Rule ICD175 ensures that all packets have the same.
        _, first = places[0]

        def buses(direction: str, mandatory: bool) -> tuple[str, ...]:
            """Return the buses on which a message may, or must, have a checksum."""
            with_checksum: set[str] = set()
            for packet, row in places:
                is_optional = row.get("optional", False)
                if direction in packet.directions and not (mandatory and is_optional):
                    with_checksum.update(buses_with(packet.section))
            return tuple(bus for bus in BUSES if bus in with_checksum)

        return Checksum(
            algorithm=self.checksums[first["checksum"]],
            covers_id=first["covers"]["from"] == ID_ROLE,
            telecommand_buses=buses(TELECOMMAND, False),
            telemetry_buses=buses(TELEMETRY, False),
            telecommand_always=buses(TELECOMMAND, True),
            telemetry_always=buses(TELEMETRY, True),
            bytes=first["bits"] // 8,
        )

    def stream(self) -> Stream | None:
        """Return the messages of a framed link; None on UART, I2C and CAN."""
        section = framed_link(self.protocol)
        if not section:
            return None
        return stream_of(
            self.node,
            section,
            self.checksums,
            ids_of(self.icd, self.node),
            self.enums,
        )

    def mask(self) -> LogMask | None:
        """Return the log mask with its bits; None if the ICD does not describe it."""
        slot, bits = self.section("log_mask").get("frame_bytes", 0), {}
        # The node's own entries override those of included nodes.
        for node in (*self.icd.included(self.node), self.node):
            for row in node.loggable:
                frame = self.telemetry.get(row.id)
                # A frame longer than its slot is cut to the slot.
                length = min(frame.length, slot) if frame else slot
                bits[row.bit] = LogBit(
                    row.bit, row.id, length, frame.name if frame else row.name or None
                )
        return self.part(LogMask, bits=bits)

    def log_file(self) -> LogFile | None:
        """Return the format of log files; None without a mask or the parts of a time."""
        given = self.section("telemetry_log")
        if not given or not self.section("log_mask"):
            return None
        header, entry = by_role(given["header"]), by_role(given["entry"])
        if "mask" not in header or not {"seconds", "milliseconds"} <= set(entry):
            return None
        spans = {
            role: (entry[role]["byte"], entry[role]["bytes"])
            for role in ("seconds", "milliseconds")
        }
        return self.part(
            LogFile,
            mask_at=header["mask"]["byte"],
            header_bytes=end(given["header"]),
            **spans,
        )

    def log_message(self) -> LogMessage | None:
        rows = by_role(self.section("unsolicited_log").get("message", ()))
        if "mask" not in rows or not self.section("log_mask"):
            return None
        return self.part(LogMessage, mask_at=rows["mask"]["byte"])

    def time(self) -> dict[str, TimePart]:
        return {
            part["name"]: TimePart(
                part["at"], part["bits"], part.get("factor", 1), part.get("offset", 0)
            )
            for part in self.section("msdos_time").get("parts", ())
        }

    def index(self) -> Index | None:
        rows = by_role(self.section("index_file").get("entry", ()))
        fields = {
            role: IndexField(row["byte"], row["bytes"]) for role, row in rows.items()
        }
        return self.part(Index, fields=fields)

    def procedures(self) -> Iterator[Procedure]:
        """Yield the procedures of the node."""
        nodes = {node.name: node for node in self.icd.included(self.node)}
        nodes[self.node.name] = self.node
        for name, section in self.icd.procedures_of(self.node).items():
            reader = ProcedureReader(
                section, nodes, self.messages, self.enums, self.checksums
            )
            yield reader.read_procedure(name)

    def unsolicited(self) -> dict[int, int]:
        """Return the telemetry that the node sends unasked on the UART: the constant that
        heads its packet -> its own id.
        """
        bus = self.buses.get(UART)
        ids: dict[int, int] = {}
        for packet in bus.packets.all if bus else ():
            for name in packet.messages or ():
                constant = value_of(packet.header[0], TELEMETRY, True)
                ids[constant] = self.messages[name].ids[-1]
        return ids

    def report(self, given: dict[str, Any]) -> Report | None:
        message = self.messages.get(given.get("message", ""))
        return Report(message, dict(given.get("fields", {}))) if message else None

    def assumptions(self) -> Iterator[Assumption]:
        protocol = {**self.protocol, "procedures": self.icd.procedures_of(self.node)}
        yield from assumptions_of(protocol, ())
        for message in self.messages.values():
            for key, why in message.assumptions:
                yield Assumption(
                    f"message {message.name}", key, declared_value(message, key), why
                )


def declared_algorithm(name: str, declaration: Mapping[str, Any]) -> ChecksumAlgorithm:
    """Return the algorithm of the checksum that a section declares."""
    # Kinds other than a CRC have only some of the parameters.
    given: dict[str, Any] = {"polynomial": 0, "init": 0, "xor_out": 0}
    given |= {"reflect_in": False, "reflect_out": False, **declaration}
    kind, seeds = given["kind"], given.get("seeds", {})
    return ChecksumAlgorithm(name, kind, read_part(Crc, given), seeds)


def declared_value(message: Message, key: str) -> object:
    """Return the value of a key of a message in the ICD."""
    if key == "acknowledge":
        return "reset" if message.expects_reset else message.acknowledge
    return getattr(message, key, None)


def assumptions_of(
    section: dict[str, Any], path: tuple[str, ...]
) -> Iterator[Assumption]:
    """Return the assumptions of a section, of its subsections, and of the rows of
    lists, which have names of their own.
    """
    for key, why in section.get("assumptions", {}).items():
        yield Assumption(".".join(path), key, section.get(key), why)
    for key, value in section.items():
        if isinstance(value, dict) and key != "assumptions":
            yield from assumptions_of(value, (*path, key))
        for row in value if isinstance(value, list) else ():
            if isinstance(row, dict):
                yield from assumptions_of(row, (*path, *_name_of_row(row)))


def _name_of_row(row: dict[str, Any]) -> tuple[str, ...]:
    """Return the message of a step, or the name of another row, if it has one."""
    names = (row.get(key) for key in ("send", "get", "poll", "receive", "name"))
    name = next((name for name in names if isinstance(name, str)), None)
    if name:
        return (name,)
    # A `map` has several messages.
    return ("map",) if "map" in row else ()


def by_role(rows: Iterable[dict[str, Any]]) -> dict[str, dict[str, Any]]:
    return {row["role"]: row for row in rows if "role" in row}


def end(rows: Iterable[dict[str, Any]]) -> int:
    """Return the byte position after the last row."""
    return max(int(row["byte"] + row["bytes"]) for row in rows)
