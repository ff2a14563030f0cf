"""Values that a field must be able to hold: enumeration members, constants, special values."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd.model import Field
from icdgen.icd.rules.context import Context, mappings
from icdgen.icd.rules.fault import Fault
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import count, quote

NUMBERS = ("uint", "int", "enum")


@rule("ICD030")
def member_fits(ctx: Context) -> Iterator[Fault]:
    largest = {id(e): e.widest for n in ctx.icd.nodes for e in n.enums}
    for field, _, _ in ctx.having["enum"]:
        top = largest.get(id(field.enum)) if field.enum else None
        if field.enum and top is not None and not field.raw_min <= top.value <= field.raw_max:
            unfit = sum(not field.raw_min <= m.value <= field.raw_max for m in field.enum.members)
            others = f" (nor do {unfit - 1} others)" if unfit > 2 else " (nor does another)" if unfit == 2 else ""
            member = f"{quote(top.name)} = {top.value} of {quote(field.enum.name)}"
            yield Fault(
                field.source,
                field.source.at("bits"),
                f"{member} does not fit the {count(field.bits, 'bit')} of {quote(field.name)}{others}",
                f"it takes {count(field.enum.bits_for(top.value), 'bit')}"
                + (", as others of the enumeration are negative" if field.signed and top.value >= 0 else ""),
            )


@rule("ICD031")
def const_fits(ctx: Context) -> Iterator[Fault]:
    for field, _, _ in ctx.having["const"]:
        problem = _misfit(field, field.const)
        if problem:
            yield Fault(field.source, field.source.at("const"), f"`const` {problem[0]}", problem[1])


@rule("ICD032")
def special_fits(ctx: Context) -> Iterator[Fault]:
    for field, _, _ in ctx.having["special"]:
        seen = set()
        for item in mappings(field.source["special"]):
            value = item.get("value")
            if not isinstance(value, int):
                continue
            problem = _misfit(field, value)
            if problem:
                yield Fault(field.source, item.at("value"), f"the special value {problem[0]}", problem[1])
            elif value in seen:
                message = f"{value} has two meanings in {quote(field.name)}"
                yield Fault(field.source, item.at("value"), message, "join them into one entry")
            seen.add(value)


def _misfit(field: Field, value: int | None) -> tuple[str, str] | None:
    """What keeps the field from holding the raw value, and what to do; None if it fits."""
    if field.type not in NUMBERS:
        what = f"of {quote(field.name)} has no meaning for type `{field.type}`"
        return what, "only uint, int and enum fields have it"
    if value is None or field.raw_min <= value <= field.raw_max:
        return None
    shown = str(value) if abs(value) < 1 << 64 else f"of {value.bit_length()} bits"
    what = f"{shown} does not fit {quote(field.name)}"
    return what, f"{count(field.bits, 'bit')} of `{field.type}` hold {field.raw_min} to {field.raw_max}"
