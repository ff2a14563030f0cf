"""What documentation comments say about messages, fields, enumerations and their members."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from icdgen.backends.rust.scales import physical_range
from icdgen.backends.rust.text import code, decimal, prose, sentence
from icdgen.icd.model import Enum, Erratum, Field, Limits, Member, Message


def errata(entries: Iterable[Erratum]) -> list[str]:
    """One paragraph an erratum."""
    return [f"{e.label} {prose(e.id)}{e.sureness}: {sentence(prose(e.title))}" for e in entries]


def _table(number: int | None) -> str:
    return f" Table {number}." if number is not None else ""


def _bytes(count: int) -> str:
    return f"{count} byte" if count == 1 else f"{count} bytes"


def message(message: Message) -> list[str]:
    """Name, kind, ids, length, table; summary; errata."""
    if message.id is not None:
        kind = f"{message.kind} {message.id}"
    else:
        kind = f"{message.kind}, set by {message.set_id} and got by {message.get_id}"
    head = f"{prose(message.name)}: {kind}, {_bytes(message.length)}.{_table(message.table)}"
    more = [sentence(prose(message.summary))] if message.summary else []
    if message.expects_reset:
        more.append("The node restarts instead of acknowledging it.")
    elif not message.acknowledge:
        more.append("It is not acknowledged.")
    return [head, " ".join(more), *errata(message.errata)]


def field(field: Field) -> list[str]:
    """Name, place, range, unit; summary, constant, special values, limits, parts; errata."""
    last = field.at + field.bits - 1
    place = f"bit {field.at}" if field.bits == 1 else f"bits {field.at} to {last}"
    head = f"{prose(field.name)} ({place})"
    unit = f" {prose(field.unit.symbol)}" if field.unit else ""
    if field.scale is not None:
        span = physical_range(field.scale, field.raw_min, field.raw_max)
        head += f": raw, {field.raw_min} to {field.raw_max}; physical {code(field.formula)}, {span}{unit}."
    elif field.type in ("uint", "int"):
        head += f": {field.raw_min} to {field.raw_max}{unit}."
    elif field.type == "float":
        head += f": {field.bits}-bit float{f', in{unit}' if unit else ''}."
    elif field.type == "bytes":
        head += f": {_bytes(field.bits // 8)}."
    else:
        head += "."
    more = [sentence(prose(field.summary))] if field.summary else []
    if field.const is not None:
        more.append(f"Always {field.const}.")
    more += (f"{special.value}: {sentence(prose(special.meaning))}" for special in field.special)
    if field.limits is not None:
        more.append(limits(field.limits, unit))
    return [head, " ".join(more), *errata(field.errata)]


def limits(limits: Limits, unit: str) -> str:
    """``At least 0, below 20480 mA.``"""
    rows = (("at least", limits.min), ("at most", limits.max), ("above", limits.above), ("below", limits.below))
    text = ", ".join(f"{word} {_number(bound)}{unit}" for word, bound in rows if bound is not None)
    return f"Must be {text}."


def _number(value: Fraction) -> str:
    return decimal(value.numerator / value.denominator)


def enum(enum: Enum) -> list[str]:
    """Name, table; summary; errata."""
    head = f"{prose(enum.name)}: an enumeration.{_table(enum.table)}"
    return [head, sentence(prose(enum.summary)) if enum.summary else "", *errata(enum.errata)]


def member(member: Member) -> list[str]:
    """Value, name; summary; errata."""
    head = f"{prose(member.name)} ({member.value})."
    return [head, sentence(prose(member.summary)) if member.summary else "", *errata(member.errata)]
