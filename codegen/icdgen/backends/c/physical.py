"""Expressions of physical values in double precision, and in whole thousandths or
millionths of the unit.

`icdgen.describe.arithmetic` decides which types compute a scale without an error. Here
the decision becomes an expression, or a call of the support header.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.backends.c.types import cast
from icdgen.describe import FieldDescription
from icdgen.describe.arithmetic import IntegerAccess
from icdgen.describe.steps import Steps, wide_parts
from icdgen.describe.storage import Storage
from icdgen.icd.curve import Curve

INT32, INT64 = (1 << 31) - 1, (1 << 63) - 1


def accessor_declarations(field: FieldDescription) -> Iterator[str]:
    """List the lines at the start of the accessors in double precision: a calibration,
    or a scale of many digits.
    """
    if field.curve is not None:
        yield from _curve_declarations(field.curve)
    elif field.steps is not None and field.steps.is_wide:
        yield from _wide_scale(field.steps)


def _curve_declarations(curve: Curve) -> Iterator[str]:
    """List the declarations of a calibration: the terms of all pieces, then the pieces."""
    terms: list[str] = []  # those of a piece in a row
    pieces: list[str] = []
    at = 0  # index of the first term of the piece
    for start, own_terms in curve.pieces:
        # A piece without terms has no physical value and does not read its pointer.
        # `&terms[at]` could be beyond the array there.
        pointer = f"&terms[{at}]" if own_terms else "terms"
        pieces.append(f"{{{start!r}, {pointer}, {len(own_terms)}u}}")
        if own_terms:
            terms.append(", ".join(map(repr, own_terms)))
        at += len(own_terms)
    yield from _array_declaration("static const double terms[]", terms)
    yield from _array_declaration("static const icdgen_piece_t curve[]", pieces)


def _array_declaration(head: str, rows: list[str]) -> Iterator[str]:
    if len(rows) == 1:
        yield f"{head} = {{{rows[0]}}};"
        return
    yield f"{head} = {{"
    yield from (f"    {row}," for row in rows)
    yield "};"


def _wide_scale(steps: Steps) -> Iterator[str]:
    """List the declaration of a scale that `icdgen_wide.h` computes: its terms are too
    large for 128 bits.
    """
    yield "static const icdgen_scale_t scale = {"
    for term in steps.terms:
        parts = (
            f"0x{part:X}u" if part > 9 else f"{part}u" for part in wide_parts(term, 32)
        )
        yield f"    {{{{{', '.join(parts)}}}}},"
    yield "};"


def int64(value: int) -> str:
    """Return the literal of a signed integer of 64 bits."""
    # A minus sign is an operator and no part of a literal (C99 6.4.4.1), and
    # 9223372036854775808 does not fit into 64 bits with a sign.
    if value == -INT64 - 1:
        return "INT64_MIN"
    return f"INT64_C({value})" if abs(value) > INT32 else str(value)


def _limit(value: int, storage: Storage) -> str:
    # C has no negative literals (C99 6.4.4.1): -2147483648 is the negation of a number
    # that does not fit into 32 bits.
    if value == storage.min and storage.signed:
        return f"INT{storage.bits}_MIN"
    if value == storage.max:
        return f"{'' if storage.signed else 'U'}INT{storage.bits}_MAX"
    if storage.signed:
        return int64(value)
    return f"UINT64_C({value})" if value >= 1 << 32 else f"{value}u"


def _function_suffix(storage: Storage, bits: int = 0) -> str:
    """Return the end of the name of a function: ``u16``; with ``bits`` for integers of
    this width.
    """
    return f"{'i' if storage.signed else 'u'}{bits or storage.bits}"


def double_value(field: FieldDescription, raw: str) -> str:
    """Return the physical value of a raw value as a double."""
    if field.curve is not None:
        return f"icdgen_curve(ICDGEN_CAST(double, {raw}), curve, {len(field.curve.pieces)}u)"
    assert field.arithmetic is not None
    steps, storage = field.arithmetic.steps, field.storage
    kind = _function_suffix(storage, 64)
    if steps.is_wide:
        return f"icdgen_wide_physical_{kind}({raw}, &scale)"
    if field.arithmetic.is_exact_in_int64_and_double:
        p, c, q = steps.terms
        return f"icdgen_quotient({_linear_expression(raw, p, c, 64)}, {int64(q)})"
    *terms, is_negated = field.arithmetic.int64_terms
    value = f"icdgen_physical_{kind}({', '.join((raw, *map(int64, terms)))})"
    # `-value` would turn 0 into -0.0; 0.0 - 0.0 is +0.0 (IEEE 754, 6.3).
    return f"0.0 - {value}" if is_negated else value


def double_setter(field: FieldDescription) -> tuple[str, ...]:
    """Return the function that sets a raw value to the nearest one of ``value``, and
    its arguments behind the raw value.
    """
    storage, ends = field.storage, field.model.settable_raws
    limits = [_limit(end, storage) for end in ends]
    if field.curve is not None:
        if field.model.type == "float":
            # A float has no whole numbers to search, so its calibration is a single
            # line that has an inverse.
            return f"icdgen_set_curve_f{field.model.bits}", "value", "curve"
        return (
            f"icdgen_set_curve_{_function_suffix(storage)}",
            "value",
            "curve",
            f"{len(field.curve.pieces)}u",
            *limits,
        )
    assert field.arithmetic is not None
    # The functions for unsigned integers have no lower limit, because it is 0.
    limits = limits if storage.signed else limits[1:]
    if field.arithmetic.steps.is_wide:
        return (
            f"icdgen_wide_set_{_function_suffix(storage)}",
            "value",
            "&scale",
            *limits,
        )
    *terms, is_negated = field.arithmetic.int64_terms
    return (
        f"icdgen_set_{_function_suffix(storage)}",
        "-value" if is_negated else "value",
        *map(int64, terms),
        *limits,
    )


def integer_value(access: IntegerAccess, raw: str) -> str:
    """Return the physical value of a raw value in whole parts of the unit."""
    return _linear_expression(
        raw, access.scale.factor, access.scale.offset, access.bits
    )


def _linear_expression(raw: str, factor: int, offset: int, bits: int) -> str:
    # The type of `raw` is never `uint64_t`, which would make the product unsigned: the
    # product must not overflow for any of its values
    # (`icdgen.describe.integer_scale.is_computable`).
    return _with_offset(
        raw if factor == 1 else f"{raw} * INT{bits}_C({factor})", offset, bits
    )


def _with_offset(value: str, offset: int, bits: int) -> str:
    return (
        # `icdgen.describe.integer_scale` ensures that the negative of the offset fits,
        # too.
        f"{value} {'+' if offset > 0 else '-'} INT{bits}_C({abs(offset)})"
        if offset
        else value
    )


def integer_range(access: IntegerAccess) -> list[str]:
    """Return the conditions for values that a setter refuses."""
    refused = [] if access.least is None else [f"value < {int64(access.least)}"]
    return refused + ([] if access.most is None else [f"value > {int64(access.most)}"])


def integer_raw(access: IntegerAccess, storage: Storage) -> str:
    """Return the raw value of ``value`` in whole parts of the unit."""
    factor, offset, bits = access.scale.factor, access.scale.offset, access.setter_bits
    # The support header rounds for positive divisors only, so a negative factor swaps
    # the operands of the difference.
    if factor > 0:
        value = _with_offset("value", -offset, bits)
    else:
        value = f"{'-' if offset < 0 else ''}INT{bits}_C({abs(offset)}) - value"
    if abs(factor) != 1:
        value = f"icdgen_nearest{bits}({value}, {int64(abs(factor))})"
    return cast(value, storage.bits, storage.signed)
