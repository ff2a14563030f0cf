"""Physical values as whole numbers of thousandths or millionths of a unit, for programs
without floating point.

`integer_scale` decides whether all values of a scale are such numbers; `integer_bits`
which integer computes them without overflow; `part_of_unit` how the part is named
(``mdeg``).
"""

from __future__ import annotations

import math
from fractions import Fraction
from functools import lru_cache

from icdgen.describe.steps import Steps
from icdgen.describe.storage import Storage
from icdgen.frozen import NamedTuple
from icdgen.icd.places import NodePlace
from icdgen.icd.units import STANDARD

# Units that have a prefix already: names of a thousandth and a millionth. Empty if
# there is no usual name.
_PREFIXED = {
    "km": ("m", "mm"), "mm": ("um", "nm"), "km_per_s": ("m_per_s", "mm_per_s"), "ms": ("us", "ns"), "us": ("ns", ""),
    "khz": ("hz", ""), "kg": ("g", "mg"), "ma": ("ua", "na"), "mv": ("uv", "nv"), "mw": ("uw", "nw"),
    "mn": ("un", "nn"), "mn_m": ("un_m", "nn_m"), "mnms": ("unms", "nnms"), "ut": ("nt", ""), "kpa": ("pa", "mpa"),
    "mah": ("uah", "nah"),
}  # fmt: skip
# Units that get a prefix. Hz does not: most readers take mhz for megahertz.
_PREFIXABLE = frozenset(
    """deg rad m s g n a v w j wh ah ohm t k c pa bar rpm n_m nms deg_per_s rad_per_s m_per_s deg_per_s2 rad_per_s2
    m_per_s2 a_m2""".split()
)
# Symbols that are not written with a prefix.
_IN_WORDS = frozenset(("deg", "c", "rpm", "deg_per_s", "deg_per_s2"))


class IntegerScale(NamedTuple):
    """Scale of whole numbers: value = raw*factor + offset, in ``1 / per`` of the unit."""

    per: int  # 1000 | 1_000_000
    factor: int
    offset: int
    low: int  # smallest value of all raw values of the field
    high: int  # largest value
    least: int  # smallest value whose nearest raw value is in the range of the field
    most: int  # largest such value


@lru_cache(maxsize=4096)
def integer_scale(steps: Steps) -> IntegerScale | None:
    """Return the scale in thousandths if every raw value is a whole number of them;
    else in millionths; else None.
    """
    # Thousandths come first, because their numbers are smaller.
    for per in (1000, 1_000_000):
        factor = Fraction(steps.p * per, steps.q)
        offset = Fraction(steps.c * per, steps.q)
        if factor.denominator == offset.denominator == 1:
            return _integer_scale(per, int(factor), int(offset), steps)
    return None


def _integer_scale(per: int, factor: int, offset: int, steps: Steps) -> IntegerScale:
    """Return the scale with the smallest and largest value that a setter accepts."""
    ends = ((raw * factor + offset, raw) for raw in (steps.raw_min, steps.raw_max))
    # A negative factor exchanges the ends.
    (low, raw_of_low), (high, raw_of_high) = sorted(ends)
    # A setter rounds to the nearest raw value: it accepts half a step beyond each end.
    half_step = Fraction(abs(factor), 2)
    bottom, top = low - half_step, high + half_step
    least, most = math.ceil(bottom), math.floor(top)
    # Ties are rounded to the even raw value.
    if least == bottom and raw_of_low % 2:
        least += 1
    if most == top and raw_of_high % 2:
        most -= 1
    return IntegerScale(per, factor, offset, low, high, least, most)


def integer_bits(scale: IntegerScale, storage: Storage) -> int | None:
    """Return the bits of the integer that can store the values of all values of the
    storage, 32 or 64; None if none can.
    """
    # A raw value beyond the field can be in the storage, and overflow of a signed
    # integer is undefined in C (C99 6.5), so all values of the storage count.
    bits = 32 if is_computable(storage, scale.factor, scale.offset, 32) else 64
    ends = Storage(bits, True)
    differences = (
        max(scale.least, ends.min) - scale.offset,
        min(scale.most, ends.max) - scale.offset,
    )
    can_compute = is_computable(storage, scale.factor, scale.offset, bits)
    return bits if can_compute and fits_bits(64, *differences) else None


def is_computable(storage: Storage, factor: int, offset: int, bits: int) -> bool:
    """Return whether raw * factor + offset does not overflow a signed integer for any
    value of the storage.
    """
    products = storage.min * factor, storage.max * factor
    return fits_bits(
        bits, *products, *(product + offset for product in products), factor, offset
    )


def fits_bits(bits: int, *values: int) -> bool:
    """Return whether a signed integer can store the values and their negatives."""
    # Code subtracts the absolute value of a negative term, which must be a literal of
    # the type.
    return max(map(abs, values)) <= (1 << bits - 1) - 1


def part_of_unit(field: NodePlace, per: int) -> tuple[str, str]:
    """Return the end of an accessor's name and the unit in words: ``mdeg``,
    ``thousandths of deg``; for km ``m``, ``m``.
    """
    prefix, part = ("milli", "thousandths") if per == 1000 else ("micro", "millionths")
    if field.unit is None:
        return prefix, part
    unit, symbol = field.unit.identifier, field.unit.symbol
    words, is_known = f"{part} of {symbol}", symbol in STANDARD
    shifted = _PREFIXED[unit][per > 1000] if unit in _PREFIXED else ""
    if shifted:
        # The unit loses its prefix (`km` becomes `m`) or gets another one (`km` becomes
        # `mm`).
        base = symbol[1:] if shifted == unit[1:] else f"{shifted[0]}{symbol[1:]}"
        return shifted, base if is_known else words
    if unit in _PREFIXABLE:
        letter = "m" if per == 1000 else "u"
        return f"{letter}{unit}", (
            words if unit in _IN_WORDS or not is_known else f"{letter}{symbol}"
        )
    return f"{prefix}_{unit}", words
