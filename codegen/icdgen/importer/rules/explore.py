"""Kinds of tables in a document, with the skeleton of a rule: `icdgen import FILE
--explore`.

A kind is a set of tables with equal headings. The skeleton contains every column
without a role: the user states the meaning of the columns.
"""

from __future__ import annotations

import json
import re
from typing import Any

from icdgen.icd.fmt.scalars import quoted_if_needed
from icdgen.importer.document import SourceTable
from icdgen.importer.rules.language import normalised
from icdgen.importer.rules.rows import numbered
from icdgen.importer.source_tables import group_by_headings, name_of
from icdgen.importer.words import plain
from icdgen.wording import count

SAMPLES = 3  # cells shown of a column
MOST_NUMBERS = 12


def report(tables: list[SourceTable], document: str) -> str:
    """Return a profile to be completed: a block for each kind with its tables, sample
    cells, and a rule.
    """
    groups = group_by_headings(tables)
    counted = f"{count(len(tables), 'table')} of {count(len(groups), 'kind')}"
    lines = [
        f"# {document}: {counted}, a rule for each. A table without a rule is not imported.",
        "# Give each column a role or a pattern (docs/reference/import-rules.md),",
        "# or put its heading under `ignore`.",
        "profile: 1",
        "node: {}  # state the orders of the document, such as {byte_order: big, bit_order: lsb0}",
        "rules:",
    ]
    for group in groups:
        lines += ["", *_block(group)]
    return "\n".join(line.rstrip() for line in lines) + "\n"


def _block(group: list[SourceTable]) -> list[str]:
    first = group[0]
    numbers = ", ".join(str(table.number) for table in group[:MOST_NUMBERS]) + (
        " ..." if len(group) > MOST_NUMBERS else ""
    )
    pages = sorted({table.page for table in group if table.page is not None})
    where = f", page {pages[0]}" if pages else ""
    if len(pages) > 1:
        where = f", pages {pages[0]} to {pages[-1]}"
    lines = [f"  # {count(len(group), 'table')}: {numbers}{where}"]
    for key, texts in (
        ("caption", [first.caption]),
        ("heading", first.headings[-1:]),
        ("before", first.before[-1:]),
    ):
        lines += [f"  #   {key}: {plain(text)[:100]}" for text in texts if text]
    titles = first.titles
    head = next(
        (
            index
            for index, row in enumerate(first.rows)
            if [plain(c.text) for c in row.cells] == titles
        ),
        0,
    )
    lines.append(
        f"  - tables: {{head: {quoted_if_needed(' | '.join(map(_title, titles)), in_flow=True)}}}"
    )
    lines += [
        "    what: message",
        "    message: {heading: '^{message} {id}$', kind: telemetry}",
        "    columns:",
    ]
    grid = first.grid()
    rows = grid[head + 1 :]
    columns = [normalised(slot.cell.text) for slot in grid[head]] if grid else []
    for column, title in enumerate(columns):
        cells = (plain(row[column].text) for row in rows if column < len(row))
        samples = " | ".join(list(dict.fromkeys(filter(None, cells)))[:SAMPLES])
        key = _column_key(numbered(title, columns[:column])) or str(column + 1)
        key = quoted_if_needed(key, in_flow=False) if title else key
        lines.append(f"      {key}:   # {samples[:90]}")
    return lines


def _column_key(title: str) -> str:
    """Return the key of a heading within `columns`; one that would have another meaning
    there is a pattern.
    """
    if title.startswith("~") or title.endswith("?") or " + " in title or title == "*":
        return f"~^{re.escape(title)}$"
    return title


def _title(title: str) -> str:
    """A heading within `head`: an empty cell is any cell, and one that begins like a
    pattern is quoted.
    """
    if not title:
        return "*"
    if title.startswith("~") or " | " in title:
        return f"~^{re.escape(title)}$"
    return title


def as_json(tables: list[SourceTable], document: str) -> str:
    """Return the kinds of tables for programs."""
    entries = [_kind_as_json(group) for group in group_by_headings(tables)]
    return json.dumps(
        {"document": document, "kinds": entries}, indent=2, ensure_ascii=False
    )


def _kind_as_json(group: list[SourceTable]) -> dict[str, Any]:
    return {
        "headings": group[0].titles,
        "count": len(group),
        "tables": [table.number for table in group],
        "pages": sorted({table.page for table in group if table.page is not None}),
        "names": [name_of(table) for table in group],
    }
