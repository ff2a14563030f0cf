"""Initial values and checks of members in C, also within arrays and structs."""

from __future__ import annotations

import pytest

from icdgen.backends.c.members import excess, initial_statements, misfits
from tests.describe.small import message_of

STRUCTS = """\
structs:
  - name: Pair
    length: 2
    fields:
      - {at: 0, bits: 4, name: Low, type: uint, const: 3, count: 2}
      - {at: 8, bits: 5, name: High, type: int}
  - name: Pairs
    length: 5
    fields:
      - {at: 0, name: Inner, struct: Pair, count: 2}
      - {at: 32, bits: 8, name: Sum, type: uint, const: 7}
"""


def test_only_members_with_a_value_other_than_0_are_set(tmp_path):
    message = message_of(
        tmp_path,
        "at: 0, bits: 8, name: Kind, type: uint, const: 9",
        "at: 8, bits: 8, name: Mode, type: uint",
        "at: 16, bits: 8, name: Marks, type: uint, count: 3, const: 5",
        "at: 40, bits: 8, name: Single, type: uint, count: 1, const: 6",
        "at: 48, name: One, struct: Pair",
        "at: 64, name: Many, struct: Pairs, count: 2",
        length=18,
        head=STRUCTS,
    )
    assert initial_statements(message) == [
        "message->kind = DEMO_STATUS_KIND_CONST;",
        "for (size_t element = 0u; element < 3u; element++) {",
        "    message->marks[element] = DEMO_STATUS_MARKS_CONST;",
        "}",
        "message->single[0] = DEMO_STATUS_SINGLE_CONST;",
        "for (size_t element = 0u; element < 2u; element++) {",
        "    message->one.low[element] = DEMO_PAIR_LOW_CONST;",
        "}",
        "for (size_t element = 0u; element < 2u; element++) {",
        "    for (size_t element_2 = 0u; element_2 < 2u; element_2++) {",
        "        for (size_t element_3 = 0u; element_3 < 2u; element_3++) {",
        "            message->many[element].inner[element_2].low[element_3] = "
        "DEMO_PAIR_LOW_CONST;",
        "        }",
        "    }",
        "    message->many[element].sum = DEMO_PAIRS_SUM_CONST;",
        "}",
    ]


@pytest.mark.parametrize(
    ("plus", "statements"),
    [
        (0, []),
        (-2, ["message->last = 2u;"]),
        (
            2,
            [
                "for (size_t element = 0u; element < 2u; element++) {",
                "    message->data[element] = DEMO_STATUS_DATA_CONST;",
                "}",
            ],
        ),
        (1, ["message->data[0] = DEMO_STATUS_DATA_CONST;"]),
    ],
)
def test_a_new_message_has_the_fewest_elements(tmp_path, plus, statements):
    message = message_of(
        tmp_path,
        "at: 0, bits: 8, name: Last, type: uint",
        "at: 8, bits: 8, name: Data, type: uint, const: 3, "
        f"count: {{field: Last, plus: {plus}}}, up_to: 5",
        length=1,
    )
    assert initial_statements(message) == statements


def narrow_members(folder):
    return message_of(
        folder,
        "at: 0, bits: 5, name: 'Say \"A\"', type: uint",
        "at: 8, bits: 8, name: Byte, type: uint",
        "at: 16, bits: 4, name: Levels, type: uint, count: 2",
        "at: 24, name: Many, struct: Pair, count: 2",
        "at: 56, bits: 8, name: Last, type: uint",
        "at: 64, name: Rest, struct: Pair, count: {field: Last, plus: 1}, up_to: 3",
        length=8,
        head=STRUCTS,
    )


def test_the_name_of_the_first_field_with_a_value_beyond_it_is_returned(tmp_path):
    message = narrow_members(tmp_path)
    assert misfits(message, is_last_part=False) == [
        "if ((message->say_a & 0xE0u) != 0u) {",
        '    return "Say \\"A\\"";',
        "}",
        "for (size_t element = 0u; element < 2u; element++) {",
        "    if ((message->levels[element] & 0xF0u) != 0u) {",
        '        return "Levels";',
        "    }",
        "}",
        "for (size_t element = 0u; element < 2u; element++) {",
        "    for (size_t element_2 = 0u; element_2 < 2u; element_2++) {",
        "        if ((message->many[element].low[element_2] & 0xF0u) != 0u) {",
        '            return "Many[].Low";',
        "        }",
        "    }",
        "    if (((ICDGEN_U32(message->many[element].high) + 0x00000010u) & "
        "0xFFFFFFE0u) != 0u) {",
        '        return "Many[].High";',
        "    }",
        "}",
    ]
    (first, *_) = misfits(message, is_last_part=True)
    assert first == (
        "for (size_t element = 0u; element < (ICDGEN_SIZE(message->last) + 1u); "
        "element++) {"
    )


def test_bits_beyond_all_fields_are_gathered_with_the_last_part_at_the_end(tmp_path):
    high = "(ICDGEN_U32(message->{}[element].high) + 0x00000010u) & 0xFFFFFFE0u"
    assert excess(narrow_members(tmp_path)) == [
        "excess |= message->say_a & 0xE0u;",
        "for (size_t element = 0u; element < 2u; element++) {",
        "    excess |= message->levels[element] & 0xF0u;",
        "}",
        "for (size_t element = 0u; element < 2u; element++) {",
        "    for (size_t element_2 = 0u; element_2 < 2u; element_2++) {",
        "        excess |= message->many[element].low[element_2] & 0xF0u;",
        "    }",
        f"    excess |= {high.format('many')};",
        "}",
        "for (size_t element = 0u; element < (ICDGEN_SIZE(message->last) + 1u); "
        "element++) {",
        "    for (size_t element_2 = 0u; element_2 < 2u; element_2++) {",
        "        excess |= message->rest[element].low[element_2] & 0xF0u;",
        "    }",
        f"    excess |= {high.format('rest')};",
        "}",
    ]


def test_a_message_whose_types_store_only_values_of_its_fields_has_no_checks(
    tmp_path,
):
    message = message_of(
        tmp_path,
        "at: 0, bits: 8, name: Byte, type: uint",
        "at: 9, bits: 1, name: Flag, type: bool",
        "at: 16, bits: 32, name: Rate, type: float",
        "at: 48, bits: 24, name: Bytes, type: bytes",
        length=9,
    )
    assert excess(message) == []
    assert misfits(message, False) == misfits(message, True) == []
