"""The fields of a message as data: rows of tables."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.c.text import literal
from icdgen.describe import MessageDescription


class Fields(NamedTuple):
    """Rows of the fields, and of their limits, to which they point."""

    limits: list[str]
    rows: list[str]


def fields(message: MessageDescription) -> Fields:
    """Those of a message, in the order of the ICD, an array as one, of structs each field."""
    found = Fields([], [])
    for field in message.leaves:
        one, bounds = field.model, field.bounds
        limits = f"&limits[{len(found.limits)}]" if bounds else "NULL"
        unit = literal(one.unit.symbol if one.unit else "")
        found.rows.append(
            f"{{{literal(one.name)}, {unit}, {one.at}u, {one.bits}u, {field.count or 1}u, {limits}, {len(bounds)}u}}"
        )
        for bound in bounds:
            value = repr(bound.value.numerator / bound.value.denominator)
            found.limits.append(f"{{ICD_LIMIT_{bound.key.upper()}, {value}}}")
    return found
