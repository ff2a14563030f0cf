"""Requests on log files and unsolicited logs, complete and truncated.

`requests` takes the link and the protocol facts of a node, and a random source. It
yields requests that encode and decode logs for each mask of `masks`, and requests with
invalid masks or frames. Nodes without a log mask have none. `icdgen.vectors.protocol`
adds the expected responses.
"""

from __future__ import annotations

from random import Random
from typing import Any

from icdgen_runtime.wire.logs import LogMessage, LogWriter

from icdgen.protocol.facts import Facts, need
from icdgen.runtime_objects.operations import AnyLink
from icdgen.vectors.wire import Requests


def masks(facts: Facts) -> list[bytes]:
    """Return masks of no bit, of single bits, of some bits and of all bits."""
    layout = need(facts.mask, "log_mask")
    # A frame shorter than its slot is followed by fill bytes.
    short = [bit for bit, row in layout.bits.items() if row.length < layout.slot_bytes]
    free = [bit for bit in range(layout.size * 8) if bit not in layout.bits]
    single = [
        1 << bit for bit in (*sorted(layout.bits)[::7], *short, *free[:1], *free[-1:])
    ]
    some = sum(1 << bit for bit in (*sorted(layout.bits)[1:20:3], *short, *free[:1]))
    return [
        number.to_bytes(layout.size, "little")
        for number in (0, *single, some, (1 << 8 * layout.size) - 1)
    ]


def requests(link: AnyLink, facts: Facts, source: Random) -> Requests:
    """Yield requests on log files and unsolicited logs, complete and truncated."""
    layout = facts.mask
    if not layout:
        return
    for mask in masks(facts):
        slots = layout.selected(mask)
        data = [[source.randbytes(slot.length) for slot in slots] for _ in range(2)]
        if facts.log_file:
            most = [
                (1 << 8 * size) - 1
                for _, size in (facts.log_file.seconds, facts.log_file.milliseconds)
            ]
            times = [(0, 0), (min(0xFFFFFFFF, most[0]), min(999, most[1]))]
            # Two entries: at time 0, and at the latest time that the file can store
            rows = [(s, ms, row) for (s, ms), row in zip(times, data, strict=True)]
            writer = LogWriter(link, mask)
            file = writer.header() + b"".join(writer.entry(*row) for row in rows)
            yield (
                "two entries",
                {
                    "op": "log_encode",
                    "mask": mask.hex(),
                    "entries": [_entry(*row) for row in rows],
                },
            )
            for size in sorted(
                {0, len(mask) - 1, len(mask), len(mask) + 1, len(file) - 1, len(file)}
            ):
                yield (
                    f"{size} of {len(file)} bytes",
                    {"op": "log_decode", "bytes": file[:size].hex()},
                )
        if facts.log_message:
            message = LogMessage.encode(link, mask, data[0])
            frames = [frame.hex() for frame in data[0]]
            yield (
                "an unsolicited log",
                {"op": "log_message_encode", "mask": mask.hex(), "frames": frames},
            )
            for size in (len(message), len(message) - 1, 3):
                yield (
                    f"{size} of {len(message)} bytes",
                    {"op": "log_message_decode", "bytes": message[:size].hex()},
                )
    mask_of_one = (
        (1 << min(layout.bits, default=0)).to_bytes(layout.size, "little").hex()
    )
    invalid = [
        ("a frame too few", []),
        ("a frame too many", ["00" * layout.slot_bytes] * 2),
        ("a frame too short", ["00"]),
    ]
    for why, data_ in invalid:
        yield (
            why,
            {
                "op": "log_encode",
                "mask": mask_of_one,
                "entries": [{"seconds": 1, "milliseconds": 2, "frames": data_}],
            },
        )
    yield "a mask that is too short", {"op": "log_encode", "mask": "01", "entries": []}


def _entry(seconds: int, milliseconds: int, frames: list[bytes]) -> dict[str, Any]:
    return {
        "seconds": seconds,
        "milliseconds": milliseconds,
        "frames": [frame.hex() for frame in frames],
    }
