"""Numbers of bytes and bits become a place in the frame, or a finding."""

from __future__ import annotations

import pytest

from icdgen.import_results.findings import SourcePlace
from icdgen.importer.rules.bit_order import ORDERS, Order
from icdgen.importer.rules.places import PlaceReader
from tests.importer.rules.small import column, rule
from tests.limits import assert_limits

LITTLE_LSB, BIG_MSB, BIG_LSB, LITTLE_MSB = ORDERS
SPOT = SourcePlace(line=9)


class Reader(PlaceReader):
    """Reader of places with the findings that it reports."""

    def __init__(self, order: Order, **keys) -> None:
        self.errors: list[tuple[str, str, str]] = []
        super().__init__(rule(**keys), order, self.report)

    def report(self, code: str, message: str, spot: SourcePlace, help: str) -> None:
        assert spot == SPOT
        self.errors.append((code, message, help))


def numbers(text: str) -> dict[str, int]:
    """Return roles of a text such as ``byte=1 bit=2``."""
    return {role: int(n) for role, n in (part.split("=") for part in text.split())}


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("byte=2", (16, 0)),
        ("byte=2 last_byte=3", (16, 16)),
        ("byte=3 last_byte=2", (16, 16)),
        ("byte=2 bit=3", (19, 0)),
        ("bit=19", (19, 0)),
        ("byte=2 bit=3 last_bit=5", (19, 3)),
        ("byte=2 bit=5 last_bit=3", (19, 3)),
        ("byte=2 last_byte=3 bit=9 last_bit=4", (20, 6)),
        ("bit=5 last_bit=5", (5, 1)),
        ("byte=1 bit=2 end_bit=6", (10, 5)),
        ("byte=1 bit=6 end_bit=2", (10, 5)),
        ("byte=0 bit=4 last_byte=1 end_bit=3", (4, 8)),
        ("byte=1 bit=3 last_byte=0 end_bit=4", (4, 8)),
    ],
)
@pytest.mark.parametrize(("origin", "shift"), [(0, 0), (1, 0), (0, 2), (3, 1)])
def test_a_place_is_the_first_bit_and_the_size_of_the_range(text, place, origin, shift):
    reader = Reader(LITTLE_LSB, origin=origin)
    moved = place[0] + 8 * (shift - origin)
    assert reader.place(numbers(text), shift, 12) == (moved, place[1])


def test_a_place_needs_a_byte_or_a_bit():
    assert Reader(LITTLE_LSB).place({"last_byte": 1, "bits": 4}, 0, 8) is None


@pytest.mark.parametrize("order", ORDERS)
def test_a_range_over_bytes_is_placed_by_its_bits_in_orders_that_ascend(order):
    text = numbers("byte=1 bit=4 last_byte=2 end_bit=3")
    is_plain = order in (LITTLE_LSB, BIG_MSB)
    assert Reader(order).place(text, 0, 8) == ((12, 8) if is_plain else (8, 8))
    assert Reader(order).place(text, 0, 9) == ((12, 8) if is_plain else (8, 9))
    assert Reader(order).counts_through(text) == is_plain
    # A register counts its bits itself, and one byte has no order of bytes.
    assert Reader(order, what="registers").counts_through(text)
    assert Reader(order).counts_through(numbers("byte=1 bit=4 end_bit=6"))
    assert Reader(order).ends(text) == [(1, 4), (2, 3)]


ENDS = "`{byte}.{bit}-{last_byte}.{end_bit}`"


@pytest.mark.parametrize(
    ("text", "message", "help"),
    [
        ("bit=1 end_bit=3", "`end_bit` without `byte`", f"give both ends of the range: {ENDS}"),
        ("byte=1 end_bit=3", "`end_bit` without `bit`", f"give both ends of the range: {ENDS}"),
        ("byte=1 bit=8 end_bit=3", "a byte has no bit 8",
         "`end_bit` and `bit` count from 0 to 7 within their bytes"),
        ("byte=1 bit=1 end_bit=9", "a byte has no bit 9",
         "`end_bit` and `bit` count from 0 to 7 within their bytes"),
        ("byte=1 bit=1 last_bit=2 end_bit=3", "`end_bit` and `last_bit` exclude each other",
         "remove one of the roles"),
    ],
)  # fmt: skip
def test_an_incomplete_range_is_reported(text, message, help):
    reader = Reader(LITTLE_LSB)
    assert not reader.is_range_clear(numbers(text), 8, "field `X`", SPOT)
    assert reader.errors == [("IMP105", f"field `X`: {message}", help)]


def test_bits_of_a_byte_are_numbered_from_0_to_7():
    for role, other in (("bit", "end_bit"), ("end_bit", "bit")):

        def is_accepted(number: int, role: str = role, other: str = other) -> bool:
            given = {"byte": 1, role: number, other: 0}
            return Reader(LITTLE_LSB).is_range_clear(given, 8, "x", SPOT)

        assert_limits(is_accepted, most=7)


@pytest.mark.parametrize(
    ("size", "is_clear"), [(16, True), (2, True), (8, False), (0, False)]
)
def test_the_size_makes_a_range_of_ambiguous_orders_clear(size, is_clear):
    text = numbers("byte=0 bit=0 last_byte=1 end_bit=7")
    reader = Reader(BIG_LSB)
    assert reader.is_range_clear(text, size, "field `X`", SPOT) == is_clear
    if is_clear:
        assert reader.errors == []
        return
    ((code, message, help),) = reader.errors
    behind = f" with a size of {size}" if size else ""
    assert (code, message) == (
        "IMP105",
        f"field `X`: the place from bit 0 of byte 0 to bit 7 of byte 1 is not clear{behind}",
    )
    assert help.startswith("with `byte_order: big, bit_order: lsb0`, such a range can")
    assert Reader(LITTLE_LSB).is_range_clear(text, size, "x", SPOT)


def frame_bits(order: Order, text: str, size: int, **keys):
    """Return the bits of a place, and the findings."""
    given = numbers(text)
    reader = Reader(order, **keys)
    place = reader.place(given, 0, size)
    assert place is not None
    at, range_size = place
    bits = reader.frame_bits(given, at, range_size or size, "field `X`", SPOT)
    return bits, reader.errors


def test_bits_of_a_range_over_bytes_are_those_that_its_size_selects():
    text = "byte=1 bit=3 last_byte=2 end_bit=4"
    expected = [(1, 4), (1, 5), (1, 6), (1, 7), (0, 0), (0, 1), (0, 2), (0, 3)]
    # From bit 3 down to bit 0 of byte 1, then from bit 7 down to bit 4 of byte 2.
    bits, _ = frame_bits(BIG_LSB, text, 8)
    assert bits == [(2, n) for n in range(4, 8)] + [(1, n) for n in range(4)]
    moved, _ = frame_bits(BIG_LSB, text, 8, origin=1)
    assert moved == expected
    assert frame_bits(BIG_MSB, text, 8) == ([], [])
    assert frame_bits(BIG_LSB, text, 9)[0] == []


@pytest.mark.parametrize(
    ("order", "bits"),
    [
        (BIG_LSB, [(3, 6), (3, 7), (2, 0), (2, 1)]),
        (LITTLE_LSB, []),
        (BIG_MSB, []),
    ],
)
def test_bits_that_are_numbered_in_several_bytes_are_those_of_a_register(order, bits):
    text = "byte=2 last_byte=3 bit=6 last_bit=9"
    assert frame_bits(order, text, 4) == (bits, [])
    one_byte = "byte=2 last_byte=2 bit=3 last_bit=4"
    assert frame_bits(order, one_byte, 2) == ([], [])
    assert frame_bits(order, "byte=2 last_byte=3", 16) == ([], [])
    assert frame_bits(order, text, 4, what="registers") == ([], [])


NOT_CLEAR = "field `X`: the place of bit {} in {} is not clear"
NUMBERED = (
    "bits are numbered from 0 to {} in these bytes; give the position by bytes or bits "
    "only"
)


def test_bits_beyond_their_bytes_are_reported():
    def is_accepted(bit: int) -> bool:
        text = f"byte=2 last_byte=3 bit=4 last_bit={bit}"
        bits, errors = frame_bits(LITTLE_LSB, text, 0, columns=[BYTES])
        message = NOT_CLEAR.format(bit, "bytes 2 to 3")
        expected = [("IMP105", message, NUMBERED.format(15))] if bit > 15 else []
        assert (bits, errors) == (None if expected else [], expected)
        return not expected

    assert_limits(is_accepted, most=15)
    _, errors = frame_bits(LITTLE_LSB, "byte=2 last_byte=2 bit=4", 5)
    message = NOT_CLEAR.format(4, "byte 2")
    assert errors == [("IMP105", message, NUMBERED.format(7))]
    assert frame_bits(LITTLE_LSB, "byte=2 last_byte=2 bit=4", 4) == ([], [])


BYTES = column("Byte", "{byte}-{last_byte}")


def test_bits_below_8_in_several_bytes_need_a_text_with_both_bytes():
    text = "byte=2 last_byte=3 bit=4 last_bit=7"
    help = (
        "a bit in the last byte has the role `end_bit`; bits that are numbered in all "
        "bytes need `{byte}-{last_byte}`"
    )
    message = NOT_CLEAR.format(7, "bytes 2 to 3")
    assert frame_bits(LITTLE_LSB, text, 4)[1] == [("IMP105", message, help)]
    assert frame_bits(LITTLE_LSB, text, 4, columns=[BYTES]) == ([], [])
    above = text.replace("last_bit=7", "last_bit=8")
    assert frame_bits(LITTLE_LSB, above, 5) == ([], [])


@pytest.mark.parametrize("order", [BIG_LSB, LITTLE_MSB])
def test_bits_above_7_of_a_byte_need_all_their_bytes_in_orders_that_are_ambiguous(
    order,
):
    def is_accepted(bit: int) -> bool:
        bits, errors = frame_bits(order, f"byte=2 bit={bit}", 1)
        if not errors:
            assert bits == []
            return True
        orders = f"byte_order: {order.byte_order}, bit_order: {order.bit_order}"
        help = (
            f"with `{orders}`, state all bytes in which the bits are numbered: the "
            "roles `byte` and `last_byte`"
        )
        message = NOT_CLEAR.format(bit, "byte 2")
        assert (bits, errors) == (None, [("IMP105", message, help)])
        return False

    assert_limits(is_accepted, most=7)
    assert frame_bits(LITTLE_LSB, "byte=2 bit=8", 1) == ([], [])


def test_bit_numbers_in_several_bytes_have_no_order_in_little_endian_msb0():
    bits, errors = frame_bits(LITTLE_MSB, "byte=2 last_byte=3 bit=6 last_bit=9", 4)
    help = (
        "with `byte_order: little, bit_order: msb0`, bit numbers in several bytes have "
        "no order: state that of the source under `node:`"
    )
    message = NOT_CLEAR.format(9, "bytes 2 to 3")
    assert (bits, errors) == (None, [("IMP105", message, help)])
