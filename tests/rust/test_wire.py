"""The wire layer of the crate answers as the reference does, whatever is asked of it."""

from __future__ import annotations

import json
import random

from icdgen.protocol import facts, uart
from icdgen.vectors import protocol
from tests.rust import harness, wire_requests


def test_the_golden_vectors(shipped):
    program = harness.build_testee(shipped.icd)
    cases = [case for node in json.loads(protocol.text(shipped.icd))["nodes"] for case in node["cases"]]
    answers = harness.ask(program, [json.dumps(case["request"]).encode() for case in cases])
    wrong = [
        (case, given)
        for case, given in zip(cases, answers, strict=True)
        if given | {"detail": 0} != case["answer"] | {"detail": 0}
    ]
    assert len(cases) > 100 and wrong == []


def test_streams_packets_and_scripts_that_nobody_thought_of(shipped):
    """Streams cut anywhere, packets in any order, long scripts of the client and of file transfer."""
    program = harness.build_testee(shipped.icd)
    asked = list(wire_requests.requests(shipped.icd, 60))
    assert harness.differences(shipped.icd, program, asked) == []


def test_noise_before_a_message_costs_nothing_but_the_noise(shipped):
    known = facts.of(shipped.icd, shipped.icd.node("cubeacp"))
    noise = random.Random(1).randbytes(1 << 20)
    if noise.endswith(bytes([known.framing.escape])):
        noise = noise[:-1] + b"\0"
    message = bytes.fromhex("1f1f1fff00")
    stream = noise + uart.encode(known.framing, message)
    request = {"op": "uart_events", "node": "cubeacp", "chunks": [stream.hex()]}
    [answer] = harness.ask(harness.build_testee(shipped.icd), [json.dumps(request).encode()])
    assert answer["events"][-1] == {"event": "message", "kind": "other", "bytes": message.hex()}
    found = [event for event in answer["events"] if event["event"] == "message"]
    lengths = sum(len(uart.encode(known.framing, bytes.fromhex(one["bytes"]))) for one in found)
    assert answer["discarded"] + answer["pending"] + lengths == len(stream)
