"""Requests about framing: golden ones with a few changes, and the answers of the
reference implementation.
"""

from __future__ import annotations

import copy
import random
import re
from collections.abc import Iterator

from icdgen_runtime._errors import IcdError

from icdgen.icd.model import Icd
from icdgen.runtime_objects import reference
from icdgen.runtime_objects.procedures import event_of, procedure_of
from icdgen.runtime_objects.refusals import Refusal
from tests import links

FRAMING = (0x1F, 0x7F, 0xFF)
CAN_BYTES = 8  # a bus carries no longer packet, and not every language can hold one
WORDS = {"kind", "bus", "do", "event", "op", "node"}


def requests(
    icd: Icd, vectors: dict, source: random.Random, count: int
) -> Iterator[tuple[dict, dict]]:
    """Yield ``count`` requests with their answers, each operation equally often."""
    by_op: dict[str, list[dict]] = {}
    for node in vectors["nodes"]:
        for case in node["cases"]:
            by_op.setdefault(case["request"]["op"], []).append(case["request"])
    names = sorted(by_op)
    while count:
        request = copy.deepcopy(source.choice(by_op[names[count % len(names)]]))
        for _ in range(source.choice((1, 1, 2, 3, 6))):
            request = _changed(source, request, "")
        _in_time(request.get("script"))
        _in_time(request.get("packets"))
        if any(
            len(packet.get("bytes", "")) > 2 * CAN_BYTES for packet in _packets(request)
        ):
            continue
        if request["op"] == "procedure" and not _frames_are_whole(icd, request):
            continue
        answer = reference.answer(icd, request)
        answer.pop("detail", None)  # text for people
        yield request, answer
        count -= 1


def _packets(request: dict) -> Iterator[dict]:
    """Return the CAN packets of a request."""
    for row in request.get("packets") or () if request["op"] == "can_join" else ():
        yield row
    for row in request.get("script") or ():
        if isinstance(row.get("receive"), dict):
            yield row["receive"]


def _changed(source: random.Random, value, key: str):
    if isinstance(value, dict):
        keys = [k for k in value if k not in WORDS]
        if keys:
            chosen = source.choice(keys)
            value[chosen] = _changed(source, value[chosen], chosen)
    elif isinstance(value, list) and value:
        _change_list(source, value, key)
    elif isinstance(value, bool):
        return not value
    elif isinstance(value, int):
        return max(
            0,
            source.choice(
                (
                    value + 1,
                    value - 1,
                    value ^ 1 << source.randrange(8),
                    value + source.randrange(2000),
                )
            ),
        )
    elif isinstance(value, str) and re.fullmatch("([0-9a-f]{2})*", value):
        return _change_bytes(source, bytearray.fromhex(value)).hex()
    return value


def _change_list(source: random.Random, rows: list, key: str) -> None:
    at, other = source.randrange(len(rows)), source.randrange(len(rows))
    what = source.choice(("remove", "repeat", "swap", "cut", "change", "change"))
    if what == "remove":
        del rows[at]
    elif what == "repeat":
        rows.insert(at, copy.deepcopy(rows[at]))
    elif what == "swap":
        rows[at], rows[other] = rows[other], rows[at]
    elif what == "cut" and key == "chunks" and len(rows[at]) > 2:
        middle = 2 * source.randrange(1, len(rows[at]) // 2)
        rows[at : at + 1] = [rows[at][:middle], rows[at][middle:]]
    else:
        rows[at] = _changed(source, rows[at], key)


def _change_bytes(source: random.Random, data: bytearray) -> bytearray:
    at, byte = (
        source.randrange(len(data) + 1),
        source.choice((*FRAMING, source.randrange(256))),
    )
    what = source.choice(("set", "flip", "remove", "insert", "repeat"))
    if what == "insert" or at == len(data):
        data.insert(at, byte)
    elif what == "set":
        data[at] = byte
    elif what == "flip":
        data[at] ^= 1 << source.randrange(8)
    elif what == "remove":
        del data[at]
    else:
        data[at:at] = data[at : at + 40]
    return data


def _in_time(rows) -> None:
    """Change a script so that time never runs backwards."""
    now = 0
    for row in rows if isinstance(rows, list) else ():
        if isinstance(row.get("at"), int):
            now = row["at"] = max(now, row["at"])


def _frames_are_whole(icd: Icd, request: dict) -> bool:
    """Return whether every received frame has its full length. The client accepts no
    other frames.
    """
    link = links.link(icd, request["node"])
    try:
        procedure = procedure_of(link, request)
    except (Refusal, IcdError):
        return True
    for row in request["script"]:
        event, pending = row.get("event"), procedure._request
        if (
            event
            and event["event"] == "done"
            and procedure._is_requested
            and pending is not None
            and pending.kind == "telemetry"
            and len(event["bytes"]) != 2 * link.TELEMETRY[pending.id].LENGTH
        ):
            return False
        if event:
            procedure.event(row["at"], event_of(event))
        procedure.next(row["at"])
    return True
