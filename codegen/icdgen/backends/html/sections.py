"""Sections of a message: contained messages and arrays, or parts of a long message that
fit on a screen.

`part_sections` follows the structure of the message, `field_sections` only the number
of fields. Each section has the numbers of its fields.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from icdgen.backends.html.relations import Relations
from icdgen.backends.html.repeats import Repeat, Repeats
from icdgen.describe.numbers import byte_range
from icdgen.icd.model import Message
from icdgen.icd.places import NodePlace
from icdgen.wording import count

_LONG = 16  # messages with more fields have sections
_FLAG_WEIGHT = 0.25  # four flags count as one field
_SHARE = 10  # fields of a section


@dataclass(frozen=True, slots=True)
class MessageSection:
    """Section of the bytes from ``first`` to before ``end``.

    ``keys``: numbers of the fields, from 1. ``url``: page of the contained message.
    ``is_element``: whether the bytes are the first element of an array.
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
        """Position and number of fields: ``bytes 0 to 5, 3 fields``; of an element ``12
        bytes each, from byte 8, 3 fields``.
        """
        size = self.end - self.first
        place = (
            f"{count(size, 'byte')} each, from byte {self.first}"
            if self.is_element
            else byte_range(self.first, size)
        )
        is_in_title = not size or place == self.title.lower()
        return (
            count(len(self.keys), "field")
            if is_in_title
            else f"{place}, {count(len(self.keys), 'field')}"
        )


def part_sections(relations: Relations, message: Message) -> list[MessageSection]:
    """Return a section for each contained message, or else for each array, and sections
    for the bytes between them.

    The list is empty if the message contains no messages and no arrays.
    """
    repeats = relations.links.repeats(message)
    return _message_sections(relations, message, repeats) or _array_sections(
        message, repeats
    )


def _message_sections(
    relations: Relations, message: Message, repeats: Repeats
) -> list[MessageSection]:
    """Return the contained messages and the bytes between them; empty if they overlap
    or are not aligned to bytes.
    """
    parts = sorted(
        relations.contains[message.node, message.name], key=lambda part: part.at
    )
    sections: list[MessageSection] = []
    end = 0
    for part in parts:
        first = part.at // 8
        # A drawing has whole bytes, and a byte belongs to one section.
        if part.at % 8 or first < end or first + part.length > message.length:
            return []
        sections += _section_between(message, repeats, end, first)
        end = first + part.length
        sections.append(
            MessageSection(
                part.place.text,
                first,
                end,
                _field_keys(message, repeats, first, end),
                part.place.url,
            )
        )
    return (
        _fold_sections(
            repeats,
            sections + _section_between(message, repeats, end, message.length),
        )
        if parts
        else []
    )


def _array_sections(message: Message, repeats: Repeats) -> list[MessageSection]:
    """Return the first element of each represented array and the bytes between them."""
    if not repeats.arrays:
        return []
    section_list = list(
        _sections_around_arrays(message, repeats, list(repeats.arrays), 0, None)
    )
    shown = {key for section in section_list for key in section.keys}
    # Derived values are placed at the end of the message, which no array includes.
    remaining_keys = [
        field.key
        for field in repeats.fields
        if field.key not in shown and not field.place.is_count
    ]
    if remaining_keys:
        section_list.append(
            MessageSection(
                "Derived values", message.length, message.length, remaining_keys
            )
        )
    return section_list


def _sections_around_arrays(
    message: Message,
    repeats: Repeats,
    arrays: list[Repeat],
    first: int,
    inside: Repeat | None,
) -> Iterator[MessageSection]:
    """Yield the sections of the message or of the first element of ``inside``, which
    begins at byte ``first``.

    Processed arrays are removed from the list.
    """
    end = first + inside.step if inside else message.length
    title, is_element = (
        (f"{inside.name} × {inside.times}", True) if inside else ("", False)
    )

    def between(start: int, stop: int) -> list[MessageSection]:
        return [
            replace(s, title=title or s.title, is_element=is_element)
            for s in _section_between(message, repeats, start, stop)
        ]

    while arrays and arrays[0].first < end:
        array = arrays.pop(0)
        yield from between(first, array.first)
        yield from _sections_around_arrays(message, repeats, arrays, array.first, array)
        first = array.end
    yield from between(first, end)


def field_sections(message: Message, repeats: Repeats) -> list[MessageSection]:
    """Return the fields in order, in several sections if there are many."""
    fields = repeats.fields
    keys = [field.key for field in fields]
    if not _is_long(repeats):
        return [MessageSection("Fields", 0, message.length, keys)]
    # Double ceiling division: first the number of sections, then their size.
    size = -(-len(keys) // -(-len(keys) // _SHARE))  # sections of similar size
    with_bits = [field.place for field in fields if _has_bits(field.place)]
    section_list = []
    for start in range(0, len(keys), size):
        section_keys = keys[start : start + size]
        places = [field.place for field in fields[start : start + size]]
        # A section of derived values only is placed at the last field that has bits.
        places = [place for place in places if _has_bits(place)] or with_bits[-1:]
        first = min(place.at for place in places) // 8
        end = -(-max(place.at + place.bits for place in places) // 8)
        section_list.append(
            MessageSection(
                f"Fields {section_keys[0]} to {section_keys[-1]}",
                first,
                end,
                section_keys,
            )
        )
    return _fold_sections(repeats, section_list)


def _has_bits(place: NodePlace) -> bool:
    return not place.is_count and place.derived is None


def _fold_sections(
    repeats: Repeats, section_list: list[MessageSection]
) -> list[MessageSection]:
    """Return the sections. In a long message, fold all sections but the first."""
    if not _is_long(repeats):
        return section_list
    return [
        replace(section, open=section is section_list[0]) for section in section_list
    ]


def _is_long(repeats: Repeats) -> bool:
    weights = (
        1 if field.place.type != "bool" else _FLAG_WEIGHT for field in repeats.fields
    )
    return sum(weights) > _LONG


def _section_between(
    message: Message, repeats: Repeats, first: int, end: int
) -> list[MessageSection]:
    title = byte_range(first, end - first).capitalize()
    return (
        [MessageSection(title, first, end, _field_keys(message, repeats, first, end))]
        if end > first
        else []
    )


def _field_keys(message: Message, repeats: Repeats, first: int, end: int) -> list[int]:
    """Return the numbers of the shown fields in a range of bytes; the last range
    includes derived values.
    """
    # The position of a derived value is the end of the message.
    return repeats.keys_between(8 * first, 8 * end + (end == message.length))
