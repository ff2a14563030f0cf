"""Fields: annotations, documentation, what they are at first, properties of physical values."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from icdgen.backends.lines import bracketed, exploded
from icdgen.backends.python.names import class_name
from icdgen.backends.python.text import WIDTH, docstring, literal, paragraph
from icdgen.describe import FieldDescription
from icdgen.describe.comments import physical_comment

_KEYWORDS = {"min": "minimum", "max": "maximum"}


class Row(NamedTuple):
    """One field."""

    attribute: str
    kind: str  # its annotation
    doc: str
    parameter: str  # of __init__
    physical: str  # name of the property with the physical value, or of the attribute
    physical_parameter: str  # of from_physical
    info: str  # FieldInfo(...)


class Scaled(NamedTuple):
    """The property that holds a physical value."""

    name: str
    doc: str
    result: str
    assign: str


def row(field: FieldDescription, default: str) -> Row:
    """Everything that the template needs of a field; ``default`` is an expression."""
    kind = class_name(field.enum) if field.enum else "int" if field.model.type == "uint" else field.model.type
    parameter = f"{field.name}: {kind} = {default}"
    physical, physical_parameter = field.name, parameter
    if field.steps is not None:
        physical = field.physical_name
        physical_parameter = f"{physical}: float = {field.steps.double(field.fresh)!r}"
    doc = docstring(4, map(paragraph, field.comment.paragraphs))
    return Row(field.name, kind, doc, parameter, physical, physical_parameter, _info(field, kind))


def _number(exact: Fraction) -> str:
    return str(exact.numerator) if exact.denominator == 1 else repr(exact.numerator / exact.denominator)


def _info(field: FieldDescription, kind: str) -> str:
    one = field.model
    items = [f'"{field.name}"', literal(one.name), str(one.at), str(one.bits), f'"{one.type}"']
    if one.unit:
        items.append(f"unit={literal(one.unit.symbol)}")
    if field.steps is not None:
        items += [f'physical="{field.physical_name}"', f"scale={field.steps.terms}"]
    if field.enum is not None:
        items.append(f"enum={kind}")
    if one.const is not None:
        items.append(f"const={one.const}")
    if one.special:
        pairs = [f"({special.value}, {literal(special.meaning)})" for special in one.special]
        items.append(exploded("special=(", pairs, ")", " " * 12))
    items += (f'{key}="{value}"' for key in ("byte_order", "bit_order") if (value := getattr(one, key)))
    items += (f"{_KEYWORDS.get(bound.key, bound.key)}={_number(bound.value)}" for bound in field.bounds)
    return bracketed("_base.FieldInfo(", items, ")", WIDTH, " " * 8)


def scaled(field: FieldDescription) -> Scaled:
    """The property of a field with a scale."""
    assert field.steps is not None
    p, c, q = field.steps.terms
    value = f"self.{field.name}" if p == 1 else f"self.{field.name} * {p}"
    if c:
        value = f"{value} {'+' if c > 0 else '-'} {abs(c)}"
    ends = str(field.model.raw_min), str(field.model.raw_max)
    arguments = ["value", f'"{field.name}"', str(field.steps.terms), *ends]
    return Scaled(
        field.physical_name,
        docstring(8, [paragraph(physical_comment(field.model, field.steps))]),
        f"float({value})" if q == 1 else f"({value}) / {q}" if c else f"{value} / {q}",
        bracketed(f"self.{field.name} = _codec.raw_value(", arguments, ")", WIDTH, " " * 8),
    )
