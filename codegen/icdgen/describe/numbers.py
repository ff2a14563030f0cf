"""Numbers, positions and lengths in words.

Comments, pages and findings use the same phrases: ``bits 4 to 7``, ``2 bytes``, ``90
(0x5A)``. `icdgen.describe.display` has the notation of values with a resolution.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache

from icdgen.icd.curve import CLAMP, EXTRAPOLATE, REFUSE, Curve
from icdgen.icd.model import Message, Special

MOST_DIGITS = 24
"""Largest number of digits of a decimal that is shown in full."""
_OUTSIDE = {
    "": "",
    CLAMP: "clamped outside",
    EXTRAPOLATE: "extrapolated outside",
    REFUSE: "no number outside",
}


@lru_cache(maxsize=4096)
def exact_text(value: Fraction | int) -> str:
    """Return the exact decimal if it has few digits, else the nearest double."""
    if value.denominator == 1:
        return str(int(value)) if abs(value) < 10**MOST_DIGITS else repr(float(value))
    # A decimal ends only if the denominator divides a power of ten.
    places = next(
        (n for n in range(1, MOST_DIGITS + 1) if 10**n % value.denominator == 0), 0
    )
    scaled = value * 10**places
    if not places or len(str(abs(scaled.numerator))) > MOST_DIGITS:
        return repr(value.numerator / value.denominator)
    # At least one digit in front of the point.
    digits = str(abs(scaled.numerator)).rjust(places + 1, "0")
    return f"{'-' if value < 0 else ''}{digits[:-places]}.{digits[-places:]}"


@lru_cache(maxsize=4096)
def factor_text(factor: Fraction) -> str:
    """Return a factor as text: ``0.01``; ``5/9`` if the decimal does not end."""
    text = exact_text(factor)
    # `exact_text` gives a rounded double if the decimal does not end soon.
    return text if Fraction(text) == factor else str(factor)


def point_text(point: tuple[float, float]) -> str:
    """Return a point of a lookup table: ``512: 20.5``, the raw and the physical value."""
    return ": ".join(repr(number).removesuffix(".0") for number in point)


def points_text(curve: Curve, most: int) -> str:
    """Return the points of a lookup table: ``0: -40, 512: 20.5, 1023: 125, clamped
    outside``.

    If there are more than ``most`` points, some in the middle are left out.
    """
    points = list(map(point_text, curve.points))
    if len(points) > most:
        points[most - 1 : -1] = [f"... ({len(points)} points)"]
    return ", ".join([*points, *filter(None, [_OUTSIDE[curve.outside]])])


def value_text(raw: int) -> str:
    """Return a raw value with a meaning as text: ``90 (0x5A)``; values below 10 in
    decimal only.
    """
    # Up to 9 both notations have the same digit.
    return f"{raw} (0x{raw:X})" if raw > 9 else str(raw)


def special_text(special: Special) -> str:
    """Return a special value as text: ``65535 (0xFFFF)``; for floats ``NaN``,
    ``-infinity``, ``-99.9``.
    """
    words = {"nan": "NaN", "inf": "infinity", "-inf": "-infinity"}
    return words.get(special.number, special.number) or value_text(special.value)


def bit_range(at: int, bits: int) -> str:
    """Return a range of bits: ``bit 3``, ``bits 4 to 7``."""
    return f"bit {at}" if bits == 1 else f"bits {at} to {at + bits - 1}"


def array_text(count: int, bits: int) -> str:
    """Return the size of an array: ``6 elements of 16 bits``."""
    return f"{count} element{'s' * (count != 1)} of {bits} bit{'s' * (bits != 1)}"


def octets_text(count: int, bits: int) -> str:
    """Return the size of an array of whole bytes: ``10 elements of 30 bytes``."""
    return f"{count} element{'s' * (count != 1)} of {byte_count(bits // 8)}"


def byte_range(first: int, count: int) -> str:
    """Return a range of bytes: ``byte 3``, ``bytes 4 to 7``."""
    return f"byte {first}" if count == 1 else f"bytes {first} to {first + count - 1}"


def length_text(message: Message) -> str:
    """Return the length of a message: ``6 bytes``; ``4 to 28 bytes`` if lengths differ."""
    shortest, longest = message.layout.shortest, byte_count(message.layout.longest)
    return longest if len(message.layout.lengths) == 1 else f"{shortest} to {longest}"


def count_text(counter: str, plus: int) -> str:
    """Return the number of elements of a variable part by its counter: ``Levels
    Count``, ``Size - 4``.
    """
    return counter + (f" {'+' if plus > 0 else '-'} {abs(plus)}" if plus else "")


def byte_count(count: int) -> str:
    """Return a number of bytes: ``1 byte``, ``2 bytes``."""
    return f"{count} byte" if count == 1 else f"{count} bytes"
