"""The rows of a message's field table."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby

from icdgen import layout
from icdgen.backends.html import texts
from icdgen.backends.html.links import Links
from icdgen.backends.html.sections import Section
from icdgen.icd.erratum import Erratum
from icdgen.icd.model import Enum, Field, Member, Message, Node
from icdgen.show.fields import remarks


@dataclass
class FieldRow:
    """A field, or (``key`` 0) a run of reserved bits."""

    key: int
    at: int
    bits: int
    name: str = "reserved"
    anchor: str = ""
    kind: str = "reserved"
    type: str = ""
    enum: Enum | None = None
    enum_url: str = ""
    members: tuple[Member, ...] = ()
    raw: str = ""
    physical: str = ""
    resolution: str = ""
    unit: str = ""
    unit_url: str = ""
    unit_title: str = ""
    formula: str = ""
    summary: str = ""
    notes: tuple[str, ...] = ()
    errata: tuple[Erratum, ...] = ()


@dataclass
class FlagRow:
    """Flags one after the other, which stand in a grid."""

    flags: list[FieldRow]
    key: int = -1


_MANY_FLAGS = 6  # of so many flags on end a grid is made

# Columns of the table that are left out where no field has anything in them.
_COLUMNS = (
    ("raw", "Raw"),
    ("physical", "Physical"),
    ("resolution", "Resolution"),
    ("unit", "Unit"),
    ("formula", "Formula"),
)


def columns_of(rows: list[FieldRow]) -> list[tuple[str, str]]:
    """Attribute and title of each further column that says something about at least one field."""
    return [(name, title) for name, title in _COLUMNS if any(getattr(row, name) for row in rows)]


def rows(message: Message, node: Node, links: Links, anchors: list[str]) -> list[FieldRow]:
    """Fields and reserved bits in the order of the frame."""
    found = [
        _row(key, field, message, links, anchors[key - 1])
        for key, field in enumerate(message.fields, 1)
        if not field.implied
    ]
    found += [FieldRow(0, gap.at, gap.bits) for gap in layout.gaps(message, node)]
    return sorted(found, key=lambda row: row.at)


def between(found: list[FieldRow], section: Section) -> list[FieldRow | FlagRow]:
    """Of these rows those of a section, flags in grids."""
    inside = [
        row
        for row in found
        if row.key in section.keys or (not row.key and section.first * 8 <= row.at < section.end * 8)
    ]
    made: list[FieldRow | FlagRow] = []
    for is_flag, group in groupby(inside, key=lambda row: row.kind == "bool"):
        run = list(group)
        made += [FlagRow(run)] if is_flag and len(run) >= _MANY_FLAGS else run
    return made


def _row(key: int, field: Field, message: Message, links: Links, anchor: str) -> FieldRow:
    return FieldRow(
        key=key,
        at=field.at,
        bits=field.bits,
        name=field.name,
        anchor=anchor,
        kind=field.type,
        type=texts.type_name(field),
        enum=field.enum,
        enum_url=links.enum(field.enum) if field.enum else "",
        members=field.enum.members if field.enum else (),
        raw=texts.raw_range(field),
        physical=texts.physical_range(field),
        resolution=texts.factor(abs(field.scale.factor)) if field.scale else "",
        unit=field.unit.symbol if field.unit else "",
        unit_url=links.unit(field.unit) if field.unit else "",
        unit_title=field.unit.quantity if field.unit else "",
        formula=field.formula if field.has_formula or field.derived else "",  # points are among the notes
        summary=field.summary,
        notes=tuple(_notes(field, message)),
        errata=field.errata,
    )


def _notes(field: Field, message: Message) -> list[str]:
    if field.derived is not None:
        return []  # the formula says it
    told = remarks(field, texts.number, message if message.has_conditions else None)
    return [note[:1].upper() + note[1:] for note in told]
