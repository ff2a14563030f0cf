"""Rows of the field table of a message."""

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
    """Field, or a run of reserved bits with ``key`` 0."""

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
    """Consecutive flags, shown as a grid."""

    flags: list[FieldRow]
    key: int = -1


_MANY_FLAGS = 6  # minimum number of consecutive flags of a grid

# Omitted if all their cells are empty
_COLUMNS = ("raw", "physical", "resolution", "unit", "formula")


def columns_of(rows: list[FieldRow]) -> list[str]:
    """Return the columns with content in at least one row."""
    return [name for name in _COLUMNS if any(getattr(row, name) for row in rows)]


def rows(message: Message, node: Node, links: Links) -> list[FieldRow]:
    """Return fields and reserved bits in the order of the frame.

    Arrays represented by one element have the rows of that element.
    """
    repeats, anchors = links.repeats(message), links.anchors(message)
    field_rows = [
        _row(key, field, message, links, anchors[key - 1])
        for key, field in enumerate(scalars_in(message.layout), 1)
        if not field.is_count and repeats.is_shown(key)
    ]
    # Reserved bits of omitted elements are omitted too.
    for gap in layout.gaps(message, node):
        field_rows += [
            FieldRow(0, at, bits) for at, bits in repeats.shown_parts(gap.at, gap.bits)
        ]
    return sorted(field_rows, key=lambda row: row.at)


def between(field_rows: list[FieldRow], section: Section) -> list[FieldRow | FlagRow]:
    """Return the rows of a section, with consecutive flags as grids."""
    inside = [
        row
        for row in field_rows
        if row.key in section.keys
        or (not row.key and section.first * 8 <= row.at < section.end * 8)
    ]
    section_rows: list[FieldRow | FlagRow] = []
    for is_flag, group in groupby(inside, key=lambda row: row.is_flag):
        run = list(group)
        section_rows += [FlagRow(run)] if is_flag and len(run) >= _MANY_FLAGS else run
    return section_rows


def _row(
    key: int, field: NodePlace, message: Message, links: Links, anchor: str
) -> FieldRow:
    # the formula describes a derived value completely
    field_remarks = (
        ()
        if field.derived
        else remarks(field, texts.number, message if message.has_conditions else None)
    )
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
        # a lookup table is part of the notes
        formula=field.formula if field.has_formula or field.derived else "",
        notes=[texts.capitalized(note) for note in field_remarks],
    )
