"""The fields of a message, or of a struct, as data: rows of tables."""

from __future__ import annotations

from typing import Any, NamedTuple

from icdgen.backends.c.names import stem
from icdgen.backends.c.text import literal
from icdgen.describe.description import Composite


class Fields(NamedTuple):
    """Rows of the fields, and of their limits, to which they point."""

    limits: list[str]
    rows: list[str]


def fields(one: Composite[Any]) -> Fields:
    """Those of a message or a struct, in the order of the ICD, an array as one, and a struct."""
    found = Fields([], [])
    for field in one.members:
        model, bounds = field.model, field.bounds
        limits = f"&limits[{len(found.limits)}]" if bounds else "NULL"
        unit = literal(model.unit.symbol if model.unit else "")
        inside = "NULL" if field.struct is None else f"{stem(field.struct)}_fields"
        place = f"{model.at}u, {model.bits}u, {field.count or 1}u"
        found.rows.append(f"{{{literal(model.name)}, {unit}, {place}, {limits}, {len(bounds)}u, {inside}}}")
        for bound in bounds:
            value = repr(bound.value.numerator / bound.value.denominator)
            found.limits.append(f"{{ICD_LIMIT_{bound.key.upper()}, {value}}}")
    return found
