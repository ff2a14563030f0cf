"""Repair of damage in a document that its profile lists under `damage`.

The cells of tables are corrected before rules read them. Each repair is a note
(IMP028).
"""

from __future__ import annotations

import re

from icdgen.import_results.findings import ImportFinding, SourcePlace
from icdgen.importer.document import SourceCell, SourceRow, SourceTable
from icdgen.importer.profile import Profile
from icdgen.importer.words import printed_integer
from icdgen.wording import count


def mend_tables(tables: list[SourceTable], profile: Profile) -> list[ImportFinding]:
    """Replace damaged words and put lost group headings back; return a note for each
    repair.
    """
    notes = []
    for table in tables:
        for entry in profile.data["damage"]:
            repairs = 0
            if "printed" in entry:
                pattern = re.compile(rf"(?<!\w){re.escape(entry['printed'])}(?!\w)")
                for cell in (cell for row in table.rows for cell in row.cells):
                    cell.text, times = pattern.subn(
                        entry["meant"].replace("\\", r"\\"), cell.text
                    )
                    repairs += times
                if repairs:
                    what = f"`{entry['printed']}` is taken for `{entry['meant']}` {count(repairs, 'time')}"
                    notes.append(_mended(f"{table.title}: {what}", table.spot))
            elif entry.get("table") == table.label and "group" in entry:
                for index, row in enumerate(table.rows):
                    if (
                        row.cells
                        and printed_integer(row.cells[0].text) == entry["before"]
                    ):
                        table.rows.insert(
                            index,
                            SourceRow([SourceCell(entry["group"])], row.page, row.line),
                        )
                        what = f"the group heading `{entry['group']}` is put back before {entry['before']}"
                        notes.append(
                            _mended(f"{table.title}: {what}", table.spot_of(row))
                        )
                        break
    return notes


def _mended(message: str, spot: SourcePlace) -> ImportFinding:
    return ImportFinding(
        "IMP028",
        f"{message}, as the profile says",
        spot,
        "compare with the page",
        "note",
    )
