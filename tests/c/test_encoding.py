"""Encode functions in C write each byte of a frame once, in order."""

from __future__ import annotations

import pytest

from icdgen.backends.c.decoding import groups_of
from icdgen.backends.c.encoding import (
    counted_text,
    encode_statements,
    size_terms,
    write_statements,
)
from icdgen.describe.arrays import all_struct_arrays
from tests.describe.small import message_of, node_of

POINT = """\
structs:
  - name: Point
    length: 4
    fields:
      - {at: 0, bits: 8, name: X, type: uint}
      - {at: 8, bits: 12, name: "Y", type: int}
"""


def encode(message):
    return encode_statements(message, groups_of(message))


@pytest.mark.parametrize(
    ("length", "statements"),
    [
        (0, ["(void)message;", "(void)buffer;"]),
        (1, ["(void)message;", "buffer[0] = 0u;"]),
        (2, ["(void)message;", "(void)memset(&buffer[0], 0, 2u);"]),
    ],
)
def test_a_message_without_fields_writes_zeros(tmp_path, length, statements):
    assert encode(message_of(tmp_path, length=length)) == statements


def test_terms_of_several_fields_are_one_statement_from_the_lowest_bit_up(tmp_path):
    message = message_of(
        tmp_path,
        "at: 5, bits: 3, name: High, type: uint",
        "at: 1, bits: 4, name: Low, type: int",
        "at: 12, bits: 8, name: Across, type: uint",
        "at: 32, bits: 8, name: Word, type: uint",
        "at: 47, bits: 1, name: Flag, type: bool",
        length=9,
    )
    assert encode(message) == [
        "buffer[0] = ICDGEN_U8(((ICDGEN_U8(message->low) & 0x0F) << 1) | "
        "(message->high << 5));",
        "buffer[1] = ICDGEN_U8(message->across << 4);",
        "buffer[2] = ICDGEN_U8(message->across >> 4);",
        "buffer[3] = 0u;",
        "buffer[4] = message->word;",
        "buffer[5] = ICDGEN_U8(message->flag << 7);",
        "(void)memset(&buffer[6], 0, 3u);",
    ]


def test_groups_of_flags_share_their_byte_with_other_fields(tmp_path):
    def flags(names, positions):
        return [
            f"at: {at}, bits: 1, name: '{name}', type: bool"
            for name, at in zip(names, positions, strict=True)
        ]

    message = message_of(
        tmp_path,
        *flags("ABCDEFGH", range(8)),
        "at: 12, bits: 4, name: Level, type: uint",
        *flags("IJKL", (11, 10, 9, 8)),
        *flags("MNOP", range(20, 24)),
        *flags("QRST", range(24, 28)),
        *flags("UVWX", range(28, 32)),
        length=4,
    )
    type = "demo_status_t, message"
    assert encode(message) == [
        f"buffer[0] = ICDGEN_JOIN_8_FLAGS({type}, a, b, c, d, e, f, g, h);",
        f"const int flags_1 = ICDGEN_JOIN_4_FLAGS_FALLING({type}, i, j, k, l);",
        "buffer[1] = ICDGEN_U8(flags_1 | (message->level << 4));",
        f"const int flags_2_4 = ICDGEN_JOIN_4_FLAGS({type}, m, n, o, p);",
        "buffer[2] = ICDGEN_U8(flags_2_4 << 4);",
        f"buffer[3] = ICDGEN_JOIN_8_FLAGS({type}, q, r, s, t, u, v, w, x);",
    ]


def test_arrays_are_written_in_rows_in_loops_or_by_functions(tmp_path):
    message = message_of(
        tmp_path,
        "at: 0, bits: 16, name: Words, type: int, count: 3, byte_order: big",
        "at: 48, bits: 12, name: Turns, type: uint, count: 5",
        "at: 112, bits: 56, name: Bytes, type: bytes",
        "at: 168, name: Points, struct: Point, count: 2",
        "at: 232, name: Single, struct: Point, count: 1",
        "at: 264, name: One, struct: Point",
        length=38,
        head=POINT,
    )
    assert encode(message) == [
        "ICDGEN_WRITE_ROW_BE(demo_status_t, message, &buffer[0], 3u, "
        "words[0], words[2]);",
        "for (size_t element = 0u; element < 4u; element += 2u) {\n"
        "        uint8_t *const part = &buffer[6u + ((element / 2u) * 3u)];\n"
        "        part[0] = ICDGEN_U8(message->turns[element]);\n"
        "        part[1] = ICDGEN_U8(ICDGEN_U8(message->turns[element] >> 8) | "
        "(ICDGEN_U8(message->turns[element + 1u]) << 4));\n"
        "        part[2] = ICDGEN_U8(message->turns[element + 1u] >> 4);\n"
        "    }",
        "buffer[12] = ICDGEN_U8(message->turns[4]);",
        "buffer[13] = ICDGEN_U8(message->turns[4] >> 8);",
        "(void)memcpy(&buffer[14], message->bytes, 7u);",
        "for (size_t element = 0u; element < 2u; element++) {\n"
        "        demo_status_write_points(&message->points[element], "
        "&buffer[21u + (element * 4u)]);\n"
        "    }",
        "demo_status_write_single(&message->single[0], &buffer[29]);",
        "buffer[33] = message->one.x;",
        "buffer[34] = ICDGEN_U8(message->one.y);",
        "buffer[35] = ICDGEN_U8(ICDGEN_U8(ICDGEN_U16(message->one.y) >> 8) & 0x0F);",
        "(void)memset(&buffer[36], 0, 2u);",
    ]
    arrays = list(all_struct_arrays(message))
    groups = groups_of(arrays[0].element_struct, "points_")
    assert write_statements(message, arrays[0], groups) == [
        "buffer[0] = message->x;",
        "buffer[1] = ICDGEN_U8(message->y);",
        "buffer[2] = ICDGEN_U8(ICDGEN_U8(ICDGEN_U16(message->y) >> 8) & 0x0F);",
        "buffer[3] = 0u;",
    ]


def test_structs_at_the_end_are_written_as_far_as_they_are_counted(tmp_path):
    message = message_of(
        tmp_path,
        "at: 0, bits: 8, name: Last, type: uint",
        "at: 8, name: Points, struct: Point, count: {field: Last, plus: 1}, up_to: 3",
        length=1,
        head=POINT,
    )
    assert encode(message) == [
        "buffer[0] = message->last;",
        "for (size_t element = 0u; element < (ICDGEN_SIZE(message->last) + 1u); "
        "element++) {\n"
        "        demo_status_write_points(&message->points[element], "
        "&buffer[1u + (element * 4u)]);\n"
        "    }",
    ]


@pytest.mark.parametrize(
    ("begin", "keys", "plus", "terms"),
    [
        (
            0,
            "bits: 8, type: uint, count: rest",
            None,
            ["ICDGEN_SIZE(message->data_count)"],
        ),
        (
            0,
            "bits: 24, type: uint, count: rest",
            None,
            ["ICDGEN_SIZE(message->data_count) * 3u"],
        ),
        (
            8,
            "bits: 8, type: uint, count: rest",
            None,
            ["1u", "ICDGEN_SIZE(message->data_count)"],
        ),
        (
            8,
            "bits: 24, type: uint, count: rest",
            None,
            ["1u", "(ICDGEN_SIZE(message->data_count) * 3u)"],
        ),
        (
            8,
            "bits: 16, type: uint",
            2,
            ["1u", "((ICDGEN_SIZE(message->number) + 2u) * 2u)"],
        ),
        # `encode` refuses a smaller counter, whose difference would wrap around.
        (
            8,
            "bits: 16, type: uint",
            -2,
            [
                "1u",
                "(((message->number > 2u) ? (ICDGEN_SIZE(message->number) - 2u) : 0u) "
                "* 2u)",
            ],
        ),
    ],
)
def test_the_size_of_a_frame_depends_on_its_elements(
    tmp_path, begin, keys, plus, terms
):
    number = ["at: 0, bits: 8, name: Number, type: uint"] * (begin // 8)
    if plus is not None:
        keys += f", count: {{field: Number, plus: {plus}}}"
    message = message_of(
        tmp_path,
        *number,
        f"at: {begin}, name: Data, {keys}, up_to: 5",
        length=begin // 8,
    )
    assert size_terms(message) == terms


NESTED = """\
structs:
  - name: Curve
    length: 1
    fields:
      - {at: 0, bits: 8, name: Kind, type: uint}
      - {at: 8, bits: 16, name: Points, type: uint, count: Inner, up_to: 3}
      - {at: 8, after: Points, bits: 8, name: Trailer, type: uint}
messages:
  - name: Curves
    id: 7
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Number, type: uint}
      - {at: 8, bits: 8, name: Inner, type: uint}
      - {at: 16, name: Curves, struct: Curve, count: Number, up_to: 2}
      - {at: 16, after: Curves, bits: 16, name: CRC, type: uint}
      - {at: 16, after: CRC, bits: 8, name: More, type: uint, count: rest, up_to: 4}
"""


def test_elements_with_arrays_of_variable_length_have_a_size_each(tmp_path):
    (message,) = node_of(tmp_path, NESTED).messages
    assert size_terms(message) == [
        "4u",
        "ICDGEN_SIZE(message->number) * (2u + (ICDGEN_SIZE(message->inner) * 2u))",
        "ICDGEN_SIZE(message->more_count)",
    ]


@pytest.mark.parametrize(
    ("plus", "value"),
    [
        (0, "strlen(text)"),
        (-2, "strlen(text) + 2u"),
        (2, "(strlen(text) > 2u) ? (strlen(text) - 2u) : 0u"),
    ],
)
def test_the_counter_of_a_text_is_its_length_less_the_difference(tmp_path, plus, value):
    message = message_of(
        tmp_path,
        "at: 0, bits: 8, name: Last, type: uint",
        f"at: 8, name: Word, type: text, size: {{field: Last, plus: {plus}}}, up_to: 9",
        length=1,
    )
    assert counted_text(message.last_part) == value
