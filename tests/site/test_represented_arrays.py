"""Arrays that a page represents by one element, with numbers and names of fields."""

from __future__ import annotations

from icdgen.backends.html.repeats import Repeat, Repeats
from tests.icd.files import loaded, status

STRUCTS = """\
structs:
  - {name: Cell, length: 2, fields: [
      {at: 0, bits: 8, name: X, type: uint}, {at: 8, bits: 8, name: Z, type: uint}]}
  - {name: Row, length: 5, fields: [
      {at: 0, name: Cells, struct: Cell, count: 2}, {at: 32, bits: 8, name: End, type: uint}]}
"""


def repeats_of(folder, text):
    result = loaded(folder, text)
    assert result.ok, [finding.message for finding in result.findings]
    (node,) = result.icd.nodes
    return Repeats(node.messages[0], node)


def shown(repeats):
    return [(field.key, field.name, field.short) for field in repeats.fields]


def test_fields_behind_an_array_keep_their_numbers(tmp_path):
    text = STRUCTS + status(
        "at: 0, bits: 8, name: Head, type: uint",
        "at: 8, name: Rows, struct: Row, count: 3",
        "at: 128, name: Single, struct: Cell",
        "at: 144, bits: 8, name: Pair, type: uint, count: 2",
        length=20,
    )
    repeats = repeats_of(tmp_path, text)
    assert repeats.arrays == [
        Repeat("Rows", 1, 5, 3, "3"),
        Repeat("Rows[].Cells", 1, 2, 2, "2"),
    ]
    assert [array.end for array in repeats.arrays] == [16, 5]
    assert repeats.names == {"Rows", "Rows[0].Cells"}
    assert shown(repeats) == [
        (1, "Head", "Head"),
        (2, "Rows[].Cells[].X", "X"),
        (3, "Rows[].Cells[].Z", "Z"),
        (6, "Rows[].End", "End"),
        (17, "Single.X", "Single.X"),
        (18, "Single.Z", "Single.Z"),
        (19, "Pair[0]", "Pair[0]"),
        (20, "Pair[1]", "Pair[1]"),
    ]
    assert repeats.keys_between(8, 136) == [2, 3, 6, 17]
    assert repeats.keys_between(9, 128) == [3, 6]


def test_a_variable_length_array_has_its_numbers_of_elements(tmp_path):
    text = status(
        "at: 0, bits: 8, name: Last, type: uint",
        "at: 8, bits: 8, name: Levels, type: uint, count: {field: Last, plus: 1}, up_to: 4",
        length=1,
    )
    repeats = repeats_of(tmp_path, text)
    assert repeats.arrays == [Repeat("Levels", 1, 1, 4, "1 to 4")]
    assert shown(repeats) == [(1, "Last", "Last"), (2, "Levels", "Levels")]


def test_only_arrays_that_share_bits_show_all_elements(tmp_path):
    text = (
        STRUCTS
        + status(
            "at: 0, name: First, struct: Cell, count: 2",
            "at: 32, name: Second, struct: Cell, count: 2",
            "at: 56, bits: 8, name: Over, type: uint, view: true",
            "at: 64, name: Third, struct: Cell, count: 2",
            length=12,
        )
        + "    derived:\n      - {name: Double, formula: Over*2}\n"
    )
    repeats = repeats_of(tmp_path, text)
    assert [array.name for array in repeats.arrays] == ["First", "Third"]
    assert [name for _, name, _ in shown(repeats)] == [
        "First[].X",
        "First[].Z",
        "Second[0].X",
        "Second[0].Z",
        "Second[1].X",
        "Second[1].Z",
        "Over",
        "Third[].X",
        "Third[].Z",
        "Double",
    ]


def test_a_count_without_bits_does_not_overlap_the_array_behind_it(tmp_path):
    text = status(
        "at: 0, bits: 8, name: Levels, type: uint, count: rest, up_to: 3", length=0
    )
    assert repeats_of(tmp_path, text).arrays == [Repeat("Levels", 0, 1, 3, "0 to 3")]


def test_reserved_bits_are_those_of_the_shown_elements(tmp_path):
    text = STRUCTS.replace("length: 2", "length: 3").replace(
        "at: 32, bits", "at: 48, bits"
    ).replace("length: 5", "length: 7") + status(
        "at: 8, name: Cells, struct: Cell, count: 4",
        "at: 104, name: Row, struct: Row",
        length=20,
    )
    repeats = repeats_of(tmp_path, text)
    gaps = [(gap.at, gap.bits) for gap in repeats.gaps]
    assert gaps == [(0, 8), (24, 8), (120, 8)]
