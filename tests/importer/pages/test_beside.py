"""Tables side by side that were read as one are separated, with the lines above them."""

from __future__ import annotations

import pytest

from icdgen.importer import profile
from icdgen.importer.document import PageBox
from icdgen.importer.pages.beside import with_tables_separated
from icdgen.importer.pages.draft import HeadingRow, PrintedRow, TableDraft
from icdgen.importer.pages.flow import TextItem

WORDS = profile.load()
BOX = PageBox(1, 0.0, 100.0, 400.0, 200.0)


def draft(*rows: str, box: PageBox = BOX) -> TableDraft:
    return TableDraft([box], head=[PrintedRow(row.split("|")) for row in rows])


def text(*cells: str, kind: str = "text") -> TextItem:
    places = [(200.0 * index, cell) for index, cell in enumerate(cells)]
    return TextItem(kind, " ".join(cells), BOX, 10.0, cells=places)


def shown(*items) -> list:
    """Return the texts of lines, and the rows of tables."""
    result = []
    for item in with_tables_separated(list(items), WORDS):
        if isinstance(item, TextItem):
            assert [cell for _, cell in item.cells] == [item.text] or len(
                item.cells
            ) > 1
            result.append(item.text)
        else:
            printed = item.header.printed if item.header else []
            rows = [*printed, *item.head, *item.rows]
            result.append(["|".join(row.texts) for row in rows])
    return result


TWO = ("Value|Name|Value|Name", "0|Off|2|Slow", "1|On||")
LEFT, RIGHT = ["Value|Name", "0|Off", "1|On"], ["Value|Name", "2|Slow"]


def test_a_table_with_repeated_headings_is_two_tables():
    assert shown(draft(*TWO)) == [LEFT, RIGHT]
    first, second = with_tables_separated([draft(*TWO)], WORDS)
    header = HeadingRow("enumeration", ["value", "name"], ["Value", "Name"])
    assert first.header == second.header == header
    assert first.boxes == second.boxes == [BOX] and first.boxes is not second.boxes


def test_columns_without_a_title_may_be_between_the_tables():
    rows = ("Value|Name||Value|Name", "0|Off||2|Slow", "1|On|||")
    assert shown(draft(*rows)) == [LEFT, RIGHT]


@pytest.mark.parametrize(
    "titles",
    [
        "Value|Name|Value|Text",
        "Value|Name|Unit|Name",
        "Value|Name|Value|Name|Unit",
        "Value|Name|Unit|Value|Name",
        "|Name||Name",
        # No headings of a known table.
        "Colour|Shape|Colour|Shape",
    ],
)
def test_other_headings_are_those_of_one_table(titles):
    rows = (titles, "0|1|2|3|4")
    assert shown(draft(*rows)) == [list(rows)]


def test_a_table_needs_rows_below_its_headings_to_be_separated():
    assert shown(draft(TWO[0])) == [[TWO[0]]]
    known = draft(*TWO)
    known.header = HeadingRow("enumeration", ["value"], ["Value"])
    assert shown(known) == [list(TWO)]


def test_each_table_follows_its_part_of_the_lines_above():
    caption = text("Table 1: A", "Table 2: B", kind="caption")
    units = text("in volts", "in amperes")
    assert shown(text("Before"), caption, units, draft(*TWO), text("x", "y")) == [
        "Before",
        *("Table 1: A", "in volts", LEFT),
        *("Table 2: B", "in amperes", RIGHT),
        "x y",
    ]


@pytest.mark.parametrize(
    "line",
    [
        text("a", "b", "c"),
        text("a"),
        text("1 Motor", "2 Wheel", kind="heading"),
        text("Table 1: A", "of wheels", kind="caption"),
    ],
)
def test_other_lines_above_stay_in_front_of_both_tables(line):
    above = text("in volts", "in amperes")
    assert shown(above, line, draft(*TWO)) == [
        "in volts in amperes",
        line.text,
        LEFT,
        RIGHT,
    ]


def test_a_single_table_leaves_the_lines_above_it():
    caption = text("Table 1: A", "Table 2: B", kind="caption")
    assert shown(caption, draft("A|B", "0|1")) == [caption.text, ["A|B", "0|1"]]


def boxed(x0, x1, top=100.0, bottom=200.0, page=1):
    return draft(f"at {x0:g}", box=PageBox(page, x0, top, x1, bottom))


def test_tables_that_overlap_vertically_are_side_by_side():
    caption = text("Table 1: A", "Table 2: B", kind="caption")
    left, right = ["at 0"], ["at 200"]
    # The right table is first if it begins above the left one.
    for tables in ([boxed(0, 190), boxed(200, 400)], [boxed(200, 400), boxed(0, 190)]):
        assert shown(caption, *tables) == ["Table 1: A", left, "Table 2: B", right]


@pytest.mark.parametrize(
    ("other", "is_beside"),
    [
        (boxed(190, 400), True),
        (boxed(189.9, 400), False),
        (boxed(-100, 0), True),
        (boxed(-100, 0.1), False),
        (boxed(200, 400, top=199.9, bottom=300.0), True),
        (boxed(200, 400, top=200.0, bottom=300.0), False),
        (boxed(200, 400, top=0.0, bottom=100.1), True),
        (boxed(200, 400, top=0.0, bottom=100.0), False),
        (boxed(200, 400, page=2), False),
    ],
)
def test_tables_on_one_page_and_at_one_height_are_side_by_side(other, is_beside):
    caption = text("Table 1: A", "Table 2: B", kind="caption")
    result = shown(caption, boxed(0, 190), other)
    assert (result[0] == "Table 1: A") == is_beside
    continued = boxed(0, 190)
    continued.boxes.append(PageBox(2, 0.0, 0.0, 190.0, 50.0))
    assert shown(caption, continued, other)[0] == caption.text
    assert shown(caption, other, continued)[0] == caption.text
