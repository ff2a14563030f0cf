"""Requests about the UART meet the limits of buffers, lengths and kinds of messages, as
their answers show.
"""

from __future__ import annotations

from random import Random

import pytest

from icdgen.protocol import facts
from icdgen.runtime_objects import reference
from icdgen.runtime_objects.links import link_of_node
from icdgen.vectors.wire import streams
from tests.conformance.icds import icd_of

ICD = icd_of()
NODE = ICD.node("cubeacp")
FACTS = facts.of(ICD, NODE)
LINK = link_of_node(ICD, NODE)
ESCAPE, START, END = FACTS.framing.escape, FACTS.framing.start, FACTS.framing.end
STREAMS = list(streams.streams(LINK, FACTS, Random(1)))
ENCODED = list(streams.encoded(LINK, FACTS, Random(1)))


def events(why, requests=STREAMS):
    """Return the events of the only request of a purpose with events."""
    (request,) = [r for w, r in requests if w == why and r["op"] == "uart_events"]
    return reference.answer(ICD, {**request, "node": NODE.name})["events"]


def names(rows):
    return [row.get("event", row.get("kind")) for row in rows]


def test_checksums_are_of_nothing_single_bits_and_random_data():
    requests = list(streams.checksums(FACTS, Random(1)))
    by_name = {}
    for why, request in requests:
        data = bytes.fromhex(request["bytes"])
        by_name.setdefault(request["name"], []).append((why, data))
    assert list(by_name) == list(FACTS.checksums)
    for rows in by_name.values():
        assert [data for _, data in rows[:5]] == [
            b"", b"123456789", b"\0", bytes(20), b"\xff" * 20,
        ]  # fmt: skip
        assert [data for _, data in rows[5:13]] == [bytes([1 << n]) for n in range(8)]
        assert [why for why, _ in rows[5:13]] == [f"bit {n}" for n in range(8)]
        sizes = [2, 7, 22, 255, 1000]
        assert [why for why, _ in rows[13:]] == [f"{n} random bytes" for n in sizes]
        assert [len(data) for _, data in rows[13:]] == sizes


def test_each_message_is_encoded_and_decoded_again():
    why, request = ENCODED[0]
    assert (why, request["bytes"]) == ("no id", "")
    assert reference.answer(ICD, {**request, "node": NODE.name})["ok"] is False
    for (why, encode), (again, decode) in zip(
        ENCODED[1::2], ENCODED[2::2], strict=True
    ):
        assert (why, encode["op"], decode["op"]) == (
            again,
            "uart_encode",
            "uart_decode",
        )
        answer = reference.answer(ICD, {**encode, "node": NODE.name})
        assert answer["bytes"] == decode["bytes"]
    messages = {why: bytes.fromhex(r["bytes"]) for why, r in ENCODED[1::2]}
    assert len(messages["the longest message"]) == FACTS.longest
    assert messages["the longest message, all escaped"] == bytes(
        [ESCAPE] * FACTS.longest
    )
    every = messages["every byte"]
    assert every == bytes([0x90, *range(256)])[: FACTS.longest]
    assert messages["the markers as data"] == bytes([END, START, END])
    sent = [int(why.split()[1]) for why in messages if why.startswith("telecommand ")]
    assert sent == [min(FACTS.telecommands), max(FACTS.telecommands)]
    for id in sent:
        data = messages[f"telecommand {id}"]
        assert (data[0], len(data) - 1) == (id, FACTS.telecommands[id].length)


def test_streams_are_decoded_alike_complete_and_in_pieces():
    decoded = [why for why, request in STREAMS if request["op"] == "uart_decode"]
    assert len(decoded) == len(set(decoded)) == 15
    for why in decoded:
        whole, single, cut = (
            events(f"{why}{how}")
            for how in ("", ", byte by byte", ", cut at odd places")
        )
        assert whole == single == cut, why


@pytest.mark.parametrize(
    ("why", "expected"),
    [
        ("two messages", ["message", "message"]),
        ("noise before, between and after", ["message", "message"]),
        ("an escape byte before the start", ["message"]),
        ("many escape bytes before the start", ["message"]),
        ("an end without a start", ["message"]),
        ("a start within a message", ["unexpected_start", "message"]),
        ("two starts in a row", ["unexpected_start", "message"]),
        ("an escape byte before another byte", ["protocol_error", "message"]),
        ("a message without an id", ["empty", "message"]),
        ("an escape byte at the very end", ["message"]),
        ("an escape byte at the very end of a started message", ["message"]),
        ("a message that is not finished", ["message"]),
        ("nothing", []),
        ("a message that is too long by one", ["overrun", "message"]),
        ("ten bytes in a buffer of 9", ["overrun", "message"]),
        ("ten bytes in a buffer of 10", ["message", "message"]),
    ],
)
def test_each_stream_has_the_events_of_its_purpose(why, expected):
    assert names(events(why)) == expected


def test_random_streams_end_with_a_message_or_are_noise():
    (noise,) = [
        r for w, r in STREAMS if w == "random bytes" and r["op"] == "uart_decode"
    ]
    assert len(noise["bytes"]) == 2 * 600
    assert names(events("random bytes rich in markers"))[-1] == "message"


def kind(why):
    (event,) = events(why)
    return event.get("kind", event.get("event"))


def test_messages_of_each_kind_have_its_length_and_others_do_not():
    assert FACTS.acknowledge
    first = min(FACTS.telecommands)
    acknowledges = [w for w, _ in STREAMS if w.startswith("the acknowledge of")]
    assert acknowledges == [
        f"the acknowledge of telecommand {id}" for id in sorted({first, ESCAPE})
    ]
    assert {kind(why) for why in acknowledges} == {"acknowledge"}
    assert kind("an acknowledge that is too long") != "acknowledge"
    assert len(FACTS.unsolicited) == 1  # otherwise the next purposes are not unique
    assert kind("unsolicited telemetry") == "packet"
    assert kind("unsolicited telemetry too long") != "packet"
    assert kind("unsolicited telemetry too short") != "packet"
    replies = [w for w, _ in STREAMS if w.startswith("telemetry ")]
    assert replies == [f"telemetry {id}" for id in list(FACTS.telemetry)[:3]]
    assert {kind(why) for why in replies} == {"reply"}


def test_ids_at_the_ends_of_the_telemetry_range_are_replies_or_not():
    first, last = FACTS.telemetry_ids.first, FACTS.telemetry_ids.last
    ends = [int(w.split()[1][:-1]) for w, _ in STREAMS if "at the ends" in w]
    assert ends == [id for id in (first - 1, first, last, last + 1) if id < 256]
    for id in ends:
        why = f"id {id}, at the ends of the telemetry range"
        is_log = id == FACTS.log_message.id
        assert (kind(why) == "reply") == (first <= id <= last and not is_log)


def test_unsolicited_logs_are_complete_or_a_byte_short():
    logs = [r for w, r in STREAMS if w == "an unsolicited log"]
    short = [r for w, r in STREAMS if w == "an unsolicited log that is too short"]
    assert len(logs) == len(short) == 4

    def kinds(requests):
        answers = [reference.answer(ICD, {**r, "node": NODE.name}) for r in requests]
        return {event.get("kind") for answer in answers for event in answer["events"]}

    assert kinds(logs) == {"log"} and "log" not in kinds(short)
