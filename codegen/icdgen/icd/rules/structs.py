"""Structs: their uses in messages and other structs, and the keys of their fields.

The rules take mappings of the files, because the model leaves out lines with errors,
and lines of the layout. They report names (ICD049, ICD140), cycles, positions and keys
of uses (ICD141 to ICD143), unused structs (ICD144), split fields (ICD145) and variable
lengths (ICD146). `layout` has the rules of fields within structs.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd import division, variable_length, variable_structs
from icdgen.icd.fault import Fault
from icdgen.icd.layout import struct_layout_of
from icdgen.icd.located import Map
from icdgen.icd.model import Node
from icdgen.icd.rules.context import Context, is_overlay
from icdgen.icd.rules.duplicates import duplicate_names
from icdgen.icd.rules.references import undeclared
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import line_of
from icdgen.icd.trees import mappings
from icdgen.suggest import close_to
from icdgen.wording import quote

# Keys of a line that uses a struct.
_KEYS_OF_USES = frozenset(
    {
        "at",
        "name",
        "identifier",
        "struct",
        "count",
        "after",
        "up_to",
        "summary",
        "aliases",
    }
)


def _uses(ctx: Context) -> Iterator[tuple[Map, Map, Node]]:
    """Yield the lines that use a struct, each with the message or struct that contains
    it, and the node.
    """
    for node in ctx.icd.nodes:
        for key in ("structs", "messages"):
            for owner in mappings(node.source.get(key)):
                for row in mappings(owner.get("fields")):
                    if isinstance(row.get("struct"), str) and isinstance(
                        row.get("name"), str
                    ):
                        yield row, owner, node


@rule("ICD140")
def structs_exist(ctx: Context) -> Iterator[Fault]:
    # If parts of the file were left out, the struct may be one of them.
    for row, _, node in _uses(ctx) if ctx.complete else ():
        if all(
            struct.name != row["struct"]
            for declaring in ctx.scope(node)
            for struct in declaring.structs
        ):
            yield Fault.at(
                row,
                "struct",
                *undeclared(ctx, node, "struct", "structs", row["struct"]),
            )


@rule("ICD141")
def structs_do_not_contain_themselves(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        # Fields of each struct that are structs.
        uses: dict[str, list[Map]] = {}
        for struct in mappings(node.source.get("structs")):
            if isinstance(struct.get("name"), str):
                rows = mappings(struct.get("fields"))
                inner = [row for row in rows if isinstance(row.get("struct"), str)]
                uses[struct["name"]] = inner
        for name, rows in uses.items():
            for row in rows:
                path = _shortest_path(row["struct"], name, uses)
                if path is not None:
                    message = f"the struct {quote(name)} contains itself: {' -> '.join((name, *path))}"
                    help = "write the inner fields directly into the struct"
                    yield Fault.at(row, "struct", message, help)


def _shortest_path(
    first: str, last: str, uses: dict[str, list[Map]]
) -> list[str] | None:
    """Return the structs from ``first`` to ``last``, each of which contains the next;
    None if there is no path.
    """
    # Breadth first, so that the first path that arrives is the shortest.
    paths, seen = [[first]], {first}
    while paths:
        path = paths.pop(0)
        if path[-1] == last:
            return path
        for row in uses.get(path[-1], ()):
            if row["struct"] not in seen:
                seen.add(row["struct"])
                paths.append([*path, row["struct"]])
    return None


@rule("ICD142")
def structs_begin_at_a_byte(ctx: Context) -> Iterator[Fault]:
    for line in ctx.lines:
        node, at = line.node, line.node.at
        if struct_layout_of(node) is not None and at % 8:
            message = f"{quote(node.name)} is a struct, but bit {at:,} is not the beginning of a byte"
            help = f"structs begin at bits {at // 8 * 8:,} and {at // 8 * 8 + 8:,}"
            yield Fault.at(node.source, "at", message, help)


@rule("ICD143")
def uses_have_no_keys_of_fields(ctx: Context) -> Iterator[Fault]:
    for row, _, _ in _uses(ctx):
        for key in row:
            if key not in _KEYS_OF_USES:
                if key == "when":
                    message = f"{quote(row['name'])} is a struct, and optional structs are not supported"
                    help = "write the fields of the struct into the message, each with `when`, or remove `when`"
                else:
                    message = f"{quote(row['name'])} is a struct, which cannot have `{key}`; its fields can"
                    help = f"move it to the fields of the struct {quote(row['struct'])}, or remove it"
                yield Fault.at(row, key, message, help)
    for struct, _ in ctx.structs:
        for field in struct.layout.nodes:
            if is_overlay(field):
                message = f"{quote(field.name)} is an overlay field, which is not supported in a struct"
                yield Fault.at(
                    field.source,
                    "view",
                    message,
                    "write the overlay field in the message",
                )


@rule("ICD146", needs_complete=True)
def variable_lengths_in_structs_are_determined(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        structs = {
            struct.name: struct for owner in ctx.scope(node) for struct in owner.structs
        }
        lengths = {name: struct.length for name, struct in structs.items()}
        sources = {name: struct.source for name, struct in structs.items()}
        variable = {
            name
            for name, struct in structs.items()
            if variable_structs.is_variable_struct(struct.source)
        }
        for struct in node.structs:
            yield from variable_structs.faults_in_struct(
                struct.source, lengths, variable
            )
            sequence = set(map(id, variable_length.sequence_of(struct.source)))
            for row in mappings(struct.source.get("fields")):
                if (
                    row.get("struct") in variable
                    and id(row) not in sequence
                    and isinstance(row.get("name"), str)
                ):
                    text = f"the struct {quote(row['struct'])} has a variable length, which is not supported in a struct"
                    yield Fault.at(
                        row,
                        "struct",
                        text,
                        f"write its fields into {quote(struct.name)}",
                    )
        for message in node.messages:
            for row in mappings(message.source.get("fields")):
                if row.get("struct") in variable and isinstance(row.get("name"), str):
                    yield from variable_structs.faults_of_inner_counts(
                        message.source, row, sources
                    )


@rule("ICD049")
def struct_names_are_unique(ctx: Context) -> Iterator[Fault]:
    yield from duplicate_names(
        ctx, "a struct", lambda node: node.structs, "rename one, or use the other"
    )


@rule("ICD144", severity="warning", needs_complete=True)
def structs_are_used(ctx: Context) -> Iterator[Fault]:
    names = [struct.name for struct, _ in ctx.structs]
    # Look at the tree and not at the model: a message with errors uses its structs,
    # too.
    structs = {
        id(item)
        for node in ctx.icd.nodes
        for item in mappings(node.source.get("structs"))
    }
    # Structs that each struct uses; under "" those that messages use.
    used_by: dict[str, set[str]] = {}
    for row, owner, node in _uses(ctx):
        declared = [
            struct.name for declaring in ctx.scope(node) for struct in declaring.structs
        ]
        # A misspelt name counts as a use of the similar struct, which ICD140 suggests.
        name = (
            row["struct"]
            if row["struct"] in declared
            else close_to(row["struct"], declared)
        )
        used_by.setdefault(
            str(owner.get("name")) if id(owner) in structs else "", set()
        ).add(name)
    used: set[str] = set()
    # A struct that only an unused struct uses is unused, too. So follow the uses from
    # the messages.
    queue = [""]
    while queue:
        new = used_by.get(queue.pop(), set()) - used
        used |= new
        queue += new
    for struct, _ in ctx.structs:
        if struct.name not in used and names.count(struct.name) == 1:
            message = f"no message uses the struct {quote(struct.name)}"
            yield Fault.at(struct.source, "name", message, "use or remove it")


@rule("ICD145")
def split_fields_have_the_same_orders(ctx: Context) -> Iterator[Fault]:
    for line in ctx.lines:
        node = line.node
        struct, home = ctx.struct_of.get(id(struct_layout_of(node)), (None, None))
        if struct is None or home is None or line.orders == home.orders:
            continue
        for split in mappings(struct.source.get("fields")):
            if not isinstance(split.get("name"), str) or not division.parts_of(split):
                continue
            # A struct takes the orders of the message that it stands in. The positions
            # of the parts of a split field were checked with the orders of the node
            # that declares it.
            if "byte_order" not in split or "bit_order" not in split:
                line_of_split = line_of(split.at("bitfields"), node.source.place)
                bits = f"the bits of the split field {quote(split['name'])} ({line_of_split}) would be in other places"
                message = (
                    f"{quote(node.name)} has other orders than `{home.name}`, so {bits}"
                )
                help = f"give {quote(split['name'])} a `byte_order` and a `bit_order`, or make its parts fields"
                yield Fault.at(node.source, "struct", message, help)
