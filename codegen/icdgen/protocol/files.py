"""Hole maps of file transfer and entries of the index file."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from icdgen.protocol.errors import LengthError, RangeError
from icdgen.protocol.facts import Facts, need


def hole_map(facts: Facts, packets: int, received: Iterable[int]) -> bytes:
    """Return the hole map of a block of ``packets`` packets.

    Raises `RangeError` if a received packet is not in the block or the map is too
    short.
    """
    form, first = (
        need(facts.hole_map, "file_transfer.hole_map"),
        need(facts.files, "file_transfer").first_packet,
    )
    positions = {number - first for number in received}
    if packets > form.bytes * 8 or not positions <= set(range(packets)):
        raise RangeError("packet")
    out = bytearray(form.bytes)
    for bit in range(form.bytes * 8):
        # Bits beyond the end of the block have their own value (`beyond_end`).
        state = (
            form.beyond_end
            if bit >= packets
            else form.received if bit in positions else 1 - form.received
        )
        out[bit // 8] |= state << (7 - bit % 8 if form.msb0 else bit % 8)
    return bytes(out)


def missing(facts: Facts, packets: int, map_: bytes) -> list[int]:
    """Return the numbers of the packets that the map marks as missing, in ascending
    order.

    Raises `RangeError` and `LengthError`.
    """
    form, first = (
        need(facts.hole_map, "file_transfer.hole_map"),
        need(facts.files, "file_transfer").first_packet,
    )
    if len(map_) != form.bytes:
        raise LengthError(form.bytes, len(map_))
    if packets > form.bytes * 8:
        raise RangeError("packet")
    numbers = []
    for bit in range(packets):
        if (
            map_[bit // 8] >> (7 - bit % 8 if form.msb0 else bit % 8) & 1
            != form.received
        ):
            numbers.append(first + bit)
    return numbers


def in_messages(facts: Facts, map_: bytes) -> list[bytes]:
    """Return the map in pieces, one for each message."""
    size = need(facts.hole_map, "file_transfer.hole_map").message_bytes
    return [map_[at : at + size] for at in range(0, len(map_), size)]


class IndexEntry(NamedTuple):
    """Entry of the index file; ``time`` is packed."""

    type: int
    counter: int
    checksum: int
    size: int
    time: int
    meta: bytes


def read_index(facts: Facts, data: bytes) -> tuple[list[IndexEntry], int]:
    """Return the entries and the number of bytes of a truncated last entry."""
    form = need(facts.index, "index_file")
    complete_bytes = len(data) // form.entry_bytes * form.entry_bytes
    entries = []
    for at in range(0, complete_bytes, form.entry_bytes):
        parts: dict[str, object] = {}
        for role, place in form.fields.items():
            content = data[at + place.at : at + place.at + place.bytes]
            parts[role] = content if role == "meta" else facts.number(content)
        entries.append(IndexEntry(**parts))  # type: ignore[arg-type]
    return entries, len(data) - complete_bytes


def write_index(facts: Facts, entries: Iterable[IndexEntry]) -> bytes:
    """Return the bytes of the index file.

    Raises `OverflowError`, and `LengthError` if metadata have the wrong size.
    """
    form, out = need(facts.index, "index_file"), b""
    for entry in entries:
        row = bytearray(form.entry_bytes)
        for role, place in form.fields.items():
            value = getattr(entry, role)
            if role == "meta":
                if len(value) != place.bytes:
                    raise LengthError(place.bytes, len(value))
            else:
                value = facts.bytes_of(value, place.bytes)
            row[place.at : place.at + place.bytes] = value
        out += row
    return out
