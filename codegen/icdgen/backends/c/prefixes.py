"""Names of a thousandth and a millionth of a unit, as accessors of whole numbers end in them."""

from __future__ import annotations

from icdgen.icd.model import Field

# Units that already carry a prefix: (a thousandth, a millionth). Empty where that has no name.
_PREFIXED = {
    "km": ("m", "mm"), "mm": ("um", "nm"), "km_per_s": ("m_per_s", "mm_per_s"), "ms": ("us", "ns"), "us": ("ns", ""),
    "khz": ("hz", ""), "kg": ("g", "mg"), "ma": ("ua", "na"), "mv": ("uv", "nv"), "mw": ("uw", "nw"),
    "mn": ("un", "nn"), "mn_m": ("un_m", "nn_m"), "mnms": ("unms", "nnms"), "ut": ("nt", ""), "kpa": ("pa", "mpa"),
    "mah": ("uah", "nah"),
}  # fmt: skip
# Units that take a prefix. Hz does not: mhz is megahertz to most readers.
_PREFIXABLE = frozenset(
    """deg rad m s g n a v w j wh ah ohm t k c pa bar rpm n_m nms deg_per_s rad_per_s m_per_s deg_per_s2 rad_per_s2
    m_per_s2 a_m2""".split()
)


def part_of_unit(field: Field, prefix: str) -> tuple[str, str]:
    """The end of an integer accessor's name, and the unit in words: ``mdeg`` and ``thousandths of deg``."""
    part = "thousandths" if prefix == "milli" else "millionths"
    if field.unit is None:
        return prefix, part
    unit = field.unit.identifier
    words = f"{part} of {field.unit.symbol}"
    if unit in _PREFIXED:
        shifted = _PREFIXED[unit][prefix == "micro"]
        return (shifted or f"{prefix}_{unit}"), words
    if unit in _PREFIXABLE:
        return f"{'m' if prefix == 'milli' else 'u'}{unit}", words
    return f"{prefix}_{unit}", words
