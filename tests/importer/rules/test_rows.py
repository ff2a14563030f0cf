"""A table becomes rows by heading; operations of the rule change and drop rows."""

from __future__ import annotations

import pytest

from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.rows import one_line, read_rows
from tests.importer.rules.small import rule, table


def rows(*texts: str, **keys) -> tuple[list[str], list[list[str]]]:
    """Return the headings, and the values of each row in their order."""
    keys.setdefault("head", "A | B")
    titles, data = read_rows(rule(**keys), table(*texts), Notes())
    return titles, [list(row.values.values()) for row in data]


def test_rows_below_the_headings_have_values_by_heading():
    titles, (first, second) = read_rows(
        rule(head="A | B"), table("Title", "A|B|C", "0|x\ny|", "1>2|z"), Notes()
    )
    assert titles == ["A", "B", "C"]
    assert first.values == {"A": "0", "B": "x\ny", "C": ""}
    assert first.ranges == {"A": (0, 0), "B": (1, 1), "C": (2, 2)}
    assert (first.text, first.source.line, first.is_short) == ("0 | x y", 3, False)
    assert second.values == {"A": "1", "B": "", "C": "z"}
    assert second.ranges == {"A": (0, 1), "C": (2, 2)}
    assert one_line(first, "B", frozenset()) == "x y"
    assert one_line(first, "D", frozenset()) == ""


def test_without_headings_columns_have_numbers():
    assert rows("0|x", "1|y|z", head="none") == (
        ["1", "2", "3"],
        [["0", "x", ""], ["1", "y", "z"]],
    )


def test_a_table_without_cells_has_no_columns():
    assert rows(head="none") == ([], [])


def test_headings_in_several_rows_are_joined_and_equal_ones_numbered():
    titles, data = rows("A>2|Bv2|B", "x|y|", "0|1|2|3", head="A", head_rows=2)
    assert titles == ["A x", "A y", "B", "B.2"]
    assert data == [["0", "1", "2", "3"]]
    assert rows("A>3|B", "0|1|2|3")[0] == ["A", "A.2", "A.3", "B"]
    assert rows("A|B||", "0|1||")[0] == ["A", "B", "", ""]


def test_a_cell_below_no_heading_keeps_its_text():
    titles, (row,) = read_rows(rule(head="A | B"), table("A|B||D", "0|x|y||z"), Notes())
    assert titles == ["A", "B", "", "D"]
    assert row.values == {"A": "0", "B": "x", "D": "", "column 3": "y", "column 5": "z"}


def test_a_cell_that_exceeds_the_headings_ends_with_the_last_heading():
    _, (row,) = read_rows(rule(head="A | B"), table("A|B|C", "0|x>5"), Notes())
    assert row.ranges["B"] == (1, 2)


@pytest.mark.parametrize(("row", "is_short"), [("0|x|y", False), ("0|x", True)])
def test_a_row_with_fewer_cells_than_headings_is_short(row, is_short):
    _, (data,) = read_rows(rule(head="A | B"), table("A|B|C", row), Notes())
    assert data.is_short == is_short


def test_repeated_headings_and_empty_rows_are_no_rows():
    text = ("A|B", "0|x", " A |B", "|", "1|y", "a|B")
    assert rows(*text)[1] == [["0", "x"], ["1", "y"], ["a", "B"]]


@pytest.mark.parametrize(
    ("row", "values"),
    [
        ("0|x", ["0", "", "x"]),
        ("0|y|x", ["0", "y", "x"]),
        ("0|", ["0", "", ""]),
        ("0", ["0", "", ""]),
    ],
)
def test_a_missing_empty_cell_is_added_in_a_column_that_may_be_absent(row, values):
    text = ("A|B|C", row)
    assert rows(*text, absent=["B"])[1] == [values]
    assert rows(*text)[1] == [row.split("|") + [""] * (3 - len(row.split("|")))]
    assert rows("A|B|C|D", "0|x", absent=["B"])[1] == [["0", "x", "", ""]]


def test_stop_ends_the_table_and_skip_drops_rows_with_a_note():
    notes = Notes()
    text = ("A|B", "0|x", "Sum|4", "1|y", "End|", "2|z")
    wanted = rule(head="A | B", skip="^sum", stop="^end$")
    _, data = read_rows(wanted, table(*text), notes)
    assert [row.text for row in data] == ["0 | x", "1 | y"]
    assert notes.dropped == {("state", "skip"): ["Sum | 4"]}
    # `stop` precedes `skip`.
    assert rows(*text, skip="^end", stop="^end")[1] == [
        ["0", "x"],
        ["Sum", "4"],
        ["1", "y"],
    ]


def test_keep_drops_rows_that_do_not_match_all_its_columns():
    notes = Notes()
    text = ("A|B|C", "0|x|p", "1|x|q", "2|y|p", "3|x\n|p")
    wanted = rule(head="A | B", keep={"B": "^x$", "C": "p"})
    _, data = read_rows(wanted, table(*text), notes)
    assert [row.values["A"] for row in data] == ["0", "3"]
    assert notes.dropped == {("state", "keep"): ["1 | x | q", "2 | y | p"]}


def test_a_row_whose_columns_of_join_are_empty_continues_the_row_above():
    text = ("A|B|C", "0|x|p", "|more|", "|and|q", "1|y|", "|  |z")
    assert rows(*text, join=["A"])[1] == [
        ["0", "x\nmore\nand", "p\nq"],
        ["1", "y", "z"],
    ]
    assert rows(*text, join=["A", "C"])[1] == [
        ["0", "x\nmore", "p"],
        ["", "and", "q"],
        ["1", "y", ""],
        ["", "  ", "z"],
    ]
    # The first row has none above it.
    assert rows("A|B", "|x", "0|y", join=["A"])[1] == [["", "x"], ["0", "y"]]


def test_a_cell_over_several_rows_joins_them_and_has_its_text_once():
    text = ("A|B|C", "0v2|x|pv2", "y", "1|z|q")
    assert rows(*text, join=["A"])[1] == [["0", "x\ny", "p"], ["1", "z", "q"]]
    assert rows(*text)[1][1] == ["0", "y", "p"]


@pytest.mark.parametrize(
    ("above", "below", "joined"),
    [
        ("on one page", "on one page", "on one page\non one page"),
        ("is on a page.", "is on a page.", "is on a page."),
        ("text is on a\npage.", "is on a page.", "text is on a\npage."),
        ("is on a page. x", "is on a page.", "is on a page. x\nis on a page."),
    ],
)
def test_the_end_of_a_cell_that_a_page_break_repeats_has_over_12_characters(
    above, below, joined
):
    assert rows("A|B", f"0|{above}", f"|{below}", join=["A"])[1] == [["0", joined]]


def test_skip_precedes_join_and_join_precedes_fill():
    text = ("A|B|C", "0|x|", "|Sum|4", "1|y|z")
    assert rows(*text, skip="^sum", join=["A"])[1] == [["0", "x", ""], ["1", "y", "z"]]
    assert rows(*text, join=["A"], fill=["A", "C"])[1] == [
        ["0", "x\nSum", "4"],
        ["1", "y", "z"],
    ]


def test_fill_repeats_the_last_text_of_a_column():
    text = ("A|B", "|w", "0|x", "|y", "1|", "|z")
    assert rows(*text, fill=["A"])[1] == [
        ["", "w"],
        ["0", "x"],
        ["0", "y"],
        ["1", ""],
        ["1", "z"],
    ]


def test_glue_removes_the_line_breaks_of_a_column():
    text = ("A|B", "Mo \n de|x\ny")
    assert rows(*text, glue=["A", "C"])[1] == [["Mode", "x\ny"]]


def test_rows_of_groups_name_the_section_of_the_rows_below():
    text = ("A|B", "0|w", "Power|", "1|x", "|y", "Motor |", "2|z")
    _, data = read_rows(rule(head="A | B", group_rows=True), table(*text), Notes())
    assert [(row.values["B"], row.roles) for row in data] == [
        ("w", {"section": ""}),
        ("x", {"section": "Power"}),
        # A text in another column only is no group.
        ("y", {"section": "Power"}),
        ("z", {"section": "Motor"}),
    ]
    assert rows(*text)[1][1] == ["Power", ""]


def test_columns_of_a_transposed_table_are_rows():
    text = ("Bit|7|6|5", "Name|On|Level>2")
    titles, data = read_rows(
        rule(head="Bit | Name", transpose=True), table(*text), Notes()
    )
    assert titles == ["Bit", "Name"]
    assert [(row.values, row.roles) for row in data] == [
        ({"Bit": "7", "Name": "On"}, {}),
        ({"Bit": "6:5", "Name": "Level"}, {}),
    ]


def test_each_block_of_a_transposed_table_is_a_byte():
    text = ("Bit|1|0", "Name|A|B", "Bit|1|0", "Name|C>2")
    titles, data = read_rows(
        rule(head="Bit | Name", transpose=True), table(*text), Notes()
    )
    assert titles == ["Bit", "Name"]
    assert [(row.values["Bit"], row.values["Name"], row.roles) for row in data] == [
        ("1", "A", {"byte": "0"}),
        ("0", "B", {"byte": "0"}),
        ("1:0", "C", {"byte": "1"}),
    ]
    assert [row.source.line for row in data] == [1, 1, 3]


def test_columns_left_of_the_headings_of_a_transposed_table_are_ignored():
    text = ("x|Bit|1", "y|Name|A|B")
    _, data = read_rows(rule(head="Bit | Name", transpose=True), table(*text), Notes())
    assert [row.values for row in data] == [
        {"Bit": "1", "Name": "A"},
        {"Bit": "", "Name": "B"},
    ]
