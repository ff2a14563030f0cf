"""Accessors of physical values in double and single precision and in whole parts of the
unit, and fields as data.

Getters and setters use constants of the module of the message: a `Scale` or a `Curve`
(`scale_of`, `curve_of`). Their expressions are in `icdgen.backends.rust.physical`.
"""

from __future__ import annotations

from typing import Any

from icdgen.backends.lines import STEP, exploded
from icdgen.backends.rust.names import field_name, scale_name
from icdgen.backends.rust.physical import (
    accessors_in_rust,
    curve_name,
    double_raw,
    double_value,
    integer_raw,
    integer_value,
    single_value,
)
from icdgen.backends.rust.text import WIDTH, assigned, double, integer, string
from icdgen.backends.rust.types import struct_path
from icdgen.describe import FieldDescription
from icdgen.describe.accessors import Accessor
from icdgen.describe.description import Composite
from icdgen.frozen import NamedTuple


class RustAccessorCode(NamedTuple):
    """Code of the getter of a physical number, and of the setter if ``raw`` is not
    empty.
    """

    name: str
    type: str
    about: str
    value: str  # expression over the raw value
    raw: str = ""  # expression of the raw value over ``value``, a Result
    what: str = ""  # action of the setter
    refused: str = ""  # values that the setter refuses


def accessors(field: FieldDescription) -> list[RustAccessorCode]:
    """Return the accessors of a field with a scale or calibration."""
    return [
        _accessor_code(accessor)
        for accessor in accessors_in_rust(field)
        if accessor.kind != "text"
    ]


def texts(composite: Composite[Any]) -> list[Accessor]:
    """Return the accessors of text fields; accessors of arrays of texts come first."""
    accessors = [
        accessor
        for field in composite.members
        for accessor in accessors_in_rust(field)
        if accessor.kind == "text"
    ]
    return sorted(accessors, key=lambda accessor: not accessor.field.count)


def _accessor_code(accessor: Accessor) -> RustAccessorCode:
    field = accessor.field
    if accessor.kind == "single":
        # A single has a getter only. The accessor in double precision sets the field.
        return RustAccessorCode(
            accessor.name, "f32", accessor.comment, single_value(field)
        )
    if accessor.kind == "integer":
        type, refused = f"i{accessor.integer_access.bits}", "if it does not fit"
        value = integer_value(field, accessor.integer_access)
        raw = integer_raw(field, accessor.integer_access)
    else:
        type, value, raw = "f64", double_value(field), double_raw(field)
        refused = (
            "if it is beyond the values of the field, or"
            if field.curve is not None
            else "if it does not fit or is"
        )
        refused += " not finite"
    if not accessor.is_settable:
        return RustAccessorCode(accessor.name, type, accessor.comment, value)
    of_element, no_element = (
        ("an element of ", ", or if there is no such element")
        if field.count
        else ("", "")
    )
    what = f"Set {of_element}{accessor.title} to the nearest raw value, ties to even"
    return RustAccessorCode(
        accessor.name,
        type,
        accessor.comment,
        value,
        raw,
        what,
        f"{refused}{no_element}.",
    )


def scale_of(field: FieldDescription) -> str:
    """Return the constant of a field with a scale, or of a field whose type can store
    values that do not fit.
    """
    # Without a scale, generated code uses only the limits of the raw value. The terms
    # of the identity fill the places of the others.
    terms = field.steps.terms if field.steps else (1, 0, 1)
    place = field.model
    numbers = [
        f"({', '.join(map(integer, row))})"
        for row in ((place.raw_min, place.raw_max), terms)
    ]
    return _constant_declaration(
        scale_name(field),
        "Scale",
        [string(place.name), string(field.allowed_text), *numbers],
    )


def _constant_declaration(name: str, type: str, items: list[str]) -> str:
    """Return ``const NAME: Scale = Scale::new(...);``, wrapped as rustfmt does."""
    call = f"{type}::new("
    if len(f"{STEP}{call}{', '.join(items)});") <= WIDTH:
        return assigned(
            f"const {name}: {type} =", f"{call}{', '.join(items)})", ";", ""
        )
    return exploded(f"const {name}: {type} = {call}", items, ");")


def curve_of(field: FieldDescription) -> str:
    """Return the constant of a field with a calibration."""
    assert field.curve is not None
    place = field.model
    ends = (
        # `Curve::raw` searches the whole numbers between these ends. A float has none:
        # `Curve::number` solves the equation of its line.
        place.settable_raws if place.type != "float" and place.is_invertible else (0, 0)
    )
    pieces = [
        f"({double(start)}, &[{', '.join(map(double, terms))}])"
        for start, terms in field.curve.pieces
    ]
    listed = (
        "\n".join(["", *(f"{STEP}{piece}," for piece in pieces), ""])
        if len(pieces) > 1
        else pieces[0]
    )
    items = f"{string(place.name)}, {string(field.allowed_text)}, ({', '.join(map(integer, ends))}), &[{listed}]"
    return f"#[rustfmt::skip]\nconst {curve_name(field)}: Curve = Curve::new({items});"


def field_row(field: FieldDescription) -> str:
    """Return the field as data: place, size, unit, limits and scale."""
    place = field.model
    chain = [f"({string(place.name)}, {integer(place.at)}, {integer(place.bits)})"]
    if field.count:
        chain.append(f".array({field.count})")
    if field.is_text:
        chain.append(".text()")
    if field.struct is not None:
        chain.append(
            f".fields({struct_path(field.struct, field.message.node)}::FIELDS)"
        )
    if place.unit is not None:
        chain.append(f".unit({string(place.unit.symbol)})")
    if field.bounds:
        limits = [f'("{bound.key}", {double(bound.double)})' for bound in field.bounds]
        chain.append(f".limits(&[{', '.join(limits)}])")
    if field.steps is not None:
        chain.append(
            f".{'wide_scale' if field.steps.is_wide else 'scale'}(&{scale_name(field)})"
        )
    if field.curve is not None:
        chain.append(f".curve(&{curve_name(field)})")
    line = "".join(chain)
    if len(chain) == 1 or len(f"{STEP}{field_name(field)}: {line},") <= WIDTH:
        return line
    return f"{chain[0]}\n{STEP * 2}{''.join(chain[1:])}"
