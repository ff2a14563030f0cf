"""Changes of structs: names and types in generated code, count and distance."""

from __future__ import annotations

import pytest

from icdgen.diff.changes.structs import _in_words, _renamed
from icdgen.diff.generated import Name
from tests.diff.cases import compared_texts, rows_of

STRUCTS = """\
structs:
  - {name: Point, length: 2, fields: [{at: 0, bits: 8, name: Left, type: uint}, {at: 8, bits: 8, name: Right, type: uint}]}
"""
STATUS = """\
messages:
  - name: Status
    id: 130
    kind: telemetry
    length: 12
    fields:
"""


def icd(*fields: str, structs: str = STRUCTS) -> str:
    return structs + STATUS + "".join(f"      - {{{field}}}\n" for field in fields)


def rows(folder, old: str, new: str, *codes: str) -> list[tuple]:
    return rows_of(compared_texts(folder, old, new, is_checked=False), *codes)


TWO_USES = "`Spot 1.West` of `Status`, `Spot 2.West` of `Status`"
ONE, FOUR = (
    "at: 0, name: Spot, struct: Point",
    "at: 0, name: Spots, struct: Point, count: 4",
)


def test_a_use_of_a_struct_that_is_new_or_gone_is_reported(tmp_path):
    other = "at: 64, name: Home, struct: Point"
    (row,) = rows(tmp_path, icd(FOUR), icd(FOUR, other), "DIF314")
    assert row[1:5] + row[7:] == (
        "addition",
        "1 struct in `Status` is new",
        "",
        "Home: Point",
        "`Home: Point` is new",
    )
    (row,) = rows(tmp_path, icd(FOUR, other), icd(FOUR), "DIF314")
    assert row[1:5] + row[7:] == (
        "error",
        "1 struct in `Status` is declared otherwise",
        "Home: Point",
        "",
        "`Home: Point` is gone",
    )


def test_each_use_of_a_struct_with_another_count_is_listed(tmp_path):
    other = "at: 64, name: Home, struct: Point"
    new = icd(FOUR.replace("count: 4", "count: 3"), f"{other}, count: 2")
    (row,) = rows(tmp_path, icd(FOUR, other), new, "DIF314")
    assert row[1:5] + row[7:] == (
        "error",
        "2 structs in `Status` are declared otherwise",
        "Spots: 4 x Point, Home: Point",
        "Spots: 3 x Point, Home: 2 x Point",
        "`Spots: 4 x Point` is gone",
        "`Home: Point` is gone",
        "`Spots: 3 x Point` is new",
        "`Home: 2 x Point` is new",
    )


def test_the_number_of_structs_is_that_of_the_removed_ones(tmp_path):
    others = ("at: 64, name: Home, struct: Point", "at: 80, name: Goal, struct: Point")
    (row,) = rows(tmp_path, icd(ONE, *others), icd(FOUR), "DIF314")
    assert row[2] == "3 structs in `Status` are declared otherwise"
    assert row[3:5] == ("Spot: Point, Home: Point, Goal: Point", "Spots: 4 x Point")


def test_another_maximum_of_a_variable_number_of_structs_is_no_other_repetition(
    tmp_path,
):
    text = icd("at: 96, name: Spots, struct: Point, count: rest, up_to: 4")
    other = text.replace("up_to: 4", "up_to: 3")
    assert [row[0] for row in rows(tmp_path, text, other, "DIF119", "DIF127")] == [
        "DIF119"
    ]


@pytest.mark.parametrize(
    ("levels", "words"),
    [
        (((0, 0),), "a struct"),
        (((1, 24),), "1 struct, one every 3 bytes"),
        (((4, 12),), "4 structs, one every 12 bits"),
        (((0, 16),), "structs, one every 2 bytes"),
        (((2, 32), (0, 0)), "2 structs, one every 4 bytes, in each of them a struct"),
    ],
)
def test_the_repetition_of_a_struct_in_words(levels, words):
    assert _in_words(levels) == words


def test_each_repeated_struct_of_a_message_is_reported_once(tmp_path):
    fields = (
        "at: 0, name: First, struct: Point, count: 2",
        "at: 48, name: Second, struct: Point, count: 2",
    )
    wider = STRUCTS.replace("length: 2", "length: 3")
    found = rows(tmp_path, icd(*fields), icd(*fields, structs=wider), "DIF127")
    now, was = "2 structs, one every 3 bytes", "2 structs, one every 2 bytes"
    assert [row[1:7] for row in found] == [
        ("error", f"`{name}` is {now}, was {was}", was, now, "Point", "Point")
        for name in ("First", "Second")
    ]


def test_a_struct_that_is_new_or_gone_has_names_of_generated_code(tmp_path):
    more = "  - {name: Extra, length: 1, fields: [{at: 0, bits: 8, name: Z, type: uint}]}\n"
    new = icd(ONE, structs=STRUCTS + more)
    (row,) = rows(tmp_path, icd(ONE), new, "DIF313")
    assert row[1:7] == (
        "addition", "the struct `Extra` is new", "", "Extra", None, "Extra"
    )  # fmt: skip
    assert row[7].startswith("C: `demo_extra_t`") and "->" not in " ".join(row[7:])
    (gone,) = rows(tmp_path, new, icd(ONE), "DIF313")
    assert gone[1:7] == (
        "error", "the struct `Extra` is gone", "Extra", "", "Extra", None
    )  # fmt: skip
    assert gone[7:] == row[7:]


def test_another_type_of_a_member_is_a_declaration_in_c(tmp_path):
    signed = STRUCTS.replace("name: Right, type: uint", "name: Right, type: int")
    (row,) = rows(tmp_path, icd(ONE), icd(ONE, structs=signed), "DIF313")
    assert row[1:] == (
        "error",
        "the struct `Point` has other generated names or types",
        "Point",
        "Point",
        "Point",
        "Point",
        "C: `uint8_t right` -> `int8_t right`",
    )


def test_names_of_the_same_member_are_paired():
    a, b, c, d = (Name("c", text) for text in "abcd")
    assert list(_renamed({0: [a], 8: [b]}, {0: [c], 8: [b]})) == [(a, c)]
    # Another number of names: which became which is not known.
    assert list(_renamed({0: [a]}, {0: [c, d]})) == [(a, None), (None, c), (None, d)]
    assert list(_renamed({8: [a], 0: [b]}, {})) == [(b, None), (a, None)]
    # A name that moved to another member is unchanged.
    assert list(_renamed({0: [a], 8: [b]}, {0: [b], 8: [a]})) == []


@pytest.mark.parametrize(
    ("uses", "words"),
    [
        (1, ()),
        (2, ("The same of `Spot 1.West` of `Status`.",)),
        (
            4,
            (
                "The same of `Spot 1.West` of `Status`, `Spot 2.West` of `Status` and "
                "`Spot 3.West` of `Status`.",
            ),
        ),
        (5, (f"The same of {TWO_USES} and 2 more.",)),
        (6, (f"The same of {TWO_USES} and 3 more.",)),
    ],
)
def test_a_change_of_a_struct_lists_up_to_three_other_uses(uses, words, tmp_path):
    spots = [f"at: {16 * n}, name: Spot {n}, struct: Point" for n in range(uses)]
    old = icd(*spots)
    new = old.replace("name: Left", "name: West")
    (change,) = [
        change
        for change in compared_texts(tmp_path, old, new, is_checked=False).changes
        if change.where.field and "West" in str(change)
    ]
    assert change.details == words
