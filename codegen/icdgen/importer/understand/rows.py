"""Rows as the page has them -> rows as they are meant: torn ones joined, group headings told from them."""

from __future__ import annotations

from dataclasses import dataclass, field

from icdgen.importer.document import Header, Row, Spot, Table, Trouble
from icdgen.importer.pages.bands import KEYS, is_key
from icdgen.importer.words import join, squeezed

_WORDS = ("name", "description", "values", "unit", "formula", "range", "default")


@dataclass(slots=True)
class Entry:
    """One row of a table by role; ``group`` is the group heading above it."""

    cells: dict[str, str]
    spot: Spot
    group: str = ""
    joined: bool = False
    notes: list[str] = field(default_factory=list)

    def get(self, role: str) -> str:
        return self.cells.get(role, "")


def entries(table: Table, troubles: list[Trouble]) -> list[Entry]:
    """The rows of a table with headings."""
    header = table.header
    assert header is not None
    made: list[Entry] = []
    group = ""
    last_page: int | None = None
    for row in table.rows:
        cells = _by_role(row, header)
        spot = Spot(row.page or table.page, row.line, table.number)
        if _has_key(cells, header):
            made.append(Entry(cells, spot, group, notes=[row.mended] if row.mended else []))
            if row.mended:
                troubles.append(Trouble("IMP021", f"a row of {table.title}: {row.mended}", spot, _LOOK, "note"))
        elif not any(row.cells):
            continue
        elif header.kind == "list" and (title := _group(row, header, made, last_page)):
            group = title
        elif made:
            _tear(made[-1], row, header, spot, table, troubles)
        else:
            table.doubts.append("a row before the first one has no key")
            text = " | ".join(c for c in row.cells if c)
            troubles.append(Trouble("IMP022", f"{table.title}: the row `{text[:80]}` belongs to no row", spot, _LOOK))
        last_page = row.page
    return made


_LOOK = "compare with the page"


def _by_role(row: Row, header: Header) -> dict[str, str]:
    return {role: cell for role, cell in zip(header.roles, row.cells, strict=False) if role}


def _has_key(cells: dict[str, str], header: Header) -> bool:
    if any(is_key(cells[role]) for role in KEYS[header.kind] if cells.get(role)):
        return True
    # Whole but for its key: a misprinted one must not let the row pass for the rest of the row above.
    other = [role for role in _FIGURES[header.kind] if cells.get(role)]
    if any(is_key(cells[role]) for role in other):
        return bool(cells.get("name"))
    spoilt = next((cells[role] for role in KEYS[header.kind] if cells.get(role)), "")
    return len(spoilt) <= 5 and any(c.isdigit() for c in spoilt) and bool(cells.get("name"))


_FIGURES = {"fields": ("bits", "bits_bytes"), "enumeration": (), "list": ("length",), "loggable": ("mask",)}


def _group(row: Row, header: Header, made: list[Entry], last_page: int | None) -> str:
    """The group heading that the row is, in a list: words in the first cell, or alone in a row of their own."""
    filled = [index for index, cell in enumerate(row.cells) if cell]
    text = " ".join(row.cells[i] for i in filled)
    if len(text) > 60 or any(c.isdigit() and len(c) > 3 for c in text.split()):
        return ""
    if filled[0] == 0 and (len(filled) == 1 or (len(filled) == 2 and filled[1] == 1)):
        return text
    new_page = row.page != last_page if row.page is not None else True
    if len(filled) == 1 and not new_page and header.roles[filled[0]] in ("name", "description"):
        return text
    return ""


def _tear(entry: Entry, row: Row, header: Header, spot: Spot, table: Table, troubles: list[Trouble]) -> None:
    """Joins the rest of a row to it."""
    for role, cell in zip(header.roles, row.cells, strict=False):
        if not cell:
            continue
        target = role
        if role not in _WORDS:  # words in a column of figures, or of labels: the tear put them there
            target = "description" if "description" in header.roles else "name"
        before = entry.cells.get(target, "")
        if squeezed(cell) and squeezed(before).endswith(squeezed(cell)) and len(squeezed(cell)) > 12:
            entry.notes.append("a repeated rest of a torn row was dropped")
            continue
        entry.cells[target] = join([before, cell])
        entry.joined = True
    text = " | ".join(c for c in row.cells if c)
    about = entry.get("name") or entry.get("id")
    troubles.append(
        Trouble(
            "IMP020", f"{table.title}: the row `{about}` was torn; joined to it: `{text[:100]}`", spot, _LOOK, "note"
        )
    )
