"""Captions of a sequence of blocks go to the tables next to them."""

from __future__ import annotations

import pytest

from icdgen.importer.document import (
    Heading,
    SourceCell,
    SourceRow,
    SourceTable,
    TextBlock,
)
from icdgen.importer.reading.captions import Caption, attach_captions


def shown(*texts: str) -> list:
    """Return label, caption and rows of each table, and the texts of other blocks.

    A text with `|` is a table, `1 A` is a caption.
    """
    blocks: list = []
    for index, text in enumerate(texts):
        number, _, title = text.partition(" ")
        if text.startswith("|"):
            blocks.append(SourceTable(rows=[SourceRow([SourceCell(text)])]))
        elif text.startswith("#"):
            blocks.append(Heading("", text))
        elif number.isdigit():
            blocks.append(Caption(int(number), title, text, 5, index))
        else:
            blocks.append(TextBlock(text))
    result = []
    for block in attach_captions(blocks):
        if isinstance(block, SourceTable):
            rows = " ".join(row.shown for row in block.rows)
            result.append((block.label, block.caption, rows))
        else:
            result.append(block.text)
    return result


@pytest.mark.parametrize(
    ("blocks", "expected"),
    [
        (["1 A", "|a", "2 B", "|b"], [(1, "A", "|a"), (2, "B", "|b")]),
        (["|a", "1 A", "|b", "2 B"], [(1, "A", "|a"), (2, "B", "|b")]),
        # As many tables are above as below: captions are above.
        (["|a", "1 A", "|b"], [(None, "", "|a"), (1, "A", "|b")]),
        (["|a", "1 A", "x", "|b", "2 B"], [(1, "A", "|a"), "x", (2, "B", "|b")]),
        # A text or a heading is between, so that the caption is a text.
        (["1 A", "x", "|a"], ["1 A", "x", (None, "", "|a")]),
        (["1 A", "#", "|a", "2 B", "|b"], ["1 A", "#", (None, "", "|a"), (2, "B", "|b")]),
        # The caption directly above a table, or directly below it.
        (["1 A", "2 B", "|b"], ["1 A", (2, "B", "|b")]),
        (["|a", "1 A", "2 B"], [(1, "A", "|a"), "2 B"]),
        (["1 A"], ["1 A"]),
        (["|a"], [(None, "", "|a")]),
        ([], []),
    ],
)  # fmt: skip
def test_captions_are_above_or_below_all_tables(blocks, expected):
    assert shown(*blocks) == expected


def test_a_table_with_the_number_of_the_table_before_continues_it():
    assert shown("1 A", "|a", "1 A", "|b", "2 B", "|c") == [
        (1, "A", "|a |b"),
        (2, "B", "|c"),
    ]
    # A text is between.
    assert shown("1 A", "|a", "x", "1 A", "|b") == [
        (1, "A", "|a"),
        "x",
        (1, "A", "|b"),
    ]


def test_a_caption_without_a_table_keeps_its_place_in_the_source():
    (block,) = attach_captions([Caption(1, "A", "Table 1: A", 5, 7)])
    assert block == TextBlock("Table 1: A", 5, 7)
