"""Date and time packed into bit fields, such as MS-DOS time."""

from __future__ import annotations

from calendar import monthrange
from collections.abc import Mapping

from icdgen.protocol.errors import RangeError
from icdgen.protocol.facts import Facts, need

PARTS = ("year", "month", "day", "hour", "minute", "second")


def unpack(facts: Facts, value: int) -> dict[str, int]:
    """Return the parts of a packed time, without a check of their ranges."""
    form = need(facts.time, "msdos_time")
    return {
        name: (value >> p.at & (1 << p.bits) - 1) * p.factor + p.offset
        for name, p in form.items()
    }


def pack(facts: Facts, parts: Mapping[str, int]) -> int:
    """Return the packed time, rounded down to its resolution.

    Raises `RangeError` for the first part, in the order of `PARTS`, that does not exist
    or does not fit.
    """
    form, value = need(facts.time, "msdos_time"), 0
    invalid = invalid_part(parts)
    if invalid:
        raise RangeError(invalid)
    for name in PARTS:
        part = form[name]
        # MS-DOS time counts seconds in steps of two.
        raw = (parts[name] - part.offset) // part.factor
        if not 0 <= raw < 1 << part.bits:
            raise RangeError(name)
        value |= raw << part.at
    return value


def invalid_part(parts: Mapping[str, int]) -> str | None:
    """Return the name of the first part of a date and time that does not exist; None if
    all are valid.
    """
    limits = {"month": (1, 12), "hour": (0, 23), "minute": (0, 59), "second": (0, 59)}
    for name in PARTS:
        if name == "day":
            # Month is checked before day, so `monthrange` receives a valid month.
            limits["day"] = 1, monthrange(parts["year"], parts["month"])[1]
        low, high = limits.get(name, (parts[name], parts[name]))
        if not low <= parts[name] <= high:
            return name
    return None
