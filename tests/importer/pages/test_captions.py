"""Captions belong to the tables below or above them, decided once for a document."""

from __future__ import annotations

import pytest

from icdgen.importer import profile
from icdgen.importer.document import Heading, PageBox, SourceTable, TextBlock
from icdgen.importer.pages.captions import blocks_with_captions
from icdgen.importer.pages.draft import PrintedRow, TableDraft
from icdgen.importer.pages.flow import TextItem
from tests.limits import assert_limits

WORDS = profile.load(None)


def document(*texts, is_part=False, page_of=None):
    """Return the blocks of items from top to bottom of a page, 20 points each.

    An item is a caption if it begins with `Table`, a table if it begins with `|`, a
    heading if it begins with `#`, and a gap of so many points if it is a number.
    """
    items, top = [], 0.0
    for text in texts:
        if isinstance(text, int):
            top += text
            continue
        page = (page_of or {}).get(text, 1)
        box = PageBox(page, 0.0, top, 100.0, top + 10)
        if text.startswith("|"):
            items.append(TableDraft([box], rows=[PrintedRow([text])]))
        else:
            kind = "caption" if text.startswith("Table") else "text"
            kind = "heading" if text.startswith("#") else kind
            items.append(TextItem(kind, text, box, 10.0, cells=[(0.0, text)]))
        top += 20
    return blocks_with_captions(items, WORDS, is_part)


def shown(*texts, **more):
    """Return label, caption and rows of each table, and the texts of other blocks."""
    return [
        (block.label, block.caption, block.rows[0].shown)
        if isinstance(block, SourceTable)
        else block.text
        for block in document(*texts, **more)
    ]


def test_captions_above_or_below_all_tables():
    assert shown("Table 1: A", "|a", "Table 2: B", "|b") == [
        (1, "A", "|a"),
        (2, "B", "|b"),
    ]
    assert shown("|a", "Table 1: A", "|b", "Table 2: B") == [
        (1, "A", "|a"),
        (2, "B", "|b"),
    ]


def test_a_continued_caption_has_no_mark_and_a_chapter_counts():
    assert shown("Table 4-12: A (continued)", "|a") == [(4_000_012, "A", "|a")]


def test_text_between_stays_and_a_table_without_a_caption_has_none():
    assert shown("Table 1: A", "words", "|a", "|b", "more") == [
        "words",
        (1, "A", "|a"),
        (None, "", "|b"),
        "more",
    ]


def test_a_caption_reaches_over_four_lines_of_text():
    def reaches(count):
        lines = [f"line {number}" for number in range(count)]
        return shown("Table 1: A", *lines, "|a")[-1] == (1, "A", "|a")

    assert_limits(reaches, most=4)
    assert shown("Table 1: A", "#Next", "|a")[-1] == (None, "", "|a")
    # A caption without a table stays text.
    assert shown("Table 1: A", "#Next", "|a")[0] == "Table 1: A"


def test_the_nearest_caption_names_a_table():
    assert shown("Table 1: A", "Table 2: B", "|a") == ["Table 1: A", (2, "B", "|a")]
    assert shown("|a", "Table 1: A", "Table 2: B") == [(1, "A", "|a"), "Table 2: B"]


def test_distances_decide_where_the_order_does_not():
    # A table in front of the first caption, and one behind the last.
    above = ["|a", 30, "Table 1: A", "|b", 30, "Table 2: B", "|c"]
    below = ["|a", "Table 1: A", 30, "|b", "Table 2: B", 30, "|c"]
    assert shown(*above) == [(None, "", "|a"), (1, "A", "|b"), (2, "B", "|c")]
    assert shown(*below) == [(1, "A", "|a"), (2, "B", "|b"), (None, "", "|c")]


def test_in_a_part_of_a_document_only_distances_decide():
    cut = ["|a", "Table 1: A", 30, "|b", "Table 2: B"]
    assert shown(*cut, is_part=True)[:2] == [(1, "A", "|a"), (2, "B", "|b")]
    other = ["Table 1: A", 30, "|a", "Table 2: B", 30, "|b", "Table 3: C", 30, "|c"]
    assert shown(*other)[0] == (1, "A", "|a")
    # The table of the first caption may be on the part before.
    assert shown(*other, is_part=True) == [
        "Table 1: A",
        (2, "B", "|a"),
        (3, "C", "|b"),
        (None, "", "|c"),
    ]


def test_equal_distances_mean_above_if_as_many_captions_have_a_table():
    assert shown("|a", "Table 1: A", "|b") == [(None, "", "|a"), (1, "A", "|b")]


def test_a_table_on_the_same_page_is_nearer():
    other = {"|b": 2}
    assert shown("|a", 300, "Table 1: A", "|b", page_of=other)[0] == (1, "A", "|a")


@pytest.mark.parametrize(("kind", "strong"), [("heading", False), ("text", True)])
def test_headings_keep_number_size_and_page(kind, strong):
    box = PageBox(3, 0.0, 0.0, 100.0, 10.0)
    item = TextItem(kind, "Motor", box, 14.0, "4.2", strong)
    assert blocks_with_captions([item], WORDS) == [
        Heading("4.2", "Motor", 3, size=14.0)
    ]
    plain = TextItem("text", "Motor", box, 14.0)
    assert blocks_with_captions([plain], WORDS) == [TextBlock("Motor", 3)]
