"""Ranges of electronic data sheets, as the limits of a field."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple
from xml.etree.ElementTree import Element

from icdgen.definitions.eds_sheets import Sheets
from icdgen.definitions.eds_values import evaluate
from icdgen.definitions.model import Item, raws
from icdgen.definitions.wording import limits

_TYPES = {  # what is said of the ends: None where there is none, else whether it is part of the range
    "inclusivemininclusivemax": (True, True), "inclusiveminexclusivemax": (True, False),
    "exclusivemininclusivemax": (False, True), "exclusiveminexclusivemax": (False, False),
    "atleast": (True, None), "greaterthan": (False, None), "atmost": (None, True), "lessthan": (None, False),
}  # fmt: skip


class Range(NamedTuple):
    """Values from one to another; None where there is no end, ``is_low_in`` whether it is one of them."""

    low: Fraction | None = None
    high: Fraction | None = None
    is_low_in: bool = True
    is_high_in: bool = True

    def within(self, other: Range) -> Range:
        """The values of both."""
        low, high, is_low_in, is_high_in = self
        if other.low is not None and (low is None or (other.low, not other.is_low_in) > (low, not is_low_in)):
            low, is_low_in = other.low, other.is_low_in
        if other.high is not None and (high is None or (other.high, other.is_high_in) < (high, is_high_in)):
            high, is_high_in = other.high, other.is_high_in
        return Range(low, high, is_low_in, is_high_in)

    def of_integers(self) -> tuple[Fraction | None, Fraction | None]:
        """The least and the largest integer."""
        low, high = self.low, self.high
        if low is not None:
            low = Fraction(-(-low // 1)) if self.is_low_in or low.denominator != 1 else low + 1
        if high is not None:
            high = Fraction(high // 1) if self.is_high_in or high.denominator != 1 else high - 1
        return low, high


ALL = Range()


def said(sheets: Sheets, element: Element) -> Range:
    """What a `MinMaxRange` within an element says; of one that says nothing all values. Raises `NotHeld`."""
    found = element.find("MinMaxRange")
    if found is None:
        return ALL
    kind = sheets.attribute(found, "rangeType", "inclusiveMinInclusiveMax").lower()
    is_low_in, is_high_in = _TYPES.get(kind, (None, None))
    low = None if is_low_in is None else _end(sheets.attribute(found, "min"))
    high = None if is_high_in is None else _end(sheets.attribute(found, "max"))
    return Range(low, high, bool(is_low_in), bool(is_high_in))


def _end(text: str) -> Fraction | None:
    try:
        return evaluate(text)
    except ValueError:
        return None


def limited(item: Item, bits: int, of: Range) -> Item:
    """The keys of the limits that a field of a type and of so many bits has, where they say more than its width."""
    if item["type"] in ("uint", "int"):
        first, last = raws(bits, item["type"] == "int")
        return dict(limits(*of.of_integers(), Fraction(first), Fraction(last)))
    found: Item = {}
    if item["type"] == "float" and (of.low is None or of.high is None or of.low <= of.high):
        for end, key in (
            (of.low, "min" if of.is_low_in else "above"),
            (of.high, "max" if of.is_high_in else "below"),
        ):
            number = None if end is None else end.numerator if end.denominator == 1 else _double(end)
            if number is not None and "e" not in str(number) and len(str(number)) < 30:
                found[key] = number
    return found


def _double(value: Fraction) -> float | None:
    try:
        return float(value)
    except OverflowError:
        return None
