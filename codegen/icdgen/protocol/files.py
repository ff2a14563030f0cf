"""Hole maps, and the entries of the index file."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from icdgen.protocol.errors import LengthError, RangeError
from icdgen.protocol.facts import Facts, need


def hole_map(facts: Facts, packets: int, received: Iterable[int]) -> bytes:
    """The map of a block of so many packets. Raises `RangeError`."""
    form, first = need(facts.hole_map, "file_transfer.hole_map"), need(facts.files, "file_transfer").first_packet
    there = {number - first for number in received}
    if packets > form.bytes * 8 or not there <= set(range(packets)):
        raise RangeError("packet")
    out = bytearray(form.bytes)
    for bit in range(form.bytes * 8):
        state = form.beyond_end if bit >= packets else form.received if bit in there else 1 - form.received
        out[bit // 8] |= state << (7 - bit % 8 if form.msb0 else bit % 8)
    return bytes(out)


def missing(facts: Facts, packets: int, map_: bytes) -> list[int]:
    """Numbers of the packets that the map says were not received, rising. Raises `RangeError`, `LengthError`."""
    form, first = need(facts.hole_map, "file_transfer.hole_map"), need(facts.files, "file_transfer").first_packet
    if len(map_) != form.bytes:
        raise LengthError(form.bytes, len(map_))
    if packets > form.bytes * 8:
        raise RangeError("packet")
    found = []
    for bit in range(packets):
        if map_[bit // 8] >> (7 - bit % 8 if form.msb0 else bit % 8) & 1 != form.received:
            found.append(first + bit)
    return found


def in_messages(facts: Facts, map_: bytes) -> list[bytes]:
    """The map in the pieces that the messages carry."""
    size = need(facts.hole_map, "file_transfer.hole_map").message_bytes
    return [map_[at : at + size] for at in range(0, len(map_), size)]


class IndexEntry(NamedTuple):
    """An entry of the index file; ``time`` is packed."""

    type: int
    counter: int
    checksum: int
    size: int
    time: int
    meta: bytes


def read_index(facts: Facts, data: bytes) -> tuple[list[IndexEntry], int]:
    """The entries, and the bytes of a truncated last one."""
    form = need(facts.index, "index_file")
    whole = len(data) // form.entry_bytes * form.entry_bytes
    entries = []
    for at in range(0, whole, form.entry_bytes):
        parts: dict[str, object] = {}
        for role, place in form.fields.items():
            found = data[at + place.at : at + place.at + place.bytes]
            parts[role] = found if role == "meta" else facts.number(found)
        entries.append(IndexEntry(**parts))  # type: ignore[arg-type]
    return entries, len(data) - whole


def write_index(facts: Facts, entries: Iterable[IndexEntry]) -> bytes:
    """The index file. Raises `OverflowError`, and `LengthError` for meta-data of another size."""
    form, out = need(facts.index, "index_file"), b""
    for entry in entries:
        one = bytearray(form.entry_bytes)
        for role, place in form.fields.items():
            value = getattr(entry, role)
            if role == "meta":
                if len(value) != place.bytes:
                    raise LengthError(place.bytes, len(value))
            else:
                value = facts.bytes_of(value, place.bytes)
            one[place.at : place.at + place.bytes] = value
        out += one
    return out
