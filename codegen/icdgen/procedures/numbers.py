"""Numbers at their places in messages, and bits of the maps of packets.

The runtimes have the same functions for the client.
"""

from __future__ import annotations

from typing import Literal

from icdgen.protocol.exchange import NumberPlace
from icdgen.protocol.procedures import PacketMap


def number_at(place: NumberPlace, data: bytes) -> int:
    """Return the number at a place; bytes that the message does not have are 0."""
    octets = data[place.at : place.at + place.size].ljust(place.size, b"\0")
    number = int.from_bytes(octets, _order(place))
    return number >> place.shift & _mask(place)


def put_number(place: NumberPlace, data: bytearray, number: int) -> None:
    """Set the bits of a number, which the message must have."""
    order = _order(place)
    octets = int.from_bytes(data[place.at : place.at + place.size], order)
    octets &= ~(_mask(place) << place.shift)
    octets |= (number & _mask(place)) << place.shift
    data[place.at : place.at + place.size] = octets.to_bytes(place.size, order)


def _order(place: NumberPlace) -> Literal["little", "big"]:
    return "little" if place.little else "big"


def _mask(place: NumberPlace) -> int:
    return (1 << place.bits) - 1


def is_received(form: PacketMap, octets: bytes | bytearray, position: int) -> bool:
    """Return whether a packet has been received according to a map."""
    if position // 8 >= len(octets):
        return False
    bit = octets[position // 8] >> _weight(form, position) & 1
    return bool(bit) == form.received


def mark_received(form: PacketMap, octets: bytearray, position: int) -> None:
    """Mark a packet as received, if the map has a bit for it."""
    if position // 8 < len(octets) and not is_received(form, octets, position):
        octets[position // 8] ^= 1 << _weight(form, position)


def empty_map(form: PacketMap) -> bytearray:
    """Return the map of a block of which nothing has been received."""
    octet = 0x00 if form.received else 0xFF
    return bytearray([octet]) * (form.bytes * len(form.messages))


def _weight(form: PacketMap, position: int) -> int:
    """Return the bit of a packet in its byte."""
    return 7 - position % 8 if form.msb0 else position % 8
