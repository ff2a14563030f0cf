"""Symbol table: every identifier that generated code of a language declares, with the
part of the ICD that it names.

The parts of an ICD are the same for all languages, and `symbols` is the only place that
goes through them. A language has a `NamingPolicy`: it names one kind of part in each
method. The rules on names, the comparison of ICDs and the verification package read the
table. Templates look a single name up with `NamingPolicy.symbol`, so they cannot write
a name that the rules do not see.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any
from weakref import WeakKeyDictionary

from icdgen.describe.description import Composite, FieldDescription
from icdgen.describe.enums import EnumDescription, MemberDescription
from icdgen.describe.nodes import Description, MessageDescription, NodeDescription
from icdgen.icd.identifiers import Identifier

Symbols = Iterable[Identifier]
DescribedPart = Composite[Any] | EnumDescription


class NamingPolicy:
    """Names of one language.

    A method yields the identifiers that are declared for one part of the ICD; by
    default none.

    A role distinguishes the identifiers of a part. Only names that templates look up
    need a role.
    """

    reserved: frozenset[str] = frozenset()
    """Words that cannot be identifiers."""

    def __init__(self) -> None:
        # Weak references: a policy lives as long as the program, a description as long
        # as its run.
        self._texts: WeakKeyDictionary[object, dict[str, str]] = WeakKeyDictionary()
        self._of_parts: WeakKeyDictionary[DescribedPart, tuple[Identifier, ...]] = (
            WeakKeyDictionary()
        )
        self.tables: WeakKeyDictionary[Description, tuple[Identifier, ...]] = (
            WeakKeyDictionary()
        )
        """Results of `symbols`: rules and backends use the same table."""

    def fixed(self, description: Description) -> Symbols:
        """Names that are declared for every ICD."""
        return ()

    def node(self, node: NodeDescription) -> Symbols:
        """Names of a node: its file, its types for all messages of a direction, and
        what these types contain.
        """
        return ()

    def in_node(self, node: NodeDescription, part: DescribedPart) -> Symbols:
        """Names of a message, struct or enumeration that are declared again for each
        node that declares or includes it.
        """
        return ()

    def message_of_direction(
        self, node: NodeDescription, direction: str, message: MessageDescription
    ) -> Symbols:
        """Names of a message in the type that has any message of a direction: in C, the
        member ``status`` of the union of ``demo_telemetry_t``.

        Included nodes can declare the message.

        The rules report only the first equal names of two messages. Names in such types
        come last.
        """
        return ()

    def link(self, node: NodeDescription) -> Symbols:
        """Names of the link of a node."""
        return ()

    def enumeration(self, enum: EnumDescription) -> Symbols:
        """Names of an enumeration."""
        return ()

    def member(self, enum: EnumDescription, member: MemberDescription) -> Symbols:
        """Names of a value of an enumeration."""
        return ()

    def composite(self, composite: Composite[Any]) -> Symbols:
        """Names of a message or struct. `fields` has the names of its fields."""
        return ()

    def fields(
        self, composite: Composite[Any], fields: Iterable[FieldDescription]
    ) -> Symbols:
        """Names of fields, overlay fields and derived values: members, getters, setters
        and constants.

        ``composite`` can be another message than that of the fields: the diff compares
        them under the name of an old one.
        """
        return ()

    def of_part(self, part: DescribedPart) -> tuple[Identifier, ...]:
        """Return the names of a message, struct or enumeration, without the names of
        its fields or members.

        Caches the result, because the symbol table and the templates need it.
        """
        names = self._of_parts.get(part)
        if names is None:
            names = self._of_parts[part] = tuple(
                self.enumeration(part)
                if isinstance(part, EnumDescription)
                else self.composite(part)
            )
        return names

    def symbol(
        self, part: NodeDescription | DescribedPart | MemberDescription, role: str
    ) -> str:
        """Return the name of a part in a role.

        Raises `KeyError` if the table has no such name.
        """
        texts = self._texts.get(part)
        if texts is None:
            texts = self._texts[part] = {
                symbol.role: symbol.text
                for symbol in self._symbols_of(part)
                if symbol.role
            }
        return texts[role]

    def _symbols_of(
        self, part: NodeDescription | DescribedPart | MemberDescription
    ) -> Symbols:
        if isinstance(part, NodeDescription):
            return (*self.node(part), *(self.link(part) if part.is_linked else ()))
        if isinstance(part, MemberDescription):
            return self.member(part.enum, part)
        return self.of_part(part)


def symbols(description: Description, policy: NamingPolicy) -> tuple[Identifier, ...]:
    """Return the identifiers of a language in the order of the ICDs, fixed names first."""
    table = policy.tables.get(description)
    if table is None:
        table = policy.tables[description] = tuple(_list_symbols(description, policy))
    return table


def _list_symbols(
    description: Description, policy: NamingPolicy
) -> Iterator[Identifier]:
    yield from policy.fixed(description)
    for node in description.nodes:
        yield from policy.node(node)
        for part in node.usable:
            yield from policy.in_node(node, part)
        for enum in node.enums:
            yield from policy.of_part(enum)
            for member in enum.members:
                yield from policy.member(enum, member)
        if node.is_linked:
            yield from policy.link(node)
        for composite in node.composites:
            yield from policy.of_part(composite)
            yield from policy.fields(composite, composite.declared_members)
        for direction in node.directions:
            for message, _ in direction.messages:
                yield from policy.message_of_direction(node, direction.kind, message)


def symbols_of_part(
    description: Description, part: DescribedPart, policy: NamingPolicy
) -> Iterator[Identifier]:
    """Yield the identifiers of a message, struct or enumeration, without the
    identifiers of its fields or members.
    """
    users = description.users_of(part.node)
    for node in users:
        yield from policy.in_node(node, part)
    yield from policy.of_part(part)
    if isinstance(part, MessageDescription):
        for node in users:
            for direction in part.directions:
                yield from policy.message_of_direction(node, direction, part)
