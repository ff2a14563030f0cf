"""Date and time packed into bits, as in MS-DOS; the ICD gives the position of each
part.
"""

from __future__ import annotations

from calendar import monthrange
from datetime import datetime
from typing import NamedTuple, Optional, Union

from .._errors import RangeError
from .errors import need
from .link import Link


class DosTime(NamedTuple):
    """The parts of a packed time, valid or not."""

    year: int
    month: int
    day: int
    hour: int
    minute: int
    second: int

    @property
    def is_valid(self) -> bool:
        """Whether the date and time exist."""
        return _wrong(self) is None

    def datetime(self) -> datetime:
        """Return a `datetime` without time zone.

        Raise `ValueError` if it does not exist.
        """
        return datetime(*self)


def dos_time_unpack(link: Link, value: int) -> DosTime:
    """Return the parts of a packed time. Raise `UnsupportedError`."""
    form = need(link.time, "msdos_time")
    parts = dict.fromkeys(DosTime._fields, 0)
    for name, part in form.items():
        raw = value >> part.at & (1 << part.bits) - 1
        parts[name] = raw * part.factor + part.offset
    return DosTime(**parts)


def dos_time_pack(link: Link, time: Union[DosTime, datetime]) -> int:
    """Return the packed time, rounded down to its resolution.

    Raise `RangeError` for the first part that does not exist or is out of range, and
    `UnsupportedError`.
    """
    form = need(link.time, "msdos_time")
    if isinstance(time, datetime):
        time = DosTime(*time.timetuple()[:6])
    wrong = _wrong(time)
    if wrong:
        raise RangeError(wrong, "what the calendar has", getattr(time, wrong))
    packed = 0
    for name in DosTime._fields:
        if name not in form:
            continue
        part = form[name]
        raw, most = (getattr(time, name) - part.offset) // part.factor, 1 << part.bits
        if not 0 <= raw < most:
            last = (most - 1) * part.factor + part.offset
            raise RangeError(name, f"{part.offset} to {last}", getattr(time, name))
        packed |= raw << part.at
    return packed


def _wrong(time: DosTime) -> Optional[str]:
    """Return the name of the first part that does not exist, or None."""
    if not 1 <= time.month <= 12:
        return "month"
    # The calendar repeats every 400 years; `monthrange` does not accept all years.
    days = monthrange(2000 + time.year % 400, time.month)[1]
    most = {"day": (1, days), "hour": (0, 23), "minute": (0, 59), "second": (0, 59)}
    for name, (low, high) in most.items():
        if not low <= getattr(time, name) <= high:
            return name
    return None
