"""Separation of tables that are side by side and were read as one table.

Their headings are repeated from left to right.
"""

from __future__ import annotations

from dataclasses import replace

from icdgen.importer.pages import headings
from icdgen.importer.pages.draft import TableDraft
from icdgen.importer.pages.flow import TextItem
from icdgen.importer.profile import Profile
from icdgen.importer.words import squeezed

Items = list[TableDraft | TextItem]


def with_tables_separated(items: Items, profile: Profile) -> Items:
    """Return the items, with such tables separated.

    Each table follows its part of the lines above the tables.
    """
    in_order: Items = []
    index = 0
    while index < len(items):
        item = items[index]
        index += 1
        if isinstance(item, TextItem):
            in_order.append(item)
            continue
        tables = _parts(item, profile)
        if not tables:
            tables = [item]
            while (
                index < len(items)
                and isinstance(following := items[index], TableDraft)
                and _beside(tables[-1], following)
            ):
                tables.append(following)
                index += 1
            tables.sort(key=lambda table: table.boxes[0].x0)
        above: list[list[TextItem]] = []
        while (
            len(tables) > 1
            and in_order
            and isinstance(in_order[-1], TextItem)
            and (lines := _lines(in_order[-1], len(tables), profile))
        ):
            above.insert(0, lines)
            in_order.pop()
        for place, table in enumerate(tables):
            in_order += [*(lines[place] for lines in above), table]
    return in_order


def _beside(draft: TableDraft, other: TableDraft) -> bool:
    """Return whether two tables are side by side on one page, and on no other page."""
    if len(draft.boxes) != 1 or len(other.boxes) != 1:
        return False
    a, b = draft.boxes[0], other.boxes[0]
    is_beside = a.x1 <= b.x0 or b.x1 <= a.x0
    return (
        a.page == b.page and is_beside and min(a.bottom, b.bottom) > max(a.top, b.top)
    )


def _parts(table: TableDraft, profile: Profile) -> list[TableDraft]:
    """Return the tables of a table with repeated headings, or an empty list."""
    if table.header is not None or len(table.head) < 2:
        return []
    titles = [squeezed(text) for text in table.head[0].lines]
    starts = [
        index for index, title in enumerate(titles) if title and title == titles[0]
    ]
    if len(starts) < 2:
        return []
    parts = [
        titles[a:b] for a, b in zip(starts, [*starts[1:], len(titles)], strict=True)
    ]
    width = len(parts[-1])
    # Columns without a title may be between the tables, and not within them.
    if any(part[:width] != parts[-1] or any(part[width:]) for part in parts):
        return []
    result = []
    for start in starts:
        header = headings.match_headings(
            table.head[0].lines[start : start + width], profile, loose=True
        )
        if header is None:
            return []
        header.printed = [table.head[0].slice(start, width)]
        rows = [row.slice(start, width) for row in table.head[1:]]
        result.append(
            TableDraft(
                list(table.boxes), header, rows=[row for row in rows if any(row.texts)]
            )
        )
    return result


def _lines(mark: TextItem, count: int, profile: Profile) -> list[TextItem]:
    """Return the parts of a line above tables, one for each table, or an empty list."""
    if len(mark.cells) != count or mark.kind == "heading":
        return []
    if mark.kind == "caption" and not all(
        profile.caption.match(text) for _, text in mark.cells
    ):
        return []
    return [replace(mark, text=text, cells=[(x, text)]) for x, text in mark.cells]
