"""Tables of a document: their numbers and the text around them, their groups of equal
headings, and their names in reports.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.importer.document import Document, Heading, PageBox, SourceTable, TextBlock
from icdgen.importer.words import table_name


def from_document(document: Document) -> list[SourceTable]:
    """Return the tables of a document, each with its number and the texts above it.

    Tables without any text are left out.
    """
    tables: list[SourceTable] = []
    chain: list[Heading] = []
    before: list[str] = []
    for block in document.blocks:
        if isinstance(block, Heading):
            chain = [heading for heading in chain if heading.contains(block)] + [block]
            before.append(block.title)
        elif isinstance(block, TextBlock):
            before.append(block.text)
        elif any(cell.text for row in block.rows for cell in row.cells):
            block.boxes = [
                PageBox(box.page, *(round(value, 1) for value in box[1:]))
                for box in block.boxes
            ]
            block.headings, block.before = [heading.title for heading in chain], before
            tables.append(block)
            block.number, before = len(tables), []
    if tables:
        tables[-1].after = before
    return tables


def count_runs(tables: list[SourceTable]) -> None:
    """Set `run` of each table: the run of ascending labels that it belongs to."""
    run, last = 1, -1
    for table in tables:
        if table.label is not None:
            run += table.label <= last
            last = table.label
        table.run = run


def group_by_headings(tables: list[SourceTable]) -> list[list[SourceTable]]:
    """Return the tables grouped by headings, the largest group first."""
    groups: dict[tuple[str, ...], list[SourceTable]] = {}
    for table in tables:
        groups.setdefault(table.kind, []).append(table)
    return sorted(groups.values(), key=lambda group: (-len(group), group[0].number))


def name_of(table: SourceTable) -> str:
    """Return the name of a table: ``Table 4-12: Motor State``, its caption, or the
    heading above it.
    """
    if table.label is not None:
        return f"Table {table_name(table.label)}" + (
            f": {table.caption}" if table.caption else ""
        )
    return table.caption or (table.headings[-1] if table.headings else table.sheet)


def texts_in_and_around(table: SourceTable) -> Iterator[str]:
    """Return every text of the table and around it."""
    yield from (table.caption, *table.headings, *table.before, *table.after)
    for row in table.rows:
        yield from (cell.text for cell in row.cells)
