"""Pasted text is read as bytes in each spelling, up to the limits of each."""

from __future__ import annotations

import base64
import random

import pytest

from icdgen.recognize.pasted import Pasted, _base64, _decimal, _of_code, read_pasted
from icdgen.values.errors import BadHex
from tests.limits import assert_limits


def is_read(text: str) -> bool:
    try:
        read_pasted(text)
    except BadHex:
        return False
    return True


@pytest.mark.parametrize(
    ("escape", "byte"),
    [
        (r"\n", 10),
        (r"\r", 13),
        (r"\t", 9),
        (r"\0", 0),
        (r"\a", 7),
        (r"\b", 8),
        (r"\f", 12),
        (r"\v", 11),
        (r"\\", 92),
        (r"\'", 39),
        (r"\"", 34),
        (r"\xff", 255),
        (r"\x7F", 127),
        ("~", 126),
        ("\xff", 255),
    ],
)
def test_each_escape_of_a_bytes_literal_is_its_byte(escape, byte):
    assert read_pasted(rf"b'\x01{escape}z'") == Pasted(bytes([1, byte, ord("z")]))


def test_the_literal_of_any_bytes_is_read_back():
    source = random.Random(1)
    for size in range(1, 40):
        data = b"\0" + source.randbytes(size)
        assert read_pasted(repr(data)).data == data
        assert read_pasted(repr(bytearray(data))).data == data


@pytest.mark.parametrize("text", [r"b'\q\x01'", "b'\\x01\u0100'"])
def test_a_literal_with_an_unknown_escape_or_character_is_refused(text):
    assert not is_read(text)


def test_numbers_of_lists_are_bytes_up_to_255():
    assert_limits(lambda number: is_read(f"{{0, 0x1, {number}}}"), most=255)
    assert_limits(lambda number: is_read(f"222 0 {number}"), most=255)


def test_the_form_is_named_only_if_a_decimal_number_differs_from_hexadecimal():
    assert _of_code("{0x10, 9}") == Pasted(b"\x10\x09")
    assert _of_code("{0x10, 10}") == Pasted(b"\x10\x0a", form="decimal numbers")
    assert _of_code("{0x0a, 9u}") == Pasted(b"\x0a\x09")
    assert _of_code("{1u8, 200U, 0xf8u8}") == Pasted(
        b"\x01\xc8\xf8", form="decimal numbers"
    )
    assert _decimal("1, 2; 250\n4") == Pasted(b"\1\2\xfa\4", form="decimal numbers")
    assert _decimal("250") is None  # one number may be anything


def test_comments_of_source_text_are_ignored():
    text = "x = {0x01, /* 0x02,\n 3 */ 0x04, // 0x05\n 0x06};"
    assert read_pasted(text) == Pasted(b"\1\4\6")


def test_base64_needs_eight_characters_or_padding_and_mixed_case():
    assert _base64("LvsKAAAA") == Pasted(bytes.fromhex("2efb0a000000"), form="base64")
    assert _base64("LvsK") is None
    assert _base64("zzzzzzzz") is None and _base64("ZZZZZZZZ") is None
    assert _base64("Lg==") == Pasted(b"\x2e", form="base64")
    assert _base64("lvsk\nlvs=") == Pasted(base64.b64decode("lvsklvs="), form="base64")
    assert _base64("LvsKAAAA=") is None
    assert _base64("LvsKAAA") is None


def test_both_alphabets_of_base64_are_supported():
    data = bytes([0xFB, 0xEF, 0xBE, 0xFF, 0xFF, 0xFF, 0x68, 0x6A, 3])
    for encode in (base64.b64encode, base64.urlsafe_b64encode):
        assert _base64(encode(data).decode()) == Pasted(data, form="base64")


def test_any_bytes_in_base64_are_read_back():
    source = random.Random(2)
    for size in range(12, 60):
        data = source.randbytes(size)
        text = base64.b64encode(data).decode()
        assert read_pasted(f"{text[:8]}\n{text[8:]}") == Pasted(data, form="base64")


@pytest.mark.parametrize(
    "label",
    [
        "[12:00:01.5] RX: ",
        "12:00:01,250 TX> ",
        "2025-01-01 12:00:01 ",
        "2025-01-01T12:00:01.5 sent ",
        "send: ",
        "frame: ",
        "recv ",
        ">>> ",
        "-> ",
        "<- ",
    ],
)
def test_labels_before_each_line_are_removed(label):
    text = f"{label}01 02\n  {label}03"
    assert read_pasted(text).data == b"\1\2\3"


@pytest.mark.parametrize(
    "text",
    ["'01', \"0x2\", '03'", "<01> <02><03>", "01h 02H, 03h"],
)
def test_marks_of_each_byte_are_removed(text):
    assert read_pasted(text).data == b"\1\2\3"


def test_the_data_of_packets_are_joined():
    pasted = read_pasted("123#0102\n124#03")
    assert [packet.data for packet in pasted.packets] == [b"\1\2", b"\3"]
    assert (pasted.data, pasted.whole) == (b"", b"\1\2\3")
    assert read_pasted("01 02").whole == b"\1\2"
