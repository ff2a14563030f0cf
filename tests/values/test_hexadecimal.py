"""Spellings of bytes that a user may paste."""

from __future__ import annotations

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.values.errors import BadHex
from icdgen.values.hexadecimal import parse_hex


@pytest.mark.parametrize(
    "text",
    [
        "2efb0a00",
        "2EFB 0A00",
        "2e fb 0a 00",
        "2e:fb:0a:00",
        "2e-fb-0a-00",
        "2e.fb.0a.00",
        "2e_fb_0a_00",
        "0x2efb0a00",
        "0x2e,0xfb,0x0a,0x00",
        "0x2E, 0xFB, 0xA, 0x0",
        "{ 0x2e, 0xfb, 0x0a, 0x00 };",
        "[0x2e, 0xfb, 0x0a, 0x00]",
        "(2e fb) (0a 00)",
        r"\x2e\xfb\x0a\x00",
        r"b'\x2e\xfb\x0a\x00'",
        '"2efb0a00"',
        "\n 2e fb\r\n\t0a 00\n",
        "$2e $fb $0a $00",
        "x2e xfb x0a x00",
    ],
)
def test_usual_spellings(text):
    assert parse_hex(text) == b"\x2e\xfb\x0a\x00"


@pytest.mark.parametrize("text", ["", " \n", "{}", "''"])
def test_nothing_is_no_bytes(text):
    assert parse_hex(text) == b""


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("2e fg", "character 5 of the bytes: `g` is not hexadecimal"),
        ("2e\nfb\n0a z0", "line 3, character 4 of the bytes: `z` is not hexadecimal"),
        ("2e f", "character 4 of the bytes: `f` is an odd number of digits"),
        ("123", "character 1 of the bytes: `123` is an odd number of digits"),
        ("0x123", "character 3 of the bytes: `123` is an odd number of digits"),
        ("0x", "character 3 of the bytes: digits must follow the prefix"),
        ("0x 12", "character 3 of the bytes: digits must follow the prefix"),
        ("0x0x12", "character 3 of the bytes: digits must follow the prefix"),
        ("12 \x1b[0m", "character 4 of the bytes: U+001B is not hexadecimal"),
        ("１２", "`１` is not hexadecimal"),
        ("'12", "`'` is not hexadecimal"),
    ],
)
def test_what_is_not_hexadecimal_is_named_with_its_place(text, words):
    with pytest.raises(BadHex) as caught:
        parse_hex(text)
    assert words in str(caught.value)
    assert "for instance" in caught.value.help


@given(st.binary(max_size=40), st.sampled_from(["", " ", ":", "-"]))
def test_what_python_prints_is_read_back(data, separator):
    assert parse_hex(data.hex(separator) if separator else data.hex()) == data


@given(st.text(max_size=30))
def test_any_text_is_read_or_refused(text):
    with contextlib.suppress(BadHex):
        parse_hex(text)


def test_long_input_takes_linear_time():
    assert len(parse_hex("0xff, " * 200_000)) == 200_000
