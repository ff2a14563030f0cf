"""Physical values and texts that test the setters of fields.

`assignments_of_field` returns pairs of an assigned value and the raw value that the setter must
store, or None if it must refuse the value. Most values lie next to a limit of rounding.
"""

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

# Refused by all fields except floats: NaNs (quiet, signaling, negative), infinities,
# and numbers beyond any raw value.
NEVER = (
    "7ff8000000000000", "7ff0000000000001", "fff8000000000123", "7ff0000000000000", "fff0000000000000",
    "7fefffffffffffff", "ffefffffffffffff",
)  # fmt: skip


def bits_of(value: float) -> str:
    """Return the 16 hex digits of the bits of a double, most significant first."""
    return struct.pack(">d", value).hex()


def float_of(bits: str) -> float:
    """Return the double of 16 hex digits."""
    value: float = struct.unpack(">d", bytes.fromhex(bits))[0]
    return value


Assignments = list[tuple[str, "int | bytes | None"]]


def assignments_of_field(field: AnyScalar) -> Assignments:
    """Return assignments of a field: the bits of a double, or a text, and the resulting
    raw value (None: refused).
    """
    if field.type == "text":
        return [(text, _raw(field, text)) for text in _texts(field.bits // 8)]
    return list(_settings(field.type, field.bits, field.scale, field.curve).items())


@lru_cache(maxsize=1 << 12)
def _settings(
    type: str, bits: int, scale: Scale | None, curve: Curve | None
) -> dict[str, int | bytes | None]:
    """Return the assignments for a type, width and calibration.

    Cached, because many fields have the same ones.
    """
    field = Scalar(name="", type=type, bits=bits, scale=scale, curve=curve)
    assignments: dict[str, int | bytes | None] = {}
    for value in _doubles(field) if curve is None else _on_curve(field, curve):
        if math.isfinite(value):
            assignments[bits_of(value)] = _raw(field, value)
    # Other fields refuse all of them, so that the file lists them once (`never_set`).
    if type == "float":
        assignments |= {bits: _raw(field, float_of(bits)) for bits in NEVER}
    return assignments


def _texts(size: int) -> Iterator[str]:
    """Yield texts of relevant lengths, the extreme ASCII characters, and non-ASCII
    characters, which are refused.
    """
    every = "".join(map(chr, range(1, 0x80)))
    # From "!" on, and one character more than fits.
    long = (every * (size // len(every) + 2))[32 : 32 + size + 1]
    yield from ("", long[:1], long[: size - 1], long[:size], long, "\x01", "\x7f")
    yield from ("\x80", "\u00e9", "\u4f4d", "\U0001f6f0")


def _raw(field: AnyScalar, assigned: str | float) -> int | bytes | None:
    try:
        return (
            codec.raw_from_text(field, assigned)
            if isinstance(assigned, str)
            else codec.raw_from_physical(field, assigned)
        )
    except codec.CodecError:
        return None


def _doubles(field: Scalar) -> Iterator[float]:
    """Yield physical values of a field with a scale, next to limits of rounding."""
    low, high = field.raw_min, field.raw_max
    # Negative zero and the smallest subnormal double.
    yield from (-0.0, 5e-324)
    # Midpoints between raw values, with the adjacent doubles, test rounding in both
    # directions.
    for raw in (low - 1, high, (low + high) // 2, low + (high - low) // 3):
        near = float(_above(field, raw))
        yield from (
            math.nextafter(near, -math.inf),
            near,
            math.nextafter(near, math.inf),
        )
    yield from _ties(field)


def _on_curve(field: Scalar, curve: Curve) -> Iterator[float]:
    """Yield physical values of some raw values, midpoints between neighbors, their
    adjacent doubles, and values beyond both ends.
    """
    yield from (-0.0, 5e-324, 1e300, -1e300)
    if field.type == "float":
        # The last two are near the largest and the smallest positive single.
        numbers = (0.0, 1.0, -1.5, 0.1, 1e-3, -123456.789, 3.4028234663852886e38, 1e-45)
        yield from (curve.double(raw) for raw in numbers)
        return
    low, high = field.settable_raws
    for raw in sorted({low, (low + high) // 2, low + (high - low) // 3, high - 1}):
        value, next_value = curve.double(raw), curve.double(raw + 1)
        middle = value + (next_value - value) / 2
        yield from (value, next_value, middle)
        for near in (value, middle, next_value):
            yield from (math.nextafter(near, -math.inf), math.nextafter(near, math.inf))


def _above(field: Scalar, raw: int) -> Fraction:
    """Return the exact physical value halfway between ``raw`` and the next raw value."""
    assert field.scale is not None
    return field.scale.physical(raw + Fraction(1, 2))


def _ties(field: Scalar) -> Iterator[float]:
    """Yield doubles exactly halfway between two raw values, even and odd, at both ends
    of the range.

    They test the rounding of ties.
    """
    assert field.scale is not None
    half, offset = field.scale.factor / 2, field.scale.offset
    common = math.lcm(half.denominator, offset.denominator)
    # The midpoint above raw r is ((2 r + 1) a + b) / common. It is a double if the odd
    # part of the denominator cancels.
    a, b = int(half * common), int(offset * common)
    odd = common // (common & -common)
    # Solve 2 a r = -(a + b) modulo `odd`. Divided by their greatest common divisor, 2 a
    # has an inverse.
    divisor = math.gcd(2 * a, odd)
    if (a + b) % divisor:
        return
    step = odd // divisor
    first = 0
    if step > 1:
        first = -(a + b) // divisor * pow(2 * a // divisor, -1, step) % step
    low, high = field.raw_min, field.raw_max
    lowest = low + (first - low) % step
    highest = high - (high - first) % step
    middle = first
    for raw in (lowest, lowest + step, middle, middle + step, highest - step, highest):
        value = _above(field, raw)
        if low - 1 <= raw <= high and Fraction(float(value)) == value:
            yield float(value)
