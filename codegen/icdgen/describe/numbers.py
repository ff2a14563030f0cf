"""Numbers and places for people."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache

from icdgen.icd.curve import CLAMP, EXTRAPOLATE, REFUSE, Curve
from icdgen.icd.model import Message, Special

MOST_DIGITS = 24  # of a decimal that is shown in full
_OUTSIDE = {"": "", CLAMP: "clamped outside", EXTRAPOLATE: "extrapolated outside", REFUSE: "no number outside"}


@lru_cache(maxsize=4096)
def exact_text(value: Fraction | int) -> str:
    """The decimal if it ends soon enough, else the nearest double."""
    if value.denominator == 1:
        return str(int(value)) if abs(value) < 10 ** MOST_DIGITS else repr(float(value))
    places = next((n for n in range(1, MOST_DIGITS + 1) if 10**n % value.denominator == 0), 0)
    scaled = value * 10**places
    if not places or len(str(abs(scaled.numerator))) > MOST_DIGITS:
        return repr(value.numerator / value.denominator)
    digits = str(abs(scaled.numerator)).rjust(places + 1, "0")
    return f"{'-' if value < 0 else ''}{digits[:-places]}.{digits[-places:]}"


@lru_cache(maxsize=4096)
def factor_text(factor: Fraction) -> str:
    """``0.01``; ``5/9`` where the decimal would not end."""
    text = exact_text(factor)
    return text if Fraction(text) == factor else str(factor)


def point_text(point: tuple[float, float]) -> str:
    """``512: 20.5``, a raw value and its physical one."""
    return ": ".join(repr(number).removesuffix(".0") for number in point)


def points_text(curve: Curve, most: int) -> str:
    """``0: -40, 512: 20.5, 1023: 125, clamped outside``; of many points the first ones and the last, ``most`` altogether."""
    points = list(map(point_text, curve.points))
    if len(points) > most:
        points[most - 1 : -1] = [f"... ({len(points)} points)"]
    return ", ".join([*points, *filter(None, [_OUTSIDE[curve.outside]])])


def value_text(raw: int) -> str:
    """A raw value that means something by itself: ``90 (0x5A)``; small and negative ones only in decimal."""
    return f"{raw} (0x{raw:X})" if raw > 9 else str(raw)


def special_text(special: Special) -> str:
    """``65535 (0xFFFF)``; of floats ``NaN``, ``-infinity``, ``-99.9``."""
    words = {"nan": "NaN", "inf": "infinity", "-inf": "-infinity"}
    return words.get(special.number, special.number) or value_text(special.value)


def bit_range(at: int, bits: int) -> str:
    """``bit 3``, ``bits 4 to 7``"""
    return f"bit {at}" if bits == 1 else f"bits {at} to {at + bits - 1}"


def array_text(count: int, bits: int) -> str:
    """``6 elements of 16 bits``"""
    return f"{count} element{'s' * (count != 1)} of {bits} bit{'s' * (bits != 1)}"


def octets_text(count: int, bits: int) -> str:
    """``10 elements of 30 bytes``"""
    return f"{count} element{'s' * (count != 1)} of {byte_count(bits // 8)}"


def byte_range(first: int, count: int) -> str:
    """``byte 3``, ``bytes 4 to 7``"""
    return f"byte {first}" if count == 1 else f"bytes {first} to {first + count - 1}"


def length_text(message: Message) -> str:
    """``6 bytes``; where frames differ ``4 to 28 bytes``."""
    shortest, longest = message.layout.shortest, byte_count(message.layout.longest)
    return longest if len(message.layout.lengths) == 1 else f"{shortest} to {longest}"


def count_text(counter: str, plus: int) -> str:
    """``Levels Count``, ``Size - 4``: how many elements, bytes or characters a part of variable length has."""
    return counter + (f" {'+' if plus > 0 else '-'} {abs(plus)}" if plus else "")


def byte_count(count: int) -> str:
    """``1 byte``, ``2 bytes``"""
    return f"{count} byte" if count == 1 else f"{count} bytes"
