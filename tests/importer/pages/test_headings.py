"""Heading rows are recognized by the vocabulary of a profile."""

from __future__ import annotations

import pytest

from icdgen.importer import profile
from icdgen.importer.pages.draft import HeadingRow
from icdgen.importer.pages.headings import match_headings, repeats_headings, segmented

WORDS = profile.load()


def roles_of(row: str, loose: bool = False) -> tuple[str, list[str]] | None:
    cells = row.split("|")
    header = match_headings(cells, WORDS, loose)
    if header is None:
        return None
    assert header.titles == cells
    return header.kind, header.roles


@pytest.mark.parametrize(
    ("row", "kind", "roles"),
    [
        ("Byte|Name|Type", "fields", ["at_bytes", "name", "type"]),
        ("OFFSET [BITS]|Signal|Bits", "fields", ["at", "name", "bits"]),
        ("Value|Name|Description", "enumeration", ["value", "name", "description"]),
        ("ID|Name|Bytes", "list", ["id", "name", "length"]),
        ("Log Bit|Frame ID", "loggable", ["bit", "id"]),
        # In a table of bytes, the meaning is the name.
        ("Byte|Meaning", "fields", ["at_bytes", "name"]),
        ("Byte|Name|Meaning", "fields", ["at_bytes", "name", "description"]),
        # Each role is that of one column.
        ("Byte|Name|Parameter", "fields", ["at_bytes", "name", ""]),
        # More known headings, or fewer unknown ones, decide.
        ("Value|Name|Colour", "enumeration", ["value", "name", ""]),
        ("Byte|Name|Colour", "fields", ["at_bytes", "name", ""]),
        # The title of all fields is no unknown heading.
        ("Byte|Name|Payload|Colour", "fields", ["at_bytes", "name", "", ""]),
        ("Byte||Name", "fields", ["at_bytes", "", "name"]),
    ],
)
def test_a_row_has_the_kind_that_explains_most_of_its_headings(row, kind, roles):
    assert roles_of(row) == (kind, roles)


@pytest.mark.parametrize(
    "row",
    [
        "Byte",
        "Byte|",
        "Byte|Name|3",
        "0x10|Name|Byte",
        "Colour|Shape",
        "Byte|Name|Colour|Shape",
        "Name|Type",
        "Name|Type|Description",
        "Value|Colour",
    ],
)
def test_values_unknown_words_and_incomplete_headings_are_no_heading_row(row):
    assert roles_of(row) is None


def test_only_a_loose_search_finds_fields_without_offsets():
    row = "Name|Type|Description"
    assert roles_of(row, loose=True) == ("fields", ["name", "type", "description"])
    # Another kind of table is preferred to fields without offsets: it explains as much.
    row = "Name|Value|Type"
    assert roles_of(row, loose=True) == ("enumeration", ["name", "value", ""])


@pytest.mark.parametrize(
    ("text", "segments"),
    [
        ("Byte Name Type", [([0], True), ([1], True), ([2], True)]),
        # The longest heading that begins at a word.
        ("Start Byte Field Name Data Type", [([0, 1], True), ([2, 3], True), ([4, 5], True)]),
        ("Value after Reset Byte Name", [([0, 1, 2], True), ([3], True), ([4], True)]),
        ("Byte of Name Type", [([0], True), ([1], False), ([2], True), ([3], True)]),
        ("Value Name", [([0], True), ([1], True)]),
        ("the byte order", None),
        ("Byte", None),
        ("", None),
    ],
)  # fmt: skip
def test_words_of_a_line_are_divided_into_headings(text, segments):
    assert segmented(text.split(), WORDS) == segments


HEADER = HeadingRow(
    "fields",
    ["at", "bits", "name", ""],
    ["Offset (bits)", "Size (bits)", "Name", "Colour"],
)


@pytest.mark.parametrize(
    ("row", "is_repeated"),
    [
        ("Offset (bits)|Size (bits)|Name|Colour", True),
        ("OFFSET (BITS)||SIZE (bits)|Name|Colour", True),
        # Some of the headings, but not a single one.
        ("Name|Colour", True),
        ("|Name||", False),
        ("Name|Shape", False),
        # The second line of wrapped headings, in their order.
        ("(bits)|(bits)", True),
        ("(bits)", False),
        ("(bits)|(bits)|(bits)", False),
        ("(bits)|Shape", False),
        # Other words for the same columns.
        ("Start Bit|Width|Signal|Shape", True),
        ("Start Bit|Width|Shape", False),
        ("Start Byte|Width|Signal", False),
        ("Width|Start Bit|Signal", False),
        ("Name|0", False),
        ("||", False),
    ],
)
def test_cells_repeat_the_headings_of_a_table(row, is_repeated):
    assert repeats_headings(row.split("|"), HEADER, WORDS) == is_repeated


def test_lower_halves_of_headings_are_in_the_order_of_the_headings():
    titles = ["Start Byte", "Mode Name", "Data Type"]
    header = HeadingRow("rule 1", ["a", "b", "c"], titles)
    assert repeats_headings(["Byte", "Type"], header, WORDS)
    assert not repeats_headings(["Type", "Byte"], header, WORDS)
