"""Conditions of optional fields in C test exactly the values of the ICD."""

from __future__ import annotations

import pytest

from icdgen.backends.c.conditional import absent_value, presence_test, write_optional
from icdgen.describe import describe
from tests.describe.small import message_of
from tests.icd.files import loaded, status
from tests.limits import assert_limits

ENUM = """\
enums:
  - name: Mode
    members:
      - {value: 1, name: Idle}
"""


def last_field(folder, when, more="type: uint", key="bits: 32, type: uint"):
    bits = int(key.removeprefix("bits: ").split(",")[0])
    fields = [f"at: 0, name: Kind, {key}"]
    if bits < 8:
        fields += [f"at: {bits}, bits: {8 - bits}, name: Other, type: uint"]
    begin = max(bits, 8)
    fields += [f"at: {begin}, bits: 32, name: Value, {more}, when: {when}"]
    result = loaded(folder, ENUM + status(*fields, length=begin // 8 + 4))
    assert result.ok, [finding.message for finding in result.findings]
    return describe(result.icd).nodes[0].messages[0].members[-1]


@pytest.mark.parametrize(
    ("key", "values", "test"),
    [
        ("bits: 8, type: uint", "7", "message->kind == 7u"),
        (
            "bits: 8, type: uint",
            "[7, 9]",
            "(message->kind == 7u) || (message->kind == 9u)",
        ),
        ("bits: 8, type: int", "-7", "message->kind == (-7)"),
        (
            "bits: 8, type: int",
            "[0, 7]",
            "(message->kind == 0) || (message->kind == 7)",
        ),
        ("bits: 1, type: bool", "1", "message->kind"),
        ("bits: 1, type: bool", "0", "!message->kind"),
        ("bits: 8, type: enum, enum: Mode", "1", "message->kind == DEMO_MODE_IDLE"),
        ("bits: 8, type: enum, enum: Mode", "5", "message->kind == 5u"),
    ],
)
def test_a_field_is_present_if_the_other_has_one_of_the_values(
    tmp_path, key, values, test
):
    field = last_field(tmp_path, f"{{Kind: {values}}}", key=key)
    assert presence_test(field) == test


def test_values_of_more_than_16_bits_are_literals_of_the_width(tmp_path):
    def is_plain(value):
        text = presence_test(last_field(tmp_path, f"{{Kind: {value}}}"))
        assert text in (
            f"message->kind == {value}u",
            f"message->kind == 0x{value:08X}u",
        )
        return text.endswith(f" {value}u")

    assert_limits(is_plain, most=0xFFFF)


def test_all_conditions_must_be_met(tmp_path):
    fields = (
        "at: 0, bits: 8, name: A, type: uint",
        "at: 8, bits: 8, name: B, type: uint",
        "at: 16, bits: 8, name: C, type: uint, when: {A: [1, 2], B: 3}",
    )
    icd = loaded(tmp_path, status(*fields, length=3)).icd
    field = describe(icd).nodes[0].messages[0].members[-1]
    assert presence_test(field) == (
        "((message->a == 1u) || (message->a == 2u)) && (message->b == 3u)"
    )


@pytest.mark.parametrize(
    ("more", "value"),
    [
        ("type: uint", "0u"),
        ("type: int", "0"),
        ("type: float", "0"),
        ("type: enum, enum: Mode", "0u"),
        ("type: uint, const: 7", "DEMO_STATUS_VALUE_CONST"),
    ],
)
def test_an_absent_field_is_zero_or_its_constant(tmp_path, more, value):
    assert absent_value(last_field(tmp_path, "{Kind: 1}", more)) == value


def test_an_absent_flag_is_false(tmp_path):
    _, flag = message_of(
        tmp_path,
        "at: 0, bits: 7, name: Kind, type: uint",
        "at: 7, bits: 1, name: Flag, type: bool, when: {Kind: 1}",
        length=1,
    ).members
    assert absent_value(flag) == "false"


def test_an_optional_field_is_added_to_the_zeros_of_its_bits(tmp_path):
    fields = (
        "at: 0, bits: 4, name: Kind, type: uint",
        "at: 4, bits: 10, name: Across, type: uint, when: {Kind: 1}",
        "at: 16, bits: 16, name: Word, type: uint, when: {Kind: 1}, byte_order: big",
    )
    message = message_of(tmp_path, *fields, length=4)
    _, across, word = message.members
    assert write_optional(across) == [
        "buffer[0] = ICDGEN_U8(buffer[0] | (ICDGEN_U8(message->across) << 4));",
        "buffer[1] = ICDGEN_U8(buffer[1] | ICDGEN_U8(message->across >> 4));",
    ]
    assert write_optional(word) == ["icdgen_store_u16be(&buffer[2], message->word);"]
