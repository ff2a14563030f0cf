"""Assignment of captions to tables, and conversion to the blocks of a document.

Drafts and text in reading order go in. Whether captions are above or below their tables
is decided once for the document, from the distances.
"""

from __future__ import annotations

from icdgen.importer.document import Block, Heading, SourceTable, TextBlock
from icdgen.importer.pages import beside, guessed
from icdgen.importer.pages.draft import TableDraft
from icdgen.importer.pages.flow import TextItem
from icdgen.importer.profile import Profile
from icdgen.importer.words import CONTINUED, table_number

FAR = 4  # a caption with this many lines of text before the table does not belong to it
Items = list[TableDraft | TextItem]


def blocks_with_captions(
    items: Items, profile: Profile, is_part: bool = False
) -> list[Block]:
    """Return headings, text and tables, the tables with number and caption.

    ``is_part``: the document is cut off at both ends.
    """
    items = beside.with_tables_separated(guessed.with_guessed_tables(items), profile)
    captions = [
        i
        for i, item in enumerate(items)
        if isinstance(item, TextItem) and item.kind == "caption"
    ]
    after = {i: _table_from(items, i, 1) for i in captions}
    before = {i: _table_from(items, i, -1) for i in captions}
    above = _stand_above(items, after, before, is_part)
    owner: dict[int, int] = {}
    for i in captions if above else reversed(captions):
        target = (after if above else before)[i]
        if target is not None:
            owner[target] = i  # the nearest caption is last and replaces others
    used = set(owner.values())
    blocks: list[Block] = []
    for index, item in enumerate(items):
        if isinstance(item, TableDraft):
            caption = items[owner[index]] if index in owner else None
            table = item.table()
            if isinstance(caption, TextItem):
                _name(table, caption, profile)
            blocks.append(table)
        elif index not in used:
            page, is_heading = item.box.page, item.kind == "heading" or item.strong
            blocks.append(
                Heading(item.number, item.text, page, size=item.size)
                if is_heading
                else TextBlock(item.text, page)
            )
    return blocks


def _table_from(items: Items, index: int, step: int) -> int | None:
    """Return the nearest table in a direction, unless a caption or more than a few
    lines are between.
    """
    between = 0
    position = index + step
    while 0 <= position < len(items):
        item = items[position]
        if isinstance(item, TableDraft):
            return position
        if item.kind != "text" or between >= FAR:
            return None
        between += 1
        position += step
    return None


def _stand_above(
    items: Items,
    after: dict[int, int | None],
    before: dict[int, int | None],
    is_part: bool,
) -> bool:
    """Return whether captions are above their tables in this document.

    First criterion: only one direction gives each caption a table of its own. Second:
    the distances on the page, which prose between caption and table can falsify. Third:
    the number of captions with a table.
    """
    down_all, up_all = (
        None not in captions.values() and len(set(captions.values())) == len(captions)
        for captions in (after, before)
    )
    # In a part of a document, the table of the first or last caption can be missing.
    if down_all != up_all and not is_part:
        return down_all
    nearer = 0
    for i in after:
        down, up = _distance(items, i, after[i], 1), _distance(items, i, before[i], -1)
        nearer += (down < up) - (up < down)
    if nearer == 0:
        return sum(table is not None for table in after.values()) >= sum(
            table is not None for table in before.values()
        )
    return nearer > 0


def _distance(items: Items, caption: int, index: int | None, step: int) -> float:
    """Return the distance of a caption from a table, in points."""
    if index is None:
        return 1000.0
    mark, table = items[caption], items[index]
    assert isinstance(mark, TextItem) and isinstance(table, TableDraft)
    box = table.boxes[0 if step > 0 else -1]
    if box.page != mark.box.page:
        return 500.0
    return max(
        0.0, box.top - mark.box.bottom if step > 0 else mark.box.top - box.bottom
    )


def _name(table: SourceTable, mark: TextItem, profile: Profile) -> None:
    match = profile.caption.match(mark.text)
    assert match is not None
    table.label = table_number(match["number"])
    table.caption = CONTINUED.sub("", match["title"]).strip()
