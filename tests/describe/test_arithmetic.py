"""The arithmetic of physical values is compared with exact arithmetic."""

from __future__ import annotations

import struct
from fractions import Fraction

from hypothesis import example, given
from hypothesis import strategies as st

from icdgen.describe.arithmetic import ScaleArithmetic, arithmetic_of
from icdgen.describe.steps import steps_of_scale
from icdgen.describe.storage import storage_of
from icdgen.icd.formula import Scale
from icdgen.icd.layout import Scalar

fractions = st.fractions(min_value=-(1 << 40), max_value=1 << 40, max_denominator=10**7)
decimals = st.builds(
    Fraction, st.integers(-(10**6), 10**6), st.sampled_from([1, 10, 1000, 10**6])
)
factors = (fractions | decimals).filter(bool)


def arithmetic(
    kind: str, bits: int, factor: Fraction, offset: Fraction = Fraction(0)
) -> ScaleArithmetic:
    scale = steps_of_scale(
        Scalar(name="Rate", bits=bits, type=kind, scale=Scale(factor, offset))
    )
    assert scale is not None
    return arithmetic_of(scale, storage_of(bits, kind == "int"))


cases = st.builds(
    arithmetic,
    st.sampled_from(["uint", "int"]),
    st.integers(1, 64),
    factors,
    fractions | decimals,
)


def raws(case: ScaleArithmetic) -> list[int]:
    """Return the ends of the raw range, and some values between them."""
    first, last = case.steps.raw_min, case.steps.raw_max
    return [first, first + 1, (first + last) // 3, last // 2, last - 1, last]


def single(value: float) -> float:
    return struct.unpack("<f", struct.pack("<f", value))[0]


@given(cases)
@example(arithmetic("uint", 16, Fraction(1, 100), Fraction(-40)))
def test_a_division_of_doubles_is_the_correctly_rounded_value_where_the_arithmetic_is_exact(
    case,
):
    p, c, q = case.steps.terms
    for raw in raws(case):
        if case.is_computable_in_doubles:
            assert (float(raw) * float(p) + float(c)) / float(q) == case.steps.double(
                raw
            )
        if case.is_exact_in_int64_and_double:
            assert -(1 << 63) <= raw * p + c < 1 << 63
            assert float(raw * p + c) / float(q) == case.steps.double(raw)


@given(cases)
@example(arithmetic("uint", 8, Fraction(1, 10), Fraction(3)))
def test_a_division_of_singles_is_the_nearest_single_where_the_arithmetic_is_exact(
    case,
):
    p, c, q = case.steps.terms
    if case.is_computable_in_singles:
        for raw in raws(case):
            numerator = single(single(raw * float(p)) + float(c))
            assert numerator == raw * p + c and single(float(q)) == q
            assert single(numerator / q) == single(case.steps.double(raw))


def test_no_language_has_to_convert_an_integer_of_64_bits_to_a_double_or_of_32_bits_to_a_single():
    assert arithmetic("uint", 16, Fraction(1, 2)).is_computable_in_singles
    assert not arithmetic("uint", 17, Fraction(1, 2)).is_computable_in_singles
    assert arithmetic("uint", 32, Fraction(1, 2)).is_computable_in_doubles
    assert not arithmetic("uint", 33, Fraction(1, 2)).is_computable_in_doubles
    assert arithmetic("uint", 32, Fraction(1, 2)).is_exact_in_int64_and_double
    assert not arithmetic(
        "uint", 33, Fraction(1, 2)
    ).is_exact_in_int64_and_double  # its storage holds 2**64 - 1


@given(cases)
@example(arithmetic("uint", 8, Fraction(1), Fraction(1 << 63)))
def test_every_term_of_a_usual_scale_is_a_literal_of_64_bits(case):
    if case.steps.is_wide:
        return
    p, c, q, is_negated = case.int64_terms
    assert all(-(1 << 63) <= term < 1 << 63 for term in (p, c, q))
    sign = -1 if is_negated else 1
    assert (sign * p, sign * c, q) == case.steps.terms


@given(cases)
@example(arithmetic("int", 16, Fraction(1, 1000)))
@example(arithmetic("uint", 32, Fraction(-1), Fraction(1 << 31)))
def test_integer_accessors_overflow_for_no_raw_value_and_no_value_that_is_set(case):
    access = case.integer_access
    if access is None:
        return
    factor, offset = access.scale.factor, access.scale.offset
    low, high = -(1 << access.bits - 1), (1 << access.bits - 1) - 1
    for raw in (case.storage.min, case.storage.max):
        assert low <= raw * factor <= high and low <= raw * factor + offset <= high
    for value in (
        low if access.least is None else access.least,
        high if access.most is None else access.most,
    ):
        assert abs(value - offset) < 1 << access.setter_bits - 1
        nearest = round(Fraction(value - offset, factor))  # to even, as setters round
        assert case.steps.raw_min <= nearest <= case.steps.raw_max
    for value in (access.least and access.least - 1, access.most and access.most + 1):
        if value is not None:
            assert (
                not case.steps.raw_min
                <= round(Fraction(value - offset, factor))
                <= case.steps.raw_max
            )
