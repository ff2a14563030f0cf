"""Decoders of framed links in noise: long noise costs only its own bytes, and
the position of a cut does not matter.
"""

from __future__ import annotations

import json
import random
from functools import cache

import pytest
from icdgen_runtime.wire.stream import StreamDecoder, stream_encode

from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from tests.conformance.build import build
from tests.conformance.driver import Testee
from tests.conformance.icds import LINKS, icd_of
from tests.conformance.languages import all_languages
from tests.conftest import ROOT

ICD = icd_of([ROOT / "examples" / "links", LINKS])
NODES = ["receiver", "positioner", "autopilot", "payload", "logger", "probe"]
LENGTH = 1 << 18
MARKERS = bytes((0x00, 0x55, 0x62, 0x7D, 0x7E, 0xB5, 0xC0, 0xDB, 0xDC, 0xFD, 0xFF))


@pytest.fixture(scope="module", params=["python", "c-sanitizers", "rust-debug"])
def testee(request):
    process = Testee(build(all_languages()[request.param], ICD))
    yield process
    assert process.close() == 0, process.complaint()


@cache
def form_of(node: str):
    return facts.of(ICD, ICD.node(node)).stream


@cache
def link_to(node: str):
    return link_of(ICD, facts.of(ICD, ICD.node(node)))


def messages(
    node: str, source: random.Random, count: int
) -> tuple[bytes, list[tuple[int, str]]]:
    """Return encoded messages, and the ids and data that a decoder must return."""
    form, line, sent = form_of(node), b"", []
    for number in range(count):
        row = source.choice(form.rows("telemetry"))
        data = source.randbytes(row.most - 1) + b"\1"
        values = {"sequence": number} if "sequence" in form.chosen("telemetry") else {}
        line += stream_encode(link_to(node), row.id, data, "telemetry", **values)
        sent.append((row.id, data.hex()))
    return line, sent


def answers_to(testee: Testee, node: str, *streams: list[bytes]) -> list[dict]:
    rows = ({"op": "stream_events", "node": node, "direction": "telemetry", "chunks": [chunk.hex() for chunk in chunks]}
            for chunks in streams)  # fmt: skip
    return [
        json.loads(answer or b"{}")
        for answer in testee.ask([json.dumps(row).encode() for row in rows])
    ]


def decoded_messages(answer: dict) -> list[tuple[int, str]]:
    """Return id and data of each message in an answer."""
    return [
        (event["id"], event["bytes"])
        for event in answer["events"]
        if event["event"] == "message"
    ]


@cache
def reference_result(node: str, line: bytes) -> tuple[list[tuple[int, str]], int, int]:
    """Return messages, discarded and pending bytes according to the decoder of the
    Python runtime.
    """
    decoder = StreamDecoder(link_to(node))
    events = [event for event in decoder.feed(line) if event.event == "message"]
    return (
        [(event.id or 0, event.data.hex()) for event in events],
        decoder.discarded,
        decoder.pending,
    )


@pytest.mark.parametrize("node", NODES)
def test_noise_before_messages_loses_none_of_them(testee, node):
    source = random.Random(node)
    noise = bytes(source.choices(MARKERS, k=LENGTH // 4)) + source.randbytes(
        3 * LENGTH // 4
    )
    line, sent = messages(node, source, 8)
    padded = (
        noise
        + bytes(form_of(node).longest_line) * 2
        + line
        + bytes(form_of(node).longest_line)
    )
    (answer,) = answers_to(testee, node, [padded])
    assert (
        decoded_messages(answer),
        answer["discarded"],
        answer["pending"],
    ) == reference_result(node, padded)
    # Where neither sync nor checksum tells noise from a message, it may take the
    # beginning of what follows with it.
    lost = 2 if node == "payload" else 0
    assert decoded_messages(answer)[-(len(sent) - lost) :] == sent[lost:]


@pytest.mark.parametrize("node", NODES)
def test_a_stream_may_be_cut_at_any_byte(testee, node):
    source = random.Random(f"{node} cut")
    short = min(form_of(node).rows("telemetry"), key=lambda row: row.most)
    data = source.randbytes(short.most - 1) + b"\1"
    encoded = stream_encode(link_to(node), short.id, data, "telemetry")
    line = (
        bytes(source.choices(MARKERS, k=6)) + encoded + encoded[:-1] + encoded + encoded
    )
    uncut, *cut = answers_to(
        testee, node, [line], *([line[:at], line[at:]] for at in range(len(line) + 1))
    )
    assert uncut["ok"] and all(answer == uncut for answer in cut)
    (single,) = answers_to(testee, node, [bytes([byte]) for byte in line])
    assert single == uncut
