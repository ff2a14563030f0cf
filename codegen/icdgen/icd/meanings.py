"""Special values and limits of fields, and how they are read from a file."""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction

from icdgen.frozen import dataclass
from icdgen.icd import floats
from icdgen.icd.located import Map

_LIMITS = frozenset({"min", "max", "above", "below"})


@dataclass(frozen=True, slots=True)
class Special:
    """A raw value with a special meaning, such as 0xFFFF for 'no time-out', or NaN for
    'not available'.
    """

    value: int  # of a float: its IEEE 754 bits
    meaning: str
    number: str = ""  # of a float: `nan`, `inf`, `-inf`, or the shortest decimal


@dataclass(frozen=True, slots=True)
class Limits:
    """Bounds of the physical value (of the raw value if there is no scale); None where
    the ICD gives no bound.
    """

    min: Fraction | None = None
    max: Fraction | None = None
    above: Fraction | None = None
    below: Fraction | None = None


def special(
    kind: str, bits: int, value: int | float | str, meaning: str
) -> Special | None:
    """Return a special value; None if a field of this type and width cannot have the
    value.
    """
    if kind != "float":
        return Special(value, meaning) if isinstance(value, int) else None
    raw = float_bits(value, bits)
    return (
        None
        if raw is None
        else Special(raw, meaning, floats.text_of(floats.value_of(raw, bits), bits))
    )


def float_bits(value: int | float | str, bits: int) -> int | None:
    """Return the bits of a float of this width from its value in an ICD; None if the
    width or the value is not valid.
    """
    if bits not in floats.WIDTHS or (
        isinstance(value, str) and value not in floats.NAMED
    ):
        return None
    with suppress(OverflowError):
        return (
            floats.bits_of(floats.NAMED[value], bits)
            if isinstance(value, str)
            else floats.nearest(exact(value), bits)
        )
    return None


def limits(item: Map) -> Limits | None:
    """Return the limits of a field as exact numbers; None if it has no limits."""
    if _LIMITS.isdisjoint(item):
        return None
    return Limits(**{key: exact(item[key]) for key in _LIMITS & item.keys()})


def exact(number: int | float) -> Fraction:
    """Return the exact value of a number of a file."""
    # repr() gives the shortest decimal, so 0.1 is one tenth and not the nearest double.
    return Fraction(number) if isinstance(number, int) else Fraction(repr(number))
