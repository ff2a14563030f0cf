"""Accessors of physical values, overlay fields and derived values."""

from __future__ import annotations

from typing import Any, NamedTuple

from icdgen.backends.c import decoding, physical
from icdgen.backends.c.names import RESERVED, stem
from icdgen.backends.c.statement import call, either
from icdgen.backends.c.text import WIDTH, described
from icdgen.backends.c.types import type_of
from icdgen.backends.lines import STEP
from icdgen.describe import FieldDescription
from icdgen.describe.comments import physical_comment, physical_name
from icdgen.describe.derived import derived
from icdgen.describe.description import Composite

ELEMENT = "element"
"""Parameter for the index of an element of an array."""


class Accessor(NamedTuple):
    """Getter and setter of a physical value. ``test`` is the condition for values that the setter refuses by itself.

    Without a setter, for overlay fields and calibrations without an inverse, ``assignment`` is empty.
    """

    end: str  # end of the names
    type: str
    about: str
    what: str  # title of the value
    expression: str
    assignment: str
    test: str = ""
    declared: tuple[str, ...] = ()  # lines at the start of both functions
    elements: int = 0  # of an array: both functions have the index as a parameter


def accessors(message: Composite[Any]) -> list[Accessor]:
    """Return the accessors in double precision."""
    scaled = [_double(field) for field in message.declared_members if field.is_scaled]
    return [*scaled, *map(_derived, message.derived)]


def _derived(field: FieldDescription) -> Accessor:
    computation = derived(field, taken=RESERVED | {"message"})
    lines = [_constant(f"const double {name}", _as_double(operand)) for name, operand in computation.fields]
    for name, operator, *operands in computation.statements:
        left, right = (operand if isinstance(operand, str) else repr(operand) for operand in operands)
        value = f"icdgen_power({left}, {right})" if operator == "^" else f"{left} {operator} {right}"
        lines.append(_constant(f"const volatile double {name}", value))
    about = " ".join(field.comment.paragraphs)
    return Accessor(field.name, "double", about, "", f"icdgen_quiet({computation.result})", "", declared=tuple(lines))


def _constant(head: str, value: str) -> str:
    line = f"{head} = {value};"
    return line if len(STEP) + len(line) <= WIDTH else f"{head} =\n{STEP * 2}{value};"


def _as_double(field: FieldDescription) -> str:
    """Return the physical value of a field of ``message`` as a double; the raw value without a scale."""
    if field.is_scaled:
        return f"{stem(field.message)}_{field.physical_name}(message)"
    raw = f"{stem(field.message)}_{field.name}(message)" if field.model.view else _member(field)
    return raw if field.model.type == "float" and field.model.bits == 64 else f"ICDGEN_CAST(double, {raw})"


_FROM_FRAME = "Read from the frame that the message makes: 0 if it makes none, as a raw value does not fit its field."


def overlay(field: FieldDescription) -> dict[str, str]:
    """Return the getter of an overlay field. Its ``statement`` reads ``value`` from ``buffer``."""
    about = field.comment._replace(
        details=(*field.comment.details, _FROM_FRAME) if field.message.is_narrow else field.comment.details
    )
    statement = decoding.number(field, "value")
    return {"name": field.name, "type": type_of(field), "about": described(about), "statement": statement}


def _double(field: FieldDescription) -> Accessor:
    scaled = physical.scaled(field)
    function, *arguments = scaled.setter
    return Accessor(
        end=field.physical_name,
        type="double",
        about=physical_comment(field.model),
        what=physical_name(field.model),
        expression=scaled.getter.format(raw=_raw(field)),
        assignment="" if not field.is_settable else call(f"return {function}", (f"&{_member(field)}", *arguments)),
        declared=scaled.declared,
        elements=field.count,
    )


def _raw(field: FieldDescription) -> str:
    """Return the raw value of a field of ``message``."""
    return f"{stem(field.message)}_{field.name}(message)" if field.model.view else _member(field)


def _member(field: FieldDescription) -> str:
    return f"message->{field.name}{f'[{ELEMENT}]' if field.count else ''}"


def integer_accessors(message: Composite[Any]) -> list[Accessor]:
    """Return the accessors in whole thousandths or millionths of the unit."""
    scaled = [field for field in message.declared_members if field.steps is not None]
    candidates = ((field, physical.scaled(field).integers) for field in scaled)
    return [_integer_accessor(field, integers) for field, integers in candidates if integers is not None]


def _integer_accessor(field: FieldDescription, integers: physical.IntegerAccessors) -> Accessor:
    return Accessor(
        end=field.integer_name(integers.scale.per),
        type=integers.type,
        about=field.integer_comment(integers.scale),
        what=field.integer_title(integers.scale.per),
        expression=integers.getter.format(raw=_raw(field)),
        assignment="" if field.model.view else f"{_member(field)} = {integers.setter};",
        test=either(integers.refused) if integers.refused else "",
        elements=field.count,
    )
