"""Expressions of physical values in double precision, and in whole thousandths or millionths of the unit."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from itertools import accumulate
from typing import NamedTuple

from icdgen.backends.c.types import cast
from icdgen.describe import FieldDescription
from icdgen.describe.arithmetic import Arithmetic, IntegerAccess
from icdgen.describe.integer_scale import IntegerScale
from icdgen.describe.steps import Steps, wide_parts
from icdgen.describe.storage import Storage
from icdgen.icd.curve import Curve

RAW = "{raw}"
"""Placeholder of the raw value in expressions."""
INT32, INT64 = (1 << 31) - 1, (1 << 63) - 1


class IntegerAccessors(NamedTuple):
    """Accessors in whole parts of the unit. ``setter`` is the raw value of ``value`` if no condition of ``refused`` holds."""

    scale: IntegerScale
    type: str  # "int32_t" | "int64_t"
    getter: str  # expression over ``{raw}``
    refused: tuple[str, ...]
    setter: str


class Scaled(NamedTuple):
    """Conversion of raw values to physical values and back."""

    getter: str  # expression of a double over ``{raw}``
    setter: tuple[str, ...]  # function, and its arguments behind the raw value
    declared: tuple[str, ...] = ()  # declarations for both
    integers: IntegerAccessors | None = None


def scaled(field: FieldDescription) -> Scaled:
    """Return the conversion of a field with a scale or calibration."""
    if field.curve is not None:
        return _on_curve(field, field.curve)
    assert field.arithmetic is not None
    return _scaled(field.arithmetic)


@lru_cache(maxsize=2048)
def _scaled(arithmetic: Arithmetic) -> Scaled:
    steps, integers = arithmetic.steps, arithmetic.integers
    declared = tuple(_wide_scale(steps)) if steps.is_wide else ()
    accessors = None if integers is None else _integers(integers, arithmetic.storage)
    return Scaled(_double_getter(arithmetic), _double_setter(arithmetic), declared, accessors)


def _on_curve(field: FieldDescription, curve: Curve) -> Scaled:
    count, storage = f"{len(curve.pieces)}u", field.storage
    getter = f"icdgen_curve(ICDGEN_CAST(double, {RAW}), curve, {count})"
    if field.model.type == "float":
        setter: tuple[str, ...] = f"icdgen_set_curve_f{field.model.bits}", "value", "curve"
    else:
        limits = (_limit(end, storage) for end in field.model.settable_raws)
        setter = f"icdgen_set_curve_{_kind(storage)}", "value", "curve", count, *limits
    return Scaled(getter, setter, tuple(_declared(curve)))


def _kind(storage: Storage, bits: int = 0) -> str:
    """Return the end of the name of a function: ``u16``; with ``bits`` for integers of this width."""
    return f"{'i' if storage.signed else 'u'}{bits or storage.bits}"


def _declared(curve: Curve) -> Iterator[str]:
    """List the declarations of a calibration: the terms of all pieces, then the pieces."""
    terms = [", ".join(map(repr, piece.terms)) for piece in curve.pieces]
    begin = accumulate((len(piece.terms) for piece in curve.pieces), initial=0)
    pieces = (
        f"{{{start!r}, {f'&terms[{at}]' if own_terms else 'terms'}, {len(own_terms)}u}}"
        for (start, own_terms), at in zip(curve.pieces, begin, strict=False)
    )
    yield from _array("static const double terms[]", list(filter(None, terms)))
    yield from _array("static const icdgen_piece_t curve[]", list(pieces))


def _array(head: str, rows: list[str]) -> Iterator[str]:
    if len(rows) == 1:
        yield f"{head} = {{{rows[0]}}};"
        return
    yield f"{head} = {{"
    yield from (f"    {row}," for row in rows)
    yield "};"


def int64(value: int) -> str:
    """Return the literal of a signed integer of 64 bits."""
    return "INT64_MIN" if value == -INT64 - 1 else f"INT64_C({value})" if abs(value) > INT32 else str(value)


def _plus(value: str, offset: int, bits: int) -> str:
    if offset == 0:
        return value
    return f"{value} {'+' if offset > 0 else '-'} INT{bits}_C({abs(offset)})"


def _double_getter(arithmetic: Arithmetic) -> str:
    steps, storage = arithmetic
    kind = _kind(storage, 64)
    if steps.is_wide:
        return f"icdgen_wide_physical_{kind}({RAW}, &scale)"
    if arithmetic.is_exact_in_int64:
        p, c, q = steps.terms
        return f"icdgen_quotient({_integer_getter(p, c, 64, storage)}, {int64(q)})"
    *terms, is_negated = arithmetic.int64_terms
    value = f"icdgen_physical_{kind}({', '.join((RAW, *map(int64, terms)))})"
    return f"0.0 - {value}" if is_negated else value


def _double_setter(arithmetic: Arithmetic) -> tuple[str, ...]:
    steps, storage = arithmetic
    ends = (steps.raw_min, steps.raw_max) if storage.signed else (steps.raw_max,)
    limits = (_limit(end, storage) for end in ends)
    if steps.is_wide:
        return f"icdgen_wide_set_{_kind(storage)}", "value", "&scale", *limits
    *terms, is_negated = arithmetic.int64_terms
    return f"icdgen_set_{_kind(storage)}", "-value" if is_negated else "value", *map(int64, terms), *limits


def _wide_scale(steps: Steps) -> list[str]:
    """Return the declaration of a scale whose terms have more than 64 bits."""
    rows = ((f"0x{part:X}u" if part > 9 else f"{part}u" for part in wide_parts(term, 32)) for term in steps.terms)
    return ["static const icdgen_scale_t scale = {", *(f"    {{{{{', '.join(row)}}}}}," for row in rows), "};"]


def _limit(value: int, storage: Storage) -> str:
    if value == storage.min and storage.signed:
        return f"INT{storage.bits}_MIN"
    if value == storage.max:
        return f"{'' if storage.signed else 'U'}INT{storage.bits}_MAX"
    if storage.signed:
        return int64(value)
    return f"UINT64_C({value})" if value >= 1 << 32 else f"{value}u"


def _integers(access: IntegerAccess, storage: Storage) -> IntegerAccessors:
    scale = access.scale
    refused = [] if access.least is None else [f"value < {int64(access.least)}"]
    refused += [] if access.most is None else [f"value > {int64(access.most)}"]
    getter = _integer_getter(scale.factor, scale.offset, access.bits, storage)
    setter = _integer_setter(scale.factor, scale.offset, access.setter_bits, storage)
    return IntegerAccessors(scale, f"int{access.bits}_t", getter, tuple(refused), setter)


def _integer_getter(factor: int, offset: int, bits: int, storage: Storage) -> str:
    # An unsigned operand of 64 bits would make the product unsigned.
    raw = cast(RAW, 64, True) if storage.bits == 64 and not storage.signed else RAW
    return _plus(raw if factor == 1 else f"{raw} * INT{bits}_C({factor})", offset, bits)


def _integer_setter(factor: int, offset: int, wide: int, storage: Storage) -> str:
    # The support header rounds for positive divisors only, so a negative factor swaps the operands of the difference.
    if factor > 0:
        value = _plus("value", -offset, wide)
    else:
        value = f"{'-' if offset < 0 else ''}INT{wide}_C({abs(offset)}) - value"
    if abs(factor) != 1:
        value = f"icdgen_nearest{wide}({value}, {int64(abs(factor))})"
    return cast(value, storage.bits, storage.signed)
