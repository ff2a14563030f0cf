"""Where everything stands on the site: paths from its top, and anchors that stay the same from release to release.

Messages and enumerations go by the words of their names, fields and members by those and, as a second anchor, by their place or
value; messages can also be reached by id, on the page of their node.
"""

from __future__ import annotations

from functools import lru_cache
from zlib import crc32

from icdgen.backends.html.repeats import Repeats
from icdgen.icd.erratum import Erratum
from icdgen.icd.model import Enum, Icd, Message, Node
from icdgen.icd.places import NodePlace, scalars_in
from icdgen.icd.units import Unit
from icdgen.naming import snake, words

_LONGEST = 80
# Stems that file systems or the site itself keep for themselves.
_TAKEN = {"index", "protocol", "con", "prn", "aux", "nul"}
_TAKEN.update(f"{port}{number}" for port in ("com", "lpt") for number in range(10))

HOME, ERRATA, UNITS, CHANGES = "index.html", "errata.html", "units.html", "changes.html"


@lru_cache(maxsize=16384)
def slug(text: str, vocabulary: tuple[str, ...]) -> str:
    """``estimated_roll_angle``; of what is too long the beginning, told apart by a checksum."""
    name = snake(words(text, vocabulary)) or f"{crc32(text.encode('utf-8', 'surrogatepass')):08x}"
    if len(name) > _LONGEST:
        return f"{name[:_LONGEST]}_{crc32(name.encode()):08x}"
    return f"{name}_" if name in _TAKEN else name


class Links:
    """Paths of a set of ICDs. Equal names below one owner are told apart by a number."""

    def __init__(self, icd: Icd) -> None:
        self._pages: dict[tuple[str, str, str], str] = {}
        self._anchors: dict[int, dict[str, str]] = {}
        self._repeats = {id(message): Repeats(message) for node in icd.nodes for message in node.messages}
        for node in icd.nodes:
            for message in node.messages:
                self._anchors[id(message)] = _anchors_of_fields(message, self.repeats(message), node.vocabulary)
            self._anchors.update((id(enum), _anchors_of_members(enum, node.vocabulary)) for enum in node.enums)
            self._give_out(node, "message", "", node.messages)
            self._give_out(node, "enum", "enum-", node.enums)

    def _give_out(self, node: Node, kind: str, prefix: str, things: tuple[Message, ...] | tuple[Enum, ...]) -> None:
        taken: set[str] = set()
        for thing in things:
            name = _free(prefix + slug(thing.identifier or thing.name, node.vocabulary), taken)
            self._pages[node.name, kind, thing.name] = f"{node.name}/{name}.html"

    def node(self, name: str) -> str:
        """``demo/index.html``"""
        return f"{name}/index.html"

    def printed(self, name: str) -> str:
        """The page that holds a whole node."""
        return f"{name}/all-messages.html"

    def protocol(self, name: str) -> str:
        """The page that says how a node talks."""
        return f"{name}/protocol.html"

    def message(self, message: Message) -> str:
        """``demo/estimated_roll.html``"""
        return self._pages[message.node, "message", message.name]

    def enum(self, enum: Enum) -> str:
        """``demo/enum-mode.html``"""
        return self._pages[enum.node, "enum", enum.name]

    def anchor(self, owner: Message | Enum, name: str) -> str:
        """Anchor of a field (``field-roll_angle``) or a member (``member-idle``) of its owner's page."""
        return self._anchors[id(owner)][name]

    def anchors(self, message: Message) -> list[str]:
        """Anchors of the fields of a message, in their order."""
        return [self.anchor(message, field.name) for field in scalars_in(message.layout)]

    def field(self, message: Message, field: NodePlace) -> str:
        """``demo/estimated_roll.html#field-roll_angle``"""
        return f"{self.message(message)}#{self.anchor(message, field.name)}"

    def repeats(self, message: Message) -> Repeats:
        """The arrays of a message of which its page shows one element."""
        return self._repeats[id(message)]

    def erratum(self, erratum: Erratum) -> str:
        """``errata.html#DEM-001``"""
        return f"{ERRATA}#{erratum.id}"

    def unit(self, unit: Unit) -> str:
        """``units.html#unit-deg``"""
        return f"{UNITS}#unit-{unit.identifier}"


def _anchors_of_fields(message: Message, repeats: Repeats, vocabulary: tuple[str, ...]) -> dict[str, str]:
    """By the name of the field; the fields of further elements have those of the first, where the page shows that alone."""
    taken: set[str] = set()
    found: dict[str, str] = {}
    for field, leader, name in zip(scalars_in(message.layout), repeats.leaders, repeats.names, strict=True):
        first = scalars_in(message.layout)[leader - 1]
        if first is field:
            found[field.name] = _free("field-" + slug(field.identifier or name, vocabulary), taken)
        else:
            found[field.name] = found[first.name]
    return found


def _anchors_of_members(enum: Enum, vocabulary: tuple[str, ...]) -> dict[str, str]:
    """By the value of the member."""
    taken: set[str] = set()
    return {str(m.value): _free("member-" + slug(m.identifier or m.name, vocabulary), taken) for m in enum.members}


def _free(name: str, taken: set[str]) -> str:
    found, number = name, 2
    while found in taken:
        found, number = f"{name}-{number}", number + 1
    taken.add(found)
    return found
