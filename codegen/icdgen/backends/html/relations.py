"""Relations within a set of ICDs: nodes that use a message, contained messages, and
places of errata.

Pages link to each other in both directions, so `Relations` goes through the set once.
All other modules of the package get it as an argument.
"""

from __future__ import annotations

from collections import defaultdict

from icdgen.backends.html import texts
from icdgen.backends.html.links import Links
from icdgen.backends.html.wire import Speaker, Wire
from icdgen.backends.packages import Packages
from icdgen.describe import MessageDescription, describe
from icdgen.frozen import NamedTuple
from icdgen.icd.annex import Loggable
from icdgen.icd.erratum import Erratum
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.places import NodePlace
from icdgen.icd.prefixed import with_prefix
from icdgen.icd.units import Unit
from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of


class PageLink(NamedTuple):
    """Name of an object and the link to its page from the top of the site."""

    text: str
    url: str


class Contained(NamedTuple):
    """Containment of messages: ``place``, of ``length`` bytes, contains the other
    message or is contained in it, from bit ``at``.
    """

    place: PageLink
    at: int
    length: int


class Relations:
    """Relations within a set of ICDs, computed once."""

    def __init__(self, icd: Icd, packages: Packages | None = None) -> None:
        self.icd, self.links = icd, Links(icd)
        self.packages = packages or Packages()
        # The prefix changes names in C only, so it is a second ICD.
        self._in_c = with_prefix(icd, self.packages.c_prefix)
        # Nodes that use the messages of a node: itself, and those that include it.
        self.speakers: dict[str, list[Node]] = {}
        for owner in icd.nodes:
            self.speakers[owner.name] = [
                node
                for node in icd.nodes
                if node is owner or owner in icd.included(node)
            ]
        # Fields of an enumeration type
        self.uses: dict[tuple[str, str], list[PageLink]] = defaultdict(list)
        self.units: dict[str, tuple[Unit, list[PageLink]]] = {}  # unit with its fields
        # Places of an erratum by its id and title: files of different nodes can use the
        # same id.
        self.places: dict[tuple[str, str], list[PageLink]] = defaultdict(list)
        self.contained_in: dict[tuple[str, str], list[Contained]] = defaultdict(list)
        self.contains: dict[tuple[str, str], list[Contained]] = defaultdict(list)
        self.logged: dict[tuple[str, str], list[tuple[Node, Loggable]]] = defaultdict(
            list
        )
        self._spoken: dict[str, Speaker] = {}
        for node in icd.nodes:
            self._add_node(node)

    def in_c(self, message: Message) -> MessageDescription:
        """Return the message with the C prefix of its node."""
        name = self.packages.c_prefix + message.node
        message_in_c = next(
            candidate
            for candidate in self._in_c.node(name).messages
            if candidate.name == message.name
        )
        return describe(self._in_c).message(message_in_c)

    def _add_node(self, node: Node) -> None:
        used_messages = {
            message.name: message for message in self.icd.messages_of(node)
        }
        for message in node.messages:
            self._add_errata(
                message.errata, PageLink(message.name, self.links.message(message))
            )
            for name, field in self.shown_fields(message):
                place = PageLink(
                    f"{message.name}: {name}", self.links.field(message, field)
                )
                self._add_errata(field.errata, place)
                if field.enum is not None:
                    self.uses[field.enum.node, field.enum.name].append(place)
                if field.unit is not None:
                    self.units.setdefault(field.unit.identifier, (field.unit, []))[
                        1
                    ].append(place)
            for part in message.contains:
                # ICD046 reports unknown names; an erratum can accept that.
                other = used_messages.get(part.message)
                if other is not None:
                    inner = Contained(self.place(other), part.at, other.length)
                    outer = Contained(self.place(message), part.at, message.length)
                    self.contains[node.name, message.name].append(inner)
                    self.contained_in[other.node, other.name].append(outer)
        for enum in node.enums:
            url = self.links.enum(enum)
            self._add_errata(enum.errata, PageLink(enum.name, url))
            for member in enum.members:
                anchor = self.links.anchor(enum, str(member.value))
                self._add_errata(
                    member.errata,
                    PageLink(f"{enum.name}: {member.name}", f"{url}#{anchor}"),
                )
        # Log masks refer to frames by their telemetry id. Of messages that share an id,
        # the first one stands for all, as on the page of the node.
        by_id: dict[int, Message] = {}
        for message in used_messages.values():
            if message.telemetry_id is not None:
                by_id.setdefault(message.telemetry_id, message)
        for row in node.loggable:
            if row.id in by_id:
                message = by_id[row.id]
                self.logged[message.node, message.name].append((node, row))
            self._add_errata(
                row.errata,
                PageLink(
                    f"Log mask bit {row.bit}", self.links.node(node.name) + "#log-mask"
                ),
            )

    def _add_errata(self, errata: tuple[Erratum, ...], place: PageLink) -> None:
        for erratum in errata:
            self.places[erratum.id, erratum.title].append(place)

    def place(self, message: Message) -> PageLink:
        """Return the message as a link."""
        return PageLink(message.name, self.links.message(message))

    def ids(self, message: Message) -> list[texts.PageId]:
        """Return the ids of a message in the notation of its protocol."""
        return texts.ids(
            message, self._speaker(self.icd.node(message.node)).facts.stream
        )

    def shown_fields(self, message: Message) -> list[tuple[str, NodePlace]]:
        """Return names and fields that the page of a message shows; of some arrays,
        only the first element.
        """
        fields = self.links.repeats(message).fields
        return [(field.name, field.place) for field in fields]

    def wire(self, message: Message) -> Wire:
        """Return the description of the transmission of a message."""
        speakers = [self._speaker(node) for node in self.speakers[message.node]]
        declared = self._speaker(self.icd.node(message.node))
        return Wire(
            *declared, [speaker for speaker in speakers if speaker.facts.checksum]
        )

    def _speaker(self, node: Node) -> Speaker:
        if node.name not in self._spoken:
            node_facts = facts.of(self.icd, node)
            self._spoken[node.name] = Speaker(
                node_facts, self.icd.protocol_of(node), link_of(self.icd, node_facts)
            )
        return self._spoken[node.name]


def manual(node: Node) -> str:
    """Return the manual of a node: ``Some Manual 7.2 (2020-11-03)``."""
    facts = dict(node.document)
    text = " ".join(filter(None, (facts.get("document"), facts.get("version"))))
    return texts.clip(text + (f" ({facts['date']})" if "date" in facts else ""), 200)


def document(node: Node) -> str:
    """Return the manual of a node with section: ``Some Manual 7.2 (2020-11-03), section
    6.3``.
    """
    text, section = manual(node), dict(node.document).get("section", "")
    if section:
        text += f", section {section}" if section[0].isdigit() else f", {section}"
    return texts.clip(text, 400)
