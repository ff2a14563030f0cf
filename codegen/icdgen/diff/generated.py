"""Names and types in generated code, for each language, and their differences between
two ICDs.

The rules of the layer ``source`` and the search for uses in the user's sources need
them. The names come from the same naming policies that the code generators use.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from copy import copy
from functools import cached_property, lru_cache

from icdgen.backends.c import types as c_types
from icdgen.backends.c.symbols import C_NAMES
from icdgen.backends.python import fields as python_fields
from icdgen.backends.python.symbols import PYTHON_NAMES
from icdgen.backends.rust import types as rust_types
from icdgen.backends.rust.symbols import RUST_NAMES
from icdgen.describe import EnumDescription, FieldDescription, describe
from icdgen.describe.description import Composite
from icdgen.describe.named import ModelPart
from icdgen.describe.symbols import NamingPolicy, symbols_of_part
from icdgen.diff.pairs import (
    DeclaredPair,
    EnumPair,
    FieldPair,
    IdentifiedPair,
    Match,
    MemberPair,
    MessagePair,
    Pair,
)
from icdgen.frozen import NamedTuple
from icdgen.icd.identifiers import Identifier
from icdgen.icd.lines import Line
from icdgen.icd.model import Enum, Icd, Member, Message, Struct
from icdgen.icd.places import NodePlace

POLICIES: dict[str, NamingPolicy] = {
    "c": C_NAMES,
    "python": PYTHON_NAMES,
    "rust": RUST_NAMES,
}
"""Names of each language."""

Symbol = tuple[str, Identifier]  # language, and an identifier of it
Declared = Message | Enum
DeclaredPart = Composite[Message] | Composite[Struct] | EnumDescription


class Name(NamedTuple):
    """Generated name.

    ``stem``: second name that a source must mention for an ambiguous name, such as the
    struct of a member.
    """

    language: str
    text: str
    stem: str = ""


class NamesOfIcd:
    """Names of an ICD in generated code, by the parts of the ICD."""

    def __init__(self, icd: Icd) -> None:
        self.description = describe(icd)

    def symbols(self, declared: DeclaredPart) -> Iterator[Symbol]:
        """Yield the identifiers of a message, struct or enumeration, without its fields
        or members.
        """
        for language, policy in POLICIES.items():
            for identifier in symbols_of_part(self.description, declared, policy):
                if identifier.part is declared.model:
                    yield language, identifier

    def names(self, declared: Declared) -> tuple[Name, ...]:
        """Return the names of a message or enumeration, without its fields or members."""
        return _names(self.symbols(self.owner(declared)))

    def names_in_owner(
        self, part: ModelPart, declared: Declared, owner: DeclaredPart | None = None
    ) -> tuple[Name, ...]:
        """Return the names of a field or member that is ``declared`` there; ``owner``
        can be another one.
        """
        here = self.owner(declared)
        owner = here if owner is None else owner
        type_in_rust = RUST_NAMES.symbol(owner, "type")
        return _names(symbols_in(owner, here, part), type_in_rust)

    def owner(self, declared: Declared) -> Composite[Message] | EnumDescription:
        """Return the description of a message or enumeration."""
        description = self.description
        return (
            description.message(declared)
            if isinstance(declared, Message)
            else description.enum(declared)
        )

    def field(self, message: Message, line: Line) -> FieldDescription:
        """Return the description of a field of a message."""
        return self.description.message(message).member_for[id(line.node)]


def symbols_in(
    owner: DeclaredPart, declared: DeclaredPart, part: ModelPart
) -> Iterator[Symbol]:
    """Yield the identifiers that a field or member of ``declared`` has as a part of
    ``owner``.
    """
    for language, policy in POLICIES.items():
        identifiers: list[Identifier] = []
        if isinstance(owner, EnumDescription) and isinstance(declared, EnumDescription):
            for member in declared.members:
                if member.part is part:
                    identifiers += policy.member(owner, member)
        elif isinstance(owner, Composite) and isinstance(declared, Composite):
            identifiers += policy.fields(owner, (declared.member_for[id(part)],))
        for identifier in identifiers:
            if identifier.part is part:
                yield language, identifier


def _names(symbols: Iterable[Symbol], type_in_rust: str = "") -> tuple[Name, ...]:
    """Return the names of the API among identifiers; ``type_in_rust`` is the type of
    the owner of a field or member.
    """
    names: dict[Name, None] = {}
    for language, identifier in symbols:
        text, stem = identifier.text, _stem(language, identifier.scope)
        is_guard = (
            language == "c"
            and text.endswith("_H")
            and isinstance(identifier.part, Message | Enum)
        )
        # File names, include guards and keywords are no names of the API.
        if stem is not None and not is_guard and text.isidentifier():
            names[
                Name(language, text, type_in_rust if language == "rust" else stem)
            ] = None
    return tuple(names)


class Generated:
    """Generated names and types of all pairs.

    To compare the names of a field or member, its owner and its node keep their old
    names: a new name of a message alone is not reported as a new name of its fields.
    """

    def __init__(self, match: Match) -> None:
        self._match = match
        self._old_names_of_nodes = {
            node.new.name: node.old.name for node in match.nodes if node.both
        }

    @cached_property
    def before(self) -> NamesOfIcd:
        return NamesOfIcd(self._match.old)

    @cached_property
    def after(self) -> NamesOfIcd:
        return NamesOfIcd(self._match.new)

    def old(self, pair: Pair) -> tuple[Name, ...]:
        """Return the old names of a pair, without its parts."""
        return self._names(pair, 0)

    def new(self, pair: Pair) -> tuple[Name, ...]:
        """Return the new names of a pair, without its parts."""
        return self._names(pair, 1)

    def _names(self, pair: Pair, side: int) -> tuple[Name, ...]:
        names, part = (self.after, pair.after) if side else (self.before, pair.before)
        if isinstance(part, Message | Enum):
            return names.names(part)
        if (
            isinstance(part, Line | Member)
            and isinstance(pair, FieldPair | MemberPair)
            and not pair.is_of_struct
        ):
            owner = pair.owner.new if side else pair.owner.old
            return names.names_in_owner(_declaration(part), owner)
        return ()

    def renamed(self, pair: IdentifiedPair) -> list[tuple[Name | None, Name | None]]:
        """Return the differing old and new names of the pair, without its parts."""
        old, real_names = self.old(pair), self.new(pair)
        new = self._under_old_owner(pair, real_names)
        if old == new:
            return []
        real = dict(zip(new, real_names, strict=False))
        changes: list[tuple[Name | None, Name | None]] = []
        for key in sorted({_sort(name) for name in (*old, *new)}):
            before, later = (
                [name for name in names if _sort(name) == key] for names in (old, new)
            )
            # Equal numbers of names correspond in order; otherwise names are added or
            # removed.
            if len(before) == len(later):
                changes += [
                    (a, real.get(b, b))
                    for a, b in zip(before, later, strict=True)
                    if a.text != b.text
                ]
            else:
                changes += [(a, None) for a in before if a not in later]
                changes += [(None, real.get(b, b)) for b in later if b not in before]
        return changes

    def _under_old_owner(
        self, pair: IdentifiedPair, names: tuple[Name, ...]
    ) -> tuple[Name, ...]:
        """Return the new ``names`` of a pair as they would be if its owner and its node
        had their old names.
        """
        if isinstance(pair, MessagePair | EnumPair):
            if not self._is_of_renamed_node(pair):
                return names
            old, new = self.before.owner(pair.old), self.after.owner(pair.new)
            return self.old(pair) if old.name == new.name else names
        if not names or not self._has_other_names(pair.owner):
            return names
        owner = self.before.owner(pair.owner.old)
        return self.after.names_in_owner(_declaration(pair.new), pair.owner.new, owner)

    def _is_of_renamed_node(self, pair: DeclaredPair) -> bool:
        """Return whether the new node of a message or enumeration has another name than
        before.
        """
        name = pair.new_node.name
        return (
            not pair.is_of_another_node
            and self._old_names_of_nodes.get(name, name) != name
        )

    def _has_other_names(self, owner: DeclaredPair) -> bool:
        """Return whether a message or enumeration, or its node, was renamed."""
        return owner.both and (is_renamed(owner) or self._is_of_renamed_node(owner))

    def retyped(self, pair: FieldPair) -> list[tuple[str, str, str]]:
        """Return language, old and new type of the raw value for each language where
        they differ. Renamed enumerations and nodes keep their old names.
        """
        # With --unchecked, an ICD may contain fields that backends reject.
        if not _is_sound(pair.old) or not _is_sound(pair.new) or pair.is_of_struct:
            return []
        before = self.before.field(pair.owner.old, pair.old)
        after = copy(self.after.field(pair.owner.new, pair.new))
        enum = (
            None if after.enum is None else self._match.enums.get(id(after.enum.model))
        )
        if enum is not None and self._has_other_names(enum):
            after.enum = self.before.description.enum(enum.old)
        if self._is_of_renamed_node(pair.owner):
            after.message = before.message
        changes = []
        for language in POLICIES:
            old, new = type_of(language, before), type_of(language, after)
            if old != new:
                changes.append((language, old, new))
        return changes


def _declaration(part: Line | Member) -> ModelPart:
    """Return the object of the model that declares a field or member."""
    return part.node if isinstance(part, Line) else part


def type_of(language: str, field: FieldDescription) -> str:
    """Return the type of the raw value of a field in a language."""
    place = field.model
    if place.type == "enum" and field.enum is None:
        return f"u{place.bits}" if language == "rust" else "int"
    if language == "rust":
        return rust_types.raw_type(field)
    if language == "c":
        array = f"[{place.count}]" if place.count else ""
        return (
            f"uint8_t{array}[{place.bits // 8}]"
            if place.is_bytes
            else f"{c_types.type_of(field)}{array}"
        )
    return python_fields.annotation(field).replace("_lazy.", "")


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
        return pair.owner.has_another_vocabulary or _decisive(pair.old) != _decisive(
            pair.new
        )
    if isinstance(pair, MemberPair):
        return pair.owner.has_another_vocabulary
    return pair.is_of_another_node or pair.has_another_vocabulary


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
    conditions = {
        "bool": field.bits == 1,
        "float": field.bits in (32, 64),
        "enum": field.enum is not None,
    }
    return field.bits <= 64 and conditions.get(field.type, True)


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
    return (
        owner.removesuffix("_t").lower()
        if language == "c"
        else owner.rpartition(".")[2]
    )
