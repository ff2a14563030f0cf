"""Damage and clock jumps of a telemetry log, found by the times of its entries.

Entries of a log have no sync word and no checksum. Their times are the only redundancy:
milliseconds below 1000, and seconds that rise by little from one entry to the next.
`LogSurvey` reads the file once and returns the spans of whole entries, the ranges of
bytes that belong to none, and the places where the clock was set.
`icdgen.logfile.source` gives the spans to the converters.

Limits: a change of data bytes that leaves all times in place cannot be detected, nor
can a loss of exactly as many bytes as bring another copy of the time, in the data, to
the place of the time. The first entry after a damaged range may have a wrong time if
the lowest byte of its time was damaged. Damage within the very first time of a file
shows only by what follows.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise, takewhile
from statistics import median
from typing import BinaryIO

from icdgen.logfile.columns import EntryLayout
from icdgen.logfile.strided import numbers_at

MINUTE, DAY, MONTH, YEAR = 60_000, 86_400_000, 30 * 86_400_000, 366 * 86_400_000  # ms
YEAR_1990 = 631_152_000_000  # ms: an earlier time may be a counter
# `datetime`, which writes the times of rows, has no later year.
LATEST_SECOND = 253_402_300_799  # the last one of the year 9999
# an entry later than this number of usual steps is checked for damage
STEPS_IN_LIMIT = 5
LEARNED_ENTRIES = 64  # entries that determine the usual step
COMPARED_ENTRIES = 8  # entries that determine the positions of other times in an entry
FIRST_CHUNK, LAST_CHUNK = 16, 1 << 20  # entries, bytes
WINDOW = 1 << 16  # bytes searched at a time
NEVER = math.inf


@dataclass(frozen=True, slots=True)
class EntrySpan:
    """Consecutive complete entries from byte ``start`` of the file."""

    start: int
    entries: int


@dataclass(frozen=True, slots=True)
class Damage:
    """Bytes ``start`` to ``end`` (exclusive) that are left out.

    ``rows`` is the approximate number of lost entries.
    """

    start: int
    end: int
    rows: int


@dataclass(frozen=True, slots=True)
class TimeJump:
    """A change of the clock at the entry at byte ``at``.

    Times are milliseconds since 1970.
    """

    at: int
    before: int
    after: int


@dataclass(slots=True)
class Integrity:
    """Complete entries, damage and clock jumps of a log.

    ``truncated`` is the length of an incomplete last entry.
    """

    spans: list[EntrySpan] = field(default_factory=list)
    damages: list[Damage] = field(default_factory=list)
    jumps: list[TimeJump] = field(default_factory=list)
    truncated: int = 0

    @property
    def entries(self) -> int:
        return sum(span.entries for span in self.spans)


class LogSurvey:
    """Search for complete entries in an open log of ``size`` bytes that begin at
    ``begin``.
    """

    def __init__(
        self, file: BinaryIO, size: int, begin: int, plan: EntryLayout
    ) -> None:
        self.file, self.size, self.begin, self.plan = file, size, begin, plan
        self.entry_bytes = plan.entry_bytes
        self.time_end = max(at + size for at, size in (plan.seconds, plan.milliseconds))
        self.step = 0.0  # usual milliseconds from an entry to the next
        self.limit = float(MINUTE)  # a longer step is checked for damage
        # Offsets in an entry at which its data also contain the time.
        self.other_times: list[int] = []

    def run(self, most: int | None = None) -> Integrity:
        """Read the file up to ``most`` complete entries.

        Without entries, there is no span.
        """
        result, size = Integrity(), self.entry_bytes
        start = self._anchor()
        if start is None:
            return result
        if start > self.begin:
            result.damages.append(self._damage(self.begin, start))
        run = start  # where the present time base begins
        while True:
            self._learn(run)
            broken = self._first_break(run)
            if most is not None and result.entries + (broken - start) // size >= most:
                result.spans.append(EntrySpan(start, most - result.entries))
                return result
            if broken + size > self.size and self._ends_well(broken):
                result.spans.append(EntrySpan(start, (broken - start) // size))
                result.truncated = self.size - broken
                return result
            keep, resume = self._resolve(run, broken)
            if keep == resume:
                before, after = self._time(broken - size), self._time(broken)
                assert before is not None and after is not None
                result.jumps.append(TimeJump(broken, before, after))
                run = broken
                continue
            result.spans.append(EntrySpan(start, max(0, keep - start) // size))
            result.damages.append(self._damage(max(keep, start), resume))
            if resume >= self.size:
                return result
            start = run = resume

    def _damage(self, start: int, end: int) -> Damage:
        """Return a damaged range with its approximate number of entries."""
        return Damage(start, end, max(1, round((end - start) / self.entry_bytes)))

    def _read(self, at: int, size: int) -> bytes:
        self.file.seek(at)
        return self.file.read(size)

    def _time(self, at: int, needed: int | None = None) -> int | None:
        """Return the time of an entry at byte ``at`` in milliseconds since 1970, or
        None if invalid.
        """
        if at < 0 or at + (self.entry_bytes if needed is None else needed) > self.size:
            return None
        time = self._times(self._read(at, self.time_end), 1, 1)
        return int(time[0]) if len(time) and time[0] >= 0 else None

    def _times(self, data: bytes, stride: int, count: int) -> Sequence[int]:
        """Return the times of ``count`` possible entries every ``stride`` bytes.

        A time is -1 if milliseconds or seconds are out of range.
        """
        seconds_at, seconds_size = self.plan.seconds
        milliseconds_at, milliseconds_size = self.plan.milliseconds
        little = self.plan.order == "little"
        # The last entry need not be complete: only its time must be within the data.
        count = min(count, (len(data) - self.time_end) // stride + 1)
        if count < FIRST_CHUNK or not _has_numpy():
            times = []
            for at in range(0, count * stride, stride):
                first = at + milliseconds_at
                octets = data[first : first + milliseconds_size]
                milliseconds = int.from_bytes(octets, self.plan.order)
                first = at + seconds_at
                octets = data[first : first + seconds_size]
                seconds = int.from_bytes(octets, self.plan.order)
                is_valid = milliseconds < 1000 and seconds <= LATEST_SECOND
                times.append(seconds * 1000 + milliseconds if is_valid else -1)
            return times
        import numpy as np

        seconds_array = numbers_at(
            data, stride, seconds_at, seconds_size, little, count=count
        )
        milliseconds_array = numbers_at(
            data, stride, milliseconds_at, milliseconds_size, little, count=count
        )
        times_array = seconds_array.astype(np.int64) * 1000
        times_array += milliseconds_array.astype(np.int64)
        is_valid_array = (milliseconds_array < 1000) & (seconds_array <= LATEST_SECOND)
        result: Sequence[int] = np.where(is_valid_array, times_array, -1)  # type: ignore[assignment]
        return result

    def _anchor(self) -> int | None:
        """Return the first byte at which entries begin, normally the first one behind
        the header.
        """
        begin, size = self.begin, self.entry_bytes
        # Not even one entry is complete, so that nothing contradicts the header.
        if begin + size > self.size:
            return begin
        first = self._time(begin)
        is_clock = first is not None and self._is_clock(begin)
        second = self._time(begin + size)
        # The header gives the first entry, so two times of these years are believed
        # even if the clock was set between them.
        is_trusted = (
            first is not None
            and first >= YEAR_1990
            and second is not None
            and abs(second - first) <= DAY
        )
        # `_rises` compares three entries.
        for low in range(begin + 1, self.size - 3 * size + 1, WINDOW):
            fresh = [
                at for at in self._candidates(low, WINDOW) if self._rises(at, MONTH)
            ]
            # Data may contain counters and times, too. Prefer a start with which the
            # file ends with a complete entry, or one that continues the first entry.
            recent = [at for at in fresh if (self._time(at) or 0) >= YEAR_1990]
            following = [
                at
                for at in recent
                if first is not None and 0 <= (self._time(at) or 0) - first <= MONTH
            ]
            pool = recent or fresh
            # The first start at each place within an entry; others are later entries of
            # these. Two entries are looked at, since damage can hide the first start.
            near: list[int] = []
            for at in pool:
                if at >= pool[0] + 2 * size:
                    break
                if all((at - other) % size for other in near):
                    near.append(at)
            ending = [at for at in near if (self.size - at) % size == 0]
            steadier = [
                at
                for at in ending
                if self._unsteadiness(at) < self._unsteadiness(begin)
            ]
            if is_trusted and not steadier:
                return begin
            if is_clock and not any(
                (self._time(at) or 0) >= YEAR_1990 for at in ending
            ):
                return begin
            if near:
                start = (ending or following or near)[0]
                self._learn(start)
                # A clock that is set within the first entries leaves them in place.
                if (start - begin) % size == 0 and first is not None:
                    return begin
                return self._regular(start)
        if is_clock or is_trusted:
            return begin
        # Too few entries to compare: believe the positions that the header gives, if
        # most of them are times.
        aligned = range(
            begin, min(self.size - size, begin + LEARNED_ENTRIES * size) + 1, size
        )
        timed = [at for at in aligned if self._time(at) is not None]
        return timed[0] if len(timed) * 2 >= len(aligned) else None

    def _learn(self, at: int) -> None:
        """Take the usual step, and the places of other times, from the entries that
        begin at ``at``.
        """
        size = self.entry_bytes
        data = self._read(at, LEARNED_ENTRIES * size)
        count = len(data) // size
        times = [int(time) for time in self._times(data, size, count)]
        # After a break, there is another time base or damage.
        chain = takewhile(
            lambda pair: pair[0] >= 0 and 0 <= pair[1] - pair[0] <= MONTH,
            pairwise(times),
        )
        steps = [after - before for before, after in chain if after > before]
        if steps:
            self.step = float(median(steps))
            self.limit = max(float(MINUTE), STEPS_IN_LIMIT * self.step)
        regular = takewhile(
            lambda pair: pair[0] >= 0 and abs(pair[1] - pair[0]) <= self.limit,
            pairwise(times),
        )
        count = 1 + sum(1 for _ in regular)
        if count > 1:
            # Place 0 is the time of the entry itself.
            places = set(range(1, size))
            # Not the last entry: `here` has a time at each byte of an entry, and those
            # at its last bytes reach into the next entry.
            for number in range(min(count - 1, COMPARED_ENTRIES)):
                here = self._times(data[number * size :], 1, size)
                places = {
                    at
                    for at in places
                    if here[at] >= 0 and abs(here[at] - times[number]) <= self.limit
                }
            self.other_times = sorted(places)

    def _first_break(self, at: int) -> int:
        """Return the first entry behind ``at`` whose time does not follow that of its
        predecessor, or the end of whole entries.
        """
        size = self.entry_bytes
        position, previous = at + size, self._time(at)
        # Reads grow, because the first rows of a log need few entries, and a long log
        # without damage needs few calls.
        amount = FIRST_CHUNK * size
        if previous is None:
            return at
        while position + size <= self.size:
            data = self._read(position, max(size, amount // size * size))
            count = len(data) // size
            if not count:
                break  # the file was truncated meanwhile
            times = self._times(data, size, count)
            index = _first_irregular(previous, times, self.limit)
            if index is not None:
                return position + index * size
            previous = int(times[-1])
            position += count * size
            amount = min(2 * amount, LAST_CHUNK)
        return position

    def _ends_well(self, end: int) -> bool:
        """Whether the bytes behind the last whole entry are the beginning of the next
        one.
        """
        remaining, last = self.size - end, end - self.entry_bytes
        if not remaining or last < self.begin:
            return True
        # An incomplete entry that has its time must have a valid one.
        if remaining >= self.time_end and self._time(end, self.time_end) is None:
            return False
        # Bytes were lost in the last entry if a whole one ends at the end of the file.
        return self._search(last + 1, end, self._time(last)) is None

    def _resolve(self, run: int, broken: int) -> tuple[int, int]:
        """Return where to stop before the entry at ``broken``, and where to resume.

        Both are equal if the clock jumped. The entry before damage is left out, as its
        data may be damaged already.
        """
        size = self.entry_bytes
        previous = self._time(broken - size)
        before = None
        if broken - 2 * size >= run:
            before = self._time(broken - 2 * size)
        here, next_, second = (
            self._time(broken + number * size) for number in range(3)
        )
        lead = self._deviation(before, previous) if before is not None else 0.0
        # Infinite behind an earlier fault, which must not exclude two of the
        # explanations below.
        lead = min(lead, self.limit)
        follow = 0.0
        if broken + 3 * size <= self.size:
            follow = self._deviation(next_, second)
        # Three explanations: the clock was set at `broken`, only the time there is
        # damaged, or only the time before it is. The one with the steps that are
        # closest to the usual step applies.
        jump = lead + self._deviation(here, next_) + follow
        only_here = lead + self._deviation(previous, next_, 2) + follow
        only_previous = (
            self._deviation(before, here, 2) + self._deviation(here, next_) + follow
        )
        # Without a battery, a clock starts again at 1970, and its first steps are no
        # evidence of damage.
        is_restart = here is not None and 0 < here < DAY
        if min(only_here, only_previous) < NEVER and not is_restart:
            if jump <= min(only_here, only_previous):
                return broken, broken
            if only_here < only_previous:
                return broken - size, broken + size
            return broken - 2 * size, broken
        # Look first near the break, and only where bytes are missing or were added.
        resume = self._search(
            broken - size + 1, broken + 3 * size, previous, is_aligned=False
        )
        if resume is not None:
            return broken - size, resume
        # Zeros are erased or lost memory.
        is_clock = bool(here or next_) and self._is_clock(broken)
        # A clock that stands still is memory with one content.
        if is_clock and (here != next_ or next_ != second):
            return broken, broken
        low = broken - size + 1
        while low + size <= self.size:
            resume = self._search(low, low + WINDOW, previous, broken - size)
            if resume is None and not is_clock:
                fresh = (
                    at
                    for at in self._candidates(low, WINDOW)
                    if self._rises(at, self.limit)
                )
                resume = next((at for at in fresh if self._has_other_times(at)), None)
            if resume is not None:
                return broken - size, resume
            low += WINDOW
        return (broken, broken) if is_clock else (broken - size, self.size)

    def _deviation(
        self, before: int | None, after: int | None, entries: int = 1
    ) -> float:
        """Return the difference between the step over ``entries`` and the usual one, in
        ms.
        """
        if before is None or after is None:
            return NEVER
        if abs(after - before) > entries * self.limit:
            return NEVER
        return abs(after - before - entries * self.step)

    def _is_clock(self, at: int) -> bool:
        """Return whether up to two entries continue the entry at ``at``, also after a
        pause.
        """
        times = [self._time(at + number * self.entry_bytes) for number in range(3)]
        available = [
            time
            for number, time in enumerate(times)
            if at + (number + 1) * self.entry_bytes <= self.size
        ]
        if len(available) == 1:
            # A single entry is believed only if the file ends with it.
            return available[0] is not None and (self.size - at) % self.entry_bytes == 0
        for before, after in pairwise(available):
            if before is None or after is None:
                return False
            step = after - before
            if not 0 <= step <= YEAR and abs(step) > self.limit:
                return False
            if after == 0 < before:
                return False  # erased memory
        return True

    def _rises(self, at: int, limit: float) -> bool:
        """Return whether two more entries follow the one at ``at``, each slightly
        later.
        """
        times = [self._time(at + number * self.entry_bytes) for number in range(3)]
        pairs = pairwise(times)
        return all(
            a is not None and b is not None and 0 < b - a <= limit for a, b in pairs
        )

    def _unsteadiness(self, at: int) -> float:
        """Return the difference of the first two steps from ``at``, from 0 to 1.

        Return infinity without two steps.
        """
        first, second, third = (
            self._time(at + number * self.entry_bytes) for number in range(3)
        )
        if first is None or second is None or third is None:
            return NEVER
        if not first <= second <= third:
            return NEVER
        return abs((third - second) - (second - first)) / max(third - first, 1)

    def _candidates(self, low: int, length: int) -> list[int]:
        """Return the bytes at which an entry could begin, judged by its time only."""
        count = min(length, self.size - self.entry_bytes - low + 1)
        if count <= 0:
            return []
        times = self._times(self._read(low, count + self.time_end - 1), 1, count)
        return [low + index for index, time in enumerate(times) if time >= 0]

    def _search(
        self,
        low: int,
        high: int,
        previous: int | None,
        origin: int | None = None,
        is_aligned: bool = True,
    ) -> int | None:
        """Return the first byte from ``low`` to before ``high`` at which entries
        continue.

        ``previous`` is the time before. ``origin`` is the start of the last entry, by
        default ``low``. ``is_aligned`` includes positions that are correct if no byte
        is missing.
        """
        if previous is None:
            return None
        size, origin = self.entry_bytes, low if origin is None else origin
        count = min(high, self.size - size + 1) - low
        if count <= 0:
            return None
        times = self._times(self._read(low, count + self.time_end - 1), 1, count)
        for index, time in enumerate(times):
            at = low + index
            # `low` is one byte behind the start of an entry.
            if not is_aligned and (at - low + 1) % size == 0:
                continue
            # The entries that are skipped took time, too.
            if not 0 <= time - previous <= self.limit * (2 + (at - origin) / size):
                continue
            following = [
                self._time(at + number * size)
                for number in (1, 2)
                if at + (number + 1) * size <= self.size
            ]
            chain = [int(time), *following]
            steps = pairwise(chain)
            if all(
                self._deviation(a, b) < NEVER for a, b in steps
            ) and self._has_other_times(at):
                return self._regular(at)
        return None

    def _regular(self, at: int) -> int:
        """Return ``at``, or the next entry if the lowest byte of the time at ``at`` is
        damaged.

        A damaged time has an unusual step to the next entry.
        """
        first, second, third = (
            self._time(at + number * self.entry_bytes) for number in range(3)
        )
        is_odd = (
            self._deviation(first, second)
            > self.step / 2
            >= self._deviation(second, third)
        )
        return at + self.entry_bytes if is_odd else at

    def _has_other_times(self, at: int) -> bool:
        """Return whether entries from ``at`` contain further times at the usual
        positions.

        Otherwise ``at`` may be one of these positions.
        """
        size = self.entry_bytes
        for place in self.other_times:
            matches: list[bool] = []
            for start in (at, at + size, at + 2 * size):
                if start + place + self.time_end > self.size:
                    break
                own = self._time(start, self.time_end)
                other = self._time(start + place, self.time_end)
                matches.append(self._deviation(own, other) < NEVER)
            if matches and not any(matches):
                return False
        return True


def _has_numpy() -> bool:
    try:
        import numpy  # noqa: F401
    except ImportError:
        return False
    return True


def _first_irregular(previous: int, times: Sequence[int], limit: float) -> int | None:
    """Return the index of the first time that is invalid, too early or too late.

    Too early is before its predecessor, too late is more than ``limit`` after it.
    """
    # Few times are a list, and all are without numpy (`LogSurvey._times`).
    if isinstance(times, list):
        for index, time in enumerate(times):
            if time < 0 or not 0 <= time - previous <= limit:
                return index
            previous = time
        return None
    import numpy as np

    steps = np.diff(times, prepend=previous)
    irregular = (np.asarray(times) < 0) | (steps < 0) | (steps > limit)
    return int(irregular.argmax()) if irregular.any() else None
