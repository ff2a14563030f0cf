"""Names and values that must be unique.

The rules compare messages, fields, enumerations and their members, aliases, nodes and
units (ICD050 to ICD054, ICD057, ICD058, ICD074). Names of messages, enumerations and
units must be unique in a node with all nodes that it includes; `brings_together`
decides which node reports a clash. `structs` and `ids` have the rules of structs and
ids.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from typing import TypeAlias, TypeVar

from icdgen import naming
from icdgen.diagnostics import Related
from icdgen.icd.fault import Fault
from icdgen.icd.layout import LayoutNode
from icdgen.icd.located import Map
from icdgen.icd.model import Enum, Member, Message, Node, Struct
from icdgen.icd.places import NodePlace, places_in, scalars_in
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import line_of
from icdgen.icd.trees import mappings
from icdgen.icd.units import STANDARD
from icdgen.wording import quote

T = TypeVar("T")
Aliased: TypeAlias = Message | LayoutNode | Enum | Member | Struct
PRINTED_TWICE = (
    "rename one, or remove it if it is a copy of the other; if the manual gives two messages or fields this name, rename "
    "one in the errata file"
)


def _twice(items: Iterable[T], key: Callable[[T], Hashable]) -> Iterator[tuple[T, T]]:
    """Yield (first, later) for every item whose key an earlier item has."""
    seen: dict[Hashable, T] = {}
    for item in items:
        value = key(item)
        if value in seen:
            yield seen[value], item
        else:
            seen[value] = item


def in_scope(
    ctx: Context, node: Node, items: Callable[[Node], Iterable[T]]
) -> list[tuple[Node, T]]:
    """Return the items of a node and of its included nodes, each with the node that
    declares it.
    """
    return [(owner, item) for owner in ctx.scope(node) for item in items(owner)]


def included_with_both(
    ctx: Context, node: Node, first: Node, second: Node
) -> list[Node]:
    """Return the nodes that ``node`` includes and that have both in their scope. They
    report a clash of the two themselves.
    """
    return [
        other
        for other in ctx.scope(node)
        if other is not node
        and first in ctx.scope(other)
        and second in ctx.scope(other)
    ]


def brings_together(ctx: Context, node: Node, first: Node, second: Node) -> bool:
    """Return whether ``node`` is the first that has both nodes in its scope, so that a
    clash is reported once.
    """
    return second is node or not included_with_both(ctx, node, first, second)


def together(node: Node, second: Node) -> str:
    """Return the end of a message about a clash of two included nodes; empty if
    ``node`` itself declares the second item.
    """
    return "" if second is node else f", and `{node.name}` includes both"


def duplicate_names(
    ctx: Context,
    what: str,
    items: Callable[[Node], Iterable[Message | Enum | Struct]],
    help: str,
) -> Iterator[Fault]:
    """Yield a fault for each name that two items in the scope of a node have."""
    for node in ctx.icd.nodes:
        pairs = _twice(in_scope(ctx, node, items), lambda pair: pair[1].name)
        for (first_node, first), (second_node, second) in pairs:
            if brings_together(ctx, node, first_node, second_node):
                line = line_of(first.source.at("name"), second.source.at("name"))
                message = f"there is already {what} named {quote(second.name)}, in {line}{together(node, second_node)}"
                related = Related(first.source.at("name"), "the first of this name")
                yield Fault.at(second.source, "name", message, help, related=related)


@rule("ICD050")
def message_names_are_unique(ctx: Context) -> Iterator[Fault]:
    yield from duplicate_names(
        ctx, "a message", lambda node: node.messages, PRINTED_TWICE
    )


@rule("ICD051")
def field_names_are_unique(ctx: Context) -> Iterator[Fault]:
    for owner, _ in ctx.owners:
        nodes = owner.layout.nodes
        names = {node.name for node in nodes}
        # A name can also equal the name of an element, such as `Satellites[0].GNSS`, or
        # of a counter.
        is_path = any("[" in name or "." in name for name in names)
        # Fast path for most messages: the names of the lines are distinct, and none can
        # equal the name of an element or a counter.
        if len(names) == len(nodes) and not owner.layout.sequence and not is_path:
            continue
        fields: list[NodePlace] = []
        for place in places_in(owner.layout):
            # Arrays with different names have no element of the same name.
            fields += place.elements() if is_path else [place.first_element]
        # If two structs or arrays have the same name, so have all their fields: report
        # only the structs or arrays.
        if is_path and len({field.name for field in fields}) == len(fields):
            fields = list(scalars_in(owner.layout))
        reported = set()
        for first, second in _twice(fields, lambda field: field.name):
            if id(second.source) in reported:
                continue  # another element of the same array
            reported.add(id(second.source))
            line = line_of(first.source.at("name"), second.source.at("name"))
            text = f"{quote(owner.name)} already has a field {quote(second.name)}, in {line}"
            related = Related(first.source.at("name"), "the first of this name")
            yield Fault.at(second.source, "name", text, PRINTED_TWICE, related=related)


@rule("ICD052")
def enumeration_names_are_unique(ctx: Context) -> Iterator[Fault]:
    yield from duplicate_names(
        ctx, "an enumeration", lambda node: node.enums, "rename one, or use the other"
    )


@rule("ICD053")
def enumeration_values_are_unique(ctx: Context) -> Iterator[Fault]:
    for enum in ctx.enums:
        for first, second in _members_with_common_values(enum):
            owner = f"{quote(first.name)} ({line_of(first.source.at('value'), second.source.at('value'))})"
            related = Related(
                first.source.at("value"), f"the value of {quote(first.name)}"
            )
            text = f"{owner} already has the value {max(first.value, second.value)}"
            yield Fault.at(
                second.source, "value", text, "correct one of them", related=related
            )


def _members_with_common_values(enum: Enum) -> Iterator[tuple[Member, Member]]:
    """Yield pairs of members that have a value in common, sorted by the order of the
    second in the file.
    """
    order = {id(member): index for index, member in enumerate(enum.members)}
    # Of the members with smaller values, the one with the largest last value.
    # A member can be a range. It meets an earlier one exactly if it begins before the
    # largest end so far, so one pass in the order of values is enough.
    furthest: Member | None = None
    pairs = []
    for member in sorted(enum.members, key=lambda member: member.value):
        if furthest is not None and member.value <= furthest.last:
            pairs.append(sorted((furthest, member), key=lambda each: order[id(each)]))
        if furthest is None or member.last > furthest.last:
            furthest = member
    yield from (
        (first, second)
        for first, second in sorted(pairs, key=lambda pair: order[id(pair[1])])
    )


@rule("ICD054")
def member_names_are_unique(ctx: Context) -> Iterator[Fault]:
    for enum in ctx.enums:
        for first, second in _twice(
            # Manuals print a name twice, such as `Reserved`. Different identifiers make
            # that acceptable.
            enum.members,
            lambda member: (member.name, member.identifier),
        ):
            value = f"{first.value} ({line_of(first.source.at('name'), second.source.at('name'))})"
            message = f"{quote(second.name)} is already the name of {value}"
            help = "if the manual prints it so, give each its own `identifier:`"
            related = Related(first.source.at("name"), "the first of this name")
            yield Fault.at(second.source, "name", message, help, related=related)


@rule("ICD074")
def aliases_are_unambiguous(ctx: Context) -> Iterator[Fault]:
    """Report aliases that do not identify one message, type, field or member."""
    reported = set()
    for node in ctx.icd.nodes:
        messages: list[Aliased] = []
        enums: list[Aliased] = []
        structs: list[Aliased] = []
        for declaring in ctx.scope(node):
            messages += declaring.messages
            enums += declaring.enums
            structs += declaring.structs
        # No command accepts a message and a type in the same place, so they can share
        # an alias.
        for items in (messages, enums + structs):
            for fault in _ambiguous_aliases(items, node.vocabulary):
                # A node that includes another node has the same aliases.
                if (key := (id(fault.owner), fault.message)) not in reported:
                    reported.add(key)
                    yield fault
    for owner, node in ctx.owners:
        if any(line.aliases for line in owner.layout.nodes):
            yield from _ambiguous_aliases(
                [place.node for place in places_in(owner.layout)], node.vocabulary
            )
    for node in ctx.icd.nodes:
        for enum in node.enums:
            yield from _ambiguous_aliases(enum.members, node.vocabulary)


def _ambiguous_aliases(
    items: Sequence[Aliased], vocabulary: tuple[str, ...]
) -> Iterator[Fault]:
    """Yield a fault for each alias that equals a name, or another alias, of the items."""
    if not any(item.aliases for item in items):
        return

    def words(text: str) -> str:
        """Return the form in which a search compares names."""
        return "".join(naming.words(text, vocabulary)) or text.casefold()

    names: dict[str, Aliased] = {}  # the first item of each name
    for item in items:
        for text in filter(None, (item.name, item.identifier)):
            names.setdefault(words(text), item)
    by_alias: dict[str, Aliased] = {}  # the first item of each alias
    for item in items:
        for index, alias in enumerate(item.aliases):
            key, place = words(alias), item.source["aliases"].item_at(index)
            other = names.get(key) or by_alias.get(key)
            by_alias.setdefault(key, item)
            if other is None:
                continue
            text = f"the alias {quote(alias)} of {quote(item.name)} is "
            if key in names and other is item:
                text, help = f"{text}its own name", "remove the alias"
            elif key in names:
                line = line_of(other.source.at("name"), place)
                text = f"{text}also the name of {quote(other.name)}, in {line}"
                help = "choose another alias"
            elif other is item:
                text, help = f"{text}listed twice", "remove one of them"
            else:
                line = line_of(other.source.at("aliases"), place)
                text = f"{text}also an alias of {quote(other.name)}, in {line}"
                help = "keep one of them"
            yield Fault(item.source, place, text, help)


@rule("ICD057")
def node_names_are_unique(ctx: Context) -> Iterator[Fault]:
    for first, second in _twice(ctx.icd.nodes, lambda node: node.name):
        head = second.source["node"]
        message = f"another file has declared the node `{second.name}`: {first.file}"
        yield Fault.at(
            head, "name", message, "name one of them differently, or leave one file out"
        )


@rule("ICD058")
def unit_symbols_are_unique(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        pairs = in_scope(ctx, node, _declared_units)
        for (first_node, first), (second_node, second) in _twice(
            pairs, lambda pair: pair[1]["symbol"]
        ):
            if brings_together(ctx, node, first_node, second_node):
                line = line_of(first.at("symbol"), second.at("symbol"))
                included = together(node, second_node)
                message = f"the unit {quote(second['symbol'])} is already declared, in {line}{included}"
                related = Related(first.at("symbol"), "the first declaration")
                yield Fault.at(
                    second,
                    "symbol",
                    message,
                    "remove one of the declarations",
                    related=related,
                )
        for unit in _declared_units(node):
            if unit["symbol"] in STANDARD:
                message = f"the unit {quote(unit['symbol'])} is built in: {STANDARD[unit['symbol']].quantity}"
                yield Fault.at(
                    unit,
                    "symbol",
                    message,
                    "remove the declaration, or choose another symbol",
                )


def _declared_units(node: Node) -> Iterator[Map]:
    """Yield the valid entries of `units` of a node."""
    symbols = {unit.symbol for unit in node.units}
    for item in mappings(node.source.get("units")):
        if isinstance(item.get("symbol"), str) and item["symbol"] in symbols:
            yield item
