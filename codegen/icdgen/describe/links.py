"""Links of nodes, for all languages: the facts of the protocol section and what follows
from them.

A backend spells the facts in the types of its runtime.
"""

from __future__ import annotations

from collections.abc import Mapping

from icdgen.describe.description import FieldDescription
from icdgen.describe.enums import EnumDescription
from icdgen.describe.nodes import Description
from icdgen.frozen import NamedTuple, dataclass
from icdgen.icd.model import CONFIGURATION, Message
from icdgen.once import cached_property
from icdgen.protocol import facts as protocol_facts
from icdgen.protocol.declared import ProtocolFact
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import Can, Crc, Index, Report, TimePart

# The orders of these tuples are those of the members in the structs of the C runtime,
# which are initialised by position.
CAN_PARTS = ("type", "channel", "source", "destination")
TIME_PARTS = ("year", "month", "day", "hour", "minute", "second")
INDEX_PARTS = ("type", "counter", "checksum", "size", "time", "meta")


class RoleField(NamedTuple):
    """Field with a role in telemetry that a link reads."""

    role: str
    field: FieldDescription


@dataclass(frozen=True, slots=True)
class ReportDescription:
    """Telemetry that a link reads, and its fields with a role there, in the order of the
    ICD.
    """

    message: Message
    places: tuple[RoleField, ...]


class SentMessage(NamedTuple):
    """Message with its id in one direction."""

    id: int
    message: Message

    @property
    def is_setting(self) -> bool:
        """Whether it sets a configuration, which can be read back and so may be sent
        again.
        """
        return self.message.kind == CONFIGURATION


class Assumptions:
    """Assumed facts of a node's protocol, with reasons.

    Each reason is returned once, so that code shows it in one place.
    """

    def __init__(self, facts: Facts) -> None:
        # CRCs of different sections can be equal, so parts are identified by their
        # `id`.
        self._sections = {id(part): section for section, part in facts.parts.items()}
        self._sections |= {
            id(each.crc): each.section for each in facts.checksums.values()
        }
        self._left = {
            (assumption.section, assumption.key): assumption.why
            for assumption in facts.assumptions
        }

    def why(self, section: str, key: str) -> str:
        """Return why the value of a key is assumed; empty if it is not, or if the
        reason was returned before.
        """
        return self._left.pop((section, key), "")

    def why_fact(self, part: object, fact: ProtocolFact) -> str:
        """Return why a declared fact of a part is assumed; empty if it is not."""
        return (
            # An assumption is about a key of the section itself, which is the first
            # part of a dotted key.
            self.why(self._sections[id(part)], fact.key.partition(".")[0])
            if fact.key
            else ""
        )

    def of_part(self, part: object) -> list[tuple[str, str]]:
        """Return key and reason of the other assumptions of the section of a part."""
        return self.of_section(self._sections[id(part)])

    def of_section(self, section: str) -> list[tuple[str, str]]:
        """Return key and reason of the other assumptions of a section."""
        return [
            # `why` removes entries, so the loop runs over a copy.
            (key, self.why(section, key))
            for where, key in [*self._left]
            if where == section
        ]

    def of_section_tree(self, start: str) -> list[tuple[str, str]]:
        """Return path and key, and the reason, of the other assumptions of a section
        and of all sections in it.
        """
        return [
            (f"{section[len(start) + 1 :]} {key}".lstrip(), self.why(section, key))
            for section, key in [*self._left]
            if section == start or section.startswith(f"{start}.")
        ]

    def remaining(self) -> list[tuple[str, str, str]]:
        """Return section, key and reason of all assumptions that were not returned
        before.
        """
        return [
            (section, key, self.why(section, key)) for section, key in [*self._left]
        ]


def byte_table(crc: Crc) -> list[int]:
    """Return the register after each of the 256 bytes if it was 0 before. If bytes
    enter least significant bit first, the register is reflected.
    """
    # The polynomial is without its top term, as in catalogues of CRCs: the bit that
    # leaves the register stands for it.
    top, mask = 1 << crc.width - 1, (1 << crc.width) - 1
    table, register = [0], crc.polynomial
    for _ in range(8):
        # `register` is the entry of the byte 1 << n, and the entry of a ^ b is entry a
        # ^ entry b.
        table += [entry ^ register for entry in table]
        register = register << 1 & mask ^ (crc.polynomial if register & top else 0)
    if crc.reflect_in:
        return [_reflected(table[_reflected(n, 8)], crc.width) for n in range(256)]
    return table


def _reflected(value: int, width: int) -> int:
    """Return a value with its bits in reverse order."""
    return int(f"{value:0{width}b}"[::-1], 2)


def links_of(description: Description) -> dict[str, LinkDescription]:
    """Return the links of all nodes that have one, by the names of the nodes."""
    linked = (node for node in description.nodes if node.is_linked)
    return {
        node.name: LinkDescription(
            description, protocol_facts.of(description.icd, node.model)
        )
        for node in linked
    }


class LinkDescription:
    """Link of a node. ``facts`` come from the protocol section."""

    def __init__(self, description: Description, facts: Facts) -> None:
        self.facts, self._describe = facts, description.message
        self.description = description

    @property
    def telecommands(self) -> list[SentMessage]:
        """Messages by ascending id; empty if the link has packets, whose format lists
        the messages.
        """
        return self._sent(self.facts.telecommands)

    @property
    def telemetry(self) -> list[SentMessage]:
        """Messages by ascending id; empty if the link has packets, whose format lists
        the messages.
        """
        return self._sent(self.facts.telemetry)

    def _sent(self, messages: Mapping[int, Message]) -> list[SentMessage]:
        return (
            []
            if self.facts.stream
            else [SentMessage(id, message) for id, message in sorted(messages.items())]
        )

    @property
    def reasons(self) -> list[int]:
        """Codes that the enumerations of refusals on UART and I2C have."""
        codes: set[int] = set()
        for exchanges in self.facts.bus_exchanges.values():
            for response in exchanges.command.responses if exchanges.command else ():
                codes.update(code for code, _ in response.reasons)
        return sorted(codes)

    @property
    def can(self) -> Can | None:
        """Facts of CAN, if the ICD has all parts of the identifier."""
        can = self.facts.can
        return can if can and set(CAN_PARTS) <= set(can.parts) else None

    @property
    def requested_ids(self) -> frozenset[int]:
        """Ids of the telemetry on a framed link that a client can request."""
        return self.facts.stream.requested_ids if self.facts.stream else frozenset()

    @cached_property
    def reason_enum(self) -> EnumDescription | None:
        """Enumeration of the reasons of refusals.

        None without reasons, or if they are not all of one enumeration without negative
        values: clients compare numbers without sign.
        """
        enums = self.facts.reason_enums
        reasons = self.description.enum(enums[0]) if len(enums) == 1 else None
        return None if reasons is None or reasons.storage.signed else reasons

    @property
    def buses(self) -> list[str]:
        """Buses of the node: ``uart``, ``i2c``, ``can``."""
        facts = {
            "uart": self.facts.framing,
            "i2c": self.facts.i2c_address,
            "can": self.can,
        }
        return [bus for bus, fact in facts.items() if fact is not None]

    @property
    def time(self) -> list[tuple[str, TimePart]]:
        """Parts of a packed time, the year first; empty unless the ICD has all of them."""
        parts = self.facts.time
        return (
            [(name, parts[name]) for name in TIME_PARTS]
            if set(TIME_PARTS) <= set(parts)
            else []
        )

    @property
    def index(self) -> Index | None:
        """Facts of the index file, if the ICD has all fields of an entry."""
        index = self.facts.index
        return index if index and set(INDEX_PARTS) <= set(index.fields) else None

    @property
    def identification(self) -> ReportDescription | None:
        """Frame that identifies the node."""
        return (
            self.report(self.facts.identification)
            if self.facts.identification
            else None
        )

    def report(self, report: Report) -> ReportDescription:
        """Return the description of telemetry that the link reads."""
        message = self._describe(report.message)
        fields = {field.model.name: field for field in message.fields}
        places = tuple(
            RoleField(role, fields[name])
            for role, name in report.fields.items()
            if name in fields
        )
        return ReportDescription(report.message, places)

    @property
    def joined_bytes(self) -> int:
        """Bytes of all packets of the longest message on CAN; 0 if no message has
        several packets.
        """
        extended = self.facts.can and self.facts.can.extended
        return (
            -(-self.facts.longest_data // extended.data_bytes) * extended.data_bytes
            if extended
            else 0
        )

    @property
    def log_entry_bytes(self) -> int:
        """Bytes of the longest entry of a log file; 0 without log files."""
        file, mask = self.facts.log_file, self.facts.mask
        return file.frames_at + mask.size * 8 * mask.slot_bytes if file and mask else 0

    def name_of(self, message: Message) -> str:
        """Return the name of a message in snake case."""
        return self._describe(message).name

    @cached_property
    def always_needed(self) -> list[Message]:
        """Messages that the wire layer requests by itself, whichever messages a program
        uses.
        """
        report = self.facts.identification
        messages = (self.facts.polled, report and report.message)
        return [message for message in messages if message]

    @cached_property
    def in_procedures(self) -> list[Message]:
        """Messages of the procedures, each once."""
        return list(
            {
                message.name: message
                for procedure in self.facts.procedures
                for message in procedure.messages
            }.values()
        )
