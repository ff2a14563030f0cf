"""Paths of all pages relative to the top of the site, and anchors that are stable
between releases.

Names of messages and enumerations determine their paths, and names of fields and
members their anchors. Position or value provide a second anchor. Messages can also be
reached by id on the page of their node.
"""

from __future__ import annotations

from functools import lru_cache
from zlib import crc32

from icdgen.backends.html.repeats import Repeats
from icdgen.icd.erratum import Erratum
from icdgen.icd.model import Enum, Icd, Message, Node
from icdgen.icd.places import NodePlace
from icdgen.icd.units import Unit
from icdgen.naming import snake, words

_LONGEST = 80
# Names of the site's own files, and device names, which Windows reserves with any
# suffix: `con.html` cannot be created there.
_TAKEN = {"index", "protocol", "con", "prn", "aux", "nul"}
_TAKEN.update(f"{port}{number}" for port in ("com", "lpt") for number in range(10))

HOME, ERRATA, UNITS, CHANGES = "index.html", "errata.html", "units.html", "changes.html"


@lru_cache(maxsize=16384)
def slug(text: str, vocabulary: tuple[str, ...]) -> str:
    """Return a name for paths, such as ``estimated_roll_angle``.

    A long name is shortened and gets a checksum.
    """
    # A name without letters and digits has no words.
    name = (
        snake(words(text, vocabulary))
        or f"{crc32(text.encode('utf-8', 'surrogatepass')):08x}"
    )
    # Some file systems limit names to 255 bytes, and paths to 260 characters.
    if len(name) > _LONGEST:
        return f"{name[:_LONGEST]}_{crc32(name.encode()):08x}"
    return f"{name}_" if name in _TAKEN else name


class Links:
    """Paths of a set of ICDs. Equal names of one owner are numbered."""

    def __init__(self, icd: Icd) -> None:
        self._pages: dict[tuple[str, str, str], str] = {}
        self._anchors: dict[int, dict[str, str]] = {}
        self._repeats = {
            id(message): Repeats(message, node)
            for node in icd.nodes
            for message in node.messages
        }
        for node in icd.nodes:
            for message in node.messages:
                self._anchors[id(message)] = _anchors_of_fields(
                    self.repeats(message), node.vocabulary
                )
            self._anchors.update(
                (id(enum), _anchors_of_members(enum, node.vocabulary))
                for enum in node.enums
            )
            self._assign_pages(node, "message", "", node.messages)
            self._assign_pages(node, "enum", "enum-", node.enums)

    def _assign_pages(
        self,
        node: Node,
        kind: str,
        prefix: str,
        things: tuple[Message, ...] | tuple[Enum, ...],
    ) -> None:
        taken: set[str] = set()
        for thing in things:
            name = free_name(
                prefix + slug(thing.identifier or thing.name, node.vocabulary), taken
            )
            self._pages[node.name, kind, thing.name] = f"{node.name}/{name}.html"

    def node(self, name: str) -> str:
        """Return the page of a node: ``demo/index.html``."""
        return f"{name}/index.html"

    def printed(self, name: str) -> str:
        """Return the page with all messages of a node."""
        return f"{name}/all-messages.html"

    def protocol(self, name: str) -> str:
        """Return the page of a node's protocol."""
        return f"{name}/protocol.html"

    def message(self, message: Message) -> str:
        """Return the page of a message: ``demo/estimated_roll.html``."""
        return self._pages[message.node, "message", message.name]

    def enum(self, enum: Enum) -> str:
        """Return the page of an enumeration: ``demo/enum-mode.html``."""
        return self._pages[enum.node, "enum", enum.name]

    def anchor(self, owner: Message | Enum, name: str) -> str:
        """Return the anchor of a field (``field-roll_angle``) or member
        (``member-idle``) in the page of its owner.
        """
        return self._anchors[id(owner)][name]

    def field(self, message: Message, field: NodePlace) -> str:
        """Return the link to a field: ``demo/estimated_roll.html#field-roll_angle``."""
        return f"{self.message(message)}#{self.anchor(message, field.name)}"

    def repeats(self, message: Message) -> Repeats:
        """Return the arrays of a message of which its page shows one element."""
        return self._repeats[id(message)]

    def erratum(self, erratum: Erratum) -> str:
        """Return the link to an erratum: ``errata.html#DEM-001``."""
        return f"{ERRATA}#{erratum.id}"

    def unit(self, unit: Unit) -> str:
        """Return the link to a unit: ``units.html#unit-deg``."""
        return f"{UNITS}#unit-{unit.identifier}"


def _anchors_of_fields(repeats: Repeats, vocabulary: tuple[str, ...]) -> dict[str, str]:
    """Return the anchors of the shown fields by name of the place."""
    taken: set[str] = set()
    return {
        field.place.name: free_name(
            "field-" + slug(field.place.identifier or field.name, vocabulary), taken
        )
        for field in repeats.fields
    }


def _anchors_of_members(enum: Enum, vocabulary: tuple[str, ...]) -> dict[str, str]:
    """Return the anchors by value of the member."""
    taken: set[str] = set()
    return {
        str(m.value): free_name(
            "member-" + slug(m.identifier or m.name, vocabulary), taken
        )
        for m in enum.members
    }


def free_name(name: str, taken: set[str]) -> str:
    """Return the name, numbered if it is taken, and add it to ``taken``."""
    candidate, number = name, 2
    while candidate in taken:
        candidate, number = f"{name}-{number}", number + 1
    taken.add(candidate)
    return candidate
