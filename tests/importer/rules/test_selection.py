"""A rule is chosen for a table, and the reason is stated why another is not."""

from __future__ import annotations

import pytest

from icdgen.importer.document import PageBox
from icdgen.importer.rules.selection import (
    choose,
    heading_rows,
    texts_of_rows,
    titles_wanted,
    why_not,
)
from tests.importer.rules.small import rule, table
from tests.limits import assert_limits


def test_cells_of_a_head_are_separated_by_a_bar_between_blanks():
    assert titles_wanted(rule(head="Byte | ~^Name|Signal |  Data\u00a0Type")) == [
        "Byte",
        "~^Name|Signal",
        "Data Type",
    ]


def test_rows_have_the_texts_of_cells_that_begin_in_their_columns():
    rows = table("Motor  state>2|C", "0v2|x|y", "z|w")
    assert texts_of_rows(rows, False) == [
        ["Motor state", "C"],
        ["0", "x", "y"],
        # A cell over several rows is in each of them.
        ["0", "z", "w"],
    ]


def test_columns_of_a_transposed_table_are_as_long_as_the_table():
    rows = table("Byte|0|1", "Name", "Bits>2|8")
    assert texts_of_rows(rows, True) == [
        ["Byte", "Name", "Bits"],
        ["0", "", ""],
        ["1", "", "8"],
    ]
    assert texts_of_rows(table(), True) == []


@pytest.mark.parametrize(
    ("head", "found"),
    [
        ("Byte | Name", range(1, 2)),
        ("byte | NAME", range(1, 2)),
        ("Byte", range(1, 2)),
        ("* | Name", range(1, 2)),
        ("~^by | ~ame$", range(1, 2)),
        ("Byte | * | *", range(1, 2)),
        ("Byte | Name | Type | *", None),
        ("Name", None),
        ("Byte | Type", None),
        ("~^yte", None),
        ("Bytes", None),
        ("none", range(0)),
        ("", range(0)),
    ],
)
def test_a_head_is_the_beginning_of_a_row(head, found):
    rows = [["Motor"], ["Byte", "Name", "Type"], ["0", "Mode", "u8"], ["Byte", "Name"]]
    assert heading_rows(rule(head=head), rows) == found


def test_headings_are_in_the_first_six_rows():
    def is_found(row: int) -> bool:
        texts = [["x"]] * (row - 1) + [["Byte", "Name"]]
        return heading_rows(rule(head="Byte | Name"), texts) == range(row - 1, row)

    assert_limits(is_found, least=1, most=6)


def test_headings_in_two_lines_are_joined_if_no_row_has_them():
    texts = [["x", "y"], ["Data", "Name"], ["Type"], ["0", "Mode"]]
    head = "Data Type | Name"
    assert heading_rows(rule(head=head), texts) == range(1, 3)
    assert heading_rows(rule(head=head, head_rows=2), texts) is None
    assert heading_rows(rule(head=head, transpose=True), texts) is None
    assert heading_rows(rule(head=head), [*texts, ["Data Type", "Name"]]) == range(4, 5)
    # The second of both rows is among the first six.
    assert heading_rows(rule(head=head), [["x"]] * 3 + texts) == range(4, 6)
    assert heading_rows(rule(head=head), [["x"]] * 4 + texts) is None


def test_headings_have_as_many_rows_as_the_rule_says():
    assert heading_rows(rule(head="A", head_rows=3), [["x"], ["A"]]) == range(1, 4)


TABLE = table("Byte|Name", "0|Mode", caption="Motor", headings=["4 Motor", "4.2 State"])


@pytest.mark.parametrize(
    ("keys", "reason"),
    [
        ({"head": "Byte | Name"}, ""),
        ({"pages": (1, 2)}, "the source has no pages"),
        ({"conditions": {"caption": "^motor$"}}, ""),
        ({"conditions": {"caption": "wheel"}}, "`caption` does not match: `Motor`"),
        ({"conditions": {"heading": "^4 "}}, ""),
        (
            {"conditions": {"heading": "wheel"}},
            "`heading` does not match: `4.2 State`",
        ),
        ({"conditions": {"before": "x"}}, "`before` does not match; there is none"),
        ({"conditions": {"sheet": "x"}}, "`sheet` does not match; there is none"),
        (
            {"head": "Byte | Type"},
            "the headings differ: `Type` is wanted as cell 2, the table has `Name`",
        ),
        (
            {"head": "Byte | Name | Type"},
            "the headings differ: `Type` is wanted as cell 3, the table has ``",
        ),
        # The row is compared in which most cells agree.
        (
            {"head": "1 | Mode"},
            "the headings differ: `1` is wanted as cell 1, the table has `0`",
        ),
    ],
)
def test_the_reason_is_stated_why_a_rule_does_not_apply(keys, reason):
    assert why_not(rule(**keys), TABLE) == reason


def test_pages_are_those_on_which_a_table_begins():
    def is_read(page: int) -> bool:
        paged = table("A|B", boxes=[PageBox(page, 0, 0, 1, 1), PageBox(9, 0, 0, 1, 1)])
        reason = why_not(rule(head="A", pages=(3, 5)), paged)
        assert reason in ("", f"the table stands on page {page}")
        return not reason

    assert_limits(is_read, least=3, most=5)


def test_texts_in_reasons_are_shortened():
    long = table("x" * 50, "y" * 50, caption="c" * 60)
    reason = why_not(rule(conditions={"caption": "z"}), long)
    assert reason == f"`caption` does not match: `{'c' * 50}`"
    reason = why_not(rule(head="A"), long)
    assert reason.endswith(f"the table has `{'x' * 40}`")
    assert why_not(rule(head="A"), table()).endswith("cell 1, the table has ``")


def names(rules, tables) -> list[list[str]]:
    return [[r.name for r in choice.rules] for choice in choose(rules, tables)]


def test_the_first_rule_that_fits_reads_a_table_and_rules_with_also_before_it():
    rules = [
        rule("a", head="B"),
        rule("b", head="A", also=True),
        rule("c", head="A"),
        rule("d", head="A", also=True),
    ]
    (choice,) = choose(rules, [table("A")])
    assert [r.name for r in choice.rules] == ["b", "c"]
    reason = "the headings differ: `B` is wanted as cell 1, the table has `A`"
    assert choice.reasons == [(rules[0], reason)]
    assert names(rules[3:], [table("A"), table("B")]) == [["d"], []]


def test_nth_counts_the_tables_that_fulfil_the_other_conditions():
    rules = [rule("a", head="A", nth=2), rule("b", head="A")]
    tables = [table("A"), table("B"), table("A"), table("A")]
    assert names(rules, tables) == [["b"], [], ["a"], ["b"]]
    choices = choose(rules, tables)
    assert [choices[n].reasons[0][1] for n in (0, 3)] == [
        "it is number 1 of the tables that fit, `nth` is 2",
        "it is number 3 of the tables that fit, `nth` is 2",
    ]
