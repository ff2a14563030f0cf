"""Printed CAN packets are read with identifier, data, length and time of each tool."""

from __future__ import annotations

import pytest

from icdgen.recognize.packets import Printed, packets
from tests.limits import assert_limits


def packet(text: str) -> Printed | None:
    result = packets(text)
    return result[0] if result else None


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("can0 123 [2] 01 AB", Printed(0x123, b"\x01\xab", False)),
        ("  vcan12  00000123   [0]", Printed(0x123, b"", True)),
        ("123 [2] 01 AB  '..'", Printed(0x123, b"\x01\xab", False)),
        ("(12.5) can0 TX - - 123 [1] 01", Printed(0x123, b"\1", False, "12.5")),
        ("(2025-01-01 12:00:01.5) can0 RX B E 123 [1] 01",
         Printed(0x123, b"\1", False, "2025-01-01 12:00:01.5")),
        ("can0 123 [8] remote request", Printed(0x123, b"", False)),
        ("123#01.AB", Printed(0x123, b"\x01\xab", False)),
        ("123#", Printed(0x123, b"", False)),
        ("123##301AB", Printed(0x123, b"\x01\xab", False)),
        ("1FFFFFFF#01 T", Printed(0x1FFFFFFF, b"\1", True)),
        ("123#R", Printed(0x123, b"", False)),
        ("123#R8", Printed(0x123, b"", False)),
        ("t12320102", Printed(0x123, b"\1\2", False)),
        ("T000001231FF", Printed(0x123, b"\xff", True)),
        ("r1238", Printed(0x123, b"", False)),
        ("R000001238", Printed(0x123, b"", True)),
        ("t1231FFEA60", Printed(0x123, b"\xff", False, "60.000")),
        ("t1231010203", Printed(0x123, b"\1", False, "0.515")),
        ("t12300001", Printed(0x123, b"", False, "0.001")),
        ("r12381234", Printed(0x123, b"", False, "4.660")),
    ],
)  # fmt: skip
def test_each_spelling_of_a_packet_is_read(text, expected):
    assert packets(text) == [expected]


@pytest.mark.parametrize(
    "text",
    [
        "",
        "1234#01",  # neither 3 nor 8 digits
        "123#R9",
        "t12390102",
        "t1231",  # no data
        "t12310102",  # one byte more than its size is no time
        "can0 123 [1]",
        "can0 123 [2] 01",
        "can0 123 [1] 01 02",
        "can0 123 [1] 01 02 03",
        "123#01\nxyz",
    ],
)
def test_a_text_with_a_line_that_is_no_packet_is_refused(text):
    assert packets(text) is None


def test_the_size_is_that_of_the_data():
    assert_limits(
        lambda size: packet(f"can0 123 [{size}] 01 02 03") is not None, least=3, most=3
    )
    assert_limits(lambda size: packet(f"t123{size}{'00' * size}") is not None, most=8)
    assert_limits(lambda size: packet(f"123#R{size}") is not None, most=8)


def test_lines_without_text_are_ignored_and_the_order_is_kept():
    assert [p.id for p in packets("\n 124#01 \r\n\n123#\n") or ()] == [0x124, 0x123]


def test_an_identifier_has_the_digits_of_its_length():
    assert Printed(0x12, b"", False).identifier == "0x012"
    assert Printed(0x12, b"", True).identifier == "0x00000012"
