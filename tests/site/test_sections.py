"""Sections of the page of a message: their bytes, titles and numbers of fields."""

from __future__ import annotations

import pytest

from icdgen.backends.html import sections
from icdgen.backends.html.relations import Relations
from icdgen.backends.html.sections import MessageSection
from tests.icd.files import loaded, status


def sections_of(folder, text, name="Status"):
    """Return the sections of a message by its parts, else by its number of fields."""
    result = loaded(folder, text)
    assert result.ok, [finding.message for finding in result.findings]
    relations = Relations(result.icd)
    (message,) = (m for m in result.icd.nodes[0].messages if m.name == name)
    parts = sections.part_sections(relations, message)
    return parts or sections.field_sections(message, relations.links.repeats(message))


def shown(rows):
    return [(s.title, s.first, s.end, s.keys, s.open) for s in rows]


def fields(count, kind="bits: 8, type: uint", step=8, first=0):
    return [f"at: {first + step * n}, {kind}, name: Field {n}" for n in range(count)]


def test_a_message_of_16_fields_has_one_section(tmp_path):
    rows = sections_of(tmp_path, status(*fields(16), length=16))
    assert shown(rows) == [("Fields", 0, 16, [*range(1, 17)], True)]
    assert rows[0].about == "bytes 0 to 15, 16 fields"


def test_a_message_of_17_fields_has_sections_and_only_the_first_is_open(tmp_path):
    rows = sections_of(tmp_path, status(*fields(17), length=17))
    assert shown(rows) == [
        ("Fields 1 to 9", 0, 9, [*range(1, 10)], True),
        ("Fields 10 to 17", 9, 17, [*range(10, 18)], False),
    ]


def test_four_flags_count_as_one_field(tmp_path):
    flags = fields(64, "bits: 1, type: bool", 1)
    assert len(sections_of(tmp_path, status(*flags, length=8))) == 1
    flags.append("at: 64, bits: 1, type: bool, name: Last")
    rows = sections_of(tmp_path, status(*flags, length=9))
    # 65 flags in 7 sections of at most 10 fields.
    assert [len(row.keys) for row in rows] == [10, 10, 10, 10, 10, 10, 5]
    assert [(row.first, row.end) for row in rows[:2]] == [(0, 2), (1, 3)]


def test_derived_values_are_in_the_last_section(tmp_path):
    derived = "".join(
        f"      - {{name: Double {n}, formula: Field 0*2}}\n" for n in range(9)
    )
    text = status(*fields(12), length=12) + f"    derived:\n{derived}"
    rows = sections_of(tmp_path, text)
    assert shown(rows) == [
        ("Fields 1 to 7", 0, 7, [*range(1, 8)], True),
        ("Fields 8 to 14", 7, 12, [*range(8, 15)], False),
        ("Fields 15 to 21", 11, 12, [*range(15, 22)], False),
    ]


COMPOSITE = """\
messages:
  - {name: Mode, id: 0, kind: telemetry, length: 2, fields: [
      {at: 0, bits: 8, name: Mode, type: uint}, {at: 8, bits: 8, name: Level, type: uint}]}
  - name: Status
    id: 255
    kind: telemetry
    length: 6
    contains: [%s]
    fields:
      - {at: 0, bits: 8, name: Head, type: uint}
      - {at: 8, bits: 8, name: Mode, type: uint}
      - {at: 16, bits: 8, name: Level, type: uint}
      - {at: 32, bits: 8, name: Other Mode, type: uint}
      - {at: 40, bits: 8, name: Other Level, type: uint}
    derived:
      - {name: Double, formula: Head*2}
"""


def test_contained_messages_are_sections_between_the_other_bytes(tmp_path):
    text = COMPOSITE % "{at: 32, message: Mode}, {at: 8, message: Mode}"
    rows = sections_of(tmp_path, text)
    assert [
        (*row, section.url) for row, section in zip(shown(rows), rows, strict=True)
    ] == [
        ("Byte 0", 0, 1, [1], True, ""),
        ("Mode", 1, 3, [2, 3], True, "demo/mode.html"),
        ("Byte 3", 3, 4, [], True, ""),
        ("Mode", 4, 6, [4, 5, 6], True, "demo/mode.html"),
    ]
    assert [row.about for row in rows] == [
        "1 field",
        "bytes 1 to 2, 2 fields",
        "0 fields",
        "bytes 4 to 5, 3 fields",
    ]


@pytest.mark.parametrize(
    ("section", "about"),
    [
        (MessageSection("Byte 3", 3, 4, [1]), "1 field"),
        (MessageSection("Bytes 3 to 4", 3, 5, [1, 2]), "2 fields"),
        (MessageSection("Levels", 3, 5, [1]), "bytes 3 to 4, 1 field"),
        (MessageSection("Derived values", 5, 5, [7]), "1 field"),
        (
            MessageSection("Levels × 3", 8, 20, [1, 2, 3], is_element=True),
            "12 bytes each, from byte 8, 3 fields",
        ),
        (
            MessageSection("Levels × 3", 0, 1, [1], is_element=True),
            "1 byte each, from byte 0, 1 field",
        ),
    ],
)
def test_a_section_says_where_it_is_and_how_many_fields_it_has(section, about):
    assert section.about == about


STRUCTS = """\
structs:
  - {name: Point, length: 3, fields: [
      {at: 0, bits: 8, name: X, type: uint}, {at: 16, bits: 8, name: Height, type: uint}]}
"""


def test_an_array_of_structs_is_a_section_of_its_first_element(tmp_path):
    text = STRUCTS + status(
        "at: 0, bits: 8, name: Head, type: uint",
        "at: 8, name: Points, struct: Point, count: 3",
        length=10,
    )
    text += "    derived:\n      - {name: Double, formula: Head*2}\n"
    rows = sections_of(tmp_path, text)
    assert [row.is_element for row in rows] == [False, True, False]
    assert shown(rows) == [
        ("Byte 0", 0, 1, [1], True),
        ("Points × 3", 1, 4, [2, 3], True),
        ("Derived values", 10, 10, [8], True),
    ]


@pytest.mark.parametrize(("count", "is_represented"), [(16, False), (17, True)])
def test_an_array_of_more_than_16_numbers_is_represented_by_one(
    tmp_path, count, is_represented
):
    field = f"at: 0, bits: 8, name: Levels, type: uint, count: {count}"
    rows = sections_of(tmp_path, status(field, length=count))
    assert (rows[0].title, len(rows[0].keys)) == (
        (f"Levels × {count}", 1) if is_represented else ("Fields", count)
    )


@pytest.mark.parametrize(
    ("field", "length"),
    [("at: 4, bits: 8, count: 20", 21), ("at: 0, bits: 4, count: 20", 10)],
)
def test_elements_that_are_no_bytes_are_all_shown(tmp_path, field, length):
    text = status(f"{field}, name: Levels, type: uint", length=length)
    rows = sections_of(tmp_path, text)
    assert sum(len(row.keys) for row in rows) == 20


def test_an_array_with_an_overlay_shows_all_its_elements(tmp_path):
    fields = (
        "at: 0, bits: 8, name: Levels, type: uint, count: 20",
        "at: 8, bits: 8, name: Second, type: uint, view: true",
    )
    rows = sections_of(tmp_path, status(*fields, length=20))
    assert sum(len(row.keys) for row in rows) == 21
