"""Names and types in generated code, for each language, and their differences between
two ICDs.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

from icdgen import backends
from icdgen.diagnostics import Place
from icdgen.diff.pairs import (
    DeclaredPair,
    EnumPair,
    FieldPair,
    IdentifiedPair,
    Match,
    MemberPair,
    MessagePair,
    NodePair,
    SideBySide,
    Thing,
)
from icdgen.icd.layout import Layout, LayoutNode, Scalar, VariableNode, size_of
from icdgen.icd.layout_copies import with_attributes
from icdgen.icd.lines import Line
from icdgen.icd.located import Map
from icdgen.icd.model import TELEMETRY, Enum, Icd, Message, Node
from icdgen.icd.places import NodePlace, places_in

if TYPE_CHECKING:
    from icdgen.backends import Identifier

Marked = TypeVar("Marked")
LANGUAGES = ("c", "python", "rust")


class Name(NamedTuple):
    """Generated name.

    ``stem``: second name that a source must mention for an ambiguous name, such as the
    struct of a member.
    """

    language: str
    text: str
    stem: str = ""


class SourceMarks(Generic[Marked]):
    """Source marks for the parts of a synthetic ICD.

    The backend returns each name with its mark, which identifies the part.
    """

    def __init__(self) -> None:
        # By identity: marks must stay alive, so that ids stay unique
        self._parts: dict[int, tuple[Map, Marked]] = {}

    def of(self, thing: Marked) -> Map:
        """Return a new mark for a part."""
        mark = Map(Place(""))
        self._parts[id(mark)] = mark, thing
        return mark

    def names(self, icd: Icd, language: str) -> Iterator[tuple[Marked, Identifier]]:
        """Yield each marked part with each of its names in generated code of a
        language.
        """
        for identifier in backends.get(language).identifiers(icd):
            if id(identifier.source) in self._parts:
                yield self._parts[id(identifier.source)][1], identifier


NOTHING, NODES, OWNERS = range(3)  # which objects keep their old names
Names = dict[int, tuple[Name, ...]]  # id(pair) -> names


class Generated:
    """Generated names of all pairs whose names may have changed.

    To compare the names of a field or member, its owner and its node keep their old
    names: a new name of a message alone is not reported as a new name of its fields.
    """

    def __init__(self, match: Match, changed: Iterable[DeclaredPair]) -> None:
        self._match, self._changed = match, list(changed)

    @cached_property
    def _affected(self) -> set[int]:
        """Identities of all pairs whose names may have changed, and of the parts of
        those pairs.
        """
        ids: set[int] = set()
        parts_of = {id(p): [part for part in p.parts if may_rename(part)] if p.both else [] for p in self._changed}
        idle = differences_without_new_names(part for parts in parts_of.values() for part in parts)
        for pair in self._changed:
            parts = [id(part) for part in parts_of[id(pair)] if difference_in_meaning(part) not in idle]
            if parts or may_rename(pair):
                ids.update((id(pair), *parts))
        return ids

    @cached_property
    def everything(self) -> Names:
        """Old names of all parts of changed messages and enumerations."""
        return _ReducedIcd(self._match, 0, {id(part) for pair in self._changed for part in (pair, *pair.parts)}).names

    @cached_property
    def _before(self) -> _ReducedIcd:
        return _ReducedIcd(self._match, 0, self._affected)

    @cached_property
    def _after(self) -> _ReducedIcd:
        return _ReducedIcd(self._match, 1, self._affected)

    @cached_property
    def _in_old_nodes(self) -> _ReducedIcd:
        if all(node.old.name == node.new.name for node in self._match.nodes if node.both):
            return self._after
        return _ReducedIcd(self._match, 1, self._affected, NODES)

    @cached_property
    def _under_old_owners(self) -> _ReducedIcd:
        owners: list[DeclaredPair] = [*self._match.messages.values(), *self._match.enums.values()]
        if any(pair.both and is_renamed(pair) for pair in owners):
            return _ReducedIcd(self._match, 1, self._affected, OWNERS)
        return self._in_old_nodes

    @property
    def old(self) -> Names:
        return self._before.names

    @property
    def new(self) -> Names:
        return self._after.names

    def renamed(self, pair: IdentifiedPair) -> list[tuple[Name | None, Name | None]]:
        """Return the differing old and new names of the pair, without its parts."""
        after = self._in_old_nodes if isinstance(pair, MessagePair | EnumPair) else self._under_old_owners
        old, new = self.old.get(id(pair), ()), after.names.get(id(pair), ())
        if old == new:
            return []
        real = dict(zip(new, self.new.get(id(pair), ()), strict=False))
        changes: list[tuple[Name | None, Name | None]] = []
        for key in sorted({_sort(name) for name in (*old, *new)}):
            before, later = ([name for name in names if _sort(name) == key] for names in (old, new))
            # Equal numbers of names correspond in order; otherwise names are added or
            # removed.
            if len(before) == len(later):
                changes += [(a, real.get(b, b)) for a, b in zip(before, later, strict=True) if a.text != b.text]
            else:
                changes += [(a, None) for a in before if a not in later]
                changes += [(None, real.get(b, b)) for b in later if b not in before]
        return changes

    def retyped(self, pair: FieldPair) -> list[tuple[str, str, str]]:
        """Return language, old and new type of the raw value for each language where
        they differ.
        """
        # With --unchecked, an ICD may contain fields that backends reject.
        if not _is_sound(pair.old) or not _is_sound(pair.new) or pair.is_of_struct:
            return []
        before, after = self._before, self._under_old_owners
        types = ((language, before.type_of(language, pair), after.type_of(language, pair)) for language in LANGUAGES)
        return [(language, old, new) for language, old, new in types if old != new]


def is_renamed(pair: IdentifiedPair) -> bool:
    """Return whether the name or the identifier of the two sides differs."""
    return (pair.old.name, pair.old.identifier) != (pair.new.name, pair.new.identifier)


def may_rename(pair: IdentifiedPair) -> bool:
    """Return whether anything differs that determines names or types of the pair
    itself.
    """
    if not pair.both or is_renamed(pair):
        return True
    if isinstance(pair, FieldPair):
        return pair.owner.has_another_vocabulary or _decisive(pair.old) != _decisive(pair.new)
    if isinstance(pair, MemberPair):
        return pair.owner.has_another_vocabulary
    return pair.is_of_another_node or pair.has_another_vocabulary


# Relevant attributes of a field, old and new, and the vocabulary
Difference = tuple[object, object, tuple[str, ...]]


def difference_in_meaning(pair: IdentifiedPair) -> Difference | None:
    """Return the difference in meaning of a field, if its names depend on no other
    change; None otherwise.
    """
    if not isinstance(pair, FieldPair) or not pair.both or is_renamed(pair):
        return None
    old, new = pair.old, pair.new
    is_typed_otherwise = (old.type, old.bits, old.count) != (new.type, new.bits, new.count)
    if pair.owner.has_another_vocabulary or old.enum or new.enum or is_typed_otherwise:
        return None
    return _decisive(old), _decisive(new), pair.owner.new_node.vocabulary


def differences_without_new_names(pairs: Iterable[IdentifiedPair]) -> set[Difference]:
    """Return the differences that change no name.

    Each difference is tested with one field, so that many equal changes take no extra
    time.
    """
    samples: dict[Difference, FieldPair] = {}
    for pair in pairs:
        difference = difference_in_meaning(pair)
        if difference is not None and isinstance(pair, FieldPair) and _is_sound(pair.old) and _is_sound(pair.new):
            samples.setdefault(difference, pair)
    before, after = (_texts(list(samples.values()), side) for side in (0, 1))
    return {difference for difference, old, new in zip(samples, before, after, strict=True) if old == new}


def _texts(samples: list[FieldPair], side: int) -> list[list[tuple[str, str]]]:
    """Return the generated names of one side of each sample, with their language, from
    a synthetic ICD with one message.
    """
    marks = SourceMarks[list[tuple[str, str]]]()
    texts_of_samples: list[list[tuple[str, str]]] = [[] for _ in samples]
    fields = [
        _sample(pair.new if side else pair.old, f"Sample {number}", marks.of(texts_of_samples[number]))
        for number, pair in enumerate(samples)
    ]
    for vocabulary in dict.fromkeys(pair.owner.new_node.vocabulary for pair in samples):
        own = (f for f, pair in zip(fields, samples, strict=True) if pair.owner.new_node.vocabulary == vocabulary)
        message = Message("Samples", TELEMETRY, Layout("Samples", 0, tuple(own)), node="samples")
        icd = Icd((Node("samples", "", "", "little", "lsb0", (message,), (), vocabulary=vocabulary),))
        for language in LANGUAGES:
            for texts, identifier in marks.names(icd, language):
                texts.append((language, identifier.text))
    return texts_of_samples


def _sample(line: Line, name: str, source: Map) -> Scalar:
    """Return a scalar with the attributes of a field, independent of its position in a
    struct.
    """
    return replace(
        line.scalar,
        name=name,
        identifier=None,
        at=line.at,
        bits=line.bits,
        length=None,
        orders=line.declared_orders,
        source=source,
    )


def _decisive(field: Line) -> object:
    raw = (
        field.type,
        field.bits,
        field.count,
        field.enum.name if field.enum else None,
        field.const,
        bool(field.conditions),
    )
    return raw, field.unit, field.scale, field.curve, field.special, field.limits


def _is_sound(field: NodePlace) -> bool:
    """Return whether backends accept the field.

    An unchecked ICD can contain fields that they do not support.
    """
    if field.is_bytes:
        return field.at % 8 == field.bits % 8 == 0
    conditions = {"bool": field.bits == 1, "float": field.bits in (32, 64), "enum": field.enum is not None}
    return field.bits <= 64 and conditions.get(field.type, True)


class _ReducedIcd:
    """Copy of one ICD, reduced to the affected pairs.

    Marks in the copy identify the names of each part.
    """

    def __init__(self, match: Match, side: int, affected: set[int], old_names: int = NOTHING) -> None:
        self.match, self.side, self.affected, self.old_names = match, side, affected, old_names
        self.marks = SourceMarks[IdentifiedPair]()
        self.enums: dict[int, Enum] = {}
        self.messages: dict[int, Message] = {}  # id(pair) -> message of the copy
        self.nodes: dict[int, LayoutNode] = {}  # id(pair) -> layout node of the copy
        icd = match.new if side else match.old
        names = {node.name: self.name_of(pair) for pair in match.nodes if (node := self.side_of(pair)) is not None}
        nodes = [(node, tuple(self.enum(enum, names) for enum in node.enums)) for node in icd.nodes]
        self.icd = Icd(
            tuple(
                replace(
                    node,
                    name=names.get(node.name, node.name),
                    includes=tuple(names.get(name, name) for name in node.includes),
                    enums=enums,
                    messages=tuple(
                        self.message(m, names) for m in node.messages if id(match.messages.get(id(m))) in affected
                    ),
                )
                for node, enums in nodes
            )
        )

    def side_of(self, pair: SideBySide[Thing]) -> Thing | None:
        return pair.after if self.side else pair.before

    def name_of(self, pair: NodePair) -> str:
        """Return the name of a node that exists on this side."""
        keeps_its_old_name = not self.side or (self.old_names and pair.before is not None)
        return pair.old.name if keeps_its_old_name else pair.new.name

    def marked(self, thing: Thing, pair: IdentifiedPair | None, **more: Any) -> Thing:
        """Return a copy of a part with a mark, and with its old name if required."""
        if pair is not None:
            more["source"] = self.marks.of(pair)
            if self.old_names == OWNERS and pair.before is not None and isinstance(pair, MessagePair | EnumPair):
                more.update(name=pair.old.name, identifier=pair.old.identifier)
        return replace(thing, **more)

    def enum(self, enum: Enum, names: dict[str, str]) -> Enum:
        pair = self.match.enums.get(id(enum))
        members = {id(self.side_of(p)): p for p in pair.parts} if pair is not None else {}
        members_to_keep = [m for m in enum.members if id(m) in members and id(members[id(m)]) in self.affected]
        own = tuple(self.marked(m, members[id(m)]) for m in members_to_keep)
        marked_enum = self.marked(enum, pair, members=own, node=names.get(enum.node, enum.node))
        self.enums[id(enum)] = marked_enum
        return marked_enum

    def message(self, message: Message, names: dict[str, str]) -> Message:
        pair = self.match.messages[id(message)]
        layout = self.layout(message, pair)
        marked_message: Message = self.marked(message, pair, layout=layout, node=names.get(message.node, message.node))
        self.messages[id(pair)] = marked_message
        return marked_message

    def layout(self, message: Message, pair: MessagePair) -> Layout:
        """Return the layout of a message with the affected lines, each with a mark,
        without structs.
        """
        layout = message.layout
        parts = {id(side.node): part for part in pair.parts if (side := self.side_of(part)) is not None}
        nodes: dict[int, Any] = {}  # id(node) -> node of the copy
        for place in places_in(layout):
            part = parts.get(id(place.node))
            if part is not None and id(part) in self.affected and place.struct is None and _is_sound(place):
                mark, enum = self.marks.of(part), self.enums.get(id(place.enum), place.enum)
                nodes[id(place.node)] = with_attributes(place.node, source=mark, enum=enum)
                self.nodes[id(part)] = nodes[id(place.node)]
        names = {node.name for node in nodes.values()} | {part.counter for part in layout.parts if part.is_rest}
        fixed = [nodes[id(node)] for node in layout.fixed if id(node) in nodes]
        derived = [nodes[id(node)] for node in layout.derived if id(node) in nodes]
        sequence: tuple[VariableNode, ...] = tuple(nodes[id(node)] for node in layout.sequence if id(node) in nodes)
        length = layout.length
        # A counter that is unaffected is not part of the copy; then the part has a
        # fixed size.
        if any(part.name not in names or part.counter not in names for part in layout.parts):
            begins = {part.name: part.begin for part in layout.parts}
            fixed += [_of_full_size(node, 8 * begins[node.name]) for node in sequence]
            sequence, length = (), layout.longest
        return replace(
            layout,
            length=length,
            fixed=tuple(fixed),
            sequence=sequence,
            derived=tuple(value for value in derived if names.issuperset(value.derivation.fields)),
        )

    @cached_property
    def names(self) -> Names:
        """Names of all affected pairs."""
        names_by_pair: dict[int, dict[Name, None]] = {}
        types: dict[int, str] = {}  # Rust: id(pair) -> name of the type
        for language in LANGUAGES:
            for pair, identifier in self.marks.names(self.icd, language):
                text, stem = identifier.text, _stem(language, identifier.scope)
                owner = pair.owner if isinstance(pair, (FieldPair, MemberPair)) else None
                # Of a header
                is_guard = owner is None and language == "c" and text.endswith("_H")
                # File names, include guards and keywords are no names of the API.
                if stem is None or is_guard or not text.isidentifier():
                    continue
                if language == "rust":
                    if owner is None:
                        types.setdefault(id(pair), text)
                    stem = types.get(id(owner), "")
                names_by_pair.setdefault(id(pair), {})[Name(language, text, stem)] = None
        return {key: tuple(names) for key, names in names_by_pair.items()}

    def type_of(self, language: str, pair: FieldPair) -> str:
        """Return the type of the raw value of a field in a language."""
        from icdgen.backends.c import types as c
        from icdgen.backends.python import fields as python
        from icdgen.backends.rust import names as rust
        from icdgen.describe import describe

        message, node = self.messages[id(pair.owner)], self.nodes[id(pair)]
        field = next(place for place in places_in(message.layout) if place.node.source is node.source)
        if field.type == "enum" and field.enum is None:
            return f"u{field.bits}" if language == "rust" else "int"
        members = describe(self.icd).message(message).declared_members
        member = next(member for member in members if member.model.source is node.source)
        if language == "rust":
            return rust.raw_type(member)
        if language == "c":
            array = f"[{field.count}]" if field.count else ""
            return f"uint8_t{array}[{field.bits // 8}]" if field.is_bytes else f"{c.type_of(member)}{array}"
        return python.annotation(member).replace("_lazy.", "")


def _of_full_size(node: VariableNode, at: int) -> VariableNode:
    """Return a variable-length node as a node of fixed size, at its position in the
    longest frame.
    """
    most = size_of(node).most
    if isinstance(node, Scalar):
        return replace(node, at=at, bits=8 * most, length=None)
    return with_attributes(node, at=at, size=most)


def _sort(name: Name) -> tuple[str, bool]:
    """Return a key by which names of both sides correspond: language and, in C, file
    scope. Struct members come first.
    """
    return name.language, not name.stem


@lru_cache(maxsize=4096)
def _stem(language: str, scope: str) -> str | None:
    """Return the name that a source must mention if it uses a member of the scope.

    Empty for names that are unique on their own; None for files.
    """
    if scope.startswith(("modules of", "files of")):
        return None
    if not scope.startswith("members of "):
        return ""
    owner = scope.removeprefix("members of ")
    return owner.removesuffix("_t").lower() if language == "c" else owner.rpartition(".")[2]
