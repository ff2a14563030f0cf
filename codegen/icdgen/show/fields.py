"""The table of a message's fields, as a reader of the manual expects it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction

from icdgen import layout
from icdgen.icd.model import Field, Message
from icdgen.tables import Column, render
from icdgen.values.numbers import exact_text

_COLUMNS = [
    Column("offset", right=True, fixed=True),
    Column("bits", right=True, fixed=True),
    Column("type"),
    Column("name"),
    Column("unit"),
    Column("resolution", right=True),
    Column("from", right=True),
    Column("to", right=True),
    Column("notes"),
]


def field_table(message: Message, width: int | None = None) -> str:
    """Fields and reserved bits in the order of the frame; empty for a message without any."""
    rows: list[tuple[int, tuple[str, ...]]] = [(field.at, _row(field)) for field in message.fields]
    reserved = ("reserved", "", "", "", "", "", "")
    rows += [(gap.at, (str(gap.at), str(gap.bits), *reserved)) for gap in layout.gaps(message)]
    return render(_COLUMNS, [row for _, row in sorted(rows, key=lambda r: r[0])], width)


def _row(field: Field) -> tuple[str, ...]:
    low, high = ("" if bound is None else exact_text(bound) for bound in bounds(field))
    resolution = factor_text(field.scale.factor) if field.scale else ""
    unit = field.unit.symbol if field.unit else ""
    kind = field.enum.name if field.enum else field.type
    return (str(field.at), str(field.bits), kind, field.name, unit, resolution, low, high, "; ".join(_notes(field)))


def factor_text(factor: Fraction) -> str:
    """``0.01``; ``5/9`` where the decimal would not end."""
    text = exact_text(factor)
    return text if Fraction(text) == factor else str(factor)


def bounds(field: Field) -> tuple[Fraction | None, Fraction | None]:
    """Smallest and largest physical value, as far as the type and inclusive limits tell."""
    limits = field.limits
    low = limits.min if limits else None
    high = limits.max if limits else None
    if field.type in ("uint", "int"):
        ends = (Fraction(field.raw_min), Fraction(field.raw_max))
        least, most = sorted(field.scale.physical(end) for end in ends) if field.scale else ends
        low, high = least if low is None else low, most if high is None else high
    return low, high


def remarks(field: Field, number: Callable[[Fraction], str] = exact_text) -> Iterator[str]:
    """What is constant, exclusive limits, and what special values mean; ``number`` writes numbers."""
    if field.const is not None:
        yield f"always {field.const}" + (f" (0x{field.const:X})" if field.const > 9 else "")
    limits = field.limits
    if limits and limits.above is not None:
        yield f"above {number(limits.above)}"
    if limits and limits.below is not None:
        yield f"below {number(limits.below)}"
    for special in field.special:
        yield f"{number(Fraction(special.value))}: {special.meaning}"


def bit_range(at: int, count: int) -> str:
    """``bit 3``, ``bits 4 to 7``"""
    return f"bit {at}" if count == 1 else f"bits {at} to {at + count - 1}"


def _notes(field: Field) -> list[str]:
    notes = list(remarks(field))
    notes += [erratum.id for erratum in field.errata]
    return notes + ([field.summary] if field.summary else [])
