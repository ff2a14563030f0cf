"""Composite messages: where repeated frames end, how their fields are compared, and
list tables of the manual.
"""

from __future__ import annotations

import pytest

from icdgen.icd.rules import composites  # noqa: F401
from tests.icd.rules.rows import messages, rows
from tests.limits import assert_limits

MODE = "enums:\n  - {name: Mode, members: [{value: 0, name: Idle}]}\n  - {name: State, members: [{value: 0, name: Idle}]}\n"


def message(
    name: str, id: int, *fields: str, length: int = 2, contains: str = ""
) -> str:
    """Return a message; its fields begin in the line after its name."""
    parts = f"contains: [{contains}], " if contains else ""
    rows = ",\n".join(f"      {{{field}}}" for field in fields)
    head = f"  - {{name: {name}, id: {id}, kind: telemetry, length: {length}, {parts}"
    return f"{head}fields: [\n{rows}]}}\n"


def pair(part: str, composite: str) -> str:
    """Return a message `Part` with one field, and one that repeats it at its bit 0."""
    return (
        f"{MODE}messages:\n"
        + message("Part", 1, f"at: 0, name: Part 1, {part}")
        + message(
            "All",
            2,
            f"at: 0, name: All 1, {composite}",
            contains="{message: Part, at: 0}",
        )
    )


INT = "bits: 16, type: int"


@pytest.mark.parametrize(
    ("part", "composite", "column", "values"),
    [
        (f"{INT}, unit: V", f"{INT}, unit: mV", 55, "unit `mV` here, `V` there"),
        (f"{INT}, unit: V", INT, 7, "unit absent here, `V` there"),
        (INT, f"{INT}, unit: V", 55, "unit `V` here, absent there"),
        ("bits: 16, type: uint", INT, 44, "type `int` here, `uint` there"),
        (
            "bits: 16, type: enum, enum: Mode",
            "bits: 16, type: enum, enum: State",
            56,
            "enum `State` here, `Mode` there",
        ),
        (
            f"{INT}, formula: raw^2",
            f"{INT}, formula: raw^3",
            58,
            "formula `raw^3` here, `raw^2` there",
        ),
        (
            f"{INT}, points: [[0, 1], [1, 2]], outside: clamp",
            f"{INT}, points: [[0, 1], [1, 3]], outside: refuse",
            57,
            "points `[[0, 1], [1, 3]]` here, `[[0, 1], [1, 2]]` there; "
            "outside `refuse` here, `clamp` there",
        ),
        (INT, f"{INT}, byte_order: big", 61, "byte_order `big` here, `little` there"),
        (
            f"{INT}, byte_order: big, bit_order: msb0, unit: V",
            "bits: 12, type: uint, formula: raw*2, unit: A",
            34,
            "bits `12` here, `16` there; type `uint` here, `int` there; "
            "unit `A` here, `V` there; formula `raw*2` here, absent there; "
            "byte_order `little` here, `big` there; bit_order `lsb0` here, `msb0` there",
        ),
    ],
)
def test_all_attributes_that_differ_are_named_at_the_first(
    tmp_path, part, composite, column, values
):
    assert rows(tmp_path, pair(part, composite), "ICD047") == [
        f"10:{column} `All 1` differs from `Part 1` in `Part` (line 8): {values}"
    ]


@pytest.mark.parametrize(
    ("part", "composite", "is_equal"),
    [
        ("formula: raw*0.01", "formula: raw/100", True),
        ("formula: raw*0.01", "formula: raw/101", False),
        ("formula: raw*1", "unit: V, formula: raw", False),
        ("formula: raw", "", False),
        ("summary: One.", "summary: Two.", True),
        ("byte_order: little", "", True),
        ("min: 3", "", True),
    ],
)
def test_formulas_are_compared_by_their_scale(tmp_path, part, composite, is_equal):
    text = pair(f"{INT}, {part}".rstrip(", "), f"{INT}, {composite}".rstrip(", "))
    assert (rows(tmp_path, text, "ICD047") == []) == is_equal


@pytest.mark.parametrize(
    ("field", "differences"),
    [
        ("at: 0, bits: 16, type: uint", ["byte_order `little` here, `big` there"]),
        ("at: 0, bits: 16, type: bytes", []),
        ("at: 8, bits: 8, type: uint", []),
        ("at: 8, bits: 4, type: uint", ["bit_order `lsb0` here, `msb0` there"]),
        (
            "at: 4, bits: 8, type: uint",
            [
                "byte_order `little` here, `big` there; bit_order `lsb0` here, `msb0` there"
            ],
        ),
        ("at: 0, bits: 16, type: uint, byte_order: big", []),
    ],
)
def test_orders_in_effect_are_compared_where_bits_depend_on_them(
    tmp_path, field, differences
):
    """The part is in an included file with other orders."""
    orders = "byte_order: big, bit_order: msb0"
    head = f"icdgen: 1\nnode: {{name: base, title: Base, {orders}}}\nmessages:\n"
    composite = message(
        "All", 2, f"name: X, {field}", contains="{message: Part, at: 0}"
    )
    part = message("Part", 1, f"name: X, {field}")
    text = f"include: [base.yaml]\nmessages:\n{composite}# base.yaml\n{head}{part}"
    start = "`X` differs from `X` in `Part` (base.yaml:5): "
    assert messages(tmp_path, text, "ICD047") == [start + each for each in differences]
    # The message declares the orders of the included file.
    text = text.replace("name: All,", f"name: All, {orders},", 1)
    assert messages(tmp_path, text, "ICD047") == []


def test_a_repeated_frame_ends_at_most_with_the_message(tmp_path):
    def is_accepted(at: int) -> bool:
        field = "at: 0, bits: 16, name: Voltage, type: uint"
        text = "messages:\n" + message("Part", 1, field)
        part = f"{{message: Part, at: {at}}}"
        text += message("All", 2, field, length=4, contains=part)
        return messages(tmp_path, text, "ICD046") != [
            f"`Part` ends at bit {at + 16}, but `All` has 32 bits"
        ]

    assert_limits(is_accepted, most=16)


def test_numbers_of_bits_are_grouped(tmp_path):
    field = "at: 0, bits: 8000, name: Octets, type: bytes"
    part = "{message: Part, at: 1}"
    text = "messages:\n" + message("Part", 1, field, length=1000)
    text += message("All", 2, field, length=1000, contains=part)
    assert messages(tmp_path, text, "ICD046") == [
        "`Part` ends at bit 8,001, but `All` has 8,000 bits"
    ]


def test_each_message_of_a_circle_is_reported(tmp_path):
    """A message that only repeats one of them is not."""
    field = "at: 0, bits: 16, name: Voltage, type: uint"
    text = "messages:\n"
    for id, (name, part) in enumerate(("AB", "BC", "CD", "DB")):
        text += message(name, id, field, contains=f"{{message: {part}, at: 0}}")
    assert messages(tmp_path, text, "ICD046") == [
        "`B` contains itself, in `C`",
        "`C` contains itself, in `D`",
        "`D` contains itself, in `B`",
    ]


def fields(*positions: int, bits: int = 8) -> list[str]:
    return [f"at: {at}, bits: {bits}, name: F{at}, type: uint" for at in positions]


@pytest.mark.parametrize(
    ("missing", "listed"),
    [
        (1, "`F0` (bit 8)"),
        (2, "`F0` (bit 8) and `F8` (bit 16)"),
        (3, "`F0` (bit 8), `F8` (bit 16) and `F16` (bit 24)"),
        (4, "`F0` (bit 8), `F8` (bit 16), `F16` (bit 24) and 1 more"),
        (6, "`F0` (bit 8), `F8` (bit 16), `F16` (bit 24) and 3 more"),
    ],
)
def test_at_most_three_fields_that_the_message_lacks_are_named(
    tmp_path, missing, listed
):
    bits = [at * 8 for at in range(6)]
    text = "messages:\n" + message("Part", 1, *fields(*bits), length=6)
    own = fields(*(bit + 8 for bit in bits[missing:]))
    contains = "{message: Part, at: 8}"
    text += message(
        "All",
        2,
        "at: 0, bits: 8, name: Count, type: uint",
        *own,
        length=7,
        contains=contains,
    )
    assert rows(tmp_path, text, "ICD047") == [
        f"11:83 `All` repeats `Part`, but no field begins where {listed} should begin"
    ]


def test_only_fields_with_bits_in_the_repeated_frame_are_compared(tmp_path):
    """Fields that end where it begins, or begin where it ends, are not in it."""
    text = "messages:\n" + message("Part", 1, *fields(0, 8))
    contains = "{message: Part, at: 8}"
    inside = [each.replace("F", "G") for each in fields(8, 16)]
    text += message(
        "All", 2, *fields(0), *inside, *fields(24), length=4, contains=contains
    )
    assert rows(tmp_path, text, "ICD047") == []
    crossing = [
        "at: 7, bits: 2, name: A, type: uint",
        "at: 23, bits: 2, name: B, type: uint",
    ]
    text = "messages:\n" + message("Part", 1, *fields(0, 8))
    text += message("All", 2, *crossing, length=4, contains=contains)
    assert messages(tmp_path, text, "ICD047") == [
        "`All` repeats `Part`, but no field begins where `F0` (bit 8) and `F8` (bit 16) "
        "should begin",
        "`A` crosses bit 8, where `Part` begins",
        "`B` begins at bit 23, which is bit 15 of `Part`, where no field begins",
    ]


ARRAY = "at: 0, bits: 8, count: {}, name: Levels, type: {}"


@pytest.mark.parametrize(
    ("own", "expected"),
    [
        (ARRAY.format(4, "uint"), []),
        (
            ARRAY.format(4, "int"),
            [
                "`Levels[0]` differs from `Levels[0]` in `Part` (line 5): type `int` here, "
                "`uint` there"
            ],
        ),
        (
            ARRAY.format(3, "uint"),
            [
                "`All` repeats `Part`, but no field begins where `Levels[3]` (bit 24) should "
                "begin"
            ],
        ),
        (
            "at: 4, bits: 8, count: 3, name: Levels, type: uint",
            [
                "`All` repeats `Part`, but no field begins where `Levels[0]` (bit 0), "
                "`Levels[1]` (bit 8), `Levels[2]` (bit 16) and 1 more should begin",
                "`Levels[0]` begins at bit 4, which is bit 4 of `Part`, where no field begins",
            ],
        ),
    ],
)
def test_an_array_is_reported_once(tmp_path, own, expected):
    text = "messages:\n" + message("Part", 1, ARRAY.format(4, "uint"), length=4)
    text += message("All", 2, own, length=4, contains="{message: Part, at: 0}")
    assert messages(tmp_path, text, "ICD047") == expected


def test_overlay_fields_have_no_counterpart(tmp_path):
    overlay = "at: 4, bits: 4, name: High, type: uint, view: true"
    plain = message("Part", 1, *fields(0), length=1)
    for part, own in ((overlay, ""), ("", overlay)):
        text = "messages:\n"
        text += message("Part", 1, *fields(0), *filter(None, [part]), length=1)
        text += message(
            "All",
            2,
            *fields(0),
            *filter(None, [own]),
            length=1,
            contains="{message: Part, at: 0}",
        )
        assert plain and rows(tmp_path, text, "ICD047") == []


@pytest.mark.parametrize(
    ("listed", "expected"),
    [
        ("{id: 0x0105}", []),
        ("{id: [1, 5]}", []),
        ("{id: 261}", []),
        ("{id: 0x0106}", ["the id `0x0106`, the detail table `0x01 0x05`"]),
        ("{id: [1, 6]}", ["the id `0x01 0x06`, the detail table `0x01 0x05`"]),
        ("{set_id: 0x05}", ["the set id `0x05`, the detail table none"]),
        ("{length: 0x05}", ["the length `5`, the detail table `0`"]),
        (
            "{length: 1, name: Stat}",
            [
                "the length `1`, the detail table `0`",
                "the name `Stat`, the detail table `Status`",
            ],
        ),
    ],
)
def test_ids_of_list_tables_are_compared_as_numbers(tmp_path, listed, expected):
    text = f"""\
icdgen: 1
node: {{name: demo, title: Demo, byte_order: little, bit_order: lsb0, id_bits: 16}}
messages:
  - {{name: Status, id: [1, 5], kind: telemetry, length: 0, listed: {listed}}}
"""
    assert messages(tmp_path, text, "ICD048") == [
        f"the list table gives `Status` {values}" for values in expected
    ]
