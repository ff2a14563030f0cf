"""Damage of the file that a profile names: mended before the tables are understood, and reported each time."""

from __future__ import annotations

import re
from typing import Any

from icdgen.importer.document import Cell, Document, Row, SourceRow, Spot, Table, Trouble
from icdgen.importer.profile import Profile
from icdgen.importer.source_tables import SourceTable
from icdgen.importer.words import number


def mend_tables(tables: list[SourceTable], profile: Profile) -> list[Trouble]:
    """Repair the tables that rules read in the same ways; return a note for each repair."""
    notes = []
    for table in tables:
        for entry in profile.data["damage"]:
            count = 0
            if "printed" in entry:
                pattern = re.compile(rf"(?<!\w){re.escape(entry['printed'])}(?!\w)")
                for cell in (cell for row in table.rows for cell in row.cells):
                    cell.text, times = pattern.subn(entry["meant"].replace("\\", r"\\"), cell.text)
                    count += times
                if count:
                    what = f"`{entry['printed']}` is taken for `{entry['meant']}` {count} times"
                    notes.append(_mended(f"{table.title}: {what}", table.spot))
            elif entry.get("table") == table.label and "group" in entry:
                for index, row in enumerate(table.rows):
                    if row.cells and number(row.cells[0].text) == entry["before"]:
                        table.rows.insert(index, SourceRow([Cell(entry["group"])], row.page, row.line))
                        what = f"the group heading `{entry['group']}` is put back before {entry['before']}"
                        notes.append(_mended(f"{table.title}: {what}", table.spot_of(row)))
                        break
    return notes


def _mended(message: str, spot: Spot) -> Trouble:
    return Trouble("IMP028", f"{message}, as the profile says", spot, "compare with the page", "note")


def mend(document: Document, profile: Profile) -> None:
    """Replaces damaged words and puts lost group headings back."""
    entries = profile.data["damage"]
    for table in document.tables:
        for entry in entries:
            if "printed" in entry:
                _words(table, entry["printed"], entry["meant"], document)
        for entry in entries:
            if entry.get("table") == table.number and "group" in entry:
                _group(table, entry, document)


def _words(table: Table, printed: str, meant: str, document: Document) -> None:
    pattern = re.compile(rf"(?<!\w){re.escape(printed)}(?!\w)")
    count = 0
    for row in table.all_rows:
        for index, cell in enumerate(row.cells):
            row.cells[index], times = pattern.subn(lambda _: meant, cell)
            count += times
    if count:
        how_often = f" {count} times" if count > 1 else ""
        document.troubles.append(
            Trouble("IMP028", f"{table.title}: `{printed}` is taken for `{meant}`{how_often}, as the profile says", table.spot,
                    "compare with the page", "note")
        )  # fmt: skip


def _group(table: Table, entry: dict[str, Any], document: Document) -> None:
    for index, row in enumerate(table.rows):
        if row.cells and number(row.cells[0]) == entry["before"]:
            heading = Row.of(entry["group"], len(row.cells), row.page, row.line)
            table.rows.insert(index, heading)
            document.troubles.append(
                Trouble("IMP028", f"{table.title}: the group heading `{entry['group']}` is put back before "
                        f"{entry['before']}, as the profile says", table.spot_of(row),
                        "compare with the page", "note")
            )  # fmt: skip
            return
