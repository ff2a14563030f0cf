"""Calibrators of XTCE become the formula or lookup table of the same values."""

from __future__ import annotations

from fractions import Fraction
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.definitions import xtce_calibration
from icdgen.definitions.model import NotSupported
from icdgen.icd import curve, formula
from tests.limits import assert_limits


def encoding(calibrator, more=""):
    text = f"<E><DefaultCalibrator>{calibrator}</DefaultCalibrator>{more}</E>"
    return ElementTree.fromstring(text)


def points(*pairs):
    return "".join(f'<SplinePoint raw="{x}" calibrated="{y}"/>' for x, y in pairs)


def spline(*pairs, more=""):
    return encoding(f"<SplineCalibrator {more}>{points(*pairs)}</SplineCalibrator>")


def term(exponent, coefficient):
    return f'<Term exponent="{exponent}" coefficient="{coefficient}"/>'


def polynomial(*terms):
    inner = "".join(term(*each) for each in terms)
    return encoding(f"<PolynomialCalibrator>{inner}</PolynomialCalibrator>")


def reason(element):
    with pytest.raises((ValueError, NotSupported)) as raised:
        xtce_calibration.calibration(element)
    return str(raised.value)


def test_an_encoding_without_a_calibrator_has_its_raw_value():
    assert xtce_calibration.calibration(ElementTree.fromstring("<E/>")) == {}


@pytest.mark.parametrize(
    ("terms", "text"),
    [
        ({1: "1"}, ""),
        ({0: "0", 1: "1", 2: "0.0"}, ""),
        ({}, "raw*0"),
        ({0: "0", 1: "0"}, "raw*0"),
        ({0: "5"}, "5"),
        ({0: "-5"}, "-5"),
        ({1: "-1"}, "-raw"),
        ({1: "1", 0: "1"}, "raw + 1"),
        ({0: "-40.5", 1: "0.0125"}, "raw*0.0125 - 40.5"),
        ({0: "1", 3: "-2", 2: "1", 1: "-1"}, "-raw^3*2 + raw^2 - raw + 1"),
        ({2: "1"}, "raw^2"),
        ({1: "2"}, "raw*2"),
    ],
)
def test_a_formula_has_the_terms_from_the_highest_power_down(terms, text):
    assert xtce_calibration.formula(terms) == text


def test_rounded_negative_powers_of_two_become_exact():
    # Few digits are kept: only digits that a double cannot tell apart are rounded.
    exact, rounded = "0.0009765625", "0.00003051757812"
    assert xtce_calibration.formula({1: exact}) == f"raw*{exact}"
    assert xtce_calibration.formula({1: rounded}) == f"raw*{rounded}"
    double = format(2.0**-31, ".17g")
    text = xtce_calibration.decimal(double)
    assert xtce_calibration.formula({1: f"-{text}", 0: "3"}) == "-raw*2^-31 + 3"
    assert xtce_calibration.formula({0: text}) == "2^-31"
    third = "0.33333333333333333"
    assert xtce_calibration.formula({1: third}) == f"raw*{third}"


@pytest.mark.parametrize(
    ("terms", "why"),
    [
        ([(16, "2")], "it is calibrated by raw^16"),
        ([(-1, "2")], "it is calibrated by raw^-1"),
        ([(1, "2"), (0, "1"), (1, "3")], "raw^1 has two coefficients"),
        ([("x", "2")], "an exponent is `x`"),
        ([(1, "x")], "a coefficient is `x`"),
        ([(1, "")], "a coefficient is ``"),
    ],
)
def test_another_polynomial_is_not_supported(terms, why):
    assert reason(polynomial(*terms)) == why


def test_a_calibration_by_context_or_algorithm_is_not_supported():
    by_context = encoding("", "<ContextCalibratorList/>")
    assert reason(by_context) == "its calibration depends on other parameters"
    assert reason(encoding("<MathOperation/>")) == "it is calibrated by an algorithm"


def test_a_table_is_sorted_by_raw_value():
    keys = xtce_calibration.calibration(spline((10, 5), ("-2.50", "1e30"), (2, "007")))
    assert keys == {
        "points": [[-2.5, "1e+30"], [2, 7], [10, 5]],
        "outside": curve.REFUSE,
    }
    assert [type(number) for number in keys["points"][0]] == [float, str]


def test_numbers_above_30_characters_stay_text():
    digits = "0." + "1" * 28
    keys = xtce_calibration.calibration(spline((0, digits), (1, digits + "1"), (2, 0)))
    assert [point[1] for point in keys["points"]] == [float(digits), digits + "1", 0]


def test_a_table_that_goes_on_is_extrapolated_and_two_points_are_a_line():
    goes_on = 'extrapolate="true"'
    three = [(0, 0), (1, 1), (2, 4)]
    assert xtce_calibration.calibration(spline(*three, more=goes_on)) == {
        "points": [[0, 0], [1, 1], [2, 4]],
        "outside": curve.EXTRAPOLATE,
    }
    two = [(2, 1), (6, 4)]
    line = {"formula": "raw*3/4 - 1/2"}
    assert xtce_calibration.calibration(spline(*two, more=goes_on)) == line
    table = {"points": [[2, 1], [6, 4]], "outside": curve.REFUSE}
    assert xtce_calibration.calibration(spline(*two)) == table
    same = spline((0, 0), (9, 9), more=goes_on)
    assert xtce_calibration.calibration(same) == {}


@pytest.mark.parametrize("order", ["0", "2"])
def test_points_that_no_lines_join_are_not_supported(order):
    why = "it is calibrated by a table of 3 points that are not joined by lines"
    three = [(0, 0), (1, 1), (2, 4)]
    assert reason(spline(*three, more=f'order="{order}"')) == why
    at_a_point = f'order="{order}" raw="2"'
    text = points(*three).replace('raw="2"', at_a_point)
    assert reason(encoding(f"<SplineCalibrator>{text}</SplineCalibrator>")) == why


def test_a_table_has_at_most_1024_points():
    def is_accepted(count):
        table = spline(*((raw, raw % 2) for raw in range(count)))
        try:
            return bool(xtce_calibration.calibration(table))
        except ValueError as error:
            assert str(error) == "it is calibrated by a table of 1,025 points"
            return False

    assert_limits(is_accepted, most=1024)


def test_points_of_equal_raw_value_are_not_supported():
    start = "it is calibrated by a table that cannot be used: "
    assert reason(spline((1, 2), (1, 3))).startswith(start)
    goes_on = spline((1, 2), (1, 3), more='extrapolate="true"')
    assert reason(goes_on) == "two points of its calibration have one raw value"


NUMBERS = st.decimals(-1000, 1000, places=3).map(str)


@given(NUMBERS, NUMBERS, NUMBERS, NUMBERS)
def test_a_line_goes_through_both_points(x0, y0, x1, y1):
    if Fraction(x0) == Fraction(x1) or Fraction(y0) == Fraction(y1):
        return
    pair = ElementTree.fromstring(f"<S>{points((x0, y0), (x1, y1))}</S>")
    text = xtce_calibration.line_through(list(pair)) or "raw"
    line = formula.parse(text)
    assert line.physical(Fraction(x0)) == Fraction(y0)
    assert line.physical(Fraction(x1)) == Fraction(y1)


def simplified(*pairs, bits=8, is_signed=False):
    table = {"points": [list(pair) for pair in pairs], "outside": "refuse"}
    return xtce_calibration.simplified_table(table, bits, is_signed)


def test_a_table_that_covers_all_raw_values_needs_no_outside():
    assert simplified((0, 1), (9, 2), (255, 3)) == {
        "points": [[0, 1], [9, 2], [255, 3]]
    }
    for incomplete in ([(1, 1), (9, 2), (255, 3)], [(0, 1), (9, 2), (254, 3)]):
        assert simplified(*incomplete)["outside"] == "refuse"
    signed = [(-128, 1), (9, 2), (127, 3)]
    assert "outside" not in simplified(*signed, is_signed=True)
    assert simplified(*signed)["outside"] == "refuse"


@pytest.mark.parametrize(
    ("pairs", "result", "is_clamped"),
    [
        ([(0, 1), (9, 1), (255, 3)], [[9, 1], [255, 3]], True),
        ([(0, 1), (9, 3), (255, 3)], [[0, 1], [9, 3]], True),
        ([(0, 1), (8, 1), (9, 3), (255, "3.0")], [[8, 1], [9, 3]], True),
        # A table keeps two points, and the ends of a wider table are not horizontal.
        ([(0, 1), (255, 1)], [[0, 1], [255, 1]], False),
        ([(0, 1), (9, 1), (255, 1)], [[9, 1], [255, 1]], True),
        ([(-1, 1), (9, 1), (256, 3)], [[-1, 1], [9, 1], [256, 3]], False),
        ([(-1, 1), (9, 3), (256, 3)], [[-1, 1], [9, 3], [256, 3]], False),
    ],
)
def test_horizontal_ends_of_a_complete_table_are_clamped(pairs, result, is_clamped):
    outside = {"outside": curve.CLAMP} if is_clamped else {}
    assert simplified(*pairs) == {"points": result, **outside}


def test_an_integer_has_at_most_40_digits_and_a_sign():
    assert_limits(
        lambda digits: is_number("-" + "1" * digits) and is_number("+" + "1" * digits),
        least=1,
        most=40,
    )
    assert xtce_calibration.number(" -12\n", "it") == -12
    with pytest.raises(NotSupported, match=r"^an exponent is `1\.0`$"):
        xtce_calibration.number("1.0", "an exponent")


def is_number(text):
    try:
        return xtce_calibration.number(text, "it") == int(text)
    except NotSupported:
        return False


@pytest.mark.parametrize(
    ("text", "result"),
    [
        (" +1.50 ", "1.5"),
        ("5.", "5"),
        (".25", "0.25"),
        ("2E3", "2000"),
        ("1e-3", "0.001"),
        ("1e999", "1e+999"),
    ],
)
def test_a_coefficient_is_written_as_in_formulas(text, result):
    assert xtce_calibration.decimal(text) == result


@pytest.mark.parametrize("text", [".", "e3", "1e1000", "0x10", "1,5", "1 2", "INF"])
def test_another_coefficient_is_not_supported(text):
    with pytest.raises(ValueError, match="a coefficient is `"):
        xtce_calibration.decimal(text)


def test_a_fixed_value_is_an_integer_or_given_by_a_parameter():
    def fixed(text, default=None):
        return xtce_calibration.fixed(ElementTree.fromstring(text), default)

    assert xtce_calibration.fixed(None) is None
    assert xtce_calibration.fixed(None, 8) == 8
    assert fixed("<S><FixedValue> 16 </FixedValue></S>", 8) == 16
    assert fixed("<S><DynamicValue/></S>", 8) is None
    with pytest.raises(NotSupported, match=r"^a fixed value is ``$"):
        fixed("<S><FixedValue/></S>")
