"""Rows as the page has them -> rows as they are meant: torn ones joined, group headings told from them."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from icdgen.importer.document import Header, Row, Spot, Table, Trouble
from icdgen.importer.pages.bands import KEYS, is_key
from icdgen.importer.words import BY_HAND, join, squeezed

_WORDS = ("name", "description", "values", "unit", "formula", "range", "default")


@dataclass(slots=True)
class Entry:
    """One row of a table by role; ``group`` is the group heading above it."""

    cells: dict[str, str]
    spot: Spot
    group: str = ""

    def get(self, role: str) -> str:
        return self.cells.get(role, "")


def entries(table: Table, troubles: list[Trouble], stands_alone: StandsAlone | None = None) -> list[Entry]:
    """The rows of a table with headings. ``stands_alone`` tells of a row without a key whether it is one all the same."""
    header = table.header
    assert header is not None
    made: list[Entry] = []
    _unread_columns(table, header, troubles)
    group = ""
    last_page: int | None = None
    for row in table.rows:
        cells = _by_role(row, header)
        spot = table.spot_of(row)
        if _has_key(cells, header) or (stands_alone is not None and stands_alone(cells)):
            made.append(Entry(cells, spot, group))
            if row.mended:
                troubles.append(Trouble("IMP021", f"a row of {table.title}: {row.mended}", spot, _LOOK, "note"))
        elif not any(row.cells):
            continue
        elif header.kind == "fields" and _REPEATS.search(text := row.text):
            table.doubts.append("it has a repeated block")
            troubles.append(Trouble("IMP037", f"{table.title}: `{text[:80]}`: a repeated block, which import does not read",
                                    spot, BY_HAND, "error"))  # fmt: skip
        elif header.kind == "list" and (title := _group(row, header, made, last_page)):
            group = title
        elif made:
            on_one_page = row.page is not None and row.page == last_page
            _tear(made[-1], row, header, spot, table, troubles, on_one_page)
        else:
            table.doubts.append("a row before the first one has no key")
            troubles.append(
                Trouble("IMP022", f"{table.title}: the row `{row.shown[:80]}` belongs to no row", spot, _LOOK)
            )
        if any(surplus := row.cells[len(header.roles) :]):
            shown = " | ".join(cell for cell in surplus if cell)
            troubles.append(Trouble("IMP027", f"{table.title}: cells right of the last heading were left out: "
                                    f"`{shown[:80]}`", spot, _LOOK))  # fmt: skip
        last_page = row.page
    return made


def _unread_columns(table: Table, header: Header, troubles: list[Trouble]) -> None:
    """Says which columns have headings without a role, so that their cells are not held."""
    for index, (role, title) in enumerate(zip(header.roles, header.titles, strict=True)):
        cells = [row.cells[index] for row in table.rows if index < len(row.cells) and row.cells[index]]
        if not role and title and cells:
            troubles.append(
                Trouble("IMP027", f"{table.title}: the column `{title}` has no role, its cells were left out: "
                        f"`{cells[0][:40]}`" + (f" and {len(cells) - 1} more" if cells[1:] else ""), table.spot,
                        f"`headings: {{{header.kind}: {{ignored: [{title}]}}}}` passes it over, or give it a role")
            )  # fmt: skip


_REPEATS = re.compile(
    r"\b(?:start|begin|beginning) of (?:the )?repeat|\brepeated (?:block|group|for)\b|\brepeats? \w+ times\b", re.I
)
_LOOK = "compare with the page"
StandsAlone = Callable[[dict[str, str]], bool]


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


def _tear(
    entry: Entry, row: Row, header: Header, spot: Spot, table: Table, troubles: list[Trouble], same_page: bool
) -> None:
    """Joins the rest of a row to it. On one page nothing tears a row: there it may have been a row of its own."""
    for role, cell in zip(header.roles, row.cells, strict=False):
        if not cell:
            continue
        target = role
        if role not in _WORDS:  # words in a column of figures, or of labels: the tear put them there
            target = "description" if "description" in header.roles else "name"
        before = entry.cells.get(target, "")
        if squeezed(cell) and squeezed(before).endswith(squeezed(cell)) and len(squeezed(cell)) > 12:
            continue  # the rest of a torn row, repeated
        entry.cells[target] = join([before, cell])
    about = entry.get("name") or entry.get("id")
    cells = _by_role(row, header)
    doubtful = same_page and bool(cells.get("name")) and len([c for c in cells.values() if c]) > 1
    troubles.append(
        Trouble("IMP020", f"{table.title}: the row `{about}` was torn; joined to it: `{row.shown[:100]}`", spot, _LOOK,
                "warning" if doubtful else "note")
    )  # fmt: skip
