"""Which doubles are worth setting as the physical value of a scaled field."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from fractions import Fraction
from functools import lru_cache

from icdgen import codec
from icdgen.icd.curve import Curve
from icdgen.icd.formula import Scale
from icdgen.icd.layout import Scalar
from icdgen.icd.places import AnyScalar

# Refused by every field but floats: NaN (quiet, signalling, negative), the infinities, and numbers beyond any raw value.
NEVER = (
    "7ff8000000000000", "7ff0000000000001", "fff8000000000123", "7ff0000000000000", "fff0000000000000",
    "7fefffffffffffff", "ffefffffffffffff",
)  # fmt: skip


def bits_of(value: float) -> str:
    """The 16 hex digits of a double's bits, most significant first."""
    return struct.pack(">d", value).hex()


def float_of(bits: str) -> float:
    """The double that 16 hex digits stand for."""
    value: float = struct.unpack(">d", bytes.fromhex(bits))[0]
    return value


Settings = list[tuple[str, "int | bytes | None"]]


def settings(field: AnyScalar) -> Settings:
    """Doubles (as their bits) or texts, and the raw value that setting each must give; None where it must be refused."""
    if field.type == "text":
        return [(text, _raw(field, text)) for text in _texts(field.bits // 8)]
    return list(_settings(field.type, field.bits, field.scale, field.curve).items())


@lru_cache(maxsize=1 << 12)
def _settings(type: str, bits: int, scale: Scale | None, curve: Curve | None) -> dict[str, int | bytes | None]:
    """Those of all fields of this type, width and formula: many have the same."""
    field = Scalar(name="", type=type, bits=bits, scale=scale, curve=curve)
    found: dict[str, int | bytes | None] = {}
    for value in _doubles(field) if curve is None else _on_curve(field, curve):
        if math.isfinite(value):
            found[bits_of(value)] = _raw(field, value)
    if type == "float":
        found |= {bits: _raw(field, float_of(bits)) for bits in NEVER}
    return found


def _texts(size: int) -> Iterator[str]:
    """Texts of every length that matters, the extreme characters, and what no text field takes."""
    every = "".join(map(chr, range(1, 0x80)))
    long = (every * (size // len(every) + 2))[32 : 32 + size + 1]
    yield from ("", long[:1], long[: size - 1], long[:size], long, "\x01", "\x7f")
    yield from ("\x80", "\u00e9", "\u4f4d", "\U0001f6f0")


def _raw(field: AnyScalar, given: str | float) -> int | bytes | None:
    try:
        return codec.raw_from_text(field, given) if isinstance(given, str) else codec.raw_from_physical(field, given)
    except codec.CodecError:
        return None


def _doubles(field: Scalar) -> Iterator[float]:
    low, high = field.raw_min, field.raw_max
    yield from (-0.0, 5e-324)
    for raw in (low - 1, high, (low + high) // 2, low + (high - low) // 3):
        near = float(_above(field, raw))
        yield from (math.nextafter(near, -math.inf), near, math.nextafter(near, math.inf))
    yield from _ties(field)


def _on_curve(field: Scalar, curve: Curve) -> Iterator[float]:
    """Beside the physical values of some raw values, half way between those of neighbours, and beyond the ends."""
    yield from (-0.0, 5e-324, 1e300, -1e300)
    if field.type == "float":
        numbers = (0.0, 1.0, -1.5, 0.1, 1e-3, -123456.789, 3.4028234663852886e38, 1e-45)
        yield from (curve.double(one) for one in numbers)
        return
    low, high = field.settable_raws
    for raw in sorted({low, (low + high) // 2, low + (high - low) // 3, high - 1}):
        here, there = curve.double(raw), curve.double(raw + 1)
        middle = here + (there - here) / 2
        yield from (here, there, middle)
        yield from (math.nextafter(one, way) for one in (here, middle, there) for way in (-math.inf, math.inf))


def _above(field: Scalar, raw: int) -> Fraction:
    """The exact physical value half way between ``raw`` and the next raw value."""
    assert field.scale is not None
    return field.scale.physical(raw + Fraction(1, 2))


def _ties(field: Scalar) -> Iterator[float]:
    """Doubles that lie exactly half way between two raw values, an even and an odd one below, at both ends of the range."""
    assert field.scale is not None
    half, offset = field.scale.factor / 2, field.scale.offset
    common = math.lcm(half.denominator, offset.denominator)
    # half way above raw r is ((2 r + 1) a + b) / common; a double needs the odd part of the denominator to cancel
    a, b = int(half * common), int(offset * common)
    odd = common // (common & -common)
    divisor = math.gcd(2 * a, odd)
    if (a + b) % divisor:
        return
    step = odd // divisor
    first = -(a + b) // divisor * pow(2 * a // divisor, -1, step) % step if step > 1 else 0
    low, high = field.raw_min, field.raw_max
    lowest = low + (first - low) % step
    highest = high - (high - first) % step
    middle = first
    for raw in (lowest, lowest + step, middle, middle + step, highest - step, highest):
        value = _above(field, raw)
        if low - 1 <= raw <= high and Fraction(float(value)) == value:
            yield float(value)
