"""From a line of the ICD to the golden vectors that notice that it is changed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

from icdgen.backends.assurance import changes
from icdgen.backends.assurance.changes import Change
from icdgen.backends.assurance.noticing import MessageWatch
from icdgen.backends.assurance.shared_ids import SharedIds
from icdgen.icd.erratum import Erratum
from icdgen.icd.located import Map
from icdgen.icd.model import Enum, Field, Icd, Member, Message, Node, Struct
from icdgen.vectors.lines import NodeLines, lines
from icdgen.vectors.make import NodeVectors, make
from icdgen.vectors.write import text

Noticed = dict[str, list[int]]
"""Node -> lines of its file of vectors."""


@dataclass(frozen=True, slots=True)
class Traced:
    """A change, and the vectors that notice it."""

    change: Change
    noticed: Noticed


@dataclass(frozen=True, slots=True)
class Element:
    """Something that a line of the ICD describes. ``row`` counts the members of its message or enumeration from 1."""

    kind: str  # "node" | "message" | "struct" | "field" | "enumeration" | "member"
    node: Node
    owner: Message | Struct | Enum | None  # of a field, its message; of a member, its enumeration
    model: Node | Message | Struct | Field | Enum | Member
    row: int | None
    changes: tuple[Traced, ...]

    @property
    def name(self) -> str:
        return self.model.name

    @property
    def part_of(self) -> str:
        """The name of its owner."""
        return self.owner.name if self.owner else ""

    @property
    def source(self) -> Map:
        """What was read of it."""
        source = self.model.source
        return source.get("node", source) if self.kind == "node" else source

    @property
    def errata(self) -> tuple[Erratum, ...]:
        """The decisions and the notes that concern it."""
        return () if self.kind == "node" else self.model.errata

    @property
    def table(self) -> int | None:
        """The manual's table that has it."""
        thing = self.owner or self.model
        return thing.table if isinstance(thing, Message | Struct | Enum) else None

    @property
    def page(self) -> int | None:
        """The manual's page, of a message and its fields, where the ICD says it."""
        thing = self.owner or self.model
        return thing.page if isinstance(thing, Message) else None

    @property
    def noticed(self) -> Noticed:
        """The vectors that notice any of the changes."""
        return together(one.noticed for one in self.changes)


class Trace:
    """That of a set of ICDs, node by node, in the order of the ICDs."""

    def __init__(self, icd: Icd) -> None:
        self.icd = icd
        self._vectors: dict[str, NodeVectors] = {}
        self._lines: dict[str, NodeLines] = {}
        self._watches: dict[tuple[str, str], MessageWatch] = {}
        for node in icd.nodes:
            vectors = self._vectors[node.name] = make(icd, node)
            found = self._lines[node.name] = lines(vectors, text(vectors))
            for one in vectors.messages:
                name = one.message.name
                self._watches[node.name, name] = MessageWatch(node, one, found.messages[name])
        self._shared = SharedIds(icd, self._vectors, self._lines)

    def elements(self, node: Node) -> Iterator[Element]:
        """Those of a node that the ICD has lines for: itself, its enumerations with members, its messages with fields."""
        yield Element("node", node, None, node, None, tuple(self._of_node(node)))
        for enum in node.enums:
            traced = list(self._of_enum(enum))
            yield Element("enumeration", node, None, enum, None, ())
            for row, member in enumerate(enum.members, 1):
                own = tuple(one for one in traced if one.change.source is member.source)
                yield Element("member", node, enum, member, row, own)
        for struct in node.structs:
            yield Element("struct", node, None, struct, None, ())
            for row, field in enumerate(struct.members, 1):
                yield Element("field", node, struct, field, row, tuple(self._of_struct(struct, field, node)))
        for message in node.messages:
            yield Element("message", node, None, message, None, tuple(self._of_message(message, node)))
            watch = self._watches[node.name, message.name]
            place = 0
            for row, field in enumerate(message.members, 1):
                if not field.implied:
                    found = changes.of_field(field, message, node)
                    own = tuple(self._of_member(message, node, watch, place, field, *one) for one in found)
                    yield Element("field", node, message, field, row, own)
                place += len(field.elements)

    def _of_member(
        self, message: Message, node: Node, watch: MessageWatch, place: int, field: Field, change: Change, now: Field
    ) -> Traced:
        fields = (*message.fields[:place], *now.elements, *message.fields[place + len(field.elements) :])
        others = self._shared.of_message(message, replace(message, fields=fields))
        return Traced(change, together([_noticed(node, watch.member(place, field, now)), others]))

    def _of_struct(self, struct: Struct, field: Field, node: Node) -> Iterator[Traced]:
        """The changes of a member of a struct, noticed wherever the struct stands."""
        for change, now in changes.of_field(field, struct, node):
            others = tuple(one for member in struct.members for one in (now if member == field else member).elements)
            changed = replace(struct, fields=others)
            found: list[Noticed] = []
            for watch in self._watches.values():
                fields = changes.with_struct(watch.message.fields, struct, changed)
                if fields is not watch.message.fields:
                    shared = self._shared.of_message(watch.message, replace(watch.message, fields=fields))
                    found += (_noticed(watch.node, watch.struct(fields)), shared)
            yield Traced(change, together(found))

    def _of_node(self, node: Node) -> Iterator[Traced]:
        for change, now in changes.of_node(node):
            if change.kind == "node":
                yield Traced(change, _noticed(node, [self._lines[node.name].head[change.key]]))
            else:
                watches = (self._watches[node.name, message.name] for message in node.messages)
                rows = [line for watch in watches for line in watch.places(watch.message.fields, now)]
                yield Traced(change, together([_noticed(node, rows), self._shared.of_node(node, now)]))

    def _of_enum(self, enum: Enum) -> Iterator[Traced]:
        for change, now in changes.of_enum(enum):
            found = [{enum.node: [self._lines[enum.node].enums[enum.name]]}]
            for watch, index in self._users.get((enum.node, enum.name), ()):
                field = replace(watch.message.fields[index], enum=now)
                found.append(_noticed(watch.node, watch.field(index, field)))
            yield Traced(change, together(found))

    @cached_property
    def _users(self) -> dict[tuple[str, str], list[tuple[MessageWatch, int]]]:
        """By enumeration, each field of it: what watches its message, and which of the fields it is."""
        users: dict[tuple[str, str], list[tuple[MessageWatch, int]]] = {}
        for watch in self._watches.values():
            for index, field in enumerate(watch.message.fields):
                if field.enum is not None:
                    users.setdefault((field.enum.node, field.enum.name), []).append((watch, index))
        return users

    def _of_message(self, message: Message, node: Node) -> Iterator[Traced]:
        watch = self._watches[node.name, message.name]
        for change, now in changes.of_message(message, node):
            if change.kind == "id":
                found = together([self._ids(message, now), _noticed(node, watch.id(change.key))])
            elif change.kind == "length":
                found = _noticed(node, watch.length())
            else:
                found = _noticed(node, watch.places(now.fields, node))
            yield Traced(change, together([found, self._shared.of_message(message, now)]))

    def _ids(self, message: Message, now: Message) -> Noticed:
        """The lists of ids, of each node that speaks the message, in which one is no longer its own."""
        found: Noticed = {}
        for node in self.icd.nodes:
            if all(message is not one for one in self.icd.messages_of(node)):
                continue
            for direction, known in self._vectors[node.name].ids.items():
                mine = {id for id, names in known.items() if message.name in names}
                if mine & (set(message.ids) - set(now.ids)):
                    found.setdefault(node.name, []).append(self._lines[node.name].ids[direction])
        return found


def together(several: Iterator[Noticed] | list[Noticed]) -> Noticed:
    """The lines of all, in order, each once."""
    found: dict[str, set[int]] = {}
    for one in several:
        for node, numbers in one.items():
            found.setdefault(node, set()).update(numbers)
    return {node: sorted(numbers) for node, numbers in found.items() if numbers}


def _noticed(node: Node, numbers: list[int]) -> Noticed:
    return {node.name: sorted(set(numbers))} if numbers else {}
