"""Hexadecimal dumps are read as the tools that print them mean them."""

from __future__ import annotations

import pytest

from icdgen.recognize.dumps import dump

DATA = bytes(range(0x10, 0x22))  # 18 bytes, in two lines


@pytest.mark.parametrize(
    "text",
    [
        # xxd
        "00000000: 1011 1213 1415 1617 1819 1a1b 1c1d 1e1f  ................\n"
        "00000010: 2021                                      !",
        # xxd before 2016
        "0000000: 1011 1213 1415 1617 1819 1a1b 1c1d 1e1f  ................\n"
        "0000010: 2021                                      !",
        # xxd -g 1
        "00000000: 10 11 12 13 14 15 16 17 18 19 1a 1b 1c 1d 1e 1f  ................\n"
        "00000010: 20 21                                             !",
        # xxd -g 4
        "00000000: 10111213 14151617 18191a1b 1c1d1e1f  ................\n"
        "00000010: 2021                                  !",
        # hexdump: words of a little-endian machine
        "0000000 1110 1312 1514 1716 1918 1b1a 1d1c 1f1e\n0000010 2120\n0000012",
        # hexdump -C
        "00000000  10 11 12 13 14 15 16 17  18 19 1a 1b 1c 1d 1e 1f  |................|\n"
        "00000010  20 21                                             | !|\n00000012",
        # od -t x1: octal addresses
        "0000000 10 11 12 13 14 15 16 17 18 19 1a 1b 1c 1d 1e 1f\n"
        "0000020 20 21\n0000022",
        # od -x
        "0000000 1110 1312 1514 1716 1918 1b1a 1d1c 1f1e\n0000020 2120\n0000022",
        # packet analyser
        "0000   10 11 12 13 14 15 16 17 18 19 1a 1b 1c 1d 1e 1f   ................\n"
        "0010   20 21                                              !",
        # with a blank line and 0x
        "0x0000: 1011 1213 1415 1617 1819 1a1b 1c1d 1e1f\n\n0x0010: 2021\n",
    ],
)
def test_the_dumps_of_all_tools_give_the_same_bytes(text):
    assert dump(text) == DATA


@pytest.mark.parametrize(
    ("line", "data"),
    [
        ("00000000: 1011", "1011"),
        ("0000000: 1011", "1011"),
        ("0000000 1110", "1011"),
        ("0000000 10 11", "1011"),
        ("0000  1011", "1011"),
        ("0000 1011  |..|", "1011"),
        ("0000 1011", None),  # its first number can be data
        ("00000000 1011", None),
        ("00000000:1011", None),
        ("0000000: 1011\n0000003: 12", None),  # a gap
        ("0000000 10 11\n0000002 zz", None),
        ("", None),
        ("\n\n", None),
    ],
)
def test_a_line_is_a_dump_if_its_first_number_is_certainly_an_address(line, data):
    result = dump(line)
    assert (None if result is None else result.hex()) == data
