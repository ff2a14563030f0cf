"""Whether a table counts bits or bytes: as its headings or the profile say, else as types, steps and the length tell."""

from __future__ import annotations

from itertools import pairwise, product
from typing import NamedTuple

from icdgen.importer.document import Header
from icdgen.importer.profile import Profile
from icdgen.importer.words import folded

_BITS, _BYTES = {"bit", "bits"}, {"byte", "bytes", "octet", "octets"}
_NUMERIC = ("uint", "int", "enum", "bool", "float")


class Extent(NamedTuple):
    """Offset and width of a row as printed, None where it prints none; ``bits`` that its type tells, 0 for none."""

    at: int | None
    width: int | None
    bits: int
    kind: str
    at_unit: int = 0  # bits, where the cell itself says what it counts
    width_unit: int = 0


class Units(NamedTuple):
    """How many bits one unit of an offset and of a width is."""

    at: int
    width: int


def decide(header: Header, rows: list[Extent], length: int | None, profile: Profile) -> Units | None:
    """The units of the table's offsets and widths; None where nothing tells."""
    at, width = _unit_of_column(header, "at", profile), _unit_of_column(header, "bits", profile)
    has_widths = "bits" in header.roles or "bits_bytes" in header.roles
    if not has_widths:
        width = at  # ranges of positions
    places = [row.at for row in rows if row.at is not None and not row.at_unit]
    widths = [row.width for row in rows if row.width is not None and not row.width_unit]
    at_choices = (1, 8) if places and not at else (at or 1,)
    width_choices = (1, 8) if widths and not width else (width or 1,)
    if len(at_choices) == len(width_choices) == 1:
        return Units(at_choices[0], width_choices[0])
    ranked = []
    for choice in (Units(a, w) for a, w in product(at_choices, width_choices) if has_widths or not widths or a == w):
        support = _support(rows, length, choice)
        if support is not None:
            ranked.append((support, choice))
    ranked.sort(reverse=True)
    if not ranked or ranked[0][0] == 0 or (len(ranked) > 1 and ranked[0][0] == ranked[1][0]):
        return None
    return ranked[0][1]


def _unit_of_column(header: Header, role: str, profile: Profile) -> int:
    """The unit that the column's heading says, or the profile; 0 where neither does."""
    for name, bits in ((f"{role}_bytes", 8), (role, 1)):
        if name in header.roles:
            title = folded(header.titles[header.roles.index(name)])
            words = set(title)
            if words & _BITS and not words & _BYTES:
                return 1
            if (words & _BYTES and not words & _BITS) or bits == 8 or profile.says("fields", name, title):
                return bits
    return 0


def _support(rows: list[Extent], length: int | None, units: Units) -> int | None:
    """How much speaks for the units; None where something speaks against them."""
    found = 0
    ends = []
    spans = []
    for row in rows:
        size = row.width * (row.width_unit or units.width) if row.width is not None else row.bits
        if row.width is not None and row.bits and row.kind in _NUMERIC:
            if size != row.bits:
                return None
            found += 2
        elif (
            row.width is not None
            and row.kind in _NUMERIC
            and (size > 64 or (row.kind == "float" and size not in (32, 64)))
        ):
            return None
        elif row.width is not None and row.kind == "float":
            found += 2
        if row.at is not None and size:
            at = row.at * (row.at_unit or units.at)
            spans.append((at, size))
            ends.append(at + size)
    for (a, size), (b, _) in pairwise(sorted(spans)):
        if b < a + size:
            return None
        found += b == a + size
    if length is not None and ends:
        if max(ends) > 8 * length:
            return None
        found += 3 * (max(ends) == 8 * length)
    return found
