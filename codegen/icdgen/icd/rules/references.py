"""References of fields and of the protocol section to enumerations and units.

The rules report unknown enumerations (ICD040) and units (ICD042), and unused
enumerations as a warning (ICD041). A name is searched in the node and the nodes that it
includes. `undeclared` makes the message and suggests a similar name; `structs` uses it,
too.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd.fault import Fault
from icdgen.icd.located import Map
from icdgen.icd.model import Node
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.protocol import sections
from icdgen.icd.rules.rule import rule
from icdgen.icd.suggestions import suggestion, yaml_text
from icdgen.icd.units import SPELLINGS, similar_unit
from icdgen.suggest import close_to
from icdgen.wording import quote


@rule("ICD040")
def enumerations_exist(ctx: Context) -> Iterator[Fault]:
    for field, (_, _, node) in ctx.fields:
        source = field.source
        if field.type != "enum":
            if "enum" in source:
                message = f"{quote(field.name)} names an enumeration, but its type is `{field.type}`"
                yield Fault.at(
                    source, "enum", message, "write `type: enum` or remove `enum:`"
                )
        elif "enum" not in source:
            message = f"{quote(field.name)} has the type `enum` but no `enum` key"
            yield Fault.at(
                source, "type", message, "add `enum:`, the name of an enumeration"
            )
        # If parts of the file were left out, the enumeration may be one of them.
        elif field.enum is None and ctx.complete:
            yield Fault.at(
                source,
                "enum",
                *undeclared(ctx, node, "enumeration", "enums", source["enum"]),
            )
    if ctx.complete:
        for node in ctx.icd.nodes:
            names = {
                enum.name for declaring in ctx.scope(node) for enum in declaring.enums
            }
            for owner, key in _protocol_enums(node):
                if owner[key] not in names:
                    yield Fault.at(
                        owner,
                        key,
                        *undeclared(ctx, node, "enumeration", "enums", owner[key]),
                    )


def undeclared(
    ctx: Context, node: Node, what: str, section: str, name: str
) -> tuple[str, str, str]:
    """Return message, help and fix for a name that no ``section`` in the scope of a
    node declares.
    """
    declaring = [
        other
        for other in ctx.icd.nodes
        if any(item.name == name for item in getattr(other, section))
    ]
    if declaring:
        help, fix = (
            f"`{declaring[0].name}` declares it: include {declaring[0].file}",
            "",
        )
    else:
        names = (
            item.name for other in ctx.scope(node) for item in getattr(other, section)
        )
        help, fix = suggestion(name, names, f"declare it in `{section}:`")
    return f"there is no {what} {quote(name)}", help, fix


@rule("ICD041", severity="warning", needs_complete=True)
def enumerations_are_used(ctx: Context) -> Iterator[Fault]:
    used = {id(field.enum) for field, _ in ctx.fields_with["enum"]}
    named = set()
    for field, (_, _, node) in ctx.fields_with["enum"]:
        # A misspelt name counts as a use of the similar enumeration, which ICD040
        # suggests.
        if field.enum is None:
            scope = ctx.scope(node)
            close = close_to(
                field.source["enum"],
                (enum.name for owner in scope for enum in owner.enums),
            )
            named |= {(id(owner), close) for owner in scope}
    for node in ctx.icd.nodes:
        for section, key in _protocol_enums(node):
            named |= {(id(owner), section[key]) for owner in ctx.scope(node)}
    for node in ctx.icd.nodes:
        names = [enum.name for enum in node.enums]
        for enum in node.enums:
            if (
                id(enum) not in used
                and (id(node), enum.name) not in named
                # ICD052 reports names that occur twice.
                and names.count(enum.name) == 1
            ):
                text = f"no field uses the enumeration {quote(enum.name)}"
                yield Fault.at(enum.source, "name", text, "use or remove it")


def _protocol_enums(node: Node) -> Iterator[tuple[Map, str]]:
    """Yield each mapping of the protocol section that names an enumeration, with the
    key of the name.
    """
    for section in sections(node):
        for key, value in section.items():
            if (key == "enum" or key.endswith("_enum")) and isinstance(value, str):
                yield section, key


@rule("ICD042", needs_complete=True)
def units_exist(ctx: Context) -> Iterator[Fault]:
    for field, (_, _, node) in ctx.fields_with["unit"]:
        if field.unit is None:
            unit = field.source["unit"]
            help = "declare it in `units:`; `icdgen units` lists the built-in units"
            fix = ""
            symbols = (
                declared.symbol for owner in ctx.scope(node) for declared in owner.units
            )
            if close := similar_unit(unit, symbols):
                otherwise = (
                    "" if unit in SPELLINGS else " If not, declare it in `units:`"
                )
                help, fix = f"did you mean {quote(close)}?{otherwise}", yaml_text(close)
            yield Fault.at(
                field.source, "unit", f"the unit {quote(unit)} is unknown", help, fix
            )
