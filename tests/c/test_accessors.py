"""Expressions of physical values in C: which function or integer computes them, and the
literals of their scale and limits.
"""

from __future__ import annotations

import re

import pytest

from icdgen.backends.c.accessors import (
    double_accessors,
    integer_accessors,
    overlay_comment,
)
from icdgen.backends.c.physical import int64, integer_range
from icdgen.describe.arithmetic import IntegerAccess
from tests.describe.small import message_of, node_of
from tests.icd.files import status
from tests.limits import assert_limits


def double_of(folder, keys, bits=16):
    message = message_of(
        folder,
        f"at: 0, name: Rate, bits: {bits}, {keys}",
        length=-(-bits // 8),
    )
    (accessor,) = double_accessors(message)
    return accessor


@pytest.mark.parametrize(
    ("bits", "keys", "value", "setter"),
    [
        (
            16,
            "type: uint, formula: raw*0.5",
            "icdgen_quotient(message->rate, 2)",
            "icdgen_set_u16(&message->rate, value, 1, 0, 2, UINT16_MAX)",
        ),
        (
            16,
            "type: int, formula: raw*0.3 - 5",
            "icdgen_quotient(message->rate * INT64_C(3) - INT64_C(50), 10)",
            "icdgen_set_i16(&message->rate, value, 3, -50, 10, INT16_MIN, INT16_MAX)",
        ),
        (
            12,
            "type: int, formula: 7 - raw*2",
            "icdgen_quotient(message->rate * INT64_C(-2) + INT64_C(7), 1)",
            "icdgen_set_i16(&message->rate, value, -2, 7, 1, -2048, 2047)",
        ),
        (
            12,
            "type: uint, formula: raw*0.5",
            "icdgen_quotient(message->rate, 2)",
            "icdgen_set_u16(&message->rate, value, 1, 0, 2, 4095u)",
        ),
        (
            40,
            "type: uint, formula: raw*0.5",
            "icdgen_physical_u64(message->rate, 1, 0, 2)",
            "icdgen_set_u64(&message->rate, value, 1, 0, 2, UINT64_C(1099511627775))",
        ),
        # The smallest field whose limit is beyond 32 bits.
        (
            33,
            "type: uint, formula: raw",
            "icdgen_physical_u64(message->rate, 1, 0, 1)",
            "icdgen_set_u64(&message->rate, value, 1, 0, 1, UINT64_C(8589934591))",
        ),
        (
            64,
            "type: int, formula: raw/4294967295",
            "icdgen_physical_i64(message->rate, 1, 0, INT64_C(4294967295))",
            "icdgen_set_i64(&message->rate, value, 1, 0, INT64_C(4294967295), "
            "INT64_MIN, INT64_MAX)",
        ),
        # 2**63 has no literal, so that the negative value is computed.
        (
            8,
            "type: uint, formula: raw*3 + 9223372036854775808",
            "0.0 - icdgen_physical_u64(message->rate, -3, INT64_MIN, 1)",
            "icdgen_set_u8(&message->rate, -value, -3, INT64_MIN, 1, UINT8_MAX)",
        ),
    ],
)
def test_a_scale_is_computed_with_the_literals_of_its_terms(
    tmp_path, bits, keys, value, setter
):
    accessor = double_of(tmp_path, keys, bits)
    assert accessor.expression == value
    assert accessor.assignment == f"return {setter};"
    assert (accessor.end, accessor.type) == ("rate_physical", "double")
    assert (accessor.declared, accessor.elements) == ((), 0)


def test_a_scale_of_many_digits_is_a_table_of_parts_of_32_bits(tmp_path):
    accessor = double_of(tmp_path, "type: int, formula: raw*2^-70 - 3")
    assert accessor.expression == "icdgen_wide_physical_i64(message->rate, &scale)"
    assert accessor.assignment == (
        "return icdgen_wide_set_i16(&message->rate, value, &scale, INT16_MIN, "
        "INT16_MAX);"
    )
    assert accessor.declared == (
        "static const icdgen_scale_t scale = {",
        "    {{1u, 0u, 0u, 0u, 0u, 0u, 0u, 0u}},",
        "    {{0u, 0u, 0xFFFFFF40u, 0xFFFFFFFFu, 0xFFFFFFFFu, 0xFFFFFFFFu, "
        "0xFFFFFFFFu, 0xFFFFFFFFu}},",
        "    {{0u, 0u, 0x40u, 0u, 0u, 0u, 0u, 0u}},",
        "};",
    )
    unsigned = double_of(tmp_path, "type: uint, formula: raw*2^-70")
    assert unsigned.assignment == (
        "return icdgen_wide_set_u16(&message->rate, value, &scale, UINT16_MAX);"
    )


@pytest.mark.parametrize(
    ("bits", "keys", "declared", "setter"),
    [
        (
            16,
            "type: uint, formula: raw^2 + 0.5",
            "static const double terms[] = {0.5, 0.0, 1.0};",
            "icdgen_set_curve_u16(&message->rate, value, curve, 1u, 0u, UINT16_MAX)",
        ),
        (
            16,
            "type: int, formula: raw^3",
            "static const double terms[] = {0.0, 0.0, 0.0, 1.0};",
            "icdgen_set_curve_i16(&message->rate, value, curve, 1u, INT16_MIN, "
            "INT16_MAX)",
        ),
    ],
)
def test_a_calibration_is_searched_between_the_ends_of_its_inverse(
    tmp_path, bits, keys, declared, setter
):
    accessor = double_of(tmp_path, keys, bits)
    assert accessor.expression == (
        "icdgen_curve(ICDGEN_CAST(double, message->rate), curve, 1u)"
    )
    assert accessor.assignment == f"return {setter};"
    assert accessor.declared[0] == declared


def test_a_lookup_table_is_an_array_of_pieces_with_their_terms(tmp_path):
    points = "points: [[10, 1], [20, 6], [30, 26]], outside: refuse"
    accessor = double_of(tmp_path, f"type: uint, {points}", bits=8)
    assert accessor.declared == (
        "static const double terms[] = {",
        "    1.0, 0.5,",
        "    6.0, 2.0,",
        "    26.0,",
        "};",
        "static const icdgen_piece_t curve[] = {",
        "    {10.0, terms, 0u},",
        "    {10.0, &terms[0], 2u},",
        "    {20.0, &terms[2], 2u},",
        "    {30.0, &terms[4], 1u},",
        # The next double above the last point; no raw value lies in between.
        "    {30.000000000000004, terms, 0u},",
        "};",
    )
    assert accessor.expression == (
        "icdgen_curve(ICDGEN_CAST(double, message->rate), curve, 5u)"
    )
    assert accessor.assignment == (
        "return icdgen_set_curve_u8(&message->rate, value, curve, 5u, 10u, 30u);"
    )


def test_elements_of_an_array_have_an_index(tmp_path):
    accessor = double_of(tmp_path, "type: uint, formula: raw*0.5, count: 3", bits=8)
    assert accessor.expression == "icdgen_quotient(message->rate[element], 2)"
    assert accessor.assignment == (
        "return icdgen_set_u8(&message->rate[element], value, 1, 0, 2, UINT8_MAX);"
    )
    assert accessor.elements == 3


def test_an_overlay_is_read_by_its_getter_and_has_no_setter(tmp_path):
    message = message_of(
        tmp_path,
        "at: 0, name: Rate, bits: 16, type: uint",
        "at: 0, name: Low, bits: 8, type: uint, view: true, formula: raw * 2",
        length=2,
    )
    (accessor,) = double_accessors(message)
    assert accessor.expression == (
        "icdgen_quotient(demo_status_low(message) * INT64_C(2), 1)"
    )
    assert accessor.assignment == ""
    (whole,) = integer_accessors(message)
    assert whole.expression == "demo_status_low(message) * INT32_C(2000)"
    assert (whole.assignment, whole.refused) == (
        "",
        "(value < -1000) || (value > 510999)",
    )


@pytest.mark.parametrize(
    ("bits", "keys", "type", "value", "assignment", "refused"),
    [
        (
            16,
            "type: uint, formula: raw*0.001",
            "int32_t",
            "message->rate",
            "ICDGEN_U16(value)",
            "(value < 0) || (value > 65535)",
        ),
        (
            16,
            "type: int, formula: 1 - raw*0.002",
            "int32_t",
            "message->rate * INT32_C(-2) + INT32_C(1000)",
            "ICDGEN_I16(icdgen_nearest32(INT32_C(1000) - value, 2))",
            "(value < -64534) || (value > 66537)",
        ),
        (
            8,
            "type: uint, formula: -raw*0.001 - 1",
            "int32_t",
            "message->rate * INT32_C(-1) - INT32_C(1000)",
            "ICDGEN_U8(-INT32_C(1000) - value)",
            "(value < -1255) || (value > -1000)",
        ),
        (
            8,
            "type: uint, formula: raw*0.01 + 1",
            "int32_t",
            "message->rate * INT32_C(10) + INT32_C(1000)",
            "ICDGEN_U8(icdgen_nearest32(value - INT32_C(1000), 10))",
            "(value < 995) || (value > 3554)",
        ),
        (
            8,
            "type: uint, formula: -raw*0.001",
            "int32_t",
            "message->rate * INT32_C(-1)",
            "ICDGEN_U8(INT32_C(0) - value)",
            "(value < -255) || (value > 0)",
        ),
        # The raw value of 32 bits, scaled, needs 64.
        (
            32,
            "type: int, formula: raw*0.01",
            "int64_t",
            "message->rate * INT64_C(10)",
            "ICDGEN_I32(icdgen_nearest64(value, 10))",
            "(value < INT64_C(-21474836485)) || (value > INT64_C(21474836474))",
        ),
    ],
)
def test_whole_parts_of_the_unit_are_computed_in_the_smallest_integer(
    tmp_path, bits, keys, type, value, assignment, refused
):
    message = message_of(
        tmp_path, f"at: 0, name: Rate, bits: {bits}, {keys}", length=bits // 8
    )
    (accessor,) = integer_accessors(message)
    assert accessor.type == type
    assert accessor.expression == value
    assert accessor.assignment == f"message->rate = {assignment};"
    assert accessor.refused == refused
    assert accessor.end == "rate_milli"


@pytest.mark.parametrize(
    ("least", "most", "text"),
    [
        (-5, 7, ["value < -5", "value > 7"]),
        (None, 1 << 31, ["value > INT64_C(2147483648)"]),
        (0, None, ["value < 0"]),
        (None, None, []),
    ],
)
def test_an_end_that_the_type_cannot_exceed_is_not_tested(least, most, text):
    access = IntegerAccess(None, 64, 64, least, most)
    assert integer_range(access) == text


def test_literals_have_the_macro_of_64_bits_beyond_32():
    assert int64(-(1 << 63)) == "INT64_MIN"
    assert int64(1 - (1 << 63)) == f"INT64_C({1 - (1 << 63)})"

    def is_plain(value):
        assert int64(value) in (str(value), f"INT64_C({value})")
        return int64(value) == str(value)

    assert_limits(is_plain, least=-(1 << 31) + 1, most=(1 << 31) - 1)


def test_each_step_of_a_derived_value_is_a_volatile_double(tmp_path):
    text = status(
        "at: 0, name: Rate, bits: 16, type: int, formula: raw*0.5, unit: V",
        "at: 16, name: Height, bits: 64, type: float",
        "at: 80, name: Message, bits: 32, type: float",
        length=14,
    )
    formula = "Rate*2 + Height^3 - Message"
    text += f"    derived:\n      - {{name: Sum, formula: '{formula}'}}\n"
    (*_, accessor) = double_accessors(node_of(tmp_path, text).messages[0])
    assert accessor.declared == (
        "const double rate = demo_status_rate_v(message);",
        "const double height = message->height;",
        # `message` is the parameter of the function.
        "const double message_ = ICDGEN_CAST(double, message->message);",
        "const volatile double step_1 = rate * 2.0;",
        "const volatile double step_2 = icdgen_power(height, 3.0);",
        "const volatile double step_3 = step_1 + step_2;",
        "const volatile double step_4 = step_3 - message_;",
    )
    assert accessor.expression == "icdgen_quiet(step_4)"
    assert (accessor.end, accessor.assignment, accessor.title) == ("sum", "", "")
    assert (accessor.type, accessor.elements) == ("double", 0)


def test_a_step_that_is_longer_than_a_line_continues_on_the_next(tmp_path):
    def first_line(length):
        folder = tmp_path / str(length)
        folder.mkdir()
        text = status(f"at: 0, name: {'a' * length}, bits: 64, type: float", length=8)
        formula = "a" * length + " + 1"
        text += f"    derived: [{{name: Sum, formula: {formula}}}]\n"
        (accessor,) = double_accessors(node_of(folder, text).messages[0])
        line = accessor.declared[0]
        name = "a" * length
        assert line.split() == [
            *f"const double {name} =".split(),
            f"message->{name};",
        ]
        assert "\n" not in line or f" =\n        message->{name};" in line
        return line

    fixed = len("    const double  = message->;")
    assert_limits(
        lambda length: "\n" not in first_line(length), most=(120 - fixed) // 2
    )


def test_the_comment_of_an_overlay_says_when_it_is_0(tmp_path):
    def comment(bits):
        message = message_of(
            tmp_path,
            f"at: 0, name: Rate, bits: {bits}, type: uint",
            "at: 0, name: Low, bits: 4, type: uint, view: true",
            length=1,
        )
        (low,) = message.overlays
        return " ".join(re.sub(r"^ \*", "", overlay_comment(low), flags=re.M).split())

    assert comment(5).endswith(
        " Read from the frame that the message makes: 0 if it makes none, as a raw "
        "value does not fit its field. /"
    )
    assert "if it makes none" not in comment(8)
