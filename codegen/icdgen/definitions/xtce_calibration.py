"""Numbers of XTCE, and calibrations as formulas."""

from __future__ import annotations

import re
from decimal import Decimal
from fractions import Fraction
from typing import TYPE_CHECKING

from icdgen.definitions.model import NotHeld
from icdgen.definitions.wording import line, printed

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

NUMBER = re.compile(r"\s*([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]{1,3})?)\s*\Z")
_INTEGER = re.compile(r"\s*([-+]?[0-9]{1,40})\s*\Z")
_MOST_POWER = 15


def calibration(encoding: Element) -> str:
    """The formula; nothing where the raw value is meant. Raises `ValueError`, with the reason, where no formula says it."""
    if encoding.find("ContextCalibratorList") is not None:
        raise ValueError("its calibration depends on other parameters")
    calibrator = encoding.find("DefaultCalibrator")
    if calibrator is None:
        return ""
    if terms := calibrator.findall("PolynomialCalibrator/Term"):
        return polynomial(terms)
    spline = calibrator.find("SplineCalibrator")
    if spline is None:
        raise ValueError("it is calibrated by an algorithm")
    points = spline.findall("SplinePoint")
    if len(points) != 2 or {one.get("order", "1") for one in (spline, *points)} != {"1"}:
        raise ValueError(f"it is calibrated by a table of {len(points)} points")
    if spline.get("extrapolate", "false") != "true":
        raise ValueError("its calibration ends with the points of its table")
    return through(points)


def number(text: str, what: str) -> int:
    """An integer. Raises `NotHeld`."""
    found = _INTEGER.match(text)
    if found is None:
        raise NotHeld(f"{what} is `{line(text, 60)}`")
    return int(found[1])


def decimal(text: str) -> str:
    """A number as a formula has it. Raises `ValueError`."""
    found = NUMBER.match(text)
    if found is None:
        raise ValueError(f"a coefficient is `{line(text, 60)}`")
    return printed(Decimal(found[1]))


def fixed(element: Element | None, default: int | None = None) -> int | None:
    """A number that is written down; None for one that something else says."""
    if element is None:
        return default
    of = element.find("FixedValue")
    return None if of is None else number(of.text or "", "a fixed value")


def polynomial(terms: list[Element]) -> str:
    """Raises `ValueError` for one that cannot be said."""
    found: dict[int, str] = {}
    for one in terms:
        power = number(one.get("exponent", ""), "an exponent")
        if not 0 <= power <= _MOST_POWER:
            raise ValueError(f"it is calibrated by raw^{power}")
        if power in found:
            raise ValueError(f"raw^{power} has two coefficients")
        found[power] = decimal(one.get("coefficient", ""))
    return formula(found)


def formula(terms: dict[int, str]) -> str:
    """The highest power first; nothing where the raw value is meant."""
    text = ""
    terms = {power: value for power, value in terms.items() if Fraction(value)}
    if terms == {1: "1"}:
        return ""
    for power, value in sorted(terms.items(), reverse=True):
        size, raw = value.lstrip("-"), "raw" if power == 1 else f"raw^{power}"
        part = size if not power else raw if size == "1" else f"{raw}*{size}"
        text += f"{' - ' if value[0] == '-' else ' + '}{part}" if text else ("-" if value[0] == "-" else "") + part
    return text or "raw*0"


def through(points: list[Element]) -> str:
    """Through two points."""
    (x0, y0), (x1, y1) = ([decimal(one.get(key, "")) for key in ("raw", "calibrated")] for one in points)
    across, up = Fraction(x1) - Fraction(x0), Fraction(y1) - Fraction(y0)
    if not across:
        raise ValueError("two points of its calibration have one raw value")
    slope, start = up / across, Fraction(y0) - Fraction(x0) * up / across
    text = f"raw*{slope.numerator}" + (f"/{slope.denominator}" if slope.denominator != 1 else "")
    if start:
        text += f" {'-' if start < 0 else '+'} {abs(start.numerator)}"
        text += f"/{start.denominator}" if start.denominator != 1 else ""
    return "" if text == "raw*1" else text
