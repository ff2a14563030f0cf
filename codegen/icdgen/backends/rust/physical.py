"""Getters of physical values and of derived values.

`icdgen.describe.arithmetic` decides which types compute a scale without an error. Here
the decision becomes an expression, or a call of the support module.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.backends.lines import STEP
from icdgen.backends.rust.names import RESERVED, field_name, scale_name
from icdgen.backends.rust.text import assigned, double, integer, mask, whole_double
from icdgen.describe import FieldDescription
from icdgen.describe.accessors import Accessor, accessors_of
from icdgen.describe.arithmetic import IntegerAccess
from icdgen.describe.derived import computation_of
from icdgen.describe.steps import Steps, wide_parts

# A derived value computes in local variables. These must not shadow the functions of
# the support module that it calls.
_TAKEN = RESERVED | {"power", "quiet", "whole"}


def big_parts(value: int) -> list[str]:
    """Return a term of a wide scale as literals."""
    return [mask(part, 64) if part > 9 else str(part) for part in wide_parts(value, 64)]


def has_constant(field: FieldDescription) -> bool:
    """Return whether code needs the constant of a scale: to set a field, to test a raw
    value, or to compute a physical value.
    """
    arithmetic = field.arithmetic
    if not field.model.is_read_only:
        return arithmetic is not None or field.is_narrow
    return arithmetic is not None and not (
        arithmetic.is_computable_in_doubles and arithmetic.is_computable_in_singles
    )


def accessors_in_rust(field: FieldDescription) -> Iterator[Accessor]:
    """List the accessors.

    `Wide` of the support module, for scales of many digits, has no integers.
    """
    if field.steps is not None and field.steps.is_wide:
        return accessors_of(field, "double", "single")
    return accessors_of(field, "text", "double", "single", "integer")


def raw_value(field: FieldDescription) -> str:
    """Return the raw value: the member, or the method of an overlay field.

    Elements and optional fields are in the variable ``raw``.
    """
    return (
        "raw"
        if field.count or field.model.conditions
        else f"self.{field_name(field)}{'()' if field.model.is_read_only else ''}"
    )


def curve_name(field: FieldDescription) -> str:
    """Return the name of the constant of a calibration: ``TEMPERATURE__CURVE``.

    Names of fields have no double underscore.
    """
    return f"{scale_name(field)}__CURVE"


def double_value(field: FieldDescription) -> str:
    """Return the physical value as a double.

    With a scale it is computed in doubles if every step is exact there, else in 128-bit
    integers by the support module.
    """
    raw, is_long = raw_value(field), field.storage.bits == 64
    if field.arithmetic is None:
        if is_long and field.model.type != "float":
            return f"{curve_name(field)}.whole({raw})"
        return (
            # A float of 64 bits is a double already, and clippy (`useless_conversion`)
            # refuses `f64::from` of it.
            f"{curve_name(field)}.physical({raw if is_long else f'f64::from({raw})'})"
        )
    if not field.arithmetic.is_computable_in_doubles:
        return f"{scale_name(field)}.physical({raw})"
    # Such a raw value has at most 32 bits: `f64` has no `From` for wider integers.
    return _quotient(field.arithmetic.steps, f"f64::from({raw})")


def double_raw(field: FieldDescription) -> str:
    """Return the raw value of the double ``value``, a Result."""
    if field.curve is None:
        return f"{scale_name(field)}.raw(value)"
    kind = (
        {32: "single", 64: "number"}[field.model.bits]
        if field.model.type == "float"
        else "raw"
    )
    return f"{curve_name(field)}.{kind}(value)"


def integer_value(field: FieldDescription, access: IntegerAccess) -> str:
    """Return the physical value in whole parts of the unit."""
    raw, factor, offset = raw_value(field), access.scale.factor, access.scale.offset
    value = (
        # clippy (`useless_conversion`) refuses `i32::from` of an `i32`.
        raw if field.storage == (access.bits, True) else f"i{access.bits}::from({raw})"
    )
    value = value if factor == 1 else f"{value} * {integer(factor)}"
    return (
        f"{value} {'+' if offset > 0 else '-'} {integer(abs(offset))}"
        if offset
        else value
    )


def integer_raw(field: FieldDescription, access: IntegerAccess) -> str:
    """Return the raw value of ``value`` in whole parts of the unit, a Result."""
    # `whole` of the support module takes an i64.
    value = "value" if access.bits == 64 else "value.into()"
    return f"{scale_name(field)}.whole({value}, {integer(access.scale.factor)}, {integer(access.scale.offset)})"


def single_value(field: FieldDescription) -> str:
    """Return the physical value of a field with a scale in single precision."""
    assert field.arithmetic is not None
    if not field.arithmetic.is_computable_in_singles:
        return f"{scale_name(field)}.single({raw_value(field)})"
    # Such a raw value has at most 16 bits: `f32` has no `From` for wider integers.
    return _quotient(field.arithmetic.steps, f"f32::from({raw_value(field)})")


def _quotient(steps: Steps, raw: str) -> str:
    # Only the division rounds here, so the result is the float nearest to the physical
    # value.
    p, c, q = steps.terms
    value = raw if abs(p) == 1 else f"{raw} * {whole_double(abs(p))}"
    if p < 0:
        # In this order a result of 0 is never -0.0 (IEEE 754, 6.3).
        value = f"{whole_double(c)} - {value}"
    elif c:
        value = f"{value} {'+' if c > 0 else '-'} {whole_double(abs(c))}"
    if q == 1:
        return value
    return f"{value if value == raw else f'({value})'} / {whole_double(q)}"


def derived_statements(field: FieldDescription) -> Iterator[str]:
    """List the lines of the method of a derived value."""
    computation = computation_of(field, _TAKEN)
    for name, operand in computation.fields:
        yield assigned(f"let {name} =", _as_double(operand), ";", STEP * 2)
    for name, value in computation.expressions(double, "power({}, {})"):
        yield assigned(f"let {name} =", value, ";", STEP * 2)
    yield f"{STEP * 2}quiet({computation.result})"


def _is_long(field: FieldDescription) -> bool:
    """Return whether it is a whole number of 64 bits, which a double may have to round."""
    return (
        not field.is_scaled and field.storage.bits == 64 and field.model.type != "float"
    )


def _as_double(field: FieldDescription) -> str:
    if field.is_scaled:
        return f"self.{field.physical_name}()"
    raw = raw_value(field)
    if _is_long(field):
        return f"whole({raw})"
    return raw if field.storage.bits == 64 else f"f64::from({raw})"
