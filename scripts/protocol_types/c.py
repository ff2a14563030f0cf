"""Protocol facts as members of the structs of the C runtime."""

from __future__ import annotations

import re
from collections.abc import Iterator

from icdgen.backends.c.facts import TYPES, has_presence_flag
from icdgen.backends.c.text import comment
from icdgen.protocol.declared import BYTE, U16, FactKind, ProtocolFact, facts_of

_TYPES = {
    FactKind.TIME: "uint32_t ", FactKind.FLAG: "bool ", FactKind.BUSES: "uint8_t ", FactKind.SPAN: "icd_part_t ",
}  # fmt: skip
_MEMBER = re.compile(
    r"(?:    /\*\*(?:(?!\*/).|\n)*\*/\n)?    [\w ]+[ *](\w+)(?:\[\w+\])?(?:, \w+)*;.*\n"
)


def written(text: str) -> str:
    """Return the header with the members of all facts. Other members follow them."""
    for part, name in TYPES.items():
        end = f"}} {name};\n"
        before, separator, after = text.partition(end)
        if separator:
            before, start, body = before.rpartition("typedef struct {\n")
            facts = facts_of(part)
            names = {member for fact in facts for member, _ in _members(fact)}
            other_members = (
                match.group()
                for match in _MEMBER.finditer(body)
                if match.group(1) not in names
            )
            fact_members = (
                comment([f"{about[0].upper()}{about[1:]}."], "    ")
                + f"\n    {text};\n"
                for fact in facts
                for text, about in _declared(fact)
            )
            text = (
                before + start + "".join([*fact_members, *other_members]) + end + after
            )
    return text


def _members(fact: ProtocolFact) -> Iterator[tuple[str, str]]:
    """Yield names and types of the members of a fact, each type with a trailing space."""
    if has_presence_flag(fact):
        yield f"has_{fact.name}", "bool "
    yield fact.name, _type(fact)


def _declared(fact: ProtocolFact) -> Iterator[tuple[str, str]]:
    for name, type in _members(fact):
        about = fact.meaning
        if name.startswith("has_"):
            about = f"whether `{fact.name}` is known"
        elif fact.kind is FactKind.BUSES:
            about += "; bit n: on bus n of icd_bus_t"
        elif fact.is_optional and not has_presence_flag(fact):
            about += (
                "; -1 if the ICD does not say"
                if fact.least == 0
                else "; 0 if the ICD does not say"
            )
        yield f"{type}{name}", about


def _type(fact: ProtocolFact) -> str:
    if fact.kind in _TYPES:
        return _TYPES[fact.kind]
    if fact.is_optional and fact.least == 0 and not has_presence_flag(fact):
        return "int16_t " if fact.holds <= U16 // 2 else "int32_t "
    if fact.holds <= BYTE:
        return "uint8_t "
    return "uint16_t " if fact.holds <= U16 else "uint32_t "
