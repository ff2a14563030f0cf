"""Documentation comments of the generated code: the facts of the ICD in a few words."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from functools import lru_cache

from icdgen.backends.c.text import plain
from icdgen.icd.formula import is_inverse
from icdgen.icd.model import CONFIGURATION, Enum, Erratum, Field, Limits, Member, Message


@lru_cache(maxsize=4096)
def number(value: Fraction | int) -> str:
    """Exact if it has at most 15 digits, else the nearest double."""
    if value.denominator == 1 and abs(value) < 10**15:
        return str(int(value))
    exact = f"{float(value):.15g}"
    return exact if Fraction(exact) == value else f"{float(value):.6g}"


def notes(errata: Iterable[Erratum]) -> list[str]:
    """One paragraph an erratum."""
    return [f"@note {plain(e.id)}: {plain(e.title)}{_ends(e.title)}" for e in errata]


def _ends(text: str) -> str:
    return "" if text.rstrip().endswith((".", "?", "!")) else "."


def sentence(text: str) -> str:
    """The text with a full stop; empty if it is empty."""
    return plain(text) + _ends(text) if text else ""


def message(one: Message, loggable: dict[int, int]) -> list[str]:
    """What the message is, where it stands in the manual, what is special about it."""
    if one.kind == CONFIGURATION:
        ids = f"set {one.set_id}, get {one.get_id}"
    else:
        ids = str(one.id)
    head = f"{plain(one.name)}: {one.kind} {ids}, {one.length} byte{'s' * (one.length != 1)}."
    if one.table is not None:
        head += f" Table {one.table}."
    facts = []
    if one.expects_reset:
        facts.append("The node restarts instead of acknowledging it.")
    elif not one.acknowledge:
        facts.append("The node does not acknowledge it.")
    if one.telemetry_id in loggable:
        facts.append(f"Bit {loggable[one.telemetry_id]} of the log mask.")
    facts += (f"Repeats {plain(part.message)} from {_from(part.at)}." for part in one.contains)
    return [head, sentence(one.summary), " ".join(facts), *notes(one.errata)]


def _from(at: int) -> str:
    return f"byte {at // 8}" if at % 8 == 0 else f"bit {at}"


def enum(one: Enum) -> str:
    """Name and table of an enumeration."""
    return f"{plain(one.name)}." + (f" Table {one.table}." if one.table is not None else "")


def member(one: Member) -> str:
    """Name and summary of a member of an enumeration."""
    return f"{plain(one.name)}. {sentence(one.summary)}".rstrip()


def field(one: Field, narrow: bool) -> list[str]:
    """Where the field lies and what its raw values mean; ``narrow``: not every value of the C type fits."""
    facts = [f"{plain(one.name)}: {_position(one)}{_raw_range(one) if narrow else ''}{_meaning(one)}."]
    if one.const is not None:
        facts.append(f"Always {value(one.const)}.")
    if one.limits is not None:
        facts.append(f"Must be {limits(one.limits)}.")
    facts += (f"{value(s.value)}: {sentence(s.meaning)}" for s in one.special)
    facts.append(sentence(one.summary))
    return [" ".join(f for f in facts if f), *notes(one.errata)]


def value(raw: int) -> str:
    """A raw value that means something by itself: small ones in decimal, others in hexadecimal."""
    return f"0x{raw:X}" if raw > 9 else str(raw)


def _position(one: Field) -> str:
    if one.type == "bytes":
        first, last = one.at // 8, (one.at + one.bits) // 8 - 1
        return f"byte {first}" if first == last else f"bytes {first} to {last}"
    return _bits(one.at, one.bits)


def _bits(at: int, bits: int) -> str:
    return f"bit {at}" if bits == 1 else f"bits {at} to {at + bits - 1}"


def _raw_range(one: Field) -> str:
    return f", raw {one.raw_min} to {one.raw_max}"


def _meaning(one: Field) -> str:
    if one.scale is None:
        return f", in {plain(one.unit.symbol)}" if one.unit else ""
    return f"; {formula(one)}, {physical_range(one)}"


def formula(one: Field) -> str:
    """The formula as the ICD has it, and the unit of what it gives."""
    text = plain(one.formula)
    if one.unit is None:
        return text
    unit = plain(one.unit.symbol)
    return f"{text}, value in {unit}" if is_inverse(text) else f"{text} {unit}"


def physical_range(one: Field) -> str:
    """``-327.68 to 327.67``: the physical values of the raw values that fit."""
    low, high = _range(one.scale, one.raw_min, one.raw_max)
    return f"{low} to {high}"


@lru_cache(maxsize=1024)
def _range(scale, low: int, high: int) -> tuple[str, str]:
    first, last = sorted((scale.physical(low), scale.physical(high)))
    return number(first), number(last)


def limits(one: Limits) -> str:
    """``above 0 and at most 10``"""
    words = {"at least": one.min, "above": one.above, "at most": one.max, "below": one.below}
    return " and ".join(f"{word} {number(value)}" for word, value in words.items() if value is not None)
