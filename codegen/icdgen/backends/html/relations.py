"""What the pages ask about a set of ICDs as a whole: who speaks what, what is contained in what, where an erratum applies."""

from __future__ import annotations

from collections import defaultdict
from typing import NamedTuple

from icdgen.backends.html import texts
from icdgen.backends.html.links import Links
from icdgen.backends.html.wire import Speaker, Wire
from icdgen.backends.packages import Packages
from icdgen.describe import MessageDescription, describe
from icdgen.icd.annex import Loggable
from icdgen.icd.erratum import Erratum
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.places import NodePlace, scalars_in
from icdgen.icd.prefixed import with_prefix
from icdgen.icd.units import Unit
from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of


class Place(NamedTuple):
    """Something with a page: what it is called, and the way there from the top of the site."""

    text: str
    url: str


class Contained(NamedTuple):
    """``place``, of ``length`` bytes, repeats, or is repeated, from bit ``at``."""

    place: Place
    at: int
    length: int


class Relations:
    """Everything is worked out once."""

    def __init__(self, icd: Icd, packages: Packages | None = None) -> None:
        self.icd, self.links = icd, Links(icd)
        self.packages = packages or Packages()
        self._in_c = with_prefix(icd, self.packages.c_prefix)
        self.speakers: dict[str, list[Node]] = {
            one.name: [node for node in icd.nodes if node is one or one in icd.included(node)] for one in icd.nodes
        }
        self.uses: dict[tuple[str, str], list[Place]] = defaultdict(list)  # fields that hold an enumeration
        self.units: dict[str, tuple[Unit, list[Place]]] = {}  # and the fields that have it
        self.places: dict[tuple[str, str], list[Place]] = defaultdict(list)
        self.contained_in: dict[tuple[str, str], list[Contained]] = defaultdict(list)
        self.contains: dict[tuple[str, str], list[Contained]] = defaultdict(list)
        self.logged: dict[tuple[str, str], list[tuple[Node, Loggable]]] = defaultdict(list)
        self._spoken: dict[str, Speaker] = {}
        for node in icd.nodes:
            self._node(node)

    def in_c(self, message: Message) -> MessageDescription:
        """The message with the prefix that its node has in C."""
        name = self.packages.c_prefix + message.node
        found = next(one for one in self._in_c.node(name).messages if one.name == message.name)
        return describe(self._in_c).message(found)

    def _node(self, node: Node) -> None:
        spoken = {message.name: message for message in self.icd.messages_of(node)}
        for message in node.messages:
            self._errata(message.errata, Place(message.name, self.links.message(message)))
            for name, field in self.shown_fields(message):
                place = Place(f"{message.name}: {name}", self.links.field(message, field))
                self._errata(field.errata, place)
                if field.enum is not None:
                    self.uses[field.enum.node, field.enum.name].append(place)
                if field.unit is not None:
                    self.units.setdefault(field.unit.identifier, (field.unit, []))[1].append(place)
            for part in message.contains:
                other = spoken.get(part.message)
                if other is not None:
                    inner = Contained(self.place(other), part.at, other.length)
                    outer = Contained(self.place(message), part.at, message.length)
                    self.contains[node.name, message.name].append(inner)
                    self.contained_in[other.node, other.name].append(outer)
        for enum in node.enums:
            url = self.links.enum(enum)
            self._errata(enum.errata, Place(enum.name, url))
            for member in enum.members:
                anchor = self.links.anchor(enum, str(member.value))
                self._errata(member.errata, Place(f"{enum.name}: {member.name}", f"{url}#{anchor}"))
        by_id = {m.telemetry_id: m for m in spoken.values() if m.telemetry_id is not None}
        for row in node.loggable:
            if row.id in by_id:
                message = by_id[row.id]
                self.logged[message.node, message.name].append((node, row))
            self._errata(row.errata, Place(f"Log mask bit {row.bit}", self.links.node(node.name) + "#log-mask"))

    def _errata(self, errata: tuple[Erratum, ...], place: Place) -> None:
        for erratum in errata:
            self.places[erratum.id, erratum.title].append(place)

    def place(self, message: Message) -> Place:
        """The message, as a link."""
        return Place(message.name, self.links.message(message))

    def shown_fields(self, message: Message) -> list[tuple[str, NodePlace]]:
        """The fields that the page of a message shows, with their names: of some arrays only those of the first element."""
        repeats = self.links.repeats(message)
        named = zip(repeats.names, scalars_in(message.layout), strict=True)
        return [pair for key, pair in enumerate(named, 1) if repeats.is_shown(key)]

    def wire(self, message: Message) -> Wire:
        """How the message travels."""
        spoken = [self._speaker(node) for node in self.speakers[message.node]]
        declared = self._speaker(self.icd.node(message.node))
        return Wire(*declared, [one for one in spoken if one.facts.checksum])

    def _speaker(self, node: Node) -> Speaker:
        if node.name not in self._spoken:
            known = facts.of(self.icd, node)
            self._spoken[node.name] = Speaker(known, self.icd.protocol_of(node), link_of(self.icd, known))
        return self._spoken[node.name]


def manual(node: Node) -> str:
    """``Some Manual 7.2 (2020-11-03)``"""
    facts = dict(node.document)
    text = " ".join(filter(None, (facts.get("document"), facts.get("version"))))
    return texts.clip(text + (f" ({facts['date']})" if "date" in facts else ""), 200)


def document(node: Node) -> str:
    """``Some Manual 7.2 (2020-11-03), section 6.3``"""
    text, section = manual(node), dict(node.document).get("section", "")
    if section:
        text += f", section {section}" if section[0].isdigit() else f", {section}"
    return texts.clip(text, 400)
