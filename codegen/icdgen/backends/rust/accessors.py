"""Accessors of physical values in double and single precision and in whole parts of the unit, and fields as data."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.lines import STEP, exploded
from icdgen.backends.rust.names import field_name, struct_path
from icdgen.backends.rust.physical import curve_name, curve_value, physical, raw_value, single
from icdgen.backends.rust.text import WIDTH, assigned, double, integer, string
from icdgen.describe import FieldDescription
from icdgen.describe.arithmetic import IntegerAccess
from icdgen.describe.comments import physical_comment, physical_name
from icdgen.describe.integer_scale import IntegerScale


class Accessor(NamedTuple):
    """Getter, and setter if ``raw`` is not empty."""

    name: str
    type: str
    about: str
    value: str  # expression over the raw value
    what: str = ""  # action of the setter
    refused: str = ""  # values that the setter refuses
    raw: str = ""  # expression of the raw value over ``value``, a Result


def accessors(field: FieldDescription) -> list[Accessor]:
    """Return the accessors of a field with a scale or calibration."""
    name, about, what = field.physical_name, physical_comment(field.model), physical_name(field.model)
    sets = f"Set {'an element of ' if field.count else ''}{{}} to the nearest raw value, ties to even"
    end = ", or if there is no such element." if field.count else "."
    if field.curve is not None:
        kind = {32: "single", 64: "number"}[field.model.bits] if field.model.type == "float" else "raw"
        raw = f"{curve_name(field)}.{kind}(value)" if field.is_settable else ""
        refused = f"if it is beyond the values of the field, or not finite{end}"
        return [Accessor(name, "f64", about, curve_value(field), sets.format(what), refused, raw)]
    scale, refused = field.declared_name.upper(), f"if it does not fit or is not finite{end}"
    result = [
        Accessor(name, "f64", about, physical(field), sets.format(what), refused, f"{scale}.raw(value)"),
        Accessor(single_name(field), "f32", f"{what}, the nearest float of 32 bits.", single(field)),
    ]
    integers = integers_of(field)
    if integers is not None:
        exact, bits = integers.scale, integers.bits
        value = "value" if bits == 64 else "value.into()"
        raw = f"{scale}.whole({value}, {integer(exact.factor)}, {integer(exact.offset)})"
        name, about, what = field.integer_name(exact.per), field.integer_comment(exact), field.integer_title(exact.per)
        read = _integer_value(field, exact, bits)
        result.append(Accessor(name, f"i{bits}", about, read, sets.format(what), f"if it does not fit{end}", raw))
    return result


def single_name(field: FieldDescription) -> str:
    """Return the name of the accessor in single precision: ``estimated_roll_angle_deg_f32``."""
    return f"{field.physical_name}_f32"


def integers_of(field: FieldDescription) -> IntegerAccess | None:
    """Return the accessors in whole parts of the unit. `Wide` of the support module, for scales of many digits, has none."""
    arithmetic = field.arithmetic
    return None if arithmetic is None or arithmetic.steps.is_wide else arithmetic.integers


def _integer_value(field: FieldDescription, exact: IntegerScale, bits: int) -> str:
    raw = raw_value(field)
    value = raw if field.storage == (bits, True) else f"i{bits}::from({raw})"
    value = value if exact.factor == 1 else f"{value} * {integer(exact.factor)}"
    return value if not exact.offset else f"{value} {'+' if exact.offset > 0 else '-'} {integer(abs(exact.offset))}"


def scale_of(field: FieldDescription) -> str:
    """Return the constant of a field with a scale, or of a field whose type can store values that do not fit."""
    terms = field.steps.terms if field.steps else (1, 0, 1)
    place = field.model
    numbers = [f"({', '.join(map(integer, row))})" for row in ((place.raw_min, place.raw_max), terms)]
    return _constant(field.name.upper(), "Scale", [string(place.name), string(field.allowed_text), *numbers])


def _constant(name: str, type: str, items: list[str]) -> str:
    """Return ``const NAME: Scale = Scale::new(...);``, wrapped as rustfmt does."""
    call = f"{type}::new("
    if len(f"{STEP}{call}{', '.join(items)});") <= WIDTH:
        return assigned(f"const {name}: {type} =", f"{call}{', '.join(items)})", ";", "")
    return exploded(f"const {name}: {type} = {call}", items, ");")


def curve_of(field: FieldDescription) -> str:
    """Return the constant of a field with a calibration."""
    assert field.curve is not None
    place = field.model
    ends = place.settable_raws if place.type != "float" and place.is_invertible else (0, 0)
    pieces = [f"({double(start)}, &[{', '.join(map(double, terms))}])" for start, terms in field.curve.pieces]
    listed = "\n".join(["", *(f"{STEP}{piece}," for piece in pieces), ""]) if len(pieces) > 1 else pieces[0]
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
        chain.append(f".fields({struct_path(field.struct, field.message.node)}::FIELDS)")
    if place.unit is not None:
        chain.append(f".unit({string(place.unit.symbol)})")
    if field.bounds:
        limits = [f'("{bound.key}", {double(bound.double)})' for bound in field.bounds]
        chain.append(f".limits(&[{', '.join(limits)}])")
    if field.steps is not None:
        chain.append(f".{'wide_scale' if field.steps.is_wide else 'scale'}(&{field.name.upper()})")
    if field.curve is not None:
        chain.append(f".curve(&{curve_name(field)})")
    line = "".join(chain)
    if len(chain) == 1 or len(f"{STEP}{field_name(field)}: {line},") <= WIDTH:
        return line
    return f"{chain[0]}\n{STEP * 2}{''.join(chain[1:])}"
