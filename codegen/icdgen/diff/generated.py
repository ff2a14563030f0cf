"""The names and types that generated code has for things, in each language, and how they differ between two ICDs."""

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
    """A generated name. ``stem`` is what a file must mention too where the name means nothing alone: a struct's member."""

    language: str
    text: str
    stem: str = ""


class SourceMarks(Generic[Marked]):
    """Sources for the parts of an ICD that is made to ask for its names, by which it is known what has each of them."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[Map, Marked]] = {}  # by identity, so that each mark must stay

    def of(self, thing: Marked) -> Map:
        """A new mark of a thing."""
        mark = Map(Place(""))
        self._known[id(mark)] = mark, thing
        return mark

    def names(self, icd: Icd, language: str) -> Iterator[tuple[Marked, Identifier]]:
        """What has a mark, and each of the names that code in the language has for it."""
        for identifier in backends.get(language).identifiers(icd):
            if id(identifier.source) in self._known:
                yield self._known[id(identifier.source)][1], identifier


NOTHING, NODES, OWNERS = range(3)  # what is called by its old name
Names = dict[int, tuple[Name, ...]]  # id(pair) -> names


class Generated:
    """Names of the pairs whose names may have changed: all others keep theirs.

    What has an owner is compared as if its message or enumeration, and their node, had kept their old names: a field's names are
    not said to change only because its message has another name.
    """

    def __init__(self, match: Match, changed: Iterable[DeclaredPair]) -> None:
        self._match, self._changed = match, list(changed)

    @cached_property
    def _kept(self) -> set[int]:
        """Everything whose names may have changed, with what it is part of: id(pair)."""
        ids: set[int] = set()
        parts_of = {id(p): [part for part in p.parts if may_rename(part)] if p.both else [] for p in self._changed}
        idle = idle_facts(part for parts in parts_of.values() for part in parts)
        for pair in self._changed:
            parts = [id(part) for part in parts_of[id(pair)] if what_differs(part) not in idle]
            if parts or may_rename(pair):
                ids.update((id(pair), *parts))
        return ids

    @cached_property
    def everything(self) -> Names:
        """Old names of everything in messages and enumerations in which anything differs."""
        return _ReducedIcd(self._match, 0, {id(part) for pair in self._changed for part in (pair, *pair.parts)}).names

    @cached_property
    def _before(self) -> _ReducedIcd:
        return _ReducedIcd(self._match, 0, self._kept)

    @cached_property
    def _after(self) -> _ReducedIcd:
        return _ReducedIcd(self._match, 1, self._kept)

    @cached_property
    def _in_old_nodes(self) -> _ReducedIcd:
        if all(node.old.name == node.new.name for node in self._match.nodes if node.both):
            return self._after
        return _ReducedIcd(self._match, 1, self._kept, NODES)

    @cached_property
    def _under_old_owners(self) -> _ReducedIcd:
        owners: list[DeclaredPair] = [*self._match.messages.values(), *self._match.enums.values()]
        if any(pair.both and is_called_otherwise(pair) for pair in owners):
            return _ReducedIcd(self._match, 1, self._kept, OWNERS)
        return self._in_old_nodes

    @property
    def old(self) -> Names:
        return self._before.names

    @property
    def new(self) -> Names:
        return self._after.names

    def renamed(self, pair: IdentifiedPair) -> list[tuple[Name | None, Name | None]]:
        """Old and new name of everything that is generated for the pair, where they differ. Its parts are left out."""
        after = self._in_old_nodes if isinstance(pair, MessagePair | EnumPair) else self._under_old_owners
        old, new = self.old.get(id(pair), ()), after.names.get(id(pair), ())
        if old == new:
            return []
        real = dict(zip(new, self.new.get(id(pair), ()), strict=False))
        changes: list[tuple[Name | None, Name | None]] = []
        for key in sorted({_sort(name) for name in (*old, *new)}):
            before, later = ([name for name in names if _sort(name) == key] for names in (old, new))
            if len(before) == len(later):
                changes += [(a, real.get(b, b)) for a, b in zip(before, later, strict=True) if a.text != b.text]
            else:
                changes += [(a, None) for a in before if a not in later]
                changes += [(None, real.get(b, b)) for b in later if b not in before]
        return changes

    def retyped(self, pair: FieldPair) -> list[tuple[str, str, str]]:
        """Language, old and new type of the raw value, where they differ."""
        if not _is_sound(pair.old) or not _is_sound(pair.new) or pair.is_of_struct:
            return []
        before, after = self._before, self._under_old_owners
        types = ((language, before.type_of(language, pair), after.type_of(language, pair)) for language in LANGUAGES)
        return [(language, old, new) for language, old, new in types if old != new]


def is_called_otherwise(pair: IdentifiedPair) -> bool:
    """Whether the name or the identifier of what is on both sides differs."""
    return (pair.old.name, pair.old.identifier) != (pair.new.name, pair.new.identifier)


def may_rename(pair: IdentifiedPair) -> bool:
    """Whether anything differs that names or types of the pair itself are made from."""
    if not pair.both or is_called_otherwise(pair):
        return True
    if isinstance(pair, FieldPair):
        return pair.owner.has_another_vocabulary or _decisive(pair.old) != _decisive(pair.new)
    if isinstance(pair, MemberPair):
        return pair.owner.has_another_vocabulary
    return pair.is_of_another_node or pair.has_another_vocabulary


Difference = tuple[object, object, tuple[str, ...]]  # decisive facts of a field, old and new, and how words are split


def what_differs(pair: IdentifiedPair) -> Difference | None:
    """What a field means otherwise, where that is all that its names could change by."""
    if not isinstance(pair, FieldPair) or not pair.both or is_called_otherwise(pair):
        return None
    old, new = pair.old, pair.new
    is_typed_otherwise = (old.type, old.bits, old.count) != (new.type, new.bits, new.count)
    if pair.owner.has_another_vocabulary or old.enum or new.enum or is_typed_otherwise:
        return None
    return _decisive(old), _decisive(new), pair.owner.new_node.vocabulary


def idle_facts(pairs: Iterable[IdentifiedPair]) -> set[Difference]:
    """The differences by which no name changes: each is tried on one field, however many differ by it."""
    samples: dict[Difference, FieldPair] = {}
    for pair in pairs:
        difference = what_differs(pair)
        if difference is not None and isinstance(pair, FieldPair) and _is_sound(pair.old) and _is_sound(pair.new):
            samples.setdefault(difference, pair)
    before, after = (_texts(list(samples.values()), side) for side in (0, 1))
    return {difference for difference, old, new in zip(samples, before, after, strict=True) if old == new}


def _texts(samples: list[FieldPair], side: int) -> list[list[tuple[str, str]]]:
    """The generated names of one side of each sample, by language, all in one message of an ICD of its own."""
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
    """Return a scalar with what a field means, wherever the field stands."""
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
    raw = field.type, field.bits, field.count, field.enum.name if field.enum else None, field.const, bool(field.when)
    return raw, field.unit, field.scale, field.curve, field.special, field.limits


def _is_sound(field: NodePlace) -> bool:
    """Whether a backend can make anything of the field: an ICD that was not checked may hold what none can."""
    if field.is_bytes:
        return field.at % 8 == field.bits % 8 == 0
    wanted = {"bool": field.bits == 1, "float": field.bits in (32, 64), "enum": field.enum is not None}
    return field.bits <= 64 and wanted.get(field.type, True)


class _ReducedIcd:
    """One of both ICDs, with what is to be kept of it; every part has a mark of its own, by which its names are found."""

    def __init__(self, match: Match, side: int, kept: set[int], old_names: int = NOTHING) -> None:
        self.match, self.side, self.kept, self.old_names = match, side, kept, old_names
        self.marks = SourceMarks[IdentifiedPair]()
        self.enums: dict[int, Enum] = {}
        self.messages: dict[int, Message] = {}  # id(pair) -> what it has become
        self.nodes: dict[int, LayoutNode] = {}  # id(pair) -> what its node has become
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
                        self.message(m, names) for m in node.messages if id(match.messages.get(id(m))) in kept
                    ),
                )
                for node, enums in nodes
            )
        )

    def side_of(self, pair: SideBySide[Thing]) -> Thing | None:
        return pair.after if self.side else pair.before

    def name_of(self, pair: NodePair) -> str:
        """The name of a node that is on this side."""
        keeps_its_old_name = not self.side or (self.old_names and pair.before is not None)
        return pair.old.name if keeps_its_old_name else pair.new.name

    def marked(self, thing: Thing, pair: IdentifiedPair | None, **more: Any) -> Thing:
        """The thing with a mark, and under its old name where that is asked for."""
        if pair is not None:
            more["source"] = self.marks.of(pair)
            if self.old_names == OWNERS and pair.before is not None and isinstance(pair, MessagePair | EnumPair):
                more.update(name=pair.old.name, identifier=pair.old.identifier)
        return replace(thing, **more)

    def enum(self, enum: Enum, names: dict[str, str]) -> Enum:
        pair = self.match.enums.get(id(enum))
        members = {id(self.side_of(p)): p for p in pair.parts} if pair is not None else {}
        members_to_keep = [m for m in enum.members if id(m) in members and id(members[id(m)]) in self.kept]
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
        """The layout of a message with the lines that are kept, each with its mark; structs are left out."""
        layout = message.layout
        parts = {id(side.node): part for part in pair.parts if (side := self.side_of(part)) is not None}
        nodes: dict[int, Any] = {}  # id(node) -> what is kept of it
        for place in places_in(layout):
            part = parts.get(id(place.node))
            if part is not None and id(part) in self.kept and place.struct is None and _is_sound(place):
                mark, enum = self.marks.of(part), self.enums.get(id(place.enum), place.enum)
                nodes[id(place.node)] = with_attributes(place.node, source=mark, enum=enum)
                self.nodes[id(part)] = nodes[id(place.node)]
        names = {node.name for node in nodes.values()} | {part.counter for part in layout.parts if part.is_rest}
        fixed = [nodes[id(node)] for node in layout.fixed if id(node) in nodes]
        derived = [nodes[id(node)] for node in layout.derived if id(node) in nodes]
        sequence: tuple[VariableNode, ...] = tuple(nodes[id(node)] for node in layout.sequence if id(node) in nodes)
        length = layout.length
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
        """Those of everything that was kept."""
        names_by_pair: dict[int, dict[Name, None]] = {}
        types: dict[int, str] = {}  # Rust: id(pair) -> name of the type
        for language in LANGUAGES:
            for pair, identifier in self.marks.names(self.icd, language):
                text, stem = identifier.text, _stem(language, identifier.scope)
                owner = pair.owner if isinstance(pair, (FieldPair, MemberPair)) else None
                is_guard = owner is None and language == "c" and text.endswith("_H")  # of a header
                if stem is None or is_guard or not text.isidentifier():
                    continue
                if language == "rust":
                    if owner is None:
                        types.setdefault(id(pair), text)
                    stem = types.get(id(owner), "")
                names_by_pair.setdefault(id(pair), {})[Name(language, text, stem)] = None
        return {key: tuple(names) for key, names in names_by_pair.items()}

    def type_of(self, language: str, pair: FieldPair) -> str:
        """The type of the field's raw value in a language."""
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
    """Return a variable-length node as one of fixed size, at its position in the longest frame."""
    most = size_of(node).most
    if isinstance(node, Scalar):
        return replace(node, at=at, bits=8 * most, length=None)
    return with_attributes(node, at=at, size=most)


def _sort(name: Name) -> tuple[str, bool]:
    """Names of one language, and in C those at file scope, correspond in their order. Members come first: they are short."""
    return name.language, not name.stem


@lru_cache(maxsize=4096)
def _stem(language: str, scope: str) -> str | None:
    """What a file must mention for a member of that scope to be meant; empty for what stands for itself, None for files."""
    if scope.startswith(("modules of", "files of")):
        return None
    if not scope.startswith("members of "):
        return ""
    owner = scope.removeprefix("members of ")
    return owner.removesuffix("_t").lower() if language == "c" else owner.rpartition(".")[2]
