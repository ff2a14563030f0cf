"""Bands of a page become rows: keys and gaps between lines separate them."""

from __future__ import annotations

import pytest

from icdgen.importer.pages.bands import (
    Band,
    aligned_band,
    group_row,
    has_keys,
    is_key,
    rows_of_band,
)
from icdgen.importer.pages.draft import HeadingRow, PrintedRow
from tests.importer.pages.words import word

EDGES = [0.0, 100.0, 200.0, 300.0]
FIELDS = HeadingRow("fields", ["at", "name", "type"], ["Offset", "Name", "Type"])
NONE: frozenset[str] = frozenset()


def band(*rows: str, gaps: tuple[float, ...] = (), edges=EDGES) -> Band:
    """Return a band with a line for each row, cells separated by `|`.

    ``gaps``: distances of the lines, 12 points if not given.
    """
    words, top = [], 0.0
    for index, row in enumerate(rows):
        if index:
            top += gaps[index - 1] if gaps else 12.0
        for text, left in zip(row.split("|"), edges, strict=False):
            if text:
                words.append(word(text, left + 5, left + 25, top))
    return Band(4, list(edges), words)


def rows(*texts: str, gaps=(), header=FIELDS, torn=False) -> list[list[str]]:
    given = band(*texts, gaps=gaps)
    return [row.texts for row in rows_of_band(given, header, NONE, torn)]


@pytest.mark.parametrize(
    "text",
    ["0", " 12 ", "0x1F", "0XA0", "A1", "0-7", "0 – 7", "3:0", "1/2", "1~2", "0..7",
     "0...7", "0 to 3", "Byte 0", "bits 3:0", "Octet 2", "Byte0-Byte 3", "5*", "5†",
     "4²", "7 to bit 0"],
)  # fmt: skip
def test_numbers_and_ranges_are_keys(text):
    assert is_key(text)


@pytest.mark.parametrize(
    "text",
    ["", "Add", "Face", "0x", "1-", "1 2", "Word 0", "G1", "0 Mode", "Mode 0", "0, 1",
     "0-", "0x1G", "1 or 2", "*"],
)  # fmt: skip
def test_words_and_incomplete_ranges_are_no_keys(text):
    assert not is_key(text)


def test_a_band_has_the_texts_of_its_cells():
    given = band("0|Mode", "|of the", "|pump|uint8")
    given.continues = (True, False, False)
    assert given.texts(NONE) == ["0", "Mode of the pump", "uint8"]
    assert given.printed(NONE) == PrintedRow(
        ["0", "Mode\nof the\npump", "uint8"], tuple(EDGES), (True, False, False), 4
    )


@pytest.mark.parametrize(("x1", "is_broken"), [(34.0, False), (34.1, True)])
def test_a_word_that_fills_its_line_goes_on_in_the_next_line(x1, is_broken):
    words = [word("infor", 2, x1), word("mation", 2, 30, 12)]
    given = Band(1, [0.0, 50.0], words)
    known = frozenset({"information"})
    assert given.texts(known) == ["information" if is_broken else "infor mation"]
    assert given.printed(known).texts == [
        "information" if is_broken else "infor\nmation"
    ]
    assert given.texts(NONE) == ["infor mation"]
    # A line with two words is not a broken word.
    given.words.append(word("x", -4, 0))
    assert given.texts(known) == ["x infor mation"]


def test_a_band_without_keys_is_one_row_and_an_empty_band_none():
    assert rows("|Mode|uint8", "|of the pump") == [["", "Mode\nof the pump", "uint8"]]
    assert rows() == []


def test_lines_around_the_only_key_are_one_row_unless_the_band_is_torn():
    text = ("|of the pump", "8|Load|uint8")
    assert rows(*text, gaps=(30,)) == [["8", "of the pump\nLoad", "uint8"]]
    torn = rows(*text, gaps=(30,), torn=True)
    assert torn == [["", "of the pump", ""], ["8", "Load", "uint8"]]


def test_each_line_with_a_key_is_a_row():
    assert rows("0|A|u8", "8|B|u8", "16|C|u8") == [
        ["0", "A", "u8"],
        ["8", "B", "u8"],
        ["16", "C", "u8"],
    ]


@pytest.mark.parametrize(
    ("gaps", "names"),
    [
        ((12, 18), ["A\nmore", "B"]),
        ((18, 12), ["A", "more\nB"]),
        # A gap that is hardly wider separates no rows.
        ((14.4, 12), ["A\nmore", "B"]),
        ((14.5, 12), ["A", "more\nB"]),
        ((12, 12), ["A\nmore", "B"]),
    ],
)
def test_a_line_between_two_keys_belongs_to_the_nearer_one(gaps, names):
    result = rows("0|A", "|more", "8|B", gaps=gaps)
    assert [row[1] for row in result] == names


def test_a_vertically_centred_key_has_as_many_lines_above_as_below():
    text = ("|a|", "0|b|", "|c|", "|d|", "8|e|", "|f|")
    assert [row[1] for row in rows(*text)] == ["a\nb\nc", "d\ne\nf"]
    # The last row has fewer lines below its key than above it.
    assert [row[1] for row in rows("|a|", "0|b|", "8|c|")] == ["a", "b", "c"]
    one_more = rows("0|a|", "|b|", "|c|", "8|d|")
    assert [row[1] for row in one_more] == ["a\nb\nc", "d"]


@pytest.mark.parametrize(
    ("gap", "torn", "names"),
    [
        (15.0, True, ["end\nA\nmore", "B"]),
        (15.1, True, ["end", "A\nmore", "B"]),
        (15.1, False, ["end\nA\nmore", "B"]),
    ],
)
def test_a_gap_above_the_first_key_ends_a_row_of_the_page_before(gap, torn, names):
    text = ("|end", "0|A", "|more", "8|B")
    result = rows(*text, gaps=(gap, 12, 18), torn=torn)
    assert [row[1] for row in result] == names


def test_a_gap_among_several_lines_above_the_first_key_ends_a_row():
    text = ("|end", "|a", "0|b", "|c", "8|d")
    result = rows(*text, gaps=(12, 12, 12, 18))
    assert [row[1] for row in result] == ["end\na", "b\nc", "d"]
    result = rows("|end", "|end", "|a", "0|b", "|c", "8|d", gaps=(12, 20, 12, 12, 18))
    assert [row[1] for row in result] == ["end\nend", "a\nb\nc", "d"]


def test_keys_are_in_the_column_with_the_role_of_the_key():
    header = HeadingRow("enumeration", ["name", "value", ""], ["Name", "Value", ""])
    assert rows("A|0|1", "b||2", "C|1|3", header=header) == [
        ["A\nb", "0", "1\n2"],
        ["C", "1", "3"],
    ]
    ids = HeadingRow("list", ["name", "", "get_id"], ["Name", "", "Get ID"])
    assert rows("1|A|5", "2||", "3|B|6", header=ids) == [
        ["1\n2", "A", "5"],
        ["3", "B", "6"],
    ]


def test_keys_of_a_rule_are_in_the_column_with_most_numbers():
    header = HeadingRow("rule 1", ["", "", ""], ["Name", "Number", ""])
    assert rows("A|0|1", "b||", "C|1|x", header=header) == [
        ["A\nb", "0", "1"],
        ["C", "1", "x"],
    ]


def test_group_headings_are_rows_of_a_list():
    header = HeadingRow("list", ["id", "name", "length"], ["ID", "Name", "Length"])
    text = ("Power", "1|On|4", "2|Off|4", "Motor", "Wheels", "3|Run|8")
    assert rows(*text, header=header) == [
        ["Power", "", ""],
        ["1", "On", "4"],
        ["2", "Off", "4"],
        ["Motor", "", ""],
        ["Wheels", "", ""],
        ["3", "Run", "8"],
    ]
    # In other tables, such a line belongs to a row.
    assert rows("0|A", "Power", "8|B") == [["0\nPower", "A", ""], ["8", "B", ""]]
    assert group_row("Power", 3, 7) == PrintedRow(["Power", "", ""], page=7)
    (row,) = rows_of_band(band("Power"), header, NONE)
    assert row == PrintedRow(["Power", "", ""], page=4)


@pytest.mark.parametrize(
    ("row", "has_key"),
    [("0|Mode", True), ("0", False), ("Mode|0", False), ("|Mode|0", False)],
)
def test_a_key_stands_beside_words_of_another_column(row, has_key):
    assert has_keys(band("|more", row), FIELDS) == has_key
    assert not has_keys(band(), FIELDS)


@pytest.mark.parametrize(
    ("edges", "texts"),
    [
        (EDGES, ["a", "b", "c"]),
        # The second cell covers half of the second column, or hardly more.
        ([0.0, 149.9, 300.0], ["a", "b", ""]),
        ([0.0, 150.0, 300.0], ["a", "", "b"]),
        ([0.0, 300.0], ["a", "", ""]),
        ([0.0, 30.0, 70.0, 200.0, 300.0], ["a b", "c", "d"]),
    ],
)
def test_a_cell_over_several_columns_is_moved_to_the_first(edges, texts):
    count = len(edges) - 1
    given = band("|".join("abcd"[:count]), edges=edges)
    aligned = aligned_band(given, EDGES)
    assert (aligned.page, aligned.edges) == (4, EDGES)
    assert aligned.texts(NONE) == texts


def test_lines_of_a_moved_cell_stay_together():
    words = [word("Mode", 60, 80), word("of", 110, 120), word("pump", 60, 150, 12)]
    given = Band(4, [0.0, 200.0, 300.0], words)
    moved = aligned_band(given, EDGES).words
    assert [(w.text, w.x0, w.x1, w.top) for w in moved] == [
        ("Mode of", 1, 99, 0),
        ("pump", 1, 99, 12),
    ]
    # Words that are in the first column stay where they are.
    inside = Band(4, [0.0, 200.0, 300.0], words[:1])
    assert aligned_band(inside, EDGES).words == words[:1]
