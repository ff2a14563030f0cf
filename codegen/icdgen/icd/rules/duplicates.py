"""Names and values that must be there once."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from typing import TypeAlias, TypeVar

from icdgen import naming
from icdgen.diagnostics import Related
from icdgen.icd.fault import Fault
from icdgen.icd.layout import LayoutNode
from icdgen.icd.located import Map
from icdgen.icd.model import Enum, Member, Message, Node, Struct
from icdgen.icd.places import places_in, scalars_in
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import line_of, quote
from icdgen.icd.trees import mappings
from icdgen.icd.units import STANDARD

T = TypeVar("T")
Aliased: TypeAlias = Message | LayoutNode | Enum | Member | Struct
PRINTED_TWICE = "rename one; if the manual prints both under this name, rename one in the errata file, or remove a copy"


def _twice(items: Iterable[T], key: Callable[[T], Hashable]) -> Iterator[tuple[T, T]]:
    """(first, later) for every item whose key was there before."""
    seen: dict[Hashable, T] = {}
    for item in items:
        value = key(item)
        if value in seen:
            yield seen[value], item
        else:
            seen[value] = item


def in_scope(ctx: Context, node: Node, items: Callable[[Node], Iterable[T]]) -> list[tuple[Node, T]]:
    """Items of the node and of what it includes, with the node that declares them."""
    return [(n, item) for n in ctx.scope(node) for item in items(n)]


def is_news(ctx: Context, node: Node, first: Node, second: Node) -> bool:
    """Whether ``node`` is the first to bring the two together; else the clash is reported where that happened."""
    return second is node or (first is not second and first not in ctx.scope(second))


def together(node: Node, second: Node) -> str:
    """Why a clash of two included nodes matters."""
    return "" if second is node else f", and `{node.name}` includes both"


def names_twice(
    ctx: Context, what: str, items: Callable[[Node], Iterable[Message | Enum | Struct]], help: str
) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        for (n1, first), (n2, second) in _twice(in_scope(ctx, node, items), lambda pair: pair[1].name):
            if is_news(ctx, node, n1, n2):
                there = line_of(first.source.at("name"), second.source.at("name"))
                message = f"there is already {what} named {quote(second.name)}, in {there}{together(node, n2)}"
                related = Related(first.source.at("name"), "the first of this name")
                yield Fault.at(second.source, "name", message, help, related=related)


@rule("ICD050")
def message_names(ctx: Context) -> Iterator[Fault]:
    yield from names_twice(ctx, "a message", lambda n: n.messages, PRINTED_TWICE)


@rule("ICD051")
def field_names(ctx: Context) -> Iterator[Fault]:
    for owner, _ in ctx.owners:
        nodes = owner.layout.nodes
        names = {node.name for node in nodes}
        # A name can also be equal to that of an element, such as `Satellites[0].GNSS`, or of a counter.
        is_path = any("[" in name or "." in name for name in names)
        if len(names) == len(nodes) and not owner.layout.sequence and not is_path:
            continue
        places = places_in(owner.layout)
        fields = [element for place in places for element in place.elements()]
        # If two structs or arrays have one name, all their fields have equal names, too: report only the former.
        if len({field.name for field in fields}) == len(fields):
            fields = list(scalars_in(owner.layout))
        reported = set()
        for first, second in _twice(fields, lambda field: field.name):
            if id(second.source) in reported:
                continue  # another element of the same array
            reported.add(id(second.source))
            there = line_of(first.source.at("name"), second.source.at("name"))
            text = f"{quote(owner.name)} already has a field {quote(second.name)}, in {there}"
            related = Related(first.source.at("name"), "the first of this name")
            yield Fault.at(second.source, "name", text, PRINTED_TWICE, related=related)


@rule("ICD052")
def enum_names(ctx: Context) -> Iterator[Fault]:
    yield from names_twice(ctx, "an enumeration", lambda n: n.enums, "rename one, or use the other")


@rule("ICD053")
def member_values(ctx: Context) -> Iterator[Fault]:
    for enum in ctx.enums:
        for first, second in _sharing(enum):
            there = f"{quote(first.name)} ({line_of(first.source.at('value'), second.source.at('value'))})"
            what = f"the value {max(first.value, second.value)}"
            related = Related(first.source.at("value"), f"the value of {quote(first.name)}")
            text = f"{there} already has {what}"
            yield Fault.at(second.source, "value", text, "correct one of them", related=related)


def _sharing(enum: Enum) -> Iterator[tuple[Member, Member]]:
    """Members that have values in common with one before them, in their order; ranges are taken as far as they are some."""
    place = {id(one): number for number, one in enumerate(enum.members)}
    reaching: Member | None = None
    found = []
    for one in sorted(enum.members, key=lambda m: m.value):
        if reaching is not None and one.value <= reaching.last:
            found.append(sorted((reaching, one), key=lambda m: place[id(m)]))
        if reaching is None or one.last > reaching.last:
            reaching = one
    yield from ((first, second) for first, second in sorted(found, key=lambda pair: place[id(pair[1])]))


@rule("ICD054")
def member_names(ctx: Context) -> Iterator[Fault]:
    for enum in ctx.enums:
        for first, second in _twice(enum.members, lambda m: (m.name, m.identifier)):
            there = f"{first.value} ({line_of(first.source.at('name'), second.source.at('name'))})"
            message = f"{quote(second.name)} is already the name of {there}"
            help = "if the manual prints it so, give each its own `identifier:`"
            related = Related(first.source.at("name"), "the first of this name")
            yield Fault.at(second.source, "name", message, help, related=related)


@rule("ICD074")
def aliases(ctx: Context) -> Iterator[Fault]:
    """Report aliases by which a look-up by name would not know what is meant."""
    reported = set()
    for node in ctx.icd.nodes:
        scope = ctx.scope(node)
        messages: list[Aliased] = [m for n in scope for m in n.messages]
        types: list[Aliased] = [*(one for n in scope for one in n.enums), *(one for n in scope for one in n.structs)]
        for items in (messages, types):
            for fault in _ambiguous_aliases(items, node.vocabulary):
                # A node that includes another meets the same aliases again.
                if (key := (id(fault.owner), fault.message)) not in reported:
                    reported.add(key)
                    yield fault
    for owner, node in ctx.owners:
        if any(line.aliases for line in owner.layout.nodes):
            yield from _ambiguous_aliases([place.node for place in places_in(owner.layout)], node.vocabulary)
    for node in ctx.icd.nodes:
        for enum in node.enums:
            yield from _ambiguous_aliases(enum.members, node.vocabulary)


def _ambiguous_aliases(items: Sequence[Aliased], vocabulary: tuple[str, ...]) -> Iterator[Fault]:
    if not any(item.aliases for item in items):
        return

    def words(text: str) -> str:
        return "".join(naming.words(text, vocabulary)) or text.casefold()

    names = {words(text): item for item in reversed(items) for text in (item.name, item.identifier) if text}
    before: dict[str, Aliased] = {}  # the things whose aliases were read already
    for item in items:
        for index, alias in enumerate(item.aliases):
            key, place = words(alias), item.source["aliases"].item_at(index)
            other = names.get(key) or before.get(key)
            before.setdefault(key, item)
            if other is None:
                continue
            text = f"the alias {quote(alias)} of {quote(item.name)} is "
            if key in names and other is item:
                text, help = f"{text}its own name", "remove the alias"
            elif key in names:
                there = line_of(other.source.at("name"), place)
                text, help = f"{text}the name of something else, in {there}", "choose another alias"
            elif other is item:
                text, help = f"{text}listed twice", "remove one of them"
            else:
                there = line_of(other.source.at("aliases"), place)
                text, help = f"{text}also an alias of {quote(other.name)}, in {there}", "keep one of them"
            yield Fault(item.source, place, text, help)


@rule("ICD057")
def node_names(ctx: Context) -> Iterator[Fault]:
    for first, second in _twice(ctx.icd.nodes, lambda n: n.name):
        head = second.source["node"]
        message = f"another file has declared the node `{second.name}`: {first.file}"
        yield Fault.at(head, "name", message, "name one of them differently, or leave one file out")


@rule("ICD058")
def unit_symbols(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        pairs = in_scope(ctx, node, _declared_units)
        for (n1, first), (n2, second) in _twice(pairs, lambda pair: pair[1]["symbol"]):
            if is_news(ctx, node, n1, n2):
                there = line_of(first.at("symbol"), second.at("symbol"))
                message = f"the unit {quote(second['symbol'])} is already declared, in {there}{together(node, n2)}"
                related = Related(first.at("symbol"), "the first declaration")
                yield Fault.at(second, "symbol", message, "remove one of the declarations", related=related)
        for unit in _declared_units(node):
            if unit["symbol"] in STANDARD:
                message = f"the unit {quote(unit['symbol'])} is built in: {STANDARD[unit['symbol']].quantity}"
                yield Fault.at(unit, "symbol", message, "remove the declaration, or choose another symbol")


def _declared_units(node: Node) -> Iterator[Map]:
    known = {u.symbol for u in node.units}
    for item in mappings(node.source.get("units")):
        if isinstance(item.get("symbol"), str) and item["symbol"] in known:
            yield item
