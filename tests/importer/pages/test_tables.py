"""Pieces of tables on several pages are assembled to tables."""

from __future__ import annotations

import pytest

from icdgen.importer import profile
from icdgen.importer.document import PageBox, SourceTable
from icdgen.importer.pages import columns
from icdgen.importer.pages.bands import Band
from icdgen.importer.pages.extract import PageContents
from icdgen.importer.pages.flow import TablePiece, TextItem
from icdgen.importer.pages.tables import TableBuilder
from tests.importer.pages.words import line, word

WORDS = profile.load()
HEAD = "Byte|Name|Type"


def ruled(*rows: str, page=1, top=100.0, left=0.0, width=300.0) -> TablePiece:
    """Return a piece with a band of 20 points for each row, in columns of one width.

    Lines of a band are separated by `/`.
    """
    bands, count = [], max(row.split("/")[0].count("|") + 1 for row in rows)
    edges = [left + index * width / count for index in range(count + 1)]
    for number, row in enumerate(rows):
        words = [
            word(text, edge + 5, edge + 25, top + 20 * number + 5 * index)
            for index, texts in enumerate(row.split("/"))
            for text, edge in zip(texts.split("|"), edges, strict=False)
            if text
        ]
        words = [w._replace(bottom=w.top + 4, size=4.0) for w in words]
        bands.append(Band(page, edges, words))
    box = PageBox(page, left, top, left + width, top + 20 * len(rows))
    return TablePiece(box, bands, ruled=True)


def text(words: str, page=1, top=0.0, kind="text", size=8.6, **keys) -> TextItem:
    box = PageBox(page, 0.0, top, 100.0, top + size)
    return TextItem(kind, words, box, size, cells=[(0.0, words)], **keys)


def built(*items) -> list:
    """Return the texts, and the shown rows of the tables."""
    blocks = TableBuilder(WORDS, frozenset()).build_tables(list(items))
    return [
        [row.shown for row in block.rows]
        if isinstance(block, SourceTable)
        else getattr(block, "title", None) or block.text
        for block in blocks
    ]


NEXT = ["1|Load|u8", "2|Rate|u8"]
JOINED = ["Byte | Name | Type", "0 | Mode | u8", "1 | Load | u8", "2 | Rate | u8"]
UPPER, LOWER = JOINED[:2], JOINED[2:]


def first() -> TablePiece:
    return ruled(HEAD, "0|Mode|u8")


def test_rows_above_the_headings_the_headings_and_rows_are_a_table():
    piece = ruled("Motor||", "State|x|", HEAD, "0|Mode|u8", "||", "1|Load|u8")
    assert built(piece) == [["Motor", "State | x", *JOINED[:3]]]


@pytest.mark.parametrize(
    ("page", "top", "is_joined"),
    [
        (2, 50.0, True),
        (3, 50.0, False),
        (0, 50.0, False),
        (1, 140.0, True),
        (1, 169.9, True),
        (1, 170.0, False),
        (1, 139.9, False),
    ],
)
def test_a_piece_on_the_next_page_or_close_below_continues_a_table(
    page, top, is_joined
):
    result = built(first(), ruled(*NEXT, page=page, top=top))
    assert result == ([JOINED] if is_joined else [UPPER, LOWER])


@pytest.mark.parametrize(
    ("width", "left", "is_joined"),
    [(307.9, 0.0, True), (308.0, 0.0, False), (292.1, 0.0, True), (300.0, 50.0, True)],
)
def test_the_parts_of_a_table_have_one_width(width, left, is_joined):
    result = built(first(), ruled(*NEXT, page=2, width=width, left=left))
    assert len(result) == (1 if is_joined else 2)


@pytest.mark.parametrize(
    ("width", "left", "is_joined"),
    [(300.0, 7.9, True), (307.9, 0.0, True), (300.0, 8.0, False), (308.0, 0.0, False)],
)
def test_the_parts_of_a_table_without_headings_have_the_same_sides(
    width, left, is_joined
):
    below = ruled("c|d", page=2, left=left, width=width)
    result = built(ruled("a|b"), below)
    assert result == ([["a | b", "c | d"]] if is_joined else [["a | b"], ["c | d"]])
    # On one page, nothing shows that they are one table.
    assert len(built(ruled("a|b"), ruled("c|d", top=125.0))) == 2


@pytest.mark.parametrize(
    ("between", "is_joined"),
    [
        ([text("x")] * 3, True),
        ([text("x")] * 4, False),
        ([text("x", size=8.7)], False),
        ([text("1 Motor", kind="heading")], False),
        ([text("Table 9: Other", kind="caption")], False),
    ],
)
def test_only_a_few_small_lines_are_between_the_parts_of_a_table(between, is_joined):
    result = built(first(), *between, ruled(*NEXT, page=2))
    tables = [item for item in result if isinstance(item, list)]
    assert tables == ([JOINED] if is_joined else [UPPER, LOWER])


@pytest.mark.parametrize(
    "captions",
    [
        ("Table 9: Motor", "Table 9: Motor (continued)"),
        ("Table 9: Motor", "TABLE 9 - Motor"),
    ],
)
def test_a_repeated_caption_joins_parts_of_different_widths(captions):
    above, again = (text(caption, kind="caption") for caption in captions)
    again.box = PageBox(2, 0.0, 0.0, 100.0, 8.0)
    items = [above, first(), text("foot"), again, ruled(*NEXT, page=2, width=320)]
    assert built(*items) == [JOINED]
    # The pages are consecutive also then.
    items[-1] = ruled(*NEXT, page=3, width=320)
    assert len([item for item in built(*items) if isinstance(item, list)]) == 2


def test_headings_that_a_page_repeats_are_no_row():
    assert built(first(), ruled(HEAD, *NEXT, page=2)) == [JOINED]
    # Also if no rule is below them.
    stacked = f"{HEAD}/{NEXT[0]}"
    assert built(first(), ruled(stacked, NEXT[1], page=2)) == [JOINED]
    # On the same page, they begin a table.
    assert len(built(first(), ruled(HEAD, *NEXT, top=150.0))) == 2


@pytest.mark.parametrize("titles", ["Byte|Type|Name", "Value|Name|Description"])
def test_other_headings_begin_a_table(titles):
    below = ruled(titles, "7|x|y", page=2)
    assert built(first(), below) == [UPPER, [titles.replace("|", " | "), "7 | x | y"]]


def test_the_id_of_a_message_begins_a_table():
    other = ruled("ID 7 Length 4||", "1|Load|u8", page=2)
    assert built(first(), other) == [UPPER, ["ID 7 Length 4", "1 | Load | u8"]]
    within = ruled(HEAD, "0|Mode|u8", "ID 7 Length 4||", HEAD, "1|Load|u8")
    expected = ["ID 7 Length 4", JOINED[0], JOINED[2]]
    assert built(within) == [UPPER, expected]


def test_headings_in_two_bands_are_one_heading_row():
    piece = ruled("Start||Data", "Byte|Name|Type", "0|Mode|u8")
    assert built(piece) == [["Start | Data", *UPPER]]


def test_headings_whose_lines_a_page_break_separates_are_joined():
    upper = ruled("Byte|Name|Initial")
    lower = ruled("||Value", "0|Mode|8", page=2)
    assert built(upper, lower) == [["Byte | Name | Initial Value", "0 | Mode | 8"]]


def test_headings_and_rows_without_a_rule_between_them_are_separated():
    piece = ruled(f"Motor||/{HEAD}/0|Mode|u8/1|Load|u8")
    assert built(piece) == [["Motor", *JOINED[:3]]]


def test_the_first_row_of_a_page_may_continue_the_last_row():
    below = ruled("|of it|/8|Load|u8", page=2)
    assert built(first(), below) == [[*UPPER, "of it", "8 | Load | u8"]]


def test_a_strong_line_below_a_list_is_a_group_of_the_next_page():
    head = "ID|Name|Length (bytes)"
    for mark, is_group in (
        (text("Power", top=300.0, strong=True), True),
        (text("Power", top=148.5), True),
        (text("Power", top=148.7), False),
    ):
        items = [ruled(head, "1|On|4"), mark, ruled("2|Off|4", page=2)]
        table = ["ID | Name | Length (bytes)", "1 | On | 4", "2 | Off | 4"]
        if is_group:
            assert built(*items) == [[*table[:2], "Power", table[2]]]
        else:
            assert table in built(*items) and "Power" in built(*items)


def loose(*rows: str, head=(), page=1, has_headings=True) -> TablePiece:
    """Return a piece without vertical rules; its columns are 60 points apart."""
    texts = [
        line(
            *((t, 60.0 * i) for i, t in enumerate(row.split("|")) if t),
            top=12.0 * number,
        )
        for number, row in enumerate(rows)
    ]
    found = columns.find_headings(texts, WORDS) if has_headings else None
    piece = TablePiece(PageBox(page, 0, 0, 200, 12 * len(rows)), [], ruled=False)
    piece.columns, piece.head = found, list(head)
    piece.lines = texts[1:] if has_headings else texts
    piece.page, piece.extent = PageContents(page, 300, 300), (0.0, 200.0)
    return piece


def test_pieces_without_vertical_rules_have_columns_from_all_their_lines():
    upper = loose(HEAD, "0|Mode|u8", head=["Motor", "State"])
    assert built(upper) == [["Motor", "State", *UPPER]]
    wide = loose("1|Load of the|u8", "2|Rate|u8", page=2, has_headings=False)
    (rows,) = built(upper, wide)
    assert rows == ["Motor", "State", *UPPER, "1 | Load of the | u8", JOINED[3]]
    # Headings that a page repeats are no row.
    again = loose(HEAD, *NEXT, page=2)
    assert built(loose(HEAD, "0|Mode|u8"), again) == [JOINED]
    other = loose("Value|Name|Description", "0|Off|x", page=2)
    assert len(built(upper, other)) == 2
