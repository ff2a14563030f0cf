"""Accessors of physical values, overlay fields and derived values.

`double_accessors` and `integer_accessors` return types, comments and expressions for
the template ``accessors.h.j2``. The arithmetic is in `icdgen.backends.c.physical`.
"""

from __future__ import annotations

from typing import Any

from icdgen.backends.c import physical
from icdgen.backends.c.names import RESERVED, getter
from icdgen.backends.c.statement import call, either
from icdgen.backends.c.text import WIDTH, described
from icdgen.backends.lines import STEP
from icdgen.describe import FieldDescription
from icdgen.describe.accessors import Accessor, Kind, accessors_of
from icdgen.describe.derived import computation_of
from icdgen.describe.description import Composite
from icdgen.frozen import NamedTuple


class CAccessorCode(NamedTuple):
    """Code of the getter and setter of a physical value.

    Without a setter, for overlay fields and calibrations without an inverse,
    ``assignment`` is empty.
    """

    end: str  # end of the names
    type: str
    about: str
    title: str  # name of the value in words
    expression: str
    assignment: str = ""
    refused: str = ""  # condition for values that the setter refuses by itself
    declared: tuple[str, ...] = ()  # lines at the start of both functions
    elements: int = 0  # of an array: both functions have the index as a parameter


def double_accessors(message: Composite[Any]) -> list[CAccessorCode]:
    """Return the accessors in double precision."""
    return [
        *map(_double_code, of_kind(message, "double")),
        *map(_derived_code, message.derived),
    ]


def integer_accessors(message: Composite[Any]) -> list[CAccessorCode]:
    """Return the accessors in whole thousandths or millionths of the unit."""
    return list(map(_integer_code, of_kind(message, "integer")))


def of_kind(message: Composite[Any], kind: Kind) -> list[Accessor]:
    """Return the accessors of one kind."""
    return [
        accessor
        for field in message.declared_members
        for accessor in accessors_of(field, kind)
    ]


def _double_code(accessor: Accessor) -> CAccessorCode:
    field, assignment = accessor.field, ""
    if accessor.is_settable:
        function, *arguments = physical.double_setter(field)
        assignment = call(
            f"return {function}", (f"&{_member_expression(field)}", *arguments)
        )
    return CAccessorCode(
        accessor.name,
        "double",
        accessor.comment,
        accessor.title,
        physical.double_value(field, _raw_value(field)),
        assignment,
        declared=tuple(physical.accessor_declarations(field)),
        elements=field.count,
    )


def _integer_code(accessor: Accessor) -> CAccessorCode:
    field, access = accessor.field, accessor.integer_access
    refused = physical.integer_range(access)
    return CAccessorCode(
        accessor.name,
        f"int{access.bits}_t",
        accessor.comment,
        accessor.title,
        physical.integer_value(access, _raw_value(field)),
        (
            f"{_member_expression(field)} = {physical.integer_raw(access, field.storage)};"
            if accessor.is_settable
            else ""
        ),
        either(refused) if refused else "",
        elements=field.count,
    )


def _derived_code(field: FieldDescription) -> CAccessorCode:
    computation = computation_of(field, taken=RESERVED | {"message"})
    lines = [
        _constant_declaration(f"const double {name}", _as_double(operand))
        for name, operand in computation.fields
    ]
    for name, value in computation.expressions(repr, "icdgen_power({}, {})"):
        # Compilers may keep intermediate results in a wider format (`FLT_EVAL_METHOD`,
        # C99 5.2.4.2.2) and fuse a product with a sum (6.5). A volatile object makes
        # each step a double, so that all targets compute the same bits.
        lines.append(_constant_declaration(f"const volatile double {name}", value))
    about = " ".join(field.comment.paragraphs)
    return CAccessorCode(
        field.name,
        "double",
        about,
        "",
        f"icdgen_quiet({computation.result})",
        declared=tuple(lines),
    )


def _constant_declaration(head: str, value: str) -> str:
    line = f"{head} = {value};"
    return line if len(STEP) + len(line) <= WIDTH else f"{head} =\n{STEP * 2}{value};"


def _as_double(field: FieldDescription) -> str:
    """Return the physical value of a field of ``message`` as a double; the raw value
    without a scale.
    """
    if field.is_scaled:
        return f"{getter(field.message, field.physical_name)}(message)"
    raw = _raw_value(field)
    return (
        raw
        if field.model.type == "float" and field.model.bits == 64
        else f"ICDGEN_CAST(double, {raw})"
    )


_FROM_FRAME = "Read from the frame that the message makes: 0 if it makes none, as a raw value does not fit its field."


def overlay_comment(field: FieldDescription) -> str:
    """Return the comment of the getter of an overlay field."""
    about = field.comment
    if field.message.is_narrow:
        # Only such a message can fail to encode: its types can store values that its
        # fields cannot.
        about = about._replace(details=(*about.details, _FROM_FRAME))
    return described(about)


def _raw_value(field: FieldDescription) -> str:
    """Return the raw value of a field of ``message``."""
    return (
        f"{getter(field.message, field.name)}(message)"
        if field.model.is_read_only
        else _member_expression(field)
    )


def _member_expression(field: FieldDescription) -> str:
    return f"message->{field.name}{'[element]' if field.count else ''}"
