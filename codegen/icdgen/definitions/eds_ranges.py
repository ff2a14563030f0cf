"""Value ranges of electronic data sheets, and the limits of fields.

Ends of ranges are exact fractions, included or not. They become `min`, `max`, `above`
and `below` of an ICD field if they lie within the values of its type.
"""

from __future__ import annotations

from fractions import Fraction
from xml.etree.ElementTree import Element

from icdgen.definitions.eds_sheets import Sheets
from icdgen.definitions.eds_values import evaluate
from icdgen.definitions.model import Item
from icdgen.definitions.wording import limits
from icdgen.frozen import NamedTuple
from icdgen.icd.layout import integer_range

# RangeType: for low and high end whether it is included; None without an end.
_TYPES = {
    "inclusivemininclusivemax": (True, True), "inclusiveminexclusivemax": (True, False),
    "exclusivemininclusivemax": (False, True), "exclusiveminexclusivemax": (False, False),
    "atleast": (True, None), "greaterthan": (False, None), "atmost": (None, True), "lessthan": (None, False),
}  # fmt: skip


class Range(NamedTuple):
    """Range of values.

    ``low`` is None without a lower limit, ``high`` without an upper limit.
    ``is_low_in`` and ``is_high_in`` state whether the range includes its limits.
    """

    low: Fraction | None = None
    high: Fraction | None = None
    is_low_in: bool = True
    is_high_in: bool = True

    def within(self, other: Range) -> Range:
        """Return the intersection of two ranges."""
        low, high, is_low_in, is_high_in = self
        if other.low is not None and (
            low is None or (other.low, not other.is_low_in) > (low, not is_low_in)
        ):
            low, is_low_in = other.low, other.is_low_in
        if other.high is not None and (
            high is None or (other.high, other.is_high_in) < (high, is_high_in)
        ):
            high, is_high_in = other.high, other.is_high_in
        return Range(low, high, is_low_in, is_high_in)

    def of_integers(self) -> tuple[Fraction | None, Fraction | None]:
        """Return the smallest and largest integer of the range, with None for an
        unlimited end.
        """
        low, high = self.low, self.high
        if low is not None:
            low = (
                Fraction(-(-low // 1))
                if self.is_low_in or low.denominator != 1
                else low + 1
            )
        if high is not None:
            high = (
                Fraction(high // 1)
                if self.is_high_in or high.denominator != 1
                else high - 1
            )
        return low, high


ALL = Range()


def stated_range(sheets: Sheets, element: Element) -> Range:
    """Return the range of a `MinMaxRange` in an element, or `ALL` without one.

    Raises `NotSupported` for an undefined design parameter.
    """
    bounds = element.find("MinMaxRange")
    if bounds is None:
        return ALL
    kind = sheets.attribute(bounds, "rangeType", "inclusiveMinInclusiveMax").lower()
    is_low_in, is_high_in = _TYPES.get(kind, (None, None))
    low = None if is_low_in is None else _end(sheets.attribute(bounds, "min"))
    high = None if is_high_in is None else _end(sheets.attribute(bounds, "max"))
    return Range(low, high, bool(is_low_in), bool(is_high_in))


def _end(text: str) -> Fraction | None:
    try:
        return evaluate(text)
    except ValueError:
        return None


def limited(item: Item, bits: int, of: Range) -> Item:
    """Return the limit keys of a field.

    Limits beyond the values of its type and bits are left out.
    """
    if item["type"] in ("uint", "int"):
        first, last = integer_range(bits, item["type"] == "int")
        return dict(limits(*of.of_integers(), Fraction(first), Fraction(last)))
    result: Item = {}
    if item["type"] == "float" and (
        of.low is None or of.high is None or of.low <= of.high
    ):
        for end, key in (
            (of.low, "min" if of.is_low_in else "above"),
            (of.high, "max" if of.is_high_in else "below"),
        ):
            if end is None:
                continue
            number = end.numerator if end.denominator == 1 else _double(end)
            # YAML 1.1 requires a point in floats: PyYAML reads ``1e+22`` as text.
            if number is not None and "e" not in str(number) and len(str(number)) < 30:
                result[key] = number
    return result


def _double(value: Fraction) -> float | None:
    try:
        return float(value)
    except OverflowError:
        return None
