"""The rows of a message's field table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

from icdgen import layout
from icdgen.backends.html import texts
from icdgen.backends.html.links import Links
from icdgen.backends.html.sections import Section
from icdgen.icd.model import Message, Node
from icdgen.icd.places import NodePlace, scalars_in
from icdgen.show.fields import remarks


@dataclass
class FieldRow:
    """A field, or (``key`` 0) a run of reserved bits."""

    key: int
    at: int
    bits: int
    field: NodePlace | None = None
    name: str = ""
    anchor: str = ""
    type: str = ""
    enum_url: str = ""
    raw: str = ""
    physical: str = ""
    resolution: str = ""
    unit: str = ""
    unit_url: str = ""
    formula: str = ""
    notes: Sequence[str] = ()

    @property
    def is_flag(self) -> bool:
        return self.field is not None and self.field.type == "bool"


@dataclass
class FlagRow:
    """Flags one after the other, which stand in a grid."""

    flags: list[FieldRow]
    key: int = -1


_MANY_FLAGS = 6  # of so many flags on end a grid is made

_COLUMNS = ("raw", "physical", "resolution", "unit", "formula")  # left out where no field has anything in them


def columns_of(rows: list[FieldRow]) -> list[str]:
    """Each further column that says something about at least one field."""
    return [name for name in _COLUMNS if any(getattr(row, name) for row in rows)]


def rows(message: Message, node: Node, links: Links) -> list[FieldRow]:
    """Fields and reserved bits in the order of the frame; of arrays that are shown by one element, that one."""
    repeats, anchors = links.repeats(message), links.anchors(message)
    found = [
        _row(key, field, message, links, anchors[key - 1])
        for key, field in enumerate(scalars_in(message.layout), 1)
        if not field.is_count and repeats.is_shown(key)
    ]
    for gap in layout.gaps(message, node):
        found += [FieldRow(0, at, bits) for at, bits in repeats.shown_parts(gap.at, gap.bits)]
    return sorted(found, key=lambda row: row.at)


def between(found: list[FieldRow], section: Section) -> list[FieldRow | FlagRow]:
    """Of these rows those of a section, flags in grids."""
    inside = [
        row
        for row in found
        if row.key in section.keys or (not row.key and section.first * 8 <= row.at < section.end * 8)
    ]
    made: list[FieldRow | FlagRow] = []
    for is_flag, group in groupby(inside, key=lambda row: row.is_flag):
        run = list(group)
        made += [FlagRow(run)] if is_flag and len(run) >= _MANY_FLAGS else run
    return made


def _row(key: int, field: NodePlace, message: Message, links: Links, anchor: str) -> FieldRow:
    # of what is derived the formula says all
    told = () if field.derived else remarks(field, texts.number, message if message.has_conditions else None)
    return FieldRow(
        key=key,
        at=field.at,
        bits=field.bits,
        field=field,
        name=links.repeats(message).short(key),
        anchor=anchor,
        type=texts.type_name(field),
        enum_url=links.enum(field.enum) if field.enum else "",
        raw=texts.raw_range(field),
        physical=texts.physical_range(field),
        resolution=texts.factor(abs(field.scale.factor)) if field.scale else "",
        unit=field.unit_symbol,
        unit_url=links.unit(field.unit) if field.unit else "",
        formula=field.formula if field.has_formula or field.derived else "",  # points are among the notes
        notes=[texts.capitalized(note) for note in told],
    )
