"""Headings, captions, texts and pieces of tables in the flow of pages."""

from __future__ import annotations

import pytest

from icdgen.importer import profile
from icdgen.importer.document import PageBox
from icdgen.importer.pages.extract import PageContents, RulingLine, Word
from icdgen.importer.pages.flow import TablePiece, TextItem, items
from tests.importer.pages.words import word

WORDS = profile.load()
PROSE = "the module sends a message each second and waits for the next one"


def words(top: float, text: str, x0: float = 50, **keys) -> list[Word]:
    """Return the words of a line; cells are separated by `|`, 100 points apart."""
    result = []
    for column, cell in enumerate(text.split("|")):
        at = x0 + 100 * column
        for part in cell.split():
            item = word(part, at, top=top)
            size = keys.get("size", 10)
            result.append(item._replace(bottom=top + size, **keys))
            at = item.x1 + 3
    return result


def page(*lines: tuple, number: int = 1, first: float = 100) -> PageContents:
    """Return a page of lines, each a text and keys of its words, 40 points apart unless
    a key `below` states the distance.
    """
    contents = PageContents(number, 700, 800)
    top = first
    for text, *rest in [*lines]:
        keys = dict(rest[0]) if rest else {}
        top += keys.pop("below", 40)
        contents.words += words(top, text, **keys)
    return contents


def shown(*pages: PageContents) -> list[tuple]:
    """Return kind, number and text of each item behind the prose, and what stands out;
    of a table the texts of its lines.
    """
    result: list[tuple] = []
    for item in items(list(pages), WORDS):
        if isinstance(item, TextItem):
            kind = "strong" if item.strong else item.kind
            if item.text != PROSE:
                result.append((kind, item.number, item.text))
        else:
            body = [line.text for line in item.lines]
            result.append(("table", item.head, body))
    return result


BOLD = {"style": "bold"}
LARGE = {"size": 10.7}


@pytest.mark.parametrize(
    ("text", "keys", "item"),
    [
        ("4.2 Motor State", BOLD, ("heading", "4.2", "Motor State")),
        ("4. Motor", LARGE, ("heading", "4", "Motor")),
        ("4.2 Motor State", {}, ("text", "", "4.2 Motor State")),
        ("4.2 Motor State", {"size": 10.5}, ("text", "", "4.2 Motor State")),
        ("4.2 motor state", BOLD, ("strong", "", "4.2 motor state")),
        ("Motor", BOLD, ("strong", "", "Motor")),
        ("Motor.", BOLD, ("text", "", "Motor.")),
        ("Motor:", BOLD, ("text", "", "Motor:")),
        ("Motor,", BOLD, ("text", "", "Motor,")),
        ("Motor;", BOLD, ("text", "", "Motor;")), ("Motor", {}, ("text", "", "Motor")),
        ("M" * 79, BOLD, ("strong", "", "M" * 79)),
        ("M" * 80, BOLD, ("text", "", "M" * 80)),
        ("4 " + "M" * 117, BOLD, ("heading", "4", "M" * 117)),
        ("4 " + "M" * 118, BOLD, ("text", "", "4 " + "M" * 118)),
        ("Table 7: Motor State", {}, ("caption", "", "Table 7: Motor State")),
        ("Table 7", {}, ("caption", "", "Table 7")),
        ("Table 7 Motor State", BOLD, ("caption", "", "Table 7 Motor State")),
        ("Table 7 shows it", {}, ("text", "", "Table 7 shows it")),
    ],
)  # fmt: skip
def test_a_line_is_a_heading_a_caption_or_text(text, keys, item):
    assert shown(page((PROSE,), (PROSE,), (PROSE,), (text, keys))) == [item]


@pytest.mark.parametrize(
    "text",
    ["(continued)", "Continues below", "table continued", "This is continued on the next page."],
)  # fmt: skip
def test_marks_of_continued_tables_are_left_out(text):
    assert shown(page((PROSE,), (text,), ("Motor",))) == [("text", "", "Motor")]


NEAR = {**BOLD, "below": 14.4}


@pytest.mark.parametrize(
    ("second", "third", "caption"),
    [
        (("of the motor", NEAR), ("and pump", NEAR), "Table 7: State of the motor and pump"),
        (("of the motor", NEAR | {"below": 14.6}), ("x",), "Table 7: State"),
        (("of the motor", NEAR | {"style": "italic"}), ("x",), "Table 7: State"),
        (("of the motor", NEAR | {"size": 10.4}), ("x",), "Table 7: State"),
        (("Table 8: Mode", NEAR), ("x",), "Table 7: State"),
        (("Offset (bits)|Length (bits)|Name", NEAR), ("0|8|Mode",), "Table 7: State"),
    ],
)  # fmt: skip
def test_lines_of_a_caption_are_alike_and_close_together(second, third, caption):
    lines = [(PROSE,)] * 4
    captions = [
        item[2]
        for item in shown(page(*lines, ("Table 7: State", BOLD), second, third))
        if item[0] == "caption"
    ]
    assert captions[0] == caption


def test_a_caption_has_at_most_three_lines():
    lines = [(PROSE,)] * 4
    more = [(text, NEAR) for text in ("one", "two", "three")]
    assert shown(page(*lines, ("Table 7: State", BOLD), *more)) == [
        ("caption", "", "Table 7: State one two"),
        ("strong", "", "three"),
    ]


HEAD = ("Offset (bits)|Length (bits)|Name|Data Type",)
ROW = {"below": 14}
ROWS = [("0|8|Mode|UINT", ROW), ("8|16|Speed|INT", ROW)]
TABLE = ["0 8 Mode UINT", "8 16 Speed INT"]


def test_a_table_without_vertical_rules_ends_at_a_paragraph_or_a_gap():
    below = (PROSE, ROW)
    assert shown(page((PROSE,), HEAD, *ROWS, below, ("Motor",))) == [
        ("table", [], TABLE),
        ("text", "", "Motor"),
    ]
    far = ("Motor", {"below": 32.1})
    assert shown(page((PROSE,), HEAD, *ROWS, far))[-1] == ("text", "", "Motor")
    close = ("Motor", {"below": 31.9, "x0": 250})
    assert shown(page((PROSE,), HEAD, *ROWS, close)) == [
        ("table", [], [*TABLE, "Motor"])
    ]


def test_rows_with_labels_above_the_headings_belong_to_the_table():
    first = ("ID 140|Frame Length (bytes) 4",)
    described = ("Description|State of the motor", ROW)
    lines = [(PROSE,), first, described, (HEAD[0], ROW), *ROWS]
    assert shown(page(*lines)) == [
        (
            "table",
            ["ID 140 Frame Length (bytes) 4", "Description State of the motor"],
            TABLE,
        )
    ]
    # Without headings, the rows above them are a table of their own.
    assert shown(page((PROSE,), first, described, (PROSE,))) == [
        (
            "table",
            ["ID 140 Frame Length (bytes) 4", "Description State of the motor"],
            [],
        )
    ]


def test_the_next_page_continues_a_table_with_a_row():
    first = page((PROSE,), HEAD, *ROWS)
    rows = [("24|8|Level|UINT",), ("32|8|Rate|UINT", ROW)]
    pieces = shown(first, page(*rows, (PROSE,), number=2))
    assert pieces == [
        ("table", [], TABLE),
        ("table", [], ["24 8 Level UINT", "32 8 Rate UINT"]),
    ]
    assert shown(first, page(("Motor",), (PROSE,), number=2))[1:] == [
        ("text", "", "Motor")
    ]
    # A caption ends the table above it.
    caption = ("Table 8: Limits",)
    assert [kind for kind, *_ in shown(first, page(caption, *rows, number=2))] == [
        "table", "caption", "text", "text"
    ]  # fmt: skip


def test_the_size_of_most_characters_is_that_of_the_body():
    lines = [(text, {"size": 12}) for text in ("Motor", "Pump", "Valve")]
    assert shown(page((PROSE,), *lines)) == [
        ("strong", "", "Motor"), ("strong", "", "Pump"), ("strong", "", "Valve")
    ]  # fmt: skip


def test_a_label_beside_all_rows_is_left_out():
    head = ("|Offset (bits)|Length (bits)|Name|Data Type",)
    rows = [
        ("Channels|0|8|Mode|UINT", ROW),
        ("Fields", ROW),
        ("Gaps|8|16|Speed|INT", ROW),
    ]
    assert shown(page((PROSE,), head, *rows)) == [
        ("table", [], ["0 8 Mode UINT", "Gaps 8 16 Speed INT"])
    ]


def test_no_line_below_the_lowest_rule_is_in_a_table_unless_it_is_a_row():
    rows = [ROWS[0], ("note", ROW), ("Motor", ROW)]
    contents = page((PROSE,), HEAD, *rows)
    bottoms = sorted({item.bottom for item in contents.words})
    contents.across = [RulingLine(y + 2, 45, 420) for y in bottoms[1:4]]
    assert shown(contents) == [
        ("table", [], [TABLE[0], "note"]), ("text", "", "Motor")
    ]  # fmt: skip
    contents.words += words(bottoms[-1] + 4, ROWS[1][0])
    assert shown(contents)[0] == ("table", [], [TABLE[0], "note"])
    contents.across.pop()
    assert shown(contents)[0] == ("table", [], [TABLE[0]])


def ruled(contents: PageContents, top: float) -> PageContents:
    """Draw a grid of two rows and two columns with words in it."""
    for y in (top, top + 20, top + 22.9, top + 42):
        contents.across.append(RulingLine(y, 50, 250))
    for x in (50, 150, 250):
        contents.down.append(RulingLine(x, top, top + 42))
    contents.words += words(top + 5, "Byte|Name", 60) + words(top + 27, "0|Mode", 60)
    return contents


def test_a_ruled_table_is_between_the_lines_around_it():
    contents = page((PROSE,), ("Motor",), first=0)
    contents.words += words(300, "Pump")
    first, middle, piece, last = items([ruled(contents, 150)], WORDS)
    texts = [item.text for item in (first, middle, last) if isinstance(item, TextItem)]
    assert texts == [PROSE, "Motor", "Pump"]
    assert isinstance(piece, TablePiece) and piece.ruled and piece.columns is None
    assert piece.box == PageBox(1, 50, 150, 250, 192)
    # Between two rules less than 3 points apart is no row.
    assert [[w.text for w in band.words] for band in piece.bands] == [
        ["Byte", "Name"],
        ["0", "Mode"],
    ]


def test_a_caption_or_a_ruled_table_ends_the_table_of_the_page_before():
    first, rows = page((PROSE,), HEAD, *ROWS), page(("24|8|Level|UINT",), number=3)
    empty = PageContents(2, 700, 800)
    assert shown(first, empty, rows)[-1] == ("table", [], ["24 8 Level UINT"])
    for second in (page(("Table 8: Limits",), number=2), ruled(page(number=2), 150)):
        second.number = 2
        assert shown(first, second, rows)[-1] == ("text", "", "24 8 Level UINT")
