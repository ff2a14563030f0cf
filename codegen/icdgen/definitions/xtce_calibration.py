"""Numbers and calibrations of XTCE: polynomials as formulas, splines as lookup tables.

Coefficients stay decimal text until they are written, so that the ICD has the digits of
the source. Raises `ValueError` for calibrations that an ICD cannot represent.
"""

from __future__ import annotations

import re
from decimal import Decimal
from fractions import Fraction
from typing import Any
from xml.etree.ElementTree import Element

from icdgen.definitions.model import NotSupported
from icdgen.definitions.wording import line, printed
from icdgen.icd import curve
from icdgen.icd.formula import FormulaError
from icdgen.icd.layout import integer_range

NUMBER = re.compile(
    r"\s*([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]{1,3})?)\s*\Z"
)
_INTEGER = re.compile(r"\s*([-+]?[0-9]{1,40})\s*\Z")
_MOST_POWER = 15  # of a polynomial
# Significant digits that a double always preserves; numbers with more may be rounded
# powers of two.
_DIGITS = 15


def calibration(encoding: Element) -> dict[str, Any]:
    """Return the keys of the calibration of an encoding: a formula, a lookup table, or
    no keys for the raw value.

    Raises `ValueError` with the reason if the calibration is not supported.
    """
    if encoding.find("ContextCalibratorList") is not None:
        raise ValueError("its calibration depends on other parameters")
    calibrator = encoding.find("DefaultCalibrator")
    if calibrator is None:
        return {}
    keys = calibrated(calibrator)
    if keys is None:
        raise ValueError("it is calibrated by an algorithm")
    return keys


def calibrated(calibrator: Element) -> dict[str, Any] | None:
    """Return the keys of a polynomial or spline calibrator, None if there is neither.

    Raises `ValueError` if it is not supported.
    """
    if terms := calibrator.findall("PolynomialCalibrator/Term"):
        return _formula_key(polynomial(terms))
    spline = calibrator.find("SplineCalibrator")
    if spline is None:
        return None
    points = spline.findall("SplinePoint")
    # Order 0 keeps the value of a point up to the next one, 1 joins points by lines, 2
    # by parabolas (XTCE 1.2, SplineCalibratorType).
    if {element.get("order", "1") for element in (spline, *points)} != {"1"}:
        raise ValueError(
            f"it is calibrated by a table of {len(points)} points that are not joined by lines"
        )
    goes_on = spline.get("extrapolate", "false") == "true"
    return (
        _formula_key(line_through(points))
        # A line through two points that goes on beyond both is a linear formula, which
        # an integer field computes exactly.
        if len(points) == 2 and goes_on
        else _table(points, goes_on)
    )


def _formula_key(text: str) -> dict[str, Any]:
    """Return the key of a formula, no key for the raw value."""
    return {"formula": text} if text else {}


def _table(points: list[Element], goes_on: bool) -> dict[str, Any]:
    """Return the keys of a lookup table.

    XTCE allows points in any order, an ICD needs ascending raw values.

    Raises `ValueError` if the points are not a valid table, or are too many.
    """
    pairs = [
        [decimal(point.get(key, "")) for key in ("raw", "calibrated")]
        for point in points
    ]
    pairs.sort(key=lambda point: Fraction(point[0]))
    try:
        curve.table(curve.doubles(pairs), "")
    except FormulaError as error:
        raise ValueError(
            f"it is calibrated by a table that cannot be used: {error}"
        ) from None
    if len(pairs) > curve.MOST_POINTS:
        raise ValueError(f"it is calibrated by a table of {len(pairs):,} points")
    return {
        "points": [[_number(text) for text in point] for point in pairs],
        "outside": curve.EXTRAPOLATE if goes_on else curve.REFUSE,
    }


def simplified_table(
    table: dict[str, Any], bits: int, is_signed: bool
) -> dict[str, Any]:
    """Return the keys of a lookup table of an integer, simplified if it covers all raw
    values.

    Horizontal segments at the ends become `outside: clamp`. A table that covers all
    values needs no `outside`.
    """
    low, high = integer_range(bits, is_signed)
    points = list(table["points"])
    (first, *_), (last, *_) = points[0], points[-1]
    if not (Fraction(first) <= low and high <= Fraction(last)):
        return table
    starts_level = (
        len(points) > 2
        and Fraction(first) == low
        and Fraction(points[0][1]) == Fraction(points[1][1])
    )
    points = points[1:] if starts_level else points
    ends_level = (
        len(points) > 2
        and Fraction(last) == high
        and Fraction(points[-1][1]) == Fraction(points[-2][1])
    )
    points = points[:-1] if ends_level else points
    return {"points": points} | (
        {"outside": curve.CLAMP} if starts_level or ends_level else {}
    )


def _number(text: str) -> int | float | str:
    """Return a number as a value of an ICD.

    Numbers with an exponent or over 30 characters stay text.
    """
    if "e" in text.lower() or len(text) > 30:
        return text
    return float(text) if "." in text else int(text)


def number(text: str, what: str) -> int:
    """Return an integer of at most 40 digits.

    Raises `NotSupported` with ``what`` as the subject for any other text.
    """
    match = _INTEGER.match(text)
    if match is None:
        raise NotSupported(f"{what} is `{line(text, 60)}`")
    return int(match[1])


def decimal(text: str) -> str:
    """Return a number in the notation of formulas.

    Raises `ValueError` if the text is not a number.
    """
    match = NUMBER.match(text)
    if match is None:
        raise ValueError(f"a coefficient is `{line(text, 60)}`")
    return printed(Decimal(match[1]))


def fixed(element: Element | None, default: int | None = None) -> int | None:
    """Return the `FixedValue` of an element, ``default`` without an element, None if a
    parameter gives the number.
    """
    if element is None:
        return default
    of = element.find("FixedValue")
    return None if of is None else number(of.text or "", "a fixed value")


def polynomial(terms: list[Element]) -> str:
    """Return the formula of a polynomial.

    Raises `ValueError` for exponents above 15 and repeated ones.
    """
    coefficients: dict[int, str] = {}
    for term in terms:
        power = number(term.get("exponent", ""), "an exponent")
        if not 0 <= power <= _MOST_POWER:
            raise ValueError(f"it is calibrated by raw^{power}")
        if power in coefficients:
            raise ValueError(f"raw^{power} has two coefficients")
        coefficients[power] = decimal(term.get("coefficient", ""))
    return formula(coefficients)


def formula(terms: dict[int, str]) -> str:
    """Return the formula of coefficients by power, the highest power first.

    Empty if the value is the raw value.
    """
    text = ""
    terms = {power: value for power, value in terms.items() if Fraction(value)}
    if terms == {1: "1"}:
        return ""
    for power, value in sorted(terms.items(), reverse=True):
        size, raw = _binary(value.lstrip("-")), "raw" if power == 1 else f"raw^{power}"
        if not power:
            part = size
        else:
            part = raw if size == "1" else f"{raw}*{size}"
        if text:
            text += (" - " if value[0] == "-" else " + ") + part
        else:
            text = ("-" if value[0] == "-" else "") + part
    return text or "raw*0"


def _binary(text: str) -> str:
    """Return ``2^-n`` for the rounded decimal digits of a negative power of two, the
    text itself for other numbers.
    """
    top, bottom = float(text).as_integer_ratio()
    is_rounded = len(text) > _DIGITS and Fraction(text) != Fraction(top, bottom)
    return f"2^-{bottom.bit_length() - 1}" if top == 1 and is_rounded else text


def line_through(points: list[Element]) -> str:
    """Return the formula of the line through two points.

    Raises `ValueError` if their raw values are equal.
    """
    (x0, y0), (x1, y1) = (
        [decimal(point.get(key, "")) for key in ("raw", "calibrated")]
        for point in points
    )
    across, up = Fraction(x1) - Fraction(x0), Fraction(y1) - Fraction(y0)
    if not across:
        raise ValueError("two points of its calibration have one raw value")
    slope, start = up / across, Fraction(y0) - Fraction(x0) * up / across
    text = f"raw*{slope.numerator}" + (
        f"/{slope.denominator}" if slope.denominator != 1 else ""
    )
    if start:
        text += f" {'-' if start < 0 else '+'} {abs(start.numerator)}"
        text += f"/{start.denominator}" if start.denominator != 1 else ""
    return "" if text == "raw*1" else text
