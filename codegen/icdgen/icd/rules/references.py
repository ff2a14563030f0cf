"""Enumerations and units that fields name."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd.fault import Fault
from icdgen.icd.located import Map
from icdgen.icd.model import Node
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.protocol import sections
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import quote
from icdgen.icd.suggestions import suggestion, yaml_text
from icdgen.icd.units import SPELLINGS, meant
from icdgen.suggest import close_to


@rule("ICD040")
def enum_known(ctx: Context) -> Iterator[Fault]:
    for field, (_, _, node) in ctx.fields:
        source = field.source
        if field.type != "enum":
            if "enum" in source:
                message = f"{quote(field.name)} names an enumeration, but its type is `{field.type}`"
                yield Fault.at(source, "enum", message, "write `type: enum` or remove `enum:`")
        elif "enum" not in source:
            message = f"{quote(field.name)} has the type `enum` but no `enum` key"
            yield Fault.at(source, "type", message, "add `enum:`, the name of an enumeration")
        elif field.enum is None and ctx.complete:
            yield Fault.at(source, "enum", *undeclared(ctx, node, "enumeration", "enums", source["enum"]))
    if ctx.complete:
        for node in ctx.icd.nodes:
            known = {e.name for n in ctx.scope(node) for e in n.enums}
            for owner, key in _protocol_enums(node):
                if owner[key] not in known:
                    yield Fault.at(owner, key, *undeclared(ctx, node, "enumeration", "enums", owner[key]))


def undeclared(ctx: Context, node: Node, what: str, section: str, name: str) -> tuple[str, str, str]:
    """Message, help and fix for a name that no ``section`` of the node or of its includes declares."""
    elsewhere = next((n for n in ctx.icd.nodes for one in getattr(n, section) if one.name == name), None)
    if elsewhere is not None:
        help, fix = f"`{elsewhere.name}` declares it: include {elsewhere.file}", ""
    else:
        known = (one.name for n in ctx.scope(node) for one in getattr(n, section))
        help, fix = suggestion(name, known, f"declare it in `{section}:`")
    return f"there is no {what} {quote(name)}", help, fix


@rule("ICD041", severity="warning", whole=True)
def enum_used(ctx: Context) -> Iterator[Fault]:
    used = {id(field.enum) for field, _ in ctx.fields_with["enum"]}
    named = set()
    for field, (_, _, node) in ctx.fields_with["enum"]:
        if field.enum is None:  # a slip of the pen; the one that is meant is used
            scope = ctx.scope(node)
            close = close_to(field.source["enum"], (e.name for n in scope for e in n.enums))
            named |= {(id(n), close) for n in scope}
    for node in ctx.icd.nodes:
        for owner, key in _protocol_enums(node):
            named |= {(id(n), owner[key]) for n in ctx.scope(node)}
    for node in ctx.icd.nodes:
        names = [e.name for e in node.enums]
        for enum in node.enums:
            if id(enum) not in used and (id(node), enum.name) not in named and names.count(enum.name) == 1:
                text = f"no field uses the enumeration {quote(enum.name)}"
                yield Fault.at(enum.source, "name", text, "use or remove it")


def _protocol_enums(node: Node) -> Iterator[tuple[Map, str]]:
    """Mappings in the protocol section that name an enumeration, with the key that does."""
    for section in sections(node):
        for key, value in section.items():
            if (key == "enum" or key.endswith("_enum")) and isinstance(value, str):
                yield section, key


@rule("ICD042", whole=True)
def unit_known(ctx: Context) -> Iterator[Fault]:
    for field, (_, _, node) in ctx.fields_with["unit"]:
        if field.unit is None:
            unit = field.source["unit"]
            help, fix = "declare it in `units:`; `icdgen units` lists the built-in units", ""
            if close := meant(unit, (u.symbol for n in ctx.scope(node) for u in n.units)):
                otherwise = "" if unit in SPELLINGS else " If not, declare it in `units:`"
                help, fix = f"did you mean {quote(close)}?{otherwise}", yaml_text(close)
            yield Fault.at(field.source, "unit", f"the unit {quote(unit)} is unknown", help, fix)
