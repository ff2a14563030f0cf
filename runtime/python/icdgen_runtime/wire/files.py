"""Hole maps, and the index file."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from .._errors import LengthError, RangeError
from .errors import need
from .link import Link


class HoleMap:
    """Received packets of a block, one bit each.

    Packets have their number in the block, from the first number in the ICD. Raise
    `RangeError` for more packets than bits of the map, and `UnsupportedError`.
    """

    def __init__(self, link: Link, packets: int, received: Iterable[int] = ()) -> None:
        self._form = form = need(link.hole_map, "file_transfer.hole_map")
        self._first = need(link.files, "file_transfer").first_packet
        self.packets = packets
        if not 0 <= packets <= 8 * form.bytes:
            raise RangeError("packets", f"0 to {8 * form.bytes}", packets)
        self._received = bytearray(packets)
        for number in received:
            self.set(number)

    @classmethod
    def from_bytes(cls, link: Link, packets: int, data: bytes) -> HoleMap:
        """Decode a map.

        Bits beyond the end of the block are ignored. Raise `LengthError`.
        """
        form = need(link.hole_map, "file_transfer.hole_map")
        if len(data) != form.bytes:
            raise LengthError("a hole map", form.bytes, len(data))
        result = cls(link, packets)
        for bit in range(packets):
            state = data[bit >> 3] >> result._weight(bit) & 1
            result._received[bit] = state == form.received
        return result

    def set(self, number: int) -> None:
        """Mark a packet as received. Raise `RangeError`."""
        self._received[self._position(number)] = 1

    def get(self, number: int) -> bool:
        """Return whether a packet was received. Raise `RangeError`."""
        return bool(self._received[self._position(number)])

    def count(self) -> int:
        """Return the number of received packets."""
        return sum(self._received)

    def missing(self) -> list[int]:
        """Return the numbers of the missing packets, in ascending order."""
        received = enumerate(self._received, self._first)
        return [number for number, is_there in received if not is_there]

    def to_bytes(self) -> bytes:
        """Encode the map."""
        form = self._form
        out = bytearray(form.bytes)
        for bit in range(8 * form.bytes):
            if bit >= self.packets:
                state = form.beyond_end
            else:
                state = form.received == self._received[bit]
            out[bit >> 3] |= state << self._weight(bit)
        return bytes(out)

    def messages(self) -> list[bytes]:
        """Return the encoded map in pieces, one for each message."""
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
    """An entry of the index file. ``time`` is packed, see `dos_time_unpack`."""

    type: int
    counter: int
    checksum: int
    size: int
    time: int
    meta: bytes = b""


def read_index(link: Link, data: bytes) -> tuple[list[IndexEntry], int]:
    """Decode an index file.

    Return its entries and the number of surplus bytes at its end.

    Raise `UnsupportedError`.
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
    """Encode an index file.

    Raise `LengthError` for meta-data of another length, `RangeError` for a number out
    of range, and `UnsupportedError`.
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
