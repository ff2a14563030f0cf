"""Requests on packed times and the index file.

`requests` takes the link and the protocol facts of a node, and a random source. It
yields requests (``dos_time``, ``index_encode``, ``index_decode``) with their purpose,
also with dates, sizes and numbers that are invalid. It yields nothing for parts that
the ICD does not declare. `icdgen.vectors.protocol` adds the expected responses.
"""

from __future__ import annotations

from random import Random
from typing import Any

from icdgen_runtime.wire.files import IndexEntry, write_index
from icdgen_runtime.wire.times import DosTime

from icdgen.protocol.facts import Facts
from icdgen.runtime_objects.operations import AnyLink
from icdgen.vectors.wire import Requests


def requests(link: AnyLink, facts: Facts, source: Random) -> Requests:
    """Yield requests on packed times and the index file."""
    if facts.time:
        bits, some = (
            (1 << bit for bit in range(32)),
            (source.getrandbits(32) for _ in range(20)),
        )
        # 0x00210000 is the beginning of 1980, the earliest MS-DOS time.
        for value in (0, 0xFFFFFFFF, 0x00210000, *bits, *some):
            yield f"{value:08x}", {"op": "dos_time", "value": value}
        dates = [
            # Limits of MS-DOS time, leap years, and parts that do not exist.
            (1980, 1, 1, 0, 0, 0), (2000, 2, 29, 12, 30, 31), (2020, 11, 3, 23, 59, 59), (2107, 12, 31, 23, 59, 58),
            (1979, 12, 31, 0, 0, 0), (2108, 1, 1, 0, 0, 0), (2100, 2, 29, 0, 0, 0), (2021, 4, 31, 0, 0, 0),
            (2021, 0, 1, 0, 0, 0), (2021, 13, 1, 0, 0, 0), (2021, 1, 0, 0, 0, 0), (2021, 1, 1, 24, 0, 0),
            (2021, 1, 1, 0, 60, 0), (2021, 1, 1, 0, 0, 60),
            # several errors at once: nonexistent parts are reported before
            # unrepresentable ones, each from the year on
            (2108, 1, 1, 24, 60, 0), (1979, 13, 32, 0, 0, 0), (2021, 2, 30, 0, 0, 60), (2108, 1, 1, 23, 0, 0),
        ]  # fmt: skip
        for date in dates:
            yield (
                "a date",
                {"op": "dos_time", **dict(zip(DosTime._fields, date, strict=True))},
            )
    if facts.index:
        index = facts.index
        sizes = {role: place.bytes for role, place in index.fields.items()}
        entries = [_random_entry(sizes, source) for _ in range(3)]
        index_entries = [
            IndexEntry(**{**e, "meta": bytes.fromhex(e["meta"])}) for e in entries
        ]
        data = write_index(link, index_entries)
        yield "three entries", {"op": "index_encode", "entries": entries}
        for size in (0, 1, index.entry_bytes, len(data) - 1, len(data)):
            yield (
                f"{size} of {len(data)} bytes",
                {"op": "index_decode", "bytes": data[:size].hex()},
            )
        yield (
            "meta-data that are too short",
            {"op": "index_encode", "entries": [{**entries[0], "meta": "00"}]},
        )
        yield (
            "a number that does not fit",
            {"op": "index_encode", "entries": [{**entries[0], "counter": 256}]},
        )


def _random_entry(sizes: dict[str, int], source: Random) -> dict[str, Any]:
    """Return an entry of the index file; ``sizes`` are the bytes of its fields."""
    return {
        role: (
            source.randbytes(size).hex()
            if role == "meta"
            else source.getrandbits(8 * size)
        )
        for role, size in sizes.items()
    }
