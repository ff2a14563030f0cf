"""Hole maps, and the entries of the index file."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from .._errors import LengthError, RangeError
from .errors import need
from .link import Link


class HoleMap:
    """Which packets of a block were received: one bit each.

    Packets go by their number in the block, which begins with what the ICD says. Raises
    `RangeError` for more packets than the map has bits, and `UnsupportedError`.
    """

    def __init__(self, link: Link, packets: int, received: Iterable[int] = ()) -> None:
        self._form = form = need(link.hole_map, "file_transfer.hole_map")
        self._first = need(link.files, "file_transfer").first_packet
        self.packets = packets
        if not 0 <= packets <= 8 * form.bytes:
            raise RangeError("packets", f"0 to {8 * form.bytes}", packets)
        self._there = bytearray(packets)
        for number in received:
            self.set(number)

    @classmethod
    def from_bytes(cls, link: Link, packets: int, data: bytes) -> HoleMap:
        """The map in ``data``; bits beyond the block's end are ignored.

        Raises `LengthError`.
        """
        form = need(link.hole_map, "file_transfer.hole_map")
        if len(data) != form.bytes:
            raise LengthError("a hole map", form.bytes, len(data))
        made = cls(link, packets)
        for bit in range(packets):
            state = data[bit >> 3] >> made._weight(bit) & 1
            made._there[bit] = state == form.received
        return made

    def set(self, number: int) -> None:
        """Notes a packet as received. Raises `RangeError`."""
        self._there[self._position(number)] = 1

    def get(self, number: int) -> bool:
        """Whether a packet was received. Raises `RangeError`."""
        return bool(self._there[self._position(number)])

    def count(self) -> int:
        """How many packets were received."""
        return sum(self._there)

    def missing(self) -> list[int]:
        """Numbers of the packets that were not received, rising."""
        there = enumerate(self._there, self._first)
        return [number for number, is_there in there if not is_there]

    def to_bytes(self) -> bytes:
        """The map as it is sent."""
        form = self._form
        out = bytearray(form.bytes)
        for bit in range(8 * form.bytes):
            if bit >= self.packets:
                state = form.beyond_end
            else:
                state = form.received == self._there[bit]
            out[bit >> 3] |= state << self._weight(bit)
        return bytes(out)

    def messages(self) -> list[bytes]:
        """The map in the pieces that its messages carry."""
        data, size = self.to_bytes(), self._form.message_bytes
        return [data[at : at + size] for at in range(0, len(data), size)]

    def _weight(self, bit: int) -> int:
        return 7 - bit % 8 if self._form.msb0 else bit % 8

    def _position(self, number: int) -> int:
        if not 0 <= number - self._first < self.packets:
            last = self._first + self.packets - 1
            raise RangeError("packet", f"{self._first} to {last}", number)
        return number - self._first


class IndexEntry(NamedTuple):
    """An entry of the index file; ``time`` is packed, see `dos_time_unpack`."""

    type: int
    counter: int
    checksum: int
    size: int
    time: int
    meta: bytes = b""


def read_index(link: Link, data: bytes) -> tuple[list[IndexEntry], int]:
    """The entries of an index file, and the bytes of a truncated last one.

    Raises `UnsupportedError`.
    """
    form = need(link.index_file, "index_file")
    count, truncated = divmod(len(data), form.entry_bytes)
    entries = []
    for number in range(count):
        row = data[number * form.entry_bytes :][: form.entry_bytes]
        numbers = dict.fromkeys(IndexEntry._fields[:-1], 0)
        meta = b""
        for role, (at, size) in form.fields.items():
            if role == "meta":
                meta = row[at : at + size]
            else:
                numbers[role] = int.from_bytes(row[at : at + size], link.order)
        entries.append(IndexEntry(**numbers, meta=meta))
    return entries, truncated


def write_index(link: Link, entries: Iterable[IndexEntry]) -> bytes:
    """An index file.

    Raises `LengthError` for meta-data of another length, `RangeError` for a number that
    does not fit, and `UnsupportedError`.
    """
    form, out = need(link.index_file, "index_file"), bytearray()
    for entry in entries:
        row = bytearray(form.entry_bytes)
        for role, (at, size) in form.fields.items():
            value = getattr(entry, role)
            if role == "meta":
                if len(value) != size:
                    raise LengthError("the meta-data", size, len(value))
                row[at : at + size] = value
            elif 0 <= value < 1 << 8 * size:
                row[at : at + size] = value.to_bytes(size, link.order)
            else:
                raise RangeError(role, f"0 to {(1 << 8 * size) - 1}", value)
        out += row
    return bytes(out)
