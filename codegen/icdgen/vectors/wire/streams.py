"""Requests on checksums and on messages in byte streams of the UART.

`checksums` is for every link; `encoded` and `streams` are for the escaped framing of
the UART, and ``framed`` has the requests for links with a packet format. Each yields
requests with their purpose from the protocol facts and a random source, also for noise,
missing ends and too long messages. `icdgen.vectors.protocol` adds the responses.
"""

from __future__ import annotations

from collections.abc import Iterator
from random import Random

from icdgen_runtime.wire.logs import LogMessage
from icdgen_runtime.wire.uart import uart_encode

from icdgen.protocol.facts import Facts, need
from icdgen.runtime_objects.operations import AnyLink
from icdgen.vectors.wire import Requests, pieces
from icdgen.vectors.wire.logs import masks

CHECKED = b"123456789"  # input of the check values of CRCs


def checksums(facts: Facts, source: Random) -> Requests:
    """Yield CRCs of no bytes, of single bytes and of random data."""
    data = [
        ("nothing", b""),
        ("the check value", CHECKED),
        ("a zero", b"\0"),
        ("zeros", bytes(20)),
        ("ones", b"\xff" * 20),
    ]
    data += [(f"bit {bit}", bytes([1 << bit])) for bit in range(8)]
    data += [
        (f"{size} random bytes", source.randbytes(size))
        for size in (2, 7, 22, 255, 1000)
    ]
    for name in facts.checksums:
        for why, content in data:
            yield why, {"op": "checksum", "name": name, "bytes": content.hex()}


def _messages(facts: Facts, source: Random) -> Iterator[tuple[str, bytes]]:
    """Yield messages (id and data) for framing."""
    framing = need(facts.framing, "uart")
    escape, end, start = framing.escape, framing.end, framing.start
    yield "an id alone", b"\x80"
    yield "an id that is the escape byte", bytes([escape, 0])
    yield "nothing but escape bytes", bytes([escape] * 5)
    yield (
        "what looks like an end within the data",
        bytes([1, escape, escape, end, escape, end, 2]),
    )
    yield (
        "what looks like a start within the data",
        bytes([1, escape, start, 2, escape]),
    )
    yield "the markers as data", bytes([end, start, end])
    yield "every byte", bytes([0x90, *range(256)])[: facts.longest]
    for id in sorted(
        {min(facts.telecommands), max(facts.telecommands)} if facts.telecommands else ()
    ):
        yield (
            f"telecommand {id}",
            bytes([id]) + source.randbytes(facts.telecommands[id].length),
        )
    yield "the longest message", bytes([0x80]) + source.randbytes(facts.longest - 1)
    yield "the longest message, all escaped", bytes([escape] * facts.longest)


def encoded(link: AnyLink, facts: Facts, source: Random) -> Requests:
    """Yield requests that encode messages and decode them again."""
    yield "no id", {"op": "uart_encode", "bytes": ""}
    for why, message in _messages(facts, source):
        yield why, {"op": "uart_encode", "bytes": message.hex()}
        yield (why, {"op": "uart_decode", "bytes": uart_encode(link, message).hex()})


def streams(link: AnyLink, facts: Facts, source: Random) -> Requests:
    """Yield streams that are cut, noisy or truncated."""
    framing = need(facts.framing, "uart")
    escape, start, end = framing.escape, framing.start, framing.end
    begin, finish = bytes([escape, start]), bytes([escape, end])

    def line(*data: int) -> bytes:
        return uart_encode(link, bytes(data))

    good = line(0x90, 1, escape, end, 2)
    streams_to_decode = [
        ("two messages", good + line(0x91)),
        (
            "noise before, between and after",
            b"\x00\xff\x7f" + good + b"noise" + good + b"\x55",
        ),
        ("an escape byte before the start", bytes([escape]) + good),
        ("many escape bytes before the start", bytes([escape] * 5) + good),
        ("an end without a start", finish + good),
        ("a start within a message", begin + b"\x90\x01\x02" + good),
        ("two starts in a row", begin + good),
        (
            "an escape byte before another byte",
            begin + bytes([0x90, escape, 0x55, 0x01]) + finish + good,
        ),
        ("a message without an id", begin + finish + good),
        ("an escape byte at the very end", good + bytes([escape])),
        (
            "an escape byte at the very end of a started message",
            good + begin + bytes([0x90, escape]),
        ),
        ("a message that is not finished", good + begin + b"\x90\x01"),
        ("nothing", b""),
        ("random bytes", source.randbytes(600)),
        (
            "random bytes rich in markers",
            bytes(source.choices([escape, start, end, 0, 0x90], k=600)) + good,
        ),
    ]
    for why, stream in streams_to_decode:
        yield why, {"op": "uart_decode", "bytes": stream.hex()}
        for how, chunks in pieces(why, stream, source):
            yield (
                how,
                {"op": "uart_events", "chunks": [chunk.hex() for chunk in chunks]},
            )
    # Ten bytes after unescaping: one more than the smaller buffer.
    long = line(0x90, *range(1, 9), escape)
    # No buffer is longer than the longest message
    for limit in (9, 10) if facts.longest >= 10 else ():
        cut = [(long + good[:-2]).hex(), finish.hex()]
        yield (
            f"ten bytes in a buffer of {limit}",
            {"op": "uart_events", "limit": limit, "chunks": cut},
        )
    too_long = uart_encode(link, bytes([0x90]) * (facts.longest + 1))
    yield (
        "a message that is too long by one",
        {"op": "uart_events", "chunks": [(too_long + good).hex()]},
    )
    for why, message in _kinds(link, facts, source):
        yield (why, {"op": "uart_events", "chunks": [uart_encode(link, message).hex()]})


def _kinds(link: AnyLink, facts: Facts, source: Random) -> Iterator[tuple[str, bytes]]:
    """Yield messages of each kind, and messages of no kind."""
    if facts.acknowledge:
        ids = sorted(
            {
                min(facts.telecommands, default=0),
                facts.framing.escape if facts.framing else 0,
            }
        )
        for id in ids:
            yield (
                f"the acknowledge of telecommand {id}",
                bytes([id, *bytes(facts.acknowledge.overhead - 1)]),
            )
        yield (
            "an acknowledge that is too long",
            bytes([ids[0], *bytes(facts.acknowledge.overhead)]),
        )
    for head, id in facts.unsolicited.items():
        for more in (-1, 0, 1):
            # The index -1 takes the last text.
            why = f"unsolicited telemetry{('', ' too long', ' too short')[more]}"
            size = facts.telemetry[id].length + more
            yield why, bytes([head]) + source.randbytes(size)
    for id, message in list(facts.telemetry.items())[:3]:
        yield f"telemetry {id}", bytes([id]) + source.randbytes(message.length)
    first, last = facts.telemetry_ids.first, facts.telemetry_ids.last
    for id in sorted({first - 1, first, last, last + 1} & set(range(256))):
        yield f"id {id}, at the ends of the telemetry range", bytes([id, 0])
    if facts.log_message and facts.mask:
        for mask in masks(facts)[:4]:
            data = [source.randbytes(slot.length) for slot in facts.mask.selected(mask)]
            log = LogMessage.encode(link, mask, data)
            yield "an unsolicited log", log
            yield "an unsolicited log that is too short", log[:-1]
