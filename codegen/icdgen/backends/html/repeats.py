"""Arrays of which a page shows one element: structs that repeat, arrays of variable length and long arrays."""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from dataclasses import dataclass, replace
from itertools import pairwise

from icdgen.icd.model import Field, Message
from icdgen.icd.paths import Step, name_of

_LONG = 16  # elements of an array of numbers that is shown by one element


@dataclass(frozen=True, slots=True)
class Repeat:
    """An array from byte ``first``, of which every element has ``step`` bytes; ``times`` is ``0 to 64``."""

    name: str  # ``satellites[].signals``
    first: int
    step: int
    count: int
    times: str

    @property
    def end(self) -> int:
        """The byte after the last element."""
        return self.first + self.step * self.count


class Repeats:
    """Those of a message, and the fields that its page shows."""

    def __init__(self, message: Message) -> None:
        is_nested = any(field.path for field in message.fields)
        found = _arrays(message) if is_nested and not message.contains else {}  # a composite has the bands of its parts
        self.arrays = sorted(found.values(), key=lambda one: (one.first, -one.end))
        keys = {field.name: key for key, field in enumerate(message.fields, 1)}
        # Key of the field of the first element that stands for each field, in the order of the fields.
        self.leaders = [keys[_leader(field, found)] for field in message.fields]
        self.names = [_name(field, found) for field in message.fields]
        # Name of the struct of the outermost array that each field is in, or of an array without structs; else empty.
        self.elements = [_element(field, found) for field in message.fields]

    def is_shown(self, key: int) -> bool:
        """Whether the page shows the field itself, and no other stands for it."""
        return self.leaders[key - 1] == key

    def shown_parts(self, at: int, bits: int) -> list[tuple[int, int]]:
        """Of a run of bits, first bit and length of each part that is in no element which the page leaves out."""
        ends = [8 * end for one in self.arrays for end in (one.first + one.step, one.end)]
        cuts = [at, *sorted(end for end in set(ends) if at < end < at + bits), at + bits]
        return [(start, end - start) for start, end in pairwise(cuts) if not self._is_skipped(start)]

    def _is_skipped(self, bit: int) -> bool:
        return any(8 * (one.first + one.step) <= bit < 8 * one.end for one in self.arrays)

    def short(self, key: int) -> str:
        """The name of a field within its array: ``elev`` of ``satellites[].elev``."""
        name = self.names[key - 1]
        return name.rpartition("[].")[2] if self.elements[key - 1] else name


def _arrays(message: Message) -> dict[str, Repeat]:
    """The arrays that are shown by one element, by the name of their first element."""
    times = {one.name: f"{one.fewest} to {one.most}" for one in message.open_parts}
    starts = sorted(field.at for field in message.fields)
    sizes = Counter(_array(field.path, depth) for field in message.fields for depth in range(len(field.path)))
    found: dict[str, Repeat] = {}
    for field in message.fields:
        for depth, step in enumerate(field.path):
            if step.index:  # only first elements lead to further arrays
                break
            name = _array(field.path, depth)
            is_open = depth == 0 and step.name in times
            if step.index is None or name in found or not (is_open or step.struct or step.count > _LONG):
                continue
            begin = sum(one.member.at for one in field.path[: depth + 1] if one.member) if step.struct else field.at
            end = begin + step.stride * step.count
            inside = bisect_left(starts, end) - bisect_left(starts, begin)
            # Other fields at the same place (alternatives, overlays) are to be seen: then every element is shown.
            if step.count > 1 and begin % 8 == step.stride % 8 == 0 and inside == sizes[name]:
                label = ".".join(filter(None, (_label(field.path[:depth], found), step.name)))
                found[name] = Repeat(label, begin // 8, step.stride // 8, step.count, times.get(name, str(step.count)))
    return found


def _array(path: tuple[Step, ...], depth: int) -> str:
    """The name of the array that a step of a path leads into."""
    return name_of((*path[:depth], replace(path[depth], index=None)))


def _first(path: tuple[Step, ...], found: dict[str, Repeat]) -> tuple[Step, ...]:
    """The same place in the first element of every array that is shown by one."""
    for depth, step in enumerate(path):
        if step.index and _array(path, depth) in found:
            path = (*path[:depth], replace(step, index=0), *path[depth + 1 :])
    return path


def _leader(field: Field, found: dict[str, Repeat]) -> str:
    return name_of(_first(field.path, found)) if found and field.path else field.name


def _name(field: Field, found: dict[str, Repeat]) -> str:
    """``satellites[].elev``"""
    if not found or not field.path:
        return field.name
    return _label(_first(field.path, found), found).removesuffix("[]")


def _label(path: tuple[Step, ...], found: dict[str, Repeat]) -> str:
    return ".".join(f"{step.name}[]" if _array(path, depth) in found else step.text for depth, step in enumerate(path))


def _element(field: Field, found: dict[str, Repeat]) -> str:
    for depth, step in enumerate(field.path):
        array = _array(field.path, depth)
        if array in found:
            return name_of(field.path[: depth + 1]) if step.struct else array
    return ""
