"""The sections of a message: the messages and arrays that it repeats, or of a long one shares that fit on a screen."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import groupby

from icdgen.backends.html.relations import Relations
from icdgen.backends.html.repeats import Repeat, Repeats
from icdgen.describe.numbers import byte_range
from icdgen.icd.model import Message
from icdgen.icd.places import NodePlace, scalars_in
from icdgen.icd.rules.wording import count

_LONG = 16  # fields of a message that is shown in sections; four flags count as one field
_SHARE = 10  # fields of a section that is no message of its own


@dataclass(frozen=True, slots=True)
class Section:
    """Bytes ``first`` to before ``end``; ``keys``: numbers of the fields, from 1; ``url``: the message that it repeats.

    ``is_element``: the bytes are those of the first element of an array.
    """

    title: str
    first: int
    end: int
    keys: list[int] = field(default_factory=list)
    url: str = ""
    open: bool = True
    is_element: bool = False

    @property
    def about(self) -> str:
        """``bytes 0 to 5, 3 fields``; of an element ``12 bytes each, from byte 8, 3 fields``."""
        size = self.end - self.first
        place = (
            f"{count(size, 'byte')} each, from byte {self.first}" if self.is_element else byte_range(self.first, size)
        )
        is_said = not size or place == self.title.lower()
        return count(len(self.keys), "field") if is_said else f"{place}, {count(len(self.keys), 'field')}"


def bands(relations: Relations, message: Message) -> list[Section]:
    """The messages and arrays that it repeats, and what is between them; none if it repeats none."""
    return _messages(relations, message) or _arrays(message, relations.links.repeats(message))


def _messages(relations: Relations, message: Message) -> list[Section]:
    """The messages that it repeats, and what is between them; none if they are not in whole bytes one after another."""
    parts = sorted(relations.contains[message.node, message.name], key=lambda part: part.at)
    found: list[Section] = []
    end = 0
    for part in parts:
        first = part.at // 8
        if part.at % 8 or first < end or first + part.length > message.length:
            return []
        found += _between(message, end, first)
        end = first + part.length
        found.append(Section(part.place.text, first, end, _keys(message, first, end), part.place.url))
    return _folded(message, found + _between(message, end, message.length)) if parts else []


def _arrays(message: Message, repeats: Repeats) -> list[Section]:
    """The first element of each array that is shown by one, and what is between them."""
    if not repeats.arrays:
        return []
    found = list(_around(message, list(repeats.arrays), 0, message.length, None))
    shown = {key for section in found for key in section.keys}
    others = [
        key for key in range(1, len(scalars_in(message.layout)) + 1) if repeats.is_shown(key) and key not in shown
    ]
    others = [key for key in others if not scalars_in(message.layout)[key - 1].is_count]
    if others:
        found.append(Section("Derived values", message.length, message.length, others))
    return [replace(one, keys=[key for key in one.keys if repeats.is_shown(key)]) for one in found]


def _around(message: Message, arrays: list[Repeat], first: int, end: int, inside: Repeat | None) -> Iterator[Section]:
    """Bytes ``first`` to before ``end``, in and between the arrays there, which are taken off the list."""
    title, is_element = (f"{inside.name} × {inside.times}", True) if inside else ("", False)

    def between(start: int, stop: int) -> list[Section]:
        return [replace(s, title=title or s.title, is_element=is_element) for s in _between(message, start, stop)]

    while arrays and arrays[0].first < end:
        array = arrays.pop(0)
        yield from between(first, array.first)
        yield from _around(message, arrays, array.first, array.first + array.step, array)
        first = array.end
    yield from between(first, end)


def shares(message: Message) -> list[Section]:
    """The fields in their order, in sections where there are many."""
    keys = list(range(1, len(scalars_in(message.layout)) + 1))
    if not _is_long(message):
        return [Section("Fields", 0, message.length, keys)]
    size = -(-len(keys) // -(-len(keys) // _SHARE))  # all about as long
    found = []
    for start in range(0, len(keys), size):
        some = keys[start : start + size]
        fields = [one for key in some if _has_bits(one := scalars_in(message.layout)[key - 1])]
        fields = fields or [one for one in scalars_in(message.layout) if _has_bits(one)][-1:]
        first, end = min(one.at for one in fields) // 8, -(-max(one.at + one.bits for one in fields) // 8)
        found.append(Section(f"Fields {some[0]} to {some[-1]}", first, end, some))
    return _folded(message, found)


def panels(message: Message, repeats: Repeats) -> list[Section]:
    """The sections of the decoder where arrays are shown by one element: it has all elements, each struct by itself."""
    found: list[Section] = []
    for element, group in groupby(
        range(1, len(scalars_in(message.layout)) + 1), key=lambda key: repeats.elements[key - 1]
    ):
        keys = list(group)
        fields = [one for key in keys if _has_bits(one := scalars_in(message.layout)[key - 1])]
        first = min((one.at for one in fields), default=0) // 8
        end = -(-max((one.at + one.bits for one in fields), default=0) // 8)
        title = element or (
            "Fields" if fields else "Count" if scalars_in(message.layout)[keys[0] - 1].is_count else "Derived values"
        )
        found.append(Section(title, first, end, keys, open=not element))
    return found


def _has_bits(one: NodePlace) -> bool:
    return not one.is_count and one.derived is None


def _folded(message: Message, found: list[Section]) -> list[Section]:
    """Of a long message only the first section is open."""
    if not _is_long(message):
        return found
    return [replace(one, open=one is found[0]) for one in found]


def _is_long(message: Message) -> bool:
    return sum(1 if one.type != "bool" else 0.25 for one in scalars_in(message.layout)) > _LONG


def _between(message: Message, first: int, end: int) -> list[Section]:
    title = byte_range(first, end - first).capitalize()
    return [Section(title, first, end, _keys(message, first, end))] if end > first else []


def _keys(message: Message, first: int, end: int) -> list[int]:
    """The numbers of the fields from one byte to another; what is derived stands with the last ones."""
    last = 8 * end + (end == message.length)
    return [key for key, one in enumerate(scalars_in(message.layout), 1) if 8 * first <= one.at < last]
