"""Decode functions in C: a statement for each field or group, loops for arrays, and
conditions for lengths and counts that a message cannot have.
"""

from __future__ import annotations

import pytest

from icdgen.backends.c.decoding import (
    counter_tests,
    decode_statements,
    element_bytes,
    element_count,
    elements_received,
    first_byte,
    for_each,
    groups_of,
    in_bytes,
    invalid_count,
    misfit_length,
    part_bytes,
    read_number,
    read_statements,
)
from icdgen.backends.c.decoding import (
    test_of_count as count_test,
)
from icdgen.describe.arrays import all_struct_arrays
from icdgen.describe.lengths import ElementBytes
from tests.describe.small import message_of
from tests.limits import assert_limits

POINT = """\
structs:
  - name: Point
    length: 3
    fields:
      - {at: 0, bits: 8, name: X, type: uint}
      - {at: 8, bits: 12, name: "Y", type: int}
"""


def decode(message):
    return decode_statements(message, groups_of(message))


def test_a_message_without_fields_reads_nothing(tmp_path):
    assert decode(message_of(tmp_path, length=2)) == [
        "(void)buffer;",
        "message->empty = 0u;",
    ]


def test_each_field_or_group_has_a_statement_in_the_order_of_the_icd(tmp_path):
    flags = [f"at: {n}, bits: 1, name: F{n}, type: bool" for n in range(8)]
    falling = [f"at: {15 - n}, bits: 1, name: G{n}, type: bool" for n in range(4)]
    words = [
        f"at: {24 + 16 * n}, bits: 16, name: W{n}, type: int, byte_order: big"
        for n in range(8)
    ]
    message = message_of(
        tmp_path,
        *flags,
        *falling,
        "at: 8, bits: 4, name: Low, type: uint",
        "at: 16, bits: 8, name: Bytes, type: bytes",
        *words,
        "at: 152, bits: 8, name: Levels, type: uint, count: 3",
        "at: 176, bits: 12, name: Turns, type: uint, count: 5",
        "at: 240, bits: 32, name: Rate, type: float",
        "at: 272, name: Points, struct: Point, count: 2",
        "at: 320, name: One, struct: Point",
        "at: 344, name: Single, struct: Point, count: 1",
        length=46,
        head=POINT,
    )
    assert decode(message) == [
        "ICDGEN_READ_8_FLAGS(demo_status_t, message, buffer[0], "
        "f0, f1, f2, f3, f4, f5, f6, f7);",
        "ICDGEN_READ_4_FLAGS_FALLING(demo_status_t, message, buffer[1] >> 4, "
        "g0, g1, g2, g3);",
        "message->low = buffer[1] & 0x0Fu;",
        "(void)memcpy(message->bytes, &buffer[2], 1u);",
        "ICDGEN_READ_ROW_BE(demo_status_t, message, &buffer[3], 8u, w0, w7);",
        "ICDGEN_READ_ROW_LE(demo_status_t, message, &buffer[19], 3u, "
        "levels[0], levels[2]);",
        "for (size_t element = 0u; element < 4u; element += 2u) {\n"
        "        const uint8_t *const part = &buffer[22u + ((element / 2u) * 3u)];\n"
        "        message->turns[element] = ICDGEN_U16(ICDGEN_U32(part[0]) | "
        "(ICDGEN_U32(part[1] & 0x0Fu) << 8));\n"
        "        message->turns[element + 1u] = ICDGEN_U16("
        "ICDGEN_U32((part[1] >> 4) & 0x0Fu) | (ICDGEN_U32(part[2]) << 4));\n"
        "    }",
        "message->turns[4] = ICDGEN_U16(ICDGEN_U32(buffer[28]) | "
        "(ICDGEN_U32(buffer[29] & 0x0Fu) << 8));",
        "icdgen_set_f32(&message->rate, icdgen_load_u32le(&buffer[30]));",
        "message->one.x = buffer[40];",
        "uint32_t bits_328 = ICDGEN_U32(buffer[41]);\n"
        "    bits_328 |= ICDGEN_U32(buffer[42] & 0x0Fu) << 8;\n"
        "    message->one.y = ICDGEN_I16(icdgen_extend32(bits_328, 0x0800u));",
        "for (size_t element = 0u; element < 2u; element++) {\n"
        "        demo_status_read_points(&message->points[element], "
        "&buffer[34u + (element * 3u)]);\n"
        "    }",
        "demo_status_read_single(&message->single[0], &buffer[43]);",
    ]


def test_bits_are_joined_in_a_variable_if_the_statement_is_longer_than_a_line(
    tmp_path,
):
    (field,) = message_of(
        tmp_path, "at: 4, bits: 12, name: Level, type: int", length=2
    ).members
    line = (
        " = icdgen_extend32(ICDGEN_U32((buffer[0] >> 4) & 0x0Fu) | "
        "(ICDGEN_U32(buffer[1]) << 4), 0x0800u);"
    ).replace("icdgen_extend32(", "ICDGEN_I16(icdgen_extend32(")
    line = line.replace("0x0800u);", "0x0800u));")

    def is_one_line(width):
        target = "x" * (width - 4 - len(line))
        text = read_number(field, target)
        if "\n" not in text:
            assert text == target + line
        else:
            assert text == (
                "uint32_t bits_4 = ICDGEN_U32((buffer[0] >> 4) & 0x0Fu);\n"
                "    bits_4 |= ICDGEN_U32(buffer[1]) << 4;\n"
                f"    {target} = ICDGEN_I16(icdgen_extend32(bits_4, 0x0800u));"
            )
        return "\n" not in text

    assert_limits(is_one_line, most=120)
    assert "uint32_t part_bits_4 = " in read_number(field, "x" * 99, "part")


def test_a_float_is_assigned_by_a_function(tmp_path):
    aligned, shifted = message_of(
        tmp_path,
        "at: 0, bits: 64, name: A, type: float, byte_order: big",
        "at: 68, bits: 32, name: B, type: float",
        length=13,
    ).members
    assert read_number(aligned, "message->a") == (
        "icdgen_set_f64(&message->a, icdgen_load_u64be(&buffer[0]));"
    )
    assert read_number(shifted, "message->b").splitlines() == [
        "uint32_t bits_68 = ICDGEN_U32((buffer[8] >> 4) & 0x0Fu);",
        "    bits_68 |= ICDGEN_U32(buffer[9]) << 4;",
        "    bits_68 |= ICDGEN_U32(buffer[10]) << 12;",
        "    bits_68 |= ICDGEN_U32(buffer[11]) << 20;",
        "    bits_68 |= ICDGEN_U32(buffer[12] & 0x0Fu) << 28;",
        "    icdgen_set_f32(&message->b, bits_68);",
    ]


def test_an_element_of_an_array_of_structs_is_read_from_its_own_first_byte(tmp_path):
    message = message_of(
        tmp_path,
        "at: 16, name: Points, struct: Point, count: 2",
        length=8,
        head=POINT,
    )
    (array,) = all_struct_arrays(message)
    groups = groups_of(array.element_struct, "points_")
    assert read_statements(message, array, groups) == [
        "message->x = buffer[0];",
        "message->y = ICDGEN_I16(icdgen_extend32(ICDGEN_U32(buffer[1]) | "
        "(ICDGEN_U32(buffer[2] & 0x0Fu) << 8), 0x0800u));",
    ]


def test_a_loop_calls_a_function_with_each_element_and_its_bytes():
    assert for_each("points", "3u", "read", ElementBytes(2, 3)).splitlines() == [
        "for (size_t element = 0u; element < 3u; element++) {",
        "        read(&message->points[element], &buffer[2u + (element * 3u)]);",
        "    }",
    ]
    assert for_each("points", "1u", "read", ElementBytes(2, 3)) == (
        "read(&message->points[0], &buffer[2]);"
    )


@pytest.mark.parametrize(
    ("begin", "step", "per_iteration", "text"),
    [
        (0, 1, 1, "element"),
        (0, 3, 1, "element * 3u"),
        (2, 1, 1, "2u + element"),
        (2, 3, 1, "2u + (element * 3u)"),
        (2, 3, 2, "2u + ((element / 2u) * 3u)"),
        (0, 1, 8, "(element / 8u)"),
    ],
)
def test_the_first_byte_of_an_element_follows_from_its_index(
    begin, step, per_iteration, text
):
    assert first_byte(ElementBytes(begin, step), per_iteration) == text


def test_bytes_of_elements_of_one_byte_need_no_product():
    assert (in_bytes("count", 1), in_bytes("count", 2)) == ("count", "count * 2u")


REST = "at: 8, name: Data, count: rest, up_to: 5, "


@pytest.mark.parametrize(
    ("begin", "part", "statements"),
    [
        (0, "type: uint, bits: 8", ["message->data_count = ICDGEN_U8(length);"]),
        (8, "type: uint, bits: 8", ["message->data_count = ICDGEN_U8(length - 1u);"]),
        (0, "type: uint, bits: 16", ["message->data_count = ICDGEN_U8(length / 2u);"]),
        (
            8,
            "type: uint, bits: 16",
            ["message->data_count = ICDGEN_U8((length - 1u) / 2u);"],
        ),
        (
            0,
            "struct: Point",
            [
                "message->data_count = ICDGEN_U8(length / 3u);",
                "(void)memset(message->data, 0, sizeof message->data);",
                "for (size_t element = 0u; element < (length / 3u); element++) {\n"
                "        demo_status_read_data(&message->data[element], "
                "&buffer[element * 3u]);\n"
                "    }",
            ],
        ),
    ],
)
def test_the_count_of_the_last_elements_follows_from_the_length(
    tmp_path, begin, part, statements
):
    kind = ["at: 0, name: Kind, bits: 8, type: uint"] * (begin // 8)
    message = message_of(
        tmp_path,
        *kind,
        f"at: {begin}, name: Data, {part}, count: rest, up_to: 5",
        length=begin // 8,
        head=POINT,
    )
    assert decode(message)[-len(statements) :] == statements
    assert count_test(message.last_part) is None


def counted(folder, plus=0, up_to=5, bits=8, type="type: uint, bits: 8", behind=()):
    begin = max(bits, 8)
    return message_of(
        folder,
        f"at: 0, name: Number, bits: {bits}, type: uint",
        f"at: {begin}, name: Data, {type}, count: {{field: Number, plus: {plus}}}, "
        f"up_to: {up_to}",
        *behind,
        length=begin // 8,
        head=POINT,
    )


@pytest.mark.parametrize(
    ("plus", "received", "count", "bytes"),
    [
        (0, "(length - 1u) / 2u", "ICDGEN_SIZE(message->number)", None),
        (
            2,
            "((length - 5u) / 2u) + 2u",
            "(ICDGEN_SIZE(message->number) + 2u)",
            None,
        ),
        (-2, "(length - 1u) / 2u", "(ICDGEN_SIZE(message->number) - 2u)", None),
    ],
)
def test_elements_are_the_counter_plus_or_minus_a_number(
    tmp_path, plus, received, count, bytes
):
    part = counted(tmp_path, plus, type="type: uint, bits: 16").last_part
    assert elements_received(part) == received.replace(
        "(length - 1u) / 2u", "((length - 1u) / 2u)"
    )
    assert element_count(part) == count
    assert part_bytes(part) == f"{count} * 2u"
    assert element_count(part, "value") == count.replace("message->number", "value")
    assert part_bytes(part, "value") == f"{element_count(part, 'value')} * 2u"


@pytest.mark.parametrize(
    ("bits", "plus", "expected"),
    [
        (
            8,
            0,
            (
                "uint8_t",
                "value = buffer[0];",
                "ICDGEN_U32(value) != ICDGEN_U32(length - 1u)",
            ),
        ),
        (
            8,
            -2,
            (
                "uint8_t",
                "value = buffer[0];",
                "ICDGEN_U32(value) != ICDGEN_U32(length - 1u) + 2u",
            ),
        ),
        (
            64,
            0,
            (
                "uint64_t",
                "value = icdgen_load_u64le(&buffer[0]);",
                "value != ICDGEN_U64(length - 8u)",
            ),
        ),
    ],
)
def test_the_count_in_a_frame_must_match_its_length(tmp_path, bits, plus, expected):
    message = counted(tmp_path, plus, bits=bits)
    assert count_test(message.last_part) == expected


@pytest.mark.parametrize(
    ("bits", "plus", "up_to", "text"),
    [
        (8, 0, 5, "message->number > 5u"),
        (8, 0, 254, "message->number > 254u"),
        # No value of the type is larger.
        (8, 0, 255, ""),
        (8, -2, 5, "(message->number < 2u) || (message->number > 7u)"),
        (8, 2, 5, "message->number > 3u"),
        (4, 0, 15, "message->number > 15u"),
    ],
)
def test_a_count_that_the_part_cannot_have_is_refused(
    tmp_path, bits, plus, up_to, text
):
    message = counted(tmp_path, plus, up_to, bits)
    part = message.last_part
    assert invalid_count(part) == text
    assert invalid_count(part, "value") == text.replace("message->number", "value")
    tests = counter_tests(message)
    assert tests == ([(text, part.counter)] if text else [])


@pytest.mark.parametrize(
    ("fields", "length", "text"),
    [
        (
            ["at: 8, name: Data, bits: 8, type: uint, count: rest, up_to: 5"],
            1,
            "(length < 1u) || (length > DEMO_STATUS_LENGTH)",
        ),
        (
            ["at: 0, name: Data, bits: 16, type: uint, count: rest, up_to: 5"],
            0,
            "(length > DEMO_STATUS_LENGTH) || ((length % 2u) != 0u)",
        ),
        (
            ["at: 8, name: Data, bits: 16, type: uint, count: rest, up_to: 5"],
            1,
            "(length < 1u) || (length > DEMO_STATUS_LENGTH) || "
            "(((length - 1u) % 2u) != 0u)",
        ),
    ],
)
def test_a_length_that_no_frame_has_is_refused(tmp_path, fields, length, text):
    assert misfit_length(message_of(tmp_path, *fields, length=length)) == text


def test_bytes_behind_the_last_part_do_not_count_for_its_length(tmp_path):
    message = message_of(
        tmp_path,
        "at: 0, name: Number, bits: 8, type: uint",
        "at: 8, name: Data, bits: 16, type: uint, count: Number, up_to: 5",
        "at: 8, after: Data, name: Sum, bits: 8, type: uint",
        length=1,
    )
    assert misfit_length(message) == "(length > 11u) || (((length - 1u) % 2u) != 0u)"


NESTED = """\
structs:
  - name: Curve
    length: 2
    fields:
      - {at: 0, bits: 16, name: Kind, type: uint}
      - {at: 16, bits: 16, name: Points, type: uint, count: Inner, up_to: 3}
      - {at: 16, after: Points, bits: 8, name: Marks, type: uint, count: More, up_to: 2}
BEHIND
"""
TRAILER = "      - {at: 16, after: Marks, bits: 8, name: Trailer, type: uint}"


@pytest.mark.parametrize(
    ("behind", "bytes"),
    [("", "2u + inner_1 + inner_2"), (TRAILER, "2u + inner_1 + inner_2 + 1u")],
)
def test_an_element_has_the_bytes_of_its_parts(tmp_path, behind, bytes):
    message = message_of(
        tmp_path,
        "at: 0, name: Number, bits: 8, type: uint",
        "at: 8, name: Inner, bits: 8, type: uint",
        "at: 16, name: More, bits: 8, type: uint",
        "at: 24, name: Curves, struct: Curve, count: Number, up_to: 2",
        length=3,
        head=NESTED.replace("BEHIND", behind),
    )
    assert element_bytes(message.last_part) == bytes


def test_a_call_in_a_loop_is_broken_if_it_is_longer_than_a_line():
    def is_one_line(width):
        fixed = "        (&message->points[element], &buffer[element * 3u]);"
        name = "f" * (width - len(fixed))
        text = for_each("points", "3u", name, ElementBytes(0, 3))
        return len(text.splitlines()) == 3

    assert_limits(is_one_line, most=120)


def test_a_part_that_is_in_a_loop_keeps_the_indentation_of_several_lines(tmp_path):
    name = "T" * 60
    message = message_of(
        tmp_path, f"at: 0, bits: 12, name: {name}, type: uint, count: 4", length=6
    )
    (statement,) = decode(message)
    assert statement.splitlines()[2:5] == [
        "        uint32_t part_bits_0 = ICDGEN_U32(part[0]);",
        "        part_bits_0 |= ICDGEN_U32(part[1] & 0x0Fu) << 8;",
        f"        message->{name.lower()}[element] = ICDGEN_U16(part_bits_0);",
    ]
