"""How a value is derived from fields, as statements: each makes a local of one operation on two others, or on numbers."""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

from icdgen.describe.description import FieldDescription

Operand = str | float  # a local, or a number


class Statement(NamedTuple):
    """``name = left operator right``, rounded to a double."""

    name: str
    operator: str  # one of + - * / ^
    left: Operand
    right: Operand


class Derived(NamedTuple):
    """``fields`` are the locals that hold physical values, or raw ones where there is no formula, as doubles."""

    fields: tuple[tuple[str, FieldDescription], ...]
    statements: tuple[Statement, ...]
    result: str  # the local that holds it


def derived(field: FieldDescription, taken: Collection[str] = ()) -> Derived:
    """Of a field that is derived; no local is called as one of ``taken`` is."""
    how = field.model.derived
    assert how is not None
    known = {one.model.name: one for one in field.message.declared_members}
    names: list[str] = []
    for name in how.fields:
        names.append(_free(known[name].name, {*taken, *names}))
    fields = tuple((name, known[of]) for name, of in zip(names, how.fields, strict=True))
    row: list[Operand] = [*names, *how.numbers]
    statements = []
    for number, (operator, left, right) in enumerate(how.steps, 1):
        statements.append(Statement(_free(f"step_{number}", names), operator, row[left], row[right]))
        row.append(statements[-1].name)
    result = row[-1]
    assert isinstance(result, str)
    return Derived(fields, tuple(statements), result)


def _free(name: str, taken: Collection[str]) -> str:
    return _free(f"{name}_", taken) if name in taken else name
