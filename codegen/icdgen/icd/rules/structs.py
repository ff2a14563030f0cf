"""Structs: what messages and other structs name, and what may stand in them."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd import division, tails
from icdgen.icd.fault import Fault
from icdgen.icd.layout import struct_layout_of
from icdgen.icd.located import Map
from icdgen.icd.model import Node
from icdgen.icd.rules.context import Context, is_overlay
from icdgen.icd.rules.duplicates import names_twice
from icdgen.icd.rules.references import undeclared
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import line_of, quote
from icdgen.icd.trees import mappings
from icdgen.suggest import close_to

_OF_MEMBERS = frozenset({"at", "name", "identifier", "struct", "count", "after", "up_to", "summary", "aliases"})
"""Keys of a struct where it stands."""


def _uses(ctx: Context) -> Iterator[tuple[Map, Map, Node]]:
    """The entries that name a struct, each with the message or struct that it stands in."""
    for node in ctx.icd.nodes:
        for key in ("structs", "messages"):
            for owner in mappings(node.source.get(key)):
                for row in mappings(owner.get("fields")):
                    if isinstance(row.get("struct"), str) and isinstance(row.get("name"), str):
                        yield row, owner, node


@rule("ICD140")
def struct_known(ctx: Context) -> Iterator[Fault]:
    for row, _, node in _uses(ctx) if ctx.complete else ():
        if all(one.name != row["struct"] for n in ctx.scope(node) for one in n.structs):
            yield Fault.at(row, "struct", *undeclared(ctx, node, "struct", "structs", row["struct"]))


@rule("ICD141")
def struct_in_itself(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        within = {
            one["name"]: [row for row in mappings(one.get("fields")) if isinstance(row.get("struct"), str)]
            for one in mappings(node.source.get("structs"))
            if isinstance(one.get("name"), str)
        }
        for name, rows in within.items():
            for row in rows:
                way = _way(row["struct"], name, within)
                if way is not None:
                    there = " -> ".join((name, *way))
                    message = f"the struct {quote(name)} contains itself: {there}"
                    help = "write the inner fields directly into the struct"
                    yield Fault.at(row, "struct", message, help)


def _way(first: str, last: str, within: dict[str, list[Map]]) -> list[str] | None:
    """The structs from one to another, each of which has the next in it; None if there is no such way."""
    ways, seen = [[first]], {first}
    while ways:
        way = ways.pop(0)
        if way[-1] == last:
            return way
        for row in within.get(way[-1], ()):
            if row["struct"] not in seen:
                seen.add(row["struct"])
                ways.append([*way, row["struct"]])
    return None


@rule("ICD142")
def struct_at_byte(ctx: Context) -> Iterator[Fault]:
    for line in ctx.lines:
        node, at = line.node, line.node.at
        if struct_layout_of(node) is not None and at % 8:
            message = f"{quote(node.name)} is a struct, but bit {at:,} is not the beginning of a byte"
            help = f"structs begin at bits {at // 8 * 8:,} and {at // 8 * 8 + 8:,}"
            yield Fault.at(node.source, "at", message, help)


@rule("ICD143")
def struct_says(ctx: Context) -> Iterator[Fault]:
    for row, _, _ in _uses(ctx):
        for key in row:
            if key not in _OF_MEMBERS:
                message = f"{quote(row['name'])} is a struct, which cannot have `{key}`; its fields can"
                yield Fault.at(row, key, message, f"move it to the fields of {quote(row['struct'])}, or remove it")
    for struct, _ in ctx.structs:
        for row in mappings(struct.source.get("fields")):
            if tails.is_open(row) and isinstance(row.get("name"), str):
                message = f"{quote(row['name'])} has a variable length, which is not supported in a struct"
                yield Fault.at(row, tails.key_of(row), message, "move it to the end of the message")
        for field in struct.layout.nodes:
            if is_overlay(field):
                message = f"{quote(field.name)} is a view, and a struct has none: there is no frame that it would read"
                yield Fault.at(field.source, "view", message, "write the view in the message")


@rule("ICD049")
def struct_names(ctx: Context) -> Iterator[Fault]:
    yield from names_twice(ctx, "a struct", lambda n: n.structs, "rename one, or use the other")


@rule("ICD144", severity="warning", whole=True)
def struct_used(ctx: Context) -> Iterator[Fault]:
    names = [struct.name for struct, _ in ctx.structs]
    structs = {id(one) for node in ctx.icd.nodes for one in mappings(node.source.get("structs"))}
    named: dict[str, set[str]] = {}  # by each struct; by a message: ""
    for row, owner, node in _uses(ctx):
        known = [struct.name for n in ctx.scope(node) for struct in n.structs]
        name = row["struct"] if row["struct"] in known else close_to(row["struct"], known)  # a slip of the pen
        named.setdefault(str(owner.get("name")) if id(owner) in structs else "", set()).add(name)
    used: set[str] = set()  # by what is written: whatever else is wrong with a message, it uses what it names
    left = [""]
    while left:
        new = named.get(left.pop(), set()) - used
        used |= new
        left += new
    for struct, _ in ctx.structs:
        if struct.name not in used and names.count(struct.name) == 1:
            message = f"no message uses the struct {quote(struct.name)}"
            yield Fault.at(struct.source, "name", message, "use or remove it")


@rule("ICD145")
def struct_divided(ctx: Context) -> Iterator[Fault]:
    for line in ctx.lines:
        node = line.node
        struct, home = ctx.struct_of.get(id(struct_layout_of(node)), (None, None))
        if struct is None or home is None or line.orders == home.orders:
            continue
        for split in _split_fields(struct.source):
            if "byte_order" not in split or "bit_order" not in split:
                there = line_of(split.at("bitfields"), node.source.place)
                bits = f"the bits of {quote(split['name'])} ({there}), which is divided, would lie elsewhere"
                message = f"{quote(node.name)} has other orders than `{home.name}`, so {bits}"
                help = f"give {quote(split['name'])} a `byte_order` and a `bit_order`, or make its parts fields"
                yield Fault.at(node.source, "struct", message, help)


def _split_fields(struct: Map) -> Iterator[Map]:
    """Yield the fields of a struct that are split into parts."""
    rows = (row for row in mappings(struct.get("fields")) if isinstance(row.get("name"), str))
    return filter(division.parts_of, rows)
