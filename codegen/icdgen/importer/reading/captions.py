"""Captions of sources that are a sequence of blocks: each goes to the table next to it,
above or below as the document does.
"""

from __future__ import annotations

from collections.abc import Sequence

from icdgen.frozen import NamedTuple
from icdgen.importer.document import Block, SourceTable, TextBlock


class Caption(NamedTuple):
    """A line that reads like a caption: number, title, and the line as a whole."""

    number: int
    title: str
    text: str
    page: int | None = None
    line: int | None = None


def attach_captions(blocks: Sequence[Block | Caption]) -> list[Block]:
    """Return the blocks, each caption with its table; a caption without a table is a
    text.

    Captions stand above their tables if as many find a table there as below. A table
    with the number of the table before it continues that one.
    """
    captions = [
        index for index, block in enumerate(blocks) if isinstance(block, Caption)
    ]
    after = {index: _table_beside(blocks, index, 1) for index in captions}
    before = {index: _table_beside(blocks, index, -1) for index in captions}
    above = sum(t is not None for t in after.values()) >= sum(
        t is not None for t in before.values()
    )
    owner: dict[int, int] = {}
    for index in captions if above else reversed(captions):
        if (target := (after if above else before)[index]) is not None:
            owner[target] = index
    used = set(owner.values())
    result: list[Block] = []
    for index, block in enumerate(blocks):
        if isinstance(block, Caption):
            if index not in used:
                result.append(TextBlock(block.text, block.page, block.line))
            continue
        if isinstance(block, SourceTable) and index in owner:
            caption = blocks[owner[index]]
            assert isinstance(caption, Caption)
            if (
                result
                and isinstance(result[-1], SourceTable)
                and result[-1].label == caption.number
            ):
                result[-1].rows += block.rows
                continue
            block.label, block.caption = caption.number, caption.title
        result.append(block)
    return result


def _table_beside(
    blocks: Sequence[Block | Caption], index: int, step: int
) -> int | None:
    near = index + step
    return (
        near
        if 0 <= near < len(blocks) and isinstance(blocks[near], SourceTable)
        else None
    )
