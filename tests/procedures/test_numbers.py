"""Numbers at their places in messages, bit by bit, and the maps of received packets."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.procedures.numbers import (
    empty_map,
    is_received,
    mark_received,
    number_at,
    put_number,
)
from icdgen.protocol.exchange import NumberPlace
from icdgen.protocol.procedures import PacketMap


@st.composite
def places(draw) -> NumberPlace:
    size = draw(st.integers(1, 4))
    shift = draw(st.integers(0, 8 * size - 1))
    bits = draw(st.integers(1, 8 * size - shift))
    return NumberPlace(draw(st.integers(0, 5)), size, shift, bits, draw(st.booleans()))


def bit_places(place: NumberPlace) -> list[tuple[int, int]]:
    """Return byte and bit of each bit of the number, the least significant one first."""
    result = []
    for bit in range(place.shift, place.shift + place.bits):
        byte = bit // 8 if place.little else place.size - 1 - bit // 8
        result.append((place.at + byte, bit % 8))
    return result


@given(place=places(), data=st.binary(max_size=12))
def test_a_number_has_the_bits_of_its_place_and_missing_bytes_are_zero(place, data):
    octets = data + bytes(12)
    bits = [octets[byte] >> bit & 1 for byte, bit in bit_places(place)]
    assert number_at(place, data) == sum(bit << n for n, bit in enumerate(bits))


@given(
    place=places(),
    data=st.binary(min_size=9, max_size=12),
    number=st.integers(0, (1 << 40) - 1),
)
def test_setting_a_number_changes_its_bits_and_no_others(place, data, number):
    expected = bytearray(data)
    for n, (byte, bit) in enumerate(bit_places(place)):
        expected[byte] = expected[byte] & ~(1 << bit) | (number >> n & 1) << bit
    changed = bytearray(data)
    put_number(place, changed, number)
    assert changed == expected
    assert number_at(place, bytes(changed)) == number % (1 << place.bits)


LSB0 = PacketMap(
    messages=(None, None, None),
    at=1,
    bytes=2,
    msb0=False,
    received=True,
    beyond_end=False,
)  # of 48 packets: three messages with two bytes each


@pytest.mark.parametrize("msb0", [False, True])
@pytest.mark.parametrize("received", [False, True])
def test_a_packet_has_one_bit_in_the_map(msb0, received):
    form = replace(LSB0, msb0=msb0, received=received)
    octets = empty_map(form)
    assert octets == (b"\0" if received else b"\xff") * 6
    for position in range(48):
        assert not is_received(form, octets, position)
        mark_received(form, octets, position)
        assert [n for n in range(48) if is_received(form, octets, n)] == [
            *range(position + 1)
        ]
        changed = octets[position // 8] ^ (0 if received else 0xFF)
        count = position % 8 + 1
        assert changed == ((0xFF00 >> count) & 0xFF if msb0 else (1 << count) - 1)
    full = bytes(octets)
    mark_received(form, octets, 7)  # a repeated packet
    assert octets == full


def test_a_packet_beyond_the_map_is_never_received():
    octets = empty_map(LSB0)
    for position in (48, 49, 1000):
        mark_received(LSB0, octets, position)
        assert not is_received(LSB0, octets, position)
    assert octets == bytes(6)
    mark_received(LSB0, octets, 47)
    assert octets == bytes(5) + b"\x80"
