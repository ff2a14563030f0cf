"""How the messages of a node travel, in no language: what its protocol facts come to in the code that is made of them.

`LinkDescription` holds the facts and what follows from them; a backend spells each in the types of its runtime.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from icdgen.describe.description import FieldDescription
from icdgen.describe.nodes import Description
from icdgen.frozen import dataclass
from icdgen.icd.model import CONFIGURATION, Message
from icdgen.once import cached_property
from icdgen.protocol import facts as protocol_facts
from icdgen.protocol.declared import Fact
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import Can, Crc, Index, Step, TimePart

ROLES = frozenset(
    "all block_size busy bytes checksum counter destination error id ignore_hole_map interface_version length node_type number "
    "offset parameter processed program ready size time type".split()
)
"""Roles of fields in procedures that the runtimes support."""

REASONS = ("none", "unknown_id", "length", "parameter", "checksum")
"""Meanings of error codes that the runtimes support."""

CAN_PARTS = ("type", "channel", "source", "destination")
TIME_PARTS = ("year", "month", "day", "hour", "minute", "second")
INDEX_PARTS = ("type", "counter", "checksum", "size", "time", "meta")


class Place(NamedTuple):
    """The field that plays a role in a procedure."""

    role: str
    field: FieldDescription


@dataclass(frozen=True, slots=True)
class StepDescription:
    """A message that plays a part in a procedure, and its fields that have a role there, in the order of the ICD."""

    message: Message
    fields: tuple[Place, ...]
    initial_frame: bytes  # the frame before values are put into it

    @property
    def places(self) -> list[Place]:
        """The fields with one of `ROLES`."""
        return [one for one in self.fields if one.role in ROLES]


class SentMessage(NamedTuple):
    """A message under its id in one direction."""

    id: int
    message: Message

    @property
    def is_setting(self) -> bool:
        """Whether it sets what can be got back, so that it may be sent again."""
        return self.message.kind == CONFIGURATION


class Assumptions:
    """What is assumed of a node's protocol and why. Each is given once: to what it holds of, or with the rest."""

    def __init__(self, facts: Facts) -> None:
        self._untold = {(one.section, one.key): one.why for one in facts.assumptions}

    def why(self, section: str, key: str) -> str:
        """Why a key is assumed; empty if it is not."""
        return self._untold.pop((section, key), "")

    def why_fact(self, section: str, fact: Fact) -> str:
        """Why a declared fact is assumed; empty if it is not."""
        return self.why(section, fact.key.partition(".")[0]) if fact.key else ""

    def of_section(self, section: str) -> list[tuple[str, str]]:
        """Key and reason of what else is assumed in a section."""
        return [(key, self.why(section, key)) for where, key in [*self._untold] if where == section]

    def others(self) -> list[tuple[str, str, str]]:
        """Section, key and reason of all that is not told."""
        return [(section, key, self.why(section, key)) for section, key in [*self._untold]]


def byte_table(crc: Crc) -> list[int]:
    """Return the register after each of the 256 bytes, most significant bit first, if it was 0 before."""
    top, mask = 1 << crc.width - 1, (1 << crc.width) - 1
    table = []
    for byte in range(256):
        register = 0
        for position in reversed(range(8)):
            is_odd = bool(register & top) != bool(byte >> position & 1)
            register = register << 1 & mask ^ (crc.polynomial if is_odd else 0)
        table.append(register)
    return table


def links_of(description: Description) -> dict[str, LinkDescription]:
    """The links of the nodes of which it is known how their messages travel, by the names of the nodes."""
    linked = (node for node in description.nodes if node.is_linked)
    return {one.name: LinkDescription(description, protocol_facts.of(description.icd, one.model)) for one in linked}


class LinkDescription:
    """How the messages of a node travel; ``facts`` is what its ICD says."""

    def __init__(self, description: Description, facts: Facts) -> None:
        self.facts, self._describe = facts, description.message

    @property
    def telecommands(self) -> list[SentMessage]:
        """By rising id; none where the envelope of the link tells them."""
        return self._sent(self.facts.telecommands)

    @property
    def telemetry(self) -> list[SentMessage]:
        """By rising id; none where the envelope of the link tells them."""
        return self._sent(self.facts.telemetry)

    def _sent(self, messages: Mapping[int, Message]) -> list[SentMessage]:
        return [] if self.facts.stream else [SentMessage(id, one) for id, one in sorted(messages.items())]

    @property
    def error_codes(self) -> list[tuple[str, int]]:
        """What codes mean, of `REASONS`, and the codes."""
        return [(reason, code) for reason, code in self.facts.errors.items() if reason in REASONS]

    @property
    def can(self) -> Can | None:
        """CAN, if all parts of the identifier are known."""
        can = self.facts.can
        return can if can and set(CAN_PARTS) <= set(can.parts) else None

    @property
    def time(self) -> list[tuple[str, TimePart]]:
        """The parts of a packed time, largest first; none unless all are known."""
        known = self.facts.time
        return [(name, known[name]) for name in TIME_PARTS] if set(TIME_PARTS) <= set(known) else []

    @property
    def index(self) -> Index | None:
        """The index file, if all fields of an entry are known."""
        index = self.facts.index
        return index if index and set(INDEX_PARTS) <= set(index.fields) else None

    @property
    def map_pieces(self) -> list[FieldDescription]:
        """The fields that carry the pieces of the hole map, each of its message."""
        form = self.facts.hole_map
        fields = [field for one in form.messages for field in self._describe(one).fields] if form else []
        return [field for field in fields if form and field.model.name == form.field]

    @cached_property
    def polled(self) -> StepDescription | None:
        """The frame that tells what became of a telecommand; it has the roles id, processed, error and parameter."""
        one = self.facts.polled
        names = ("id", "processed", "error", "parameter")
        return self.step(Step(one.message, {name: getattr(one, name) for name in names})) if one else None

    @property
    def identification(self) -> StepDescription | None:
        """The frame that identifies the node."""
        return self.step(self.facts.identification) if self.facts.identification else None

    def step(self, step: Step) -> StepDescription:
        """A message that plays a part in a procedure."""
        message = self._describe(step.message)
        fields = {field.model.name: field for field in message.fields}
        found = tuple(Place(role, fields[name]) for role, name in step.fields.items() if name in fields)
        return StepDescription(step.message, found, step.frame(message.node))

    @property
    def joined_bytes(self) -> int:
        """Bytes of all packets of the longest message on CAN; 0 if no message has several."""
        extended = self.facts.can and self.facts.can.extended
        return -(-self.facts.longest_data // extended.data_bytes) * extended.data_bytes if extended else 0

    @property
    def log_entry_bytes(self) -> int:
        """Bytes of the longest entry of a log file; 0 if it has none."""
        file, mask = self.facts.log_file, self.facts.mask
        return file.frames_at + mask.size * 8 * mask.slot_bytes if file and mask else 0

    @property
    def longest_step(self) -> int:
        """Bytes of the longest message that takes part in a procedure."""
        return max((message.length for message in self.in_procedures), default=0)

    def name_of(self, message: Message) -> str:
        """What it is called in names of code."""
        return self._describe(message).name

    @cached_property
    def always_needed(self) -> list[Message]:
        """The messages that the wire layer asks for by itself, whatever a program does."""
        return [step.message for step in (self.polled, self.identification) if step]

    @cached_property
    def in_procedures(self) -> list[Message]:
        """The messages that take part in the transfer of files and programs."""
        facts = self.facts
        steps = list(facts.files.steps.values()) if facts.files else []
        for operation in filter(None, (facts.program_copy, facts.program_information)):
            steps += [operation.request, operation.progress]
        return [step.message for step in steps] + list(facts.hole_map.messages if facts.hole_map else ())
