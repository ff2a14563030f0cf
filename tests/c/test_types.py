"""Types, declarations and literals of members in C."""

from __future__ import annotations

import pytest

from icdgen.backends.c.types import cast, declaration, mask, type_of
from tests.describe.small import message_of

HEAD = """\
enums: [{name: Mode, members: [{value: 1, name: Idle}]}]
structs:
  - {name: Cell, length: 1, fields: [{at: 0, bits: 8, name: Kind, type: uint}]}
"""


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ("bits: 8, type: uint", "uint8_t rate"),
        ("bits: 9, type: int", "int16_t rate"),
        ("bits: 33, type: uint", "uint64_t rate"),
        ("bits: 16, type: int, count: 3", "int16_t rate[3]"),
        ("bits: 1, type: bool", "bool rate"),
        ("bits: 1, type: bool, count: 8", "bool rate[8]"),
        ("bits: 32, type: float", "float rate"),
        ("bits: 64, type: float", "double rate"),
        ("bits: 4, type: enum, enum: Mode", "demo_mode_t rate"),
        ("bits: 24, type: bytes", "uint8_t rate[3]"),
        ("bits: 16, type: text, count: 2", "uint8_t rate[2][2]"),
        ("struct: Cell", "demo_cell_t rate"),
        ("struct: Cell, count: 4", "demo_cell_t rate[4]"),
    ],
)
def test_a_member_has_the_type_and_the_size_of_its_field(tmp_path, keys, text):
    field = f"at: 0, name: Rate, {keys}"
    (member,) = message_of(tmp_path, field, length=8, head=HEAD).members
    assert declaration(member) == text
    if member.struct is None and not member.model.is_bytes:
        assert type_of(member) == text.split()[0]


@pytest.mark.parametrize(
    ("value", "bits", "text"),
    [
        (0, 8, "0x00u"),
        (0xAB, 16, "0x00ABu"),
        (0xFFFFFFFF, 32, "0xFFFFFFFFu"),
        (1, 64, "UINT64_C(0x0000000000000001)"),
    ],
)
def test_a_mask_has_two_digits_for_each_byte(value, bits, text):
    assert mask(value, bits) == text


def test_a_cast_is_the_macro_of_its_width_and_sign():
    assert (cast("a", 8), cast("a", 64, True)) == ("ICDGEN_U8(a)", "ICDGEN_I64(a)")
