"""Ids are written as bytes if the header of packets has several bytes for them."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.describe.ids import id_text, pair_bytes


def stream(*packets):
    return SimpleNamespace(
        packets=[
            SimpleNamespace(
                fields=[
                    SimpleNamespace(
                        role=role, size=size, bits=bits, shift=shift, little=little
                    )
                    for role, size, bits, shift, little in fields
                ]
            )
            for fields in packets
        ]
    )


BYTE = ("id", 1, 8, 0, True)
LENGTH = ("length", 2, 16, 0, True)


@pytest.mark.parametrize(
    ("packets", "size"),
    [
        ([], 0),
        ([[LENGTH]], 0),
        ([[BYTE, LENGTH]], 0),
        ([[BYTE, BYTE]], 2),
        ([[BYTE, BYTE, BYTE]], 3),
        ([[("id", 2, 16, 0, False)]], 2),
        ([[("id", 2, 16, 0, True)]], 0),  # a little-endian number
        ([[("id", 2, 11, 0, False)]], 0),  # part of its bytes
        ([[("id", 2, 16, 1, False)]], 0),
        ([[BYTE, ("id", 1, 7, 0, False)]], 0),
        ([[LENGTH], [BYTE, BYTE]], 2),  # the first packet format with an id
        ([[BYTE], [BYTE, BYTE]], 0),
        ([[BYTE, BYTE], [BYTE]], 2),
    ],
)
def test_only_several_whole_bytes_are_written_as_bytes(packets, size):
    assert pair_bytes(stream(*packets)) == size


def test_bytes_are_hexadecimal_and_numbers_decimal():
    assert id_text(stream([BYTE, BYTE]), 0x0A35) == "0A 35"
    assert id_text(stream([BYTE]), 53) == "53"
    assert id_text(None, 309) == "309"
