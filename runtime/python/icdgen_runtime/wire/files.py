"""The index file: a list of the files of a device, one entry of fixed size per file."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from .._errors import LengthError, RangeError
from .errors import need
from .link import Link


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
