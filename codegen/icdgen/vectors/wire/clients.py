"""Scripts of the client on each bus: replies, negative acknowledges, time-outs, late
and unrelated messages.

These are the clients of UART, CAN and I2C; ``asking`` has the client over a packet
format and explains the rows of scripts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from random import Random
from typing import Any

from icdgen_runtime.wire.awaited import MOST_AWAITED
from icdgen_runtime.wire.can import CanMessage, can_split
from icdgen_runtime.wire.i2c import i2c_write
from icdgen_runtime.wire.link import CanKind
from icdgen_runtime.wire.logs import LogMessage
from icdgen_runtime.wire.uart import uart_encode

from icdgen.icd.buses import CAN, I2C, UART
from icdgen.icd.model import CONFIGURATION, Message
from icdgen.protocol.facts import Facts, need
from icdgen.runtime_objects.links import acknowledge_of, responses_on, with_outcome
from icdgen.runtime_objects.operations import AnyLink
from icdgen.vectors.wire import Requests, Row, Script

SETTINGS = {
    "reply_timeout": 100,
    "retries": 2,
    "poll_interval": 10,
    "poll_timeout": 50,
    "late": 100,
}
OURS = 0x42  # CAN address of the client


class BusSample:
    """Messages of the node for the scripts.

    If the node has no message of a kind, another one replaces it.
    """

    def __init__(self, link: AnyLink, facts: Facts, source: Random) -> None:
        self.link, self.facts = link, facts
        sent, frames = facts.telecommands.values(), facts.telemetry.values()
        acknowledged = [m for m in sent if m.acknowledge and m.kind != CONFIGURATION]
        # Prefer a telecommand that fits into one CAN packet.
        self.plain: Message = max(
            acknowledged or sent, key=lambda m: (m.length <= 8, m.length)
        )
        self.long: Message = max(sent, key=lambda m: m.length)
        self.setting = next((m for m in sent if m.kind == CONFIGURATION), None)
        self.silent = next(
            (m for m in sent if not m.acknowledge and not m.expects_reset), None
        )
        self.reset = next((m for m in sent if m.expects_reset), None)
        self.wide: Message = max(frames, key=lambda m: m.length)
        self.frame: Message = next((m for m in frames if m.length > 1), self.wide)
        self.source = source

    def ask(self, at: int, message: Message, **more: object) -> dict[str, Any]:
        return {
            "at": at,
            "telecommand": message.telecommand_id,
            "bytes": self.source.randbytes(message.length).hex(),
            **more,
        }

    def request(self, at: int, message: Message) -> dict[str, Any]:
        return {"at": at, "telemetry": message.telemetry_id}

    def line(self, message: bytes) -> str:
        """Return the bytes of a message on the UART, in hexadecimal."""
        return uart_encode(self.link, message).hex()

    def acknowledge(self, message: Message, code: int = 0) -> str:
        """Return the bytes of an acknowledge on the UART, in hexadecimal."""
        return self.line(acknowledge_of(self.link, message.telecommand_id or 0, code))


def scripts(link: AnyLink, facts: Facts) -> Requests:
    """Yield the scripts of the client on all buses."""
    if not facts.telecommands or not facts.telemetry:
        return
    sample = BusSample(link, facts, Random(f"{facts.node.name} client"))
    if facts.framing and facts.acknowledge:
        for why, rows in _uart(facts, sample):
            yield f"UART: {why}", _op(UART, rows)
        if facts.checksum and UART in facts.checksum.telecommand_buses:
            for why, rows in _checked(facts, sample):
                yield f"UART with checksum: {why}", _op(UART, rows, crc=True)
        if facts.checksum and UART in facts.checksum.telemetry_buses:
            for why, rows in _checked_frames(facts, sample):
                yield f"UART, {why}", _op(UART, rows)
                yield f"UART with checksum, {why}", _op(UART, rows, crc=True)
    if facts.polled and facts.i2c_address is not None:
        for checked in (False, True) if facts.checksum else (False,):
            for why, rows in _i2c(facts, sample, checked):
                yield (
                    f"I2C{' with checksum' * checked}: {why}",
                    _op(I2C, rows, **({"crc": True} if checked else {})),
                )
    if facts.can:
        for why, rows in _can(facts, sample):
            yield f"CAN: {why}", _op(CAN, rows, address=OURS)


def _op(bus: str, script: list[dict[str, Any]], **more: object) -> dict[str, Any]:
    return {"op": "client", "bus": bus, **more, "settings": SETTINGS, "script": script}


def _uart(facts: Facts, s: BusSample) -> Iterator[tuple[str, list[dict[str, Any]]]]:
    def ack(at: int, message: Message, code: int = 0) -> dict[str, Any]:
        return {"at": at, "receive": s.acknowledge(message, code)}

    def reply(at: int, message: Message, more: int = 0) -> dict[str, Any]:
        data = s.source.randbytes(message.length + more)
        return {"at": at, "receive": s.line(bytes([message.telemetry_id or 0]) + data)}

    plain, frame, framing = s.plain, s.frame, need(facts.framing, "uart")
    other = next(
        (m for m in facts.telecommands.values() if m.acknowledge and m is not plain),
        plain,
    )
    escape = f"{framing.escape:02x}"
    begin, finish = f"{escape}{framing.start:02x}", f"{escape}{framing.end:02x}"
    yield (
        "a telecommand and its acknowledge",
        [s.ask(0, plain), ack(30, plain), s.ask(30, plain), ack(40, plain)],
    )
    for name, code in facts.reasons.items():
        yield f"refused: {name}", [s.ask(0, plain), ack(30, plain, code)]
    yield "refused with a code that has no name", [s.ask(0, plain), ack(30, plain, 200)]
    yield (
        "the next before the acknowledge",
        [s.ask(0, plain), s.ask(5, plain), s.request(5, frame), ack(30, plain)],
    )
    yield (
        "no acknowledge",
        [
            s.ask(0, plain),
            {"at": 99},
            {"at": 100},
            s.request(101, frame),
            reply(102, frame),
        ],
    )
    yield "no acknowledge, and it may be repeated", [
        s.ask(0, plain, repeat=True), {"at": 100}, {"at": 200}, {"at": 299}, {"at": 300}, {"at": 1000},
    ]  # fmt: skip
    yield "a late acknowledge is not that of the next with the same id", [
        s.ask(0, plain, repeat=True), {"at": 100}, ack(120, plain), s.ask(125, plain), ack(130, plain), {"at": 219},
        {"at": 220}, ack(230, plain),
    ]  # fmt: skip
    yield "after a late acknowledge another id need not wait", [
        s.ask(0, plain, repeat=True), {"at": 100}, ack(120, plain), s.ask(125, other), ack(130, plain), ack(140, other),
    ]  # fmt: skip
    yield "a late acknowledge confirms nothing after another request has ended", [
        s.ask(0, plain), {"at": 100}, s.request(101, frame), reply(102, frame), s.ask(110, plain), ack(120, plain),
        ack(130, plain, 3),
    ]  # fmt: skip
    yield "a late frame that is damaged is still awaited", [
        s.request(0, frame), {"at": 1, "cancel": True}, s.request(2, frame), reply(3, frame, 1), reply(4, frame),
        reply(5, frame),
    ]  # fmt: skip
    yield from _many_late(s, reply)
    yield (
        "an unexpected acknowledge",
        [ack(0, plain), s.request(1, frame), ack(2, plain), reply(3, frame)],
    )
    yield (
        "the acknowledge of another telecommand",
        [s.ask(0, plain), ack(1, other), ack(2, plain)],
    )
    yield "a frame", [s.request(0, frame), reply(30, frame)]
    yield (
        "the longest frame and the longest telecommand",
        [s.request(0, s.wide), reply(90, s.wide), s.ask(91, s.long)],
    )
    pieces = reply(1, frame)["receive"]
    # The last cut is between the escape byte and the end of the frame.
    yield "a frame that comes in pieces, after noise", [
        s.request(0, frame), {"at": 1, "receive": "0055" + pieces[:6]}, {"at": 2},
        {"at": 3, "receive": pieces[6:-2]}, {"at": 4, "receive": pieces[-2:]},
    ]  # fmt: skip
    yield (
        "a frame that comes at the third try",
        [s.request(0, frame), {"at": 100}, {"at": 200}, reply(250, frame)],
    )
    yield (
        "a frame that never comes",
        [s.request(0, frame), {"at": 100}, {"at": 200}, {"at": 300}],
    )
    yield (
        "time stands still, then jumps",
        [s.request(0, frame), {"at": 5000}, {"at": 5000}, reply(5001, frame)],
    )
    yield (
        "a frame that is too long",
        [s.request(0, frame), reply(1, frame, 1), reply(2, frame)],
    )
    yield (
        "a frame that was not asked for",
        [s.request(0, frame), reply(1, s.wide), reply(2, frame)],
    )
    yield "errors in the stream", [
        s.request(0, frame), {"at": 1, "receive": f"{begin}90{escape}00"},
        {"at": 2, "receive": f"{begin}{finish}{begin}90"}, reply(3, frame),
    ]  # fmt: skip
    cancel = {"cancel": True}
    yield "cancelled: its acknowledge is unexpected, and another id need not wait", [
        s.ask(0, plain), {"at": 5, **cancel}, s.ask(5, other), ack(6, plain), ack(7, other),
    ]  # fmt: skip
    yield "cancelled, and the same id again", [
        s.ask(0, plain), {"at": 5, **cancel}, s.ask(6, plain), ack(7, plain), {"at": 199}, {"at": 200}, ack(201, plain),
    ]  # fmt: skip
    yield "cancelled while it is delayed", [
        s.ask(0, plain), {"at": 5, **cancel}, s.ask(6, plain), {"at": 7, **cancel}, s.ask(8, plain), {"at": 200}, ack(201, plain),
    ]  # fmt: skip
    yield "cancelled twice, and with nothing to cancel", [
        {"at": 0, **cancel}, s.request(0, frame), {"at": 1, **cancel}, {"at": 1, **cancel}, {"at": 100}, {"at": 500},
        s.request(500, frame), reply(501, frame),
    ]  # fmt: skip
    if s.setting:
        yield (
            "a setting is repeated",
            [s.ask(0, s.setting), {"at": 100}, ack(110, s.setting)],
        )
    if s.silent:
        yield (
            "not acknowledged",
            [
                s.ask(0, s.silent),
                s.ask(0, s.silent),
                s.request(0, frame),
                reply(9, frame),
            ],
        )
    if s.reset:
        yield "a reset", [s.ask(0, s.reset), ack(5, s.reset)]
    unknown = next(id for id in range(256) if id not in facts.telecommands)
    yield (
        "an unknown id",
        [{"at": 0, "telecommand": unknown, "bytes": ""}, {"at": 0, "telemetry": 0}],
    )
    yield (
        "a wrong length",
        [
            {
                "at": 0,
                "telecommand": plain.telecommand_id,
                "bytes": "00" * (plain.length + 1),
            }
        ],
    )
    for head, id in facts.unsolicited.items():
        data = bytes([head]) + s.source.randbytes(facts.telemetry[id].length)
        yield "download packets", [{"at": 0, "receive": s.line(data) * 2}]
    if facts.mask and facts.log_message:
        log = LogMessage.encode(s.link, bytes(facts.mask.size), [])
        yield "an unsolicited log while a reply is awaited", [
            s.request(0, frame), {"at": 1, "receive": s.line(log)}, reply(2, frame),
        ]  # fmt: skip


def _many_late(
    s: BusSample, reply: Callable[[int, Message], Row]
) -> Iterator[tuple[str, Script]]:
    """Yield requests that are cancelled until a client remembers no more of them."""
    *frames, last = list(s.facts.telemetry.values())[: MOST_AWAITED + 1]
    if len(frames) < MOST_AWAITED:
        return
    cancelled = [
        row
        for at, frame in enumerate(frames)
        for row in (s.request(10 * at, frame), {"at": 10 * at + 1, "cancel": True})
    ]
    for why, rows in {
        "until one is forgotten": [{"at": 199}, {"at": 200}],
        "until one has arrived": [reply(90, frames[3])],
    }.items():
        yield f"more late frames than a client remembers: the next request waits {why}", [
            *cancelled, s.request(80, last), *rows, reply(205, last),
        ]  # fmt: skip


def _checked(facts: Facts, s: BusSample) -> Iterator[tuple[str, list[dict[str, Any]]]]:
    code = facts.reasons.get("checksum")
    if code is None:
        return
    bad = {"receive": s.acknowledge(s.plain, code)}
    good = {"receive": s.acknowledge(s.plain)}
    yield (
        "sent again after a wrong checksum",
        [s.ask(0, s.plain), {"at": 1, **bad}, {"at": 2, **good}],
    )
    yield (
        "always a wrong checksum",
        [s.ask(0, s.plain), *({"at": at, **bad} for at in range(1, 5))],
    )


def _checked_frames(
    facts: Facts, s: BusSample
) -> Iterator[tuple[str, list[dict[str, Any]]]]:
    id, data = s.frame.telemetry_id or 0, s.source.randbytes(s.frame.length)
    right, bare = i2c_write(s.link, id, data, True), i2c_write(s.link, id, data, False)
    wrong = right[:-1] + bytes([right[-1] ^ 1])
    good, bad, missing = (
        {"receive": s.line(checked)} for checked in (right, wrong, bare)
    )
    yield "a frame with its checksum", [s.request(0, s.frame), {"at": 1, **good}]
    yield (
        "a wrong checksum, then the right one",
        [s.request(0, s.frame), {"at": 1, **bad}, {"at": 2, **good}],
    )
    yield (
        "a frame without its checksum, then with it",
        [s.request(0, s.frame), {"at": 1, **missing}, {"at": 2, **good}],
    )
    yield (
        "always a wrong checksum",
        [
            s.request(0, s.frame),
            *({"at": at, **bad} for at in (1, 101, 201)),
            {"at": 301},
        ],
    )
    longer = {
        "receive": s.line(
            bare + bytes(facts.checksum.bytes + 1 if facts.checksum else 1)
        )
    }
    yield (
        "more than a checksum behind a frame",
        [s.request(0, s.frame), {"at": 1, **longer}, {"at": 2, **good}],
    )


def _i2c(
    facts: Facts, s: BusSample, checked: bool
) -> Iterator[tuple[str, list[dict[str, Any]]]]:
    polled, (response,) = need(facts.polled, "polled"), responses_on(s.link, I2C)
    success = next(code for code, says in response.meanings if says == "ack")
    checked_frames = bool(
        checked and facts.checksum and I2C in facts.checksum.telemetry_buses
    )

    def frame(message: Message, data: bytes) -> str:
        # `i2c_write` begins with the id, which a reply does not repeat.
        return i2c_write(s.link, message.telemetry_id or 0, data, checked_frames)[
            1:
        ].hex()

    def state(
        at: int, message: Message, processed: int, code: int = 0
    ) -> dict[str, Any]:
        id, parameter = message.telecommand_id or 0, 7 if code else 0
        empty = bytes(polled.length)
        data = with_outcome(s.link, empty, id, bool(processed), code, parameter)
        return {"at": at, "receive": frame(polled, data)}

    plain, wide = s.plain, s.frame
    other = next((m for m in facts.telecommands.values() if m is not plain), plain)
    written, failed = {"at": 1, "receive": ""}, {"receive": None}
    yield "a telecommand, polled until it is processed", [
        s.ask(0, plain), written, {"at": 10}, {"at": 11}, state(12, plain, 0), {"at": 22}, state(23, plain, 1),
    ]  # fmt: skip
    yield "the acknowledge is still that of another telecommand", [
        s.ask(0, plain), written, {"at": 11}, state(12, other, 1), {"at": 22}, state(23, plain, 1),
    ]  # fmt: skip
    for name, code in {"none": success, **facts.reasons}.items():
        yield (
            f"outcome {name}",
            [s.ask(0, plain), written, {"at": 11}, state(12, plain, 1, code)],
        )
    yield "never processed", [
        s.ask(0, plain), written, *(row for at in range(11, 100, 11) for row in ({"at": at}, state(at + 1, plain, 0))),
    ]  # fmt: skip
    yield (
        "polling fails once",
        [
            s.ask(0, plain),
            written,
            {"at": 11},
            {"at": 12, **failed},
            {"at": 22},
            state(23, plain, 1),
        ],
    )
    yield "the write fails", [s.ask(0, plain), {"at": 1, **failed}]
    yield "the write fails, and it may be repeated", [
        s.ask(0, plain, repeat=True), {"at": 1, **failed}, {"at": 11}, {"at": 12, **failed}, {"at": 22}, {"at": 23, **failed},
    ]  # fmt: skip
    yield (
        "the driver says nothing",
        [
            s.request(0, wide),
            {"at": 100},
            {"at": 110},
            {"at": 210},
            {"at": 220},
            {"at": 320},
        ],
    )
    yield (
        "a frame",
        [
            s.request(0, wide),
            {"at": 1, "receive": frame(wide, bytes(range(wide.length)))},
        ],
    )
    yield "a frame of the wrong length, then the right one", [
        s.request(0, wide), {"at": 1, "receive": "00"}, {"at": 11}, {"at": 12, "receive": frame(wide, bytes(wide.length))},
    ]  # fmt: skip
    if checked_frames:
        broken = bytes([1]).hex() + frame(wide, bytes(wide.length))[2:]
        yield (
            "a frame with a wrong checksum",
            [s.request(0, wide), *({"at": at, "receive": broken} for at in (1, 12))],
        )
    if s.silent:
        yield (
            "not acknowledged",
            [s.ask(0, s.silent), written, s.ask(2, s.silent), {"at": 3, "receive": ""}],
        )
    yield "a transfer that was not asked for", [{"at": 0, "receive": "00"}]
    second = next(
        (m for m in facts.telecommands.values() if m.acknowledge and m is not plain),
        other,
    )
    # Until all attempts of a request are used.
    quiet = [{"at": 100}, {"at": 110}, {"at": 210}, {"at": 220}, {"at": 320}]
    near = next(
        (
            m
            for m in facts.telemetry.values()
            if m is not wide and m.length == wide.length
        ),
        wide,
    )
    begin = 320 if near is not wide else 420  # a request of the same id is delayed
    old, new = (
        {"receive": frame(near, bytes((value,)) * near.length)} for value in (1, 2)
    )
    yield "frames after the time-out of their request do not belong to the next", [
        s.request(0, wide), *quiet, s.request(begin, near), *({"at": begin + n, **old} for n in (1, 2, 3)),
        {"at": begin + 4, **new},
    ]  # fmt: skip
    yield "a frame that takes longer than its request waits", [
        s.request(0, wide), {"at": 101, **old}, {"at": 111}, {"at": 112, **new},
    ]  # fmt: skip
    yield "a frame that is sent for again before the first has come", [
        s.request(0, wide), {"at": 100}, {"at": 110}, {"at": 111, **old}, {"at": 112, **new},
    ]  # fmt: skip
    yield "a write that ends when its request has timed out is not that of the next", [
        s.ask(0, plain), {"at": 100}, s.ask(101, second), {"at": 102, "receive": ""}, {"at": 103, "receive": ""}, {"at": 113},
        state(114, second, 1),
    ]  # fmt: skip
    yield "a poll that ends when its request has timed out is not that of the next", [
        s.ask(0, plain), written, {"at": 11}, {"at": 111}, s.request(112, wide), {"at": 113, **failed}, {"at": 114, **new},
    ]  # fmt: skip
    if s.reset:
        yield "a write that comes late does not write the reset that follows", [
            s.ask(0, plain), {"at": 100}, s.ask(101, s.reset), {"at": 102, "receive": ""}, {"at": 103, "receive": ""},
        ]  # fmt: skip
    yield "cancelled: what it owes is not for the next", [
        s.request(0, wide), {"at": 1, "cancel": True}, s.ask(2, plain), {"at": 3, **old}, {"at": 4, "receive": ""}, {"at": 14},
        {"at": 15, "cancel": True}, s.request(16, wide), state(17, plain, 1), {"at": 18, **new},
    ]  # fmt: skip
    unreported = [
        row
        for at in range(MOST_AWAITED)
        for row in (s.request(at, wide), {"at": at, "cancel": True})
    ]
    yield "no transaction while the results of too many are missing", [
        *unreported, s.request(20, near), {"at": 21, **failed}, *({"at": 21 + n, **old} for n in range(1, MOST_AWAITED)),
        {"at": 40, **new},
    ]  # fmt: skip
    yield "more transfers than requested", [
        s.request(0, wide), {"at": 1, **new}, {"at": 2, **old}, s.request(3, wide), {"at": 4, **new},
    ]  # fmt: skip


def _can(facts: Facts, s: BusSample) -> Iterator[tuple[str, list[dict[str, Any]]]]:
    assert facts.can
    node = facts.can.node_address

    def come(
        at: int, kind: CanKind, id: int | None, data: bytes = b"", source: int = node
    ) -> list[dict[str, Any]]:
        packets = can_split(s.link, CanMessage(kind, id or 0, source, OURS, data))
        return [
            {"at": at, "receive": {"id": p.id, "bytes": p.data.hex()}} for p in packets
        ]

    plain, frame, wide = s.plain, s.frame, s.wide
    id, frame_id = plain.telecommand_id, frame.telemetry_id
    yield (
        "a telecommand and its acknowledge",
        [s.ask(0, plain), *come(5, "acknowledge", id)],
    )
    yield (
        "a long telecommand",
        [s.ask(0, s.long), *come(5, "acknowledge", s.long.telecommand_id)],
    )
    yield "refused", [s.ask(0, plain), *come(5, "refusal", id)]
    yield (
        "a request refused",
        [s.request(0, frame), *come(5, "request_refusal", frame_id)],
    )
    yield (
        "a frame",
        [s.request(0, frame), *come(5, "reply", frame_id, bytes(frame.length))],
    )
    data = s.source.randbytes(wide.length)
    packets = come(5, "reply", wide.telemetry_id, data)
    yield "a long frame", [s.request(0, wide), *packets]
    if len(packets) > 1:
        yield "a long frame, turned round", [s.request(0, wide), *packets[::-1]]
        repeated = [{**row, "at": 105} for row in packets]
        yield (
            "a lost packet, and the repeated frame",
            [s.request(0, wide), *packets[1:], {"at": 100}, *repeated],
        )
    yield (
        "a frame that is too short",
        [s.request(0, frame), *come(5, "reply", frame_id, bytes(1)), {"at": 100}],
    )
    yield (
        "from another node",
        [
            s.ask(0, plain),
            *come(5, "acknowledge", id, source=node ^ 2),
            *come(6, "acknowledge", id),
        ],
    )
    yield "to somebody else", [
        s.ask(0, plain), {"at": 1, "receive": {"id": come(1, "acknowledge", id)[0]["receive"]["id"] ^ 1, "bytes": ""}},
    ]  # fmt: skip
    yield "no reply", [s.request(0, frame), {"at": 100}, {"at": 200}, {"at": 300}]
    yield "an unexpected acknowledge", come(0, "acknowledge", id)
    yield "cancelled: its acknowledge is unexpected", [
        s.ask(0, plain), {"at": 1, "cancel": True}, s.request(2, frame), *come(3, "acknowledge", id),
        *come(4, "reply", frame_id, bytes(frame.length)),
    ]  # fmt: skip
    yield "a late acknowledge confirms nothing after another request has ended", [
        s.ask(0, plain), {"at": 100}, s.request(101, frame), *come(102, "request_refusal", frame_id), s.ask(110, plain),
        *come(120, "acknowledge", id), *come(130, "refusal", id),
    ]  # fmt: skip
    if s.silent:
        yield "not acknowledged", [s.ask(0, s.silent), s.ask(0, s.silent)]
