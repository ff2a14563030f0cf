"""Getter and setter of a physical value."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.lines import STEP
from icdgen.backends.rust.text import assigned, doc, prose, signature, whole_double
from icdgen.describe import FieldDescription
from icdgen.describe.comments import physical_comment, physical_name
from icdgen.describe.steps import Steps


class Accessors(NamedTuple):
    """The physical accessors of a field."""

    doc: str
    signature: str
    expression: str
    set_doc: str
    set_signature: str
    assignment: str


def accessors(field: FieldDescription) -> Accessors:
    """Those of a field with a scale. The support module's entry of the field checks what is set."""
    assert field.steps is not None
    getter, constant, what = field.physical_name, field.name.upper(), physical_name(field.model)
    return Accessors(
        doc([prose(physical_comment(field.model, field.steps))], "    "),
        signature(f"pub fn {getter}", ("&self",), "f64"),
        _physical(field.steps, field.storage.bits, f"self.{field.name}", constant),
        doc([prose(f"Sets {what}, to the nearest raw value, ties to even.")], "    "),
        signature(f"pub fn set_{getter}", ("&mut self", "value: f64"), "Result<(), Error>"),
        assigned(f"self.{field.name} =", f"{constant}.raw(value)?", ";", STEP * 2),
    )


def _physical(steps: Steps, bits: int, raw: str, constant: str) -> str:
    """In doubles where every step is exact in them, else through 128-bit integers of the support module."""
    if bits > 32 or not steps.exact_in_doubles:
        return f"{constant}.physical({raw})"
    p, c, q = steps.terms
    raw = f"f64::from({raw})"
    value = raw if abs(p) == 1 else f"{raw} * {whole_double(abs(p))}"
    if p < 0:
        value = f"{whole_double(c)} - {value}"  # so that a zero comes out positive, whatever the signs
    elif c:
        value = f"{value} {'+' if c > 0 else '-'} {whole_double(abs(c))}"
    if q == 1:
        return value
    return f"{value if value == raw else f'({value})'} / {whole_double(q)}"
