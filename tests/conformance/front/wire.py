"""Answer requests about framing: bytes and packets on each bus."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from icdgen.icd.responses import KINDS as VERDICTS
from icdgen.protocol.packet_formats import DIRECTIONS, GIVEN
from icdgen.protocol.sections import CAN_KINDS
from icdgen.runtime_objects.refusals import Refusal
from icdgen.runtime_objects.request_keys import (
    flag,
    hex_bytes,
    mappings,
    number,
    octets,
    rows,
    text,
)
from tests.conformance.front.program import Facts, Reply, items

Request = dict[str, Any]
Answer = dict[str, Any]

CAN_BYTES = 8  # of a classic CAN frame
MOST = (1 << 32) - 1
DATE = ("year", "month", "day", "hour", "minute", "second")
ENTRY = ("type", "counter", "checksum", "size", "time")
USERS = ("boot_ms", "log_file_type", "index_file_type")
TEXTS = {"bytes", "mask", "meta", "write", "kind", "reason", "result", "error"}


class LinkProgram(NamedTuple):
    """The function that asks the program about a link, and the plan of the link."""

    ask: Callable[..., Reply]
    link: dict[str, Any]


def typed(facts: Facts) -> Answer:
    """Return a row as JSON: hex and words as text, other values as numbers, null for a
    missing number.
    """
    answer: Answer = {}
    for key, value in facts.items():
        if key in TEXTS:
            answer[key] = value
        else:
            answer[key] = int(value) if value else None
    return answer


def event(kind: str, facts: Facts) -> Answer:
    answer = {"event": kind, **typed(facts)}
    if kind in ("message", "request", "packet") and "reason" in facts:
        # The value of a field of the packet; elsewhere, a reason is a word.
        answer["reason"] = int(facts["reason"])
    return answer


def checksum(to: LinkProgram, request: Request) -> Answer:
    name = text(request, "name").encode().hex()
    return typed(to.ask("checksum", name, octets(request).hex()).facts)


def uart_encode(to: LinkProgram, request: Request) -> Answer:
    return typed(to.ask("uart_encode", octets(request).hex()).facts)


def uart_decode(to: LinkProgram, request: Request) -> Answer:
    reply = to.ask("uart_events", to.link["longest"], octets(request).hex())
    return {"frames": [row["bytes"] for row in reply.rows_of("message")]}


def uart_events(to: LinkProgram, request: Request) -> Answer:
    longest = to.link["longest"]
    limit, chunks = (
        number(request, "limit", 1, longest, longest),
        rows(request, "chunks"),
    )
    reply = to.ask("uart_events", limit, *(hex_bytes(chunk).hex() for chunk in chunks))
    return {"events": [event(*row) for row in reply.rows], **typed(reply.facts)}


def can_split(to: LinkProgram, request: Request) -> Answer:
    kind, data = text(request, "kind"), octets(request).hex()
    if kind not in CAN_KINDS:
        raise Refusal("request", detail="there is no such kind")
    ids = [number(request, key, 0, 255) for key in ("id", "source", "destination")]
    return {
        "packets": [
            typed(row)
            for row in to.ask("can_split", kind, *ids, data).rows_of("packet")
        ]
    }


def can_join(to: LinkProgram, request: Request) -> Answer:
    address = number(request, "address", 0, 255) if "address" in request else ""
    senders = number(request, "senders", 1, 16, 4)
    end = number(request, "end") if "end" in request else ""
    packets: list[object] = []
    for row in mappings(request, "packets"):
        data = octets(row)
        if len(data) > CAN_BYTES:
            raise Refusal("request", detail="a packet has too many bytes")
        packets += (
            number(row, "at", default=0),
            number(row, "id", 0, (1 << 29) - 1),
            data.hex(),
        )
    return {
        "events": [
            event(*row)
            for row in to.ask("can_join", address, senders, end, *packets).rows
        ]
    }


def i2c_request(to: LinkProgram, request: Request) -> Answer:
    kind, id, checked = (
        text(request, "kind"),
        number(request, "id", 0, 255),
        flag(request, "crc"),
    )
    if kind == "telemetry":
        return {
            "write": bytes([id]).hex(),
            **typed(to.ask("i2c_read", id, int(checked)).facts),
        }
    if kind != "telecommand":
        raise Refusal("request", detail="there is no such kind")
    return {
        **typed(to.ask("i2c_write", id, int(checked), octets(request).hex()).facts),
        "read": 0,
    }


def i2c_reply(to: LinkProgram, request: Request) -> Answer:
    id, data, checked = (
        number(request, "id", 0, 255),
        octets(request),
        flag(request, "crc"),
    )
    return typed(to.ask("i2c_reply", id, int(checked), data.hex()).facts)


def log_decode(to: LinkProgram, request: Request) -> Answer:
    """Decode a log at once, byte by byte and in chunks of seven bytes. All three
    results must be equal.
    """
    data = octets(request)
    replies = [
        to.ask(
            "log_decode",
            *(data[at : at + size].hex() for at in range(0, len(data), size)),
        )
        for size in (len(data) or 1, 1, 7)
    ]
    reply = replies[0]
    if replies.count(reply) != len(replies):
        raise Refusal("pieces", detail="it depends on how the file was cut")
    entries: list[Answer] = []
    for kind, row in reply.rows:
        if kind == "entry":
            entries.append({**typed(row), "frames": []})
        else:
            entries[-1]["frames"].append(typed(row))
    return {"mask": None, **typed(reply.facts), "entries": entries}


def log_encode(to: LinkProgram, request: Request) -> Answer:
    words: list[object] = []
    for entry in mappings(request, "entries"):
        frames = _hex_rows(entry, "frames")
        words += (
            number(entry, "seconds"),
            number(entry, "milliseconds", 0, 65535),
            len(frames),
            *frames,
        )
    return _joined(to.ask("log_encode", octets(request, "mask").hex(), *words))


def log_message_decode(to: LinkProgram, request: Request) -> Answer:
    reply = to.ask("log_message_decode", octets(request).hex())
    return {
        **typed(reply.facts),
        "frames": [typed(row) for row in reply.rows_of("frame")],
    }


def log_message_encode(to: LinkProgram, request: Request) -> Answer:
    frames = _hex_rows(request, "frames")
    return typed(
        to.ask(
            "log_message_encode", octets(request, "mask").hex(), len(frames), *frames
        ).facts
    )


def dos_time(to: LinkProgram, request: Request) -> Answer:
    if "value" in request:
        facts = typed(to.ask("dos_time_unpack", number(request, "value")).facts)
        return {**facts, "valid": bool(facts["valid"])}
    return typed(
        to.ask("dos_time_pack", *(number(request, key, 0, 9999) for key in DATE)).facts
    )


def index_decode(to: LinkProgram, request: Request) -> Answer:
    reply = to.ask("index_decode", octets(request).hex())
    return {
        **typed(reply.facts),
        "entries": [typed(row) for row in reply.rows_of("entry")],
    }


def index_encode(to: LinkProgram, request: Request) -> Answer:
    words: list[object] = []
    for row in mappings(request, "entries"):
        words += (*(number(row, key) for key in ENTRY), octets(row, "meta").hex())
    return _joined(to.ask("index_encode", *words))


def identify(to: LinkProgram, request: Request) -> Answer:
    facts = typed(to.ask("identify", octets(request).hex()).facts)
    return {**facts, "matches": bool(facts["matches"])}


def link_data(to: LinkProgram, request: Request) -> Answer:
    facts = typed(to.ask("link_data").facts)
    return {key: facts.get(key) for key in USERS}


def stream_encode(to: LinkProgram, request: Request) -> Answer:
    # 2: the packet that requests telemetry of the id
    is_request = request.get("direction") == "request"
    direction = len(DIRECTIONS) if is_request else _direction(request)
    id, data, chosen = number(request, "id"), octets(request).hex(), _chosen(request)
    return typed(to.ask("stream_encode", direction, id, data, *chosen).facts)


def stream_encode_packet(to: LinkProgram, request: Request) -> Answer:
    packet, id = number(request, "packet"), number(request, "id")
    words = (_direction(request), packet, id, *_chosen(request))
    return typed(to.ask("stream_encode_packet", *words).facts)


def _chosen(request: Request) -> list[object]:
    """Return the values of the fields that the sender chooses, in the order of the
    roles.
    """
    values = request.get("values", {})
    if not isinstance(values, dict) or not set(values) <= set(GIVEN):
        raise Refusal(
            "request",
            detail="`values` are those of fields that the sender chooses, by role",
        )
    return [number(values, role) if role in values else "" for role in GIVEN]


def stream_events(to: LinkProgram, request: Request) -> Answer:
    direction, longest = _direction(request), to.link["longest"]
    limit, chunks = (
        number(request, "limit", to.link["around"], longest, longest),
        rows(request, "chunks"),
    )
    reply = to.ask(
        "stream_events", direction, limit, *(hex_bytes(chunk).hex() for chunk in chunks)
    )
    return {"events": [event(*row) for row in reply.rows], **typed(reply.facts)}


def stream_respond(to: LinkProgram, request: Request) -> Answer:
    verdict = text(request, "verdict")
    if verdict not in VERDICTS:
        raise Refusal("request", detail="there is no such verdict")
    reason = number(request, "reason", default=0)
    chunks = [hex_bytes(chunk).hex() for chunk in rows(request, "chunks")]
    data, chosen = octets(request).hex(), _chosen(request)
    for role, value in request.get("values", {}).items():
        if role not in to.link["of_device"]:
            raise Refusal("unsupported")
        if value > to.link["of_device"][role]:
            raise Refusal("range")
    words = (int("reason" in request), reason, data, *chosen, *chunks)
    reply = to.ask("stream_respond", VERDICTS.index(verdict), *words)
    return {"responses": [typed(row) for row in reply.rows_of("response")]}


def _direction(request: Request) -> int:
    """Return the program's number of a direction."""
    direction = text(request, "direction")
    if direction not in DIRECTIONS:
        raise Refusal("request", detail="there is no such direction")
    return DIRECTIONS.index(direction)


def _joined(reply: Reply) -> Answer:
    """Return bytes that may arrive in chunks."""
    return {"bytes": "".join(items(reply.facts["bytes"]))}


def _hex_rows(request: Request, key: str) -> list[str]:
    return [hex_bytes(row).hex() for row in rows(request, key)]


OPS: dict[str, Callable[[LinkProgram, Request], Answer]] = {
    op.__name__: op
    for op in (
        checksum, uart_encode, uart_decode, uart_events, can_split, can_join, i2c_request, i2c_reply, log_decode,
        log_encode, log_message_decode, log_message_encode, dos_time, index_decode, index_encode, identify,
        link_data, stream_encode, stream_encode_packet, stream_events, stream_respond,
    )
}  # fmt: skip
