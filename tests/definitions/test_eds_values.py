"""Numbers of electronic data sheets: expressions and encodings of integers."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.definitions.eds_values import (
    CODES,
    TWOS,
    UNSIGNED,
    encoded_value,
    evaluate,
    integer_value,
)
from icdgen.definitions.model import NotSupported
from tests.limits import assert_limits


def is_expression(text):
    try:
        evaluate(text)
    except ValueError:
        return False
    return True


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2 ^ (16) - 1", 65535),
        ("2 ^ 3 ^ 2", 512),
        ("-2 ^ 2", -4),
        ("(-2) ^ 2", 4),
        ("10 - 4 - 3", 3),
        ("16 / 4 / 2", 2),
        ("2 + 3 * 4", 14),
        ("12 / 4 * 3", 9),
        ("(2 + 3) * 4", 20),
        ("7 / 2", Fraction(7, 2)),
        ("- -+3", 3),
        (" 0x1F ", 31),
        ("0Xff", 255),
        ("1.5e2", 150),
        ("2E-2", Fraction(1, 50)),
        (".5", Fraction(1, 2)),
        ("5.", 5),
        ("0 ^ 0", 1),
        ("3 * -2", -6),
    ],
)
def test_an_expression_has_the_usual_precedence(text, value):
    assert evaluate(text) == value


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "no number"),
        ("a", "no number"),
        ("1 +", "no number"),
        ("* 1", "no number"),
        ("()", "no number"),
        ("1 2", "more behind it"),
        ("1)", "more behind it"),
        ("(1", "a parenthesis is not closed"),
        ("1 / 0", "divided by 0"),
        ("1 / (2 - 2)", "divided by 0"),
        ("2 ^ -1", "an exponent that is not a small number"),
        ("2 ^ 0.5", "an exponent that is not a small number"),
    ],
)
def test_another_text_is_no_expression(text, why):
    with pytest.raises(ValueError) as raised:
        evaluate(text)
    assert str(raised.value) == why


def test_limits_of_an_expression():
    assert_limits(lambda power: is_expression(f"1 ^ {power}"), least=0, most=128)
    assert_limits(lambda digits: is_expression("1" * digits), least=1, most=40)
    assert_limits(lambda digits: is_expression("0x" + "F" * digits), least=1, most=32)
    assert_limits(lambda depth: is_expression("(" * depth + "1" + ")" * depth), most=20)
    assert_limits(lambda depth: is_expression("-" * depth + "1"), most=20)
    # 500 characters, and 256 bits of a numerator or a denominator.
    assert is_expression("1+" * 249 + "11") and not is_expression("1+" * 249 + "111")
    assert is_expression("2 ^ 128 * (2 ^ 128 - 1)")
    assert not is_expression("2 ^ 128 * 2 ^ 128")
    assert is_expression("1 / 2 ^ 127 / 2 ^ 128")
    assert not is_expression("1 / 2 ^ 128 / 2 ^ 128")


def is_value(text, least=None, most=None):
    try:
        return integer_value(text, "its size", least, most) == evaluate(text)
    except NotSupported as error:
        assert str(error) == f"its size is `{text}`"
        return False


def test_an_integer_value_is_within_its_limits():
    for spelling in ("{}", "{} + 0"):
        assert_limits(
            lambda value, spelling=spelling: is_value(spelling.format(value), 3, 9),
            least=3,
            most=9,
        )
    assert is_value("-5") and is_value("9" * 20) and is_value("9" * 19)
    assert is_value("4 / 2") and not is_value("3 / 2") and not is_value("many")


BITS = st.sampled_from([4, 8, 12, 16, 24])


def decoded(raw, code, bits):
    """Return the number of transmitted bits, None if they are no digits of a BCD."""
    if code in ("BCD", "packedBCD"):
        width = 8 if code == "BCD" else 4
        digits = [raw >> at & (1 << width) - 1 for at in range(0, bits, width)]
        if bits % width or max(digits) > 9:
            return None
        return sum(digit * 10**place for place, digit in enumerate(digits))
    magnitude, is_negative = raw & (1 << bits - 1) - 1, raw >> bits - 1
    if not is_negative:
        return magnitude
    if code == "signMagnitude":
        return -magnitude
    return -(magnitude ^ (1 << bits - 1) - 1)


@given(BITS, st.sampled_from(CODES[2:]), st.integers(-40000, 40000))
def test_an_encoded_value_decodes_to_the_number(bits, code, value):
    if code == "BCD":
        bits *= 2
    raw = encoded_value(value, code, bits)
    if code in ("BCD", "packedBCD"):
        digits = bits // (8 if code == "BCD" else 4)
        fits = 0 <= value < 10**digits
    else:
        fits = abs(value) < 1 << bits - 1
    assert (raw is not None) == fits
    if raw is not None:
        assert 0 <= raw < 1 << bits and decoded(raw, code, bits) == value


def test_plain_encodings_have_the_value_itself_within_their_range():
    def fits(code):
        return lambda value: encoded_value(value, code, 8) == value

    assert_limits(fits(UNSIGNED), least=0, most=255)
    assert_limits(fits(TWOS), least=-128, most=127)
