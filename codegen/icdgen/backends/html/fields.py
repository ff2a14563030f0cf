"""Rows of the field table of a message.

`rows` returns fields and reserved bits in the order of the frame, and `split`
distributes them to the sections of the page.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

from icdgen.backends.html import texts
from icdgen.backends.html.links import Links
from icdgen.backends.html.repeats import ShownField
from icdgen.backends.html.sections import MessageSection
from icdgen.icd.model import Message
from icdgen.icd.places import NodePlace
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


def rows(message: Message, links: Links) -> list[FieldRow]:
    """Return fields and reserved bits in the order of the frame.

    Arrays represented by one element have the rows of that element.
    """
    repeats = links.repeats(message)
    field_rows = [
        _row(field, message, links)
        for field in repeats.fields
        if not field.place.is_count
    ]
    # `key` 0 marks reserved bits; keys of fields begin with 1.
    field_rows += [FieldRow(0, gap.at, gap.bits) for gap in repeats.gaps]
    return sorted(field_rows, key=lambda row: row.at)


def split(
    field_rows: list[FieldRow], sections: list[MessageSection]
) -> list[list[FieldRow | FlagRow]]:
    """Return the rows of each section, with consecutive flags as grids."""
    index_of_key = {row.key: index for index, row in enumerate(field_rows)}
    reserved = [(row.at, index) for index, row in enumerate(field_rows) if not row.key]
    indices_by_section = []
    for section in sections:
        # Reserved bits have no key, so sections list fields only: find the bits by
        # position.
        begin = bisect_left(reserved, (8 * section.first, 0))
        end = bisect_left(reserved, (8 * section.end, 0))
        indices = [index for _, index in reserved[begin:end]]
        indices += (index_of_key[key] for key in section.keys if key in index_of_key)
        indices_by_section.append(indices)
    # Reserved bits between the fields of two sections are shown at the end of the first
    # of them, and those in front of all fields in the first section.
    shown = {index for indices in indices_by_section for index in indices}
    for at, index in reserved:
        if index not in shown:
            begun = [n for n, section in enumerate(sections) if 8 * section.first <= at]
            indices_by_section[begun[-1] if begun else 0].append(index)
    return [
        _with_grids([field_rows[index] for index in sorted(indices)])
        for indices in indices_by_section
    ]


def _with_grids(field_rows: list[FieldRow]) -> list[FieldRow | FlagRow]:
    """Return rows with consecutive flags as grids."""
    rows_and_grids: list[FieldRow | FlagRow] = []
    for is_flag, group in groupby(field_rows, key=lambda row: row.is_flag):
        run = list(group)
        is_grid = is_flag and len(run) >= _MANY_FLAGS
        rows_and_grids += [FlagRow(run)] if is_grid else run
    return rows_and_grids


def _row(shown: ShownField, message: Message, links: Links) -> FieldRow:
    field = shown.place
    # the formula describes a derived value completely
    field_remarks = (
        ()
        if field.derived
        else remarks(field, texts.number, message if message.has_conditions else None)
    )
    return FieldRow(
        key=shown.key,
        at=field.at,
        bits=field.bits,
        field=field,
        name=shown.short,
        anchor=links.anchor(message, field.name),
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
