"""The reference codec: positions of bits, lengths of frames, texts and ranges, computed
by hand.

The code of all languages is compared with it, so that a mistake in it would be one in
all of them.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from icdgen import codec
from icdgen.icd.model import Message, Node
from tests.icd.files import loaded, status
from tests.limits import assert_limits


def message_of(
    folder: Path, *fields: str, length: int, orders: str = "little lsb0"
) -> tuple[Node, Message]:
    byte_order, bit_order = orders.split()
    node = (
        f"{{name: demo, title: Demo, byte_order: {byte_order}, bit_order: {bit_order}}}"
    )
    text = f"icdgen: 1\nnode: {node}\n{status(*fields, length=length)}"
    (node,) = loaded(folder, text).icd.nodes
    return node, node.messages[0]


@pytest.mark.parametrize(
    ("orders", "values"),
    [
        ("little lsb0", "2 1 412 341 18d0 5634 3c2b1a09"),
        ("little msb0", "1 2 312 342 8d2 5634 3c2b1a12"),
        ("big lsb0", "2 1 124 134 1a6 3456 9345678"),
        ("big msb0", "1 2 123 234 11a2 3456 12345678"),
    ],
)
def test_the_bits_of_a_value_follow_byte_order_and_bit_order(tmp_path, orders, values):
    frame = bytes.fromhex("12345678")
    places = ((0, 4), (4, 4), (0, 12), (4, 12), (6, 13), (8, 16), (1, 31))
    for (at, bits), value in zip(places, values.split(), strict=True):
        field = f"at: {at}, bits: {bits}, name: Level, type: uint"
        node, message = message_of(tmp_path, field, length=4, orders=orders)
        raw = codec.decode(node, message, frame)
        assert raw == {"Level": int(value, 16)}, (at, bits)
        others = codec.encode(node, message, {"Level": 0})
        again = codec.encode(node, message, raw)
        # The other bits of a new frame are 0.
        assert others == bytes(4) and codec.decode(node, message, again) == raw
        assert sum(byte.bit_count() for byte in again) == int(value, 16).bit_count()


LEVEL = "at: 0, bits: 8, name: Level, type: uint"
WORDS = "at: 8, bits: 16, name: Words, type: uint, count: rest, up_to: 3"
ITEMS = "at: 8, bits: 8, name: Items, type: uint, count: Level, up_to: 3"


@pytest.mark.parametrize(
    ("fields", "length", "frame", "raw"),
    [
        ([LEVEL], 1, "05", {"Level": 5}),
        ([LEVEL, WORDS], 1, "01", {"Level": 1, "Words Count": 0}),
        (
            [LEVEL, WORDS],
            1,
            "0102030405",
            {"Level": 1, "Words[0]": 0x302, "Words[1]": 0x504, "Words Count": 2},
        ),
        ([LEVEL, ITEMS], 1, "00", {"Level": 0}),
        ([LEVEL, ITEMS], 1, "020907", {"Level": 2, "Items[0]": 9, "Items[1]": 7}),
    ],
)
def test_a_frame_has_the_elements_that_its_length_and_counter_give(
    tmp_path, fields, length, frame, raw
):
    node, message = message_of(tmp_path, *fields, length=length)
    data = bytes.fromhex(frame)
    assert codec.decode_frame(node, message, data) == raw
    # `decode` returns all elements; those that are not in the frame are 0.
    absent = {
        f"{name}[{index}]": 0
        for name, field in (("Words", WORDS), ("Items", ITEMS))
        for index in range(3)
        if field in fields
    }
    assert codec.decode(node, message, data) == absent | raw


@pytest.mark.parametrize(
    ("fields", "length", "frame", "expected"),
    [
        ([LEVEL], 1, "", 1),
        ([LEVEL], 1, "0102", 1),
        ([LEVEL, WORDS], 1, "", 1),
        ([LEVEL, WORDS], 1, "0102", 1),
        ([LEVEL, WORDS], 1, "01020304050607" + "0000", 7),
        ([LEVEL, ITEMS], 1, "", 1),
        ([LEVEL, ITEMS], 1, "0002", 1),
        ([LEVEL, ITEMS], 1, "0201", 3),
        ([LEVEL, ITEMS], 1, "0401020304", 4),
    ],
)
def test_a_frame_with_another_length_is_rejected_with_one_that_fits(
    tmp_path, fields, length, frame, expected
):
    node, message = message_of(tmp_path, *fields, length=length)
    data = bytes.fromhex(frame)
    with pytest.raises(codec.LengthError) as caught:
        codec.decode(node, message, data)
    assert (caught.value.expected, caught.value.actual) == (expected, len(data))


@pytest.mark.parametrize(
    ("raw", "text"),
    [
        (b"", ""),
        (b"abc", "abc"),
        (b"abc\0\0", "abc"),
        (b"ab\0cd\0", "ab"),
        (b"\0abc", ""),
        (b"a\xe9\n", "a\ufffd\n"),
    ],
)
def test_a_text_ends_at_its_first_nul(raw, text):
    assert codec.text(raw) == text


@pytest.mark.parametrize(
    ("type", "least", "most"), [("uint", 0, 4095), ("int", -2048, 2047)]
)
def test_physical_values_are_accepted_in_the_range_of_the_raw_value(
    tmp_path, type, least, most
):
    """A value is rounded to the nearest raw value, ties to even."""
    field = f"at: 0, bits: 12, name: Level, type: {type}, formula: raw*0.5 - 20"
    _, message = message_of(tmp_path, field, length=2)
    (level,) = message.fields

    def is_accepted(raw: int) -> bool:
        try:
            assert codec.raw_from_physical(level, Fraction(raw, 2) - 20) == raw
        except codec.CodecError as error:
            text = f"'Level' takes {least / 2 - 20:g} to {most / 2 - 20:g}, not "
            assert str(error) == f"{text}{raw / 2 - 20:g}"
            return False
        return True

    assert_limits(is_accepted, least=least, most=most)
    assert codec.raw_from_physical(level, -19.25) == 2  # 1.5
    assert codec.raw_from_physical(level, -18.75) == 2  # 2.5
    for value in (float("nan"), float("inf"), -float("inf")):
        with pytest.raises(codec.CodecError, match="takes a finite number"):
            codec.raw_from_physical(level, value)


def test_the_double_of_a_value_is_physical_or_the_number_itself(tmp_path):
    fields = (
        "at: 0, bits: 8, name: Level, type: int",
        "at: 8, bits: 8, name: Scaled, type: uint, formula: raw*0.1",
        "at: 16, bits: 32, name: Gain, type: float",
    )
    _, message = message_of(tmp_path, *fields, length=6)
    level, scaled, gain = message.fields
    assert codec.value_double(level, -3) == -3.0
    assert codec.value_double(scaled, 3) == 0.3
    assert codec.value_double(gain, 0x3FC00000) == 1.5
    assert codec.physical_double(level, -3) is None
