"""The wire layer of the crate answers as the reference does, whatever is asked of it."""

from __future__ import annotations

import json
import random

from icdgen_runtime.wire.uart import uart_encode

from icdgen.vectors import protocol
from tests import links
from tests.conformance import wire, wire_changed, wire_random
from tests.rust import harness

SMALL = """\
icdgen: 1
node: {name: small, title: Small node, byte_order: big, bit_order: msb0}
protocol:
  link:
    buses:
      uart:
        framing: {by: escape, escape: 0x10, start: 0x02, end: 0x03, data: 0x10, other: ignore, escaped_in: [data]}
messages:
  - {name: Ping, kind: telecommand, id: 16, length: 2, fields: [{at: 0, bits: 12, name: Key, type: uint}]}
"""


def test_the_golden_vectors(shipped):
    program = harness.build_testee(shipped.icd)
    cases = [
        case
        for node in json.loads(protocol.text(shipped.icd))["nodes"]
        for case in node["cases"]
    ]
    answers = harness.ask(
        program, [json.dumps(case["request"]).encode() for case in cases]
    )
    wrong = [
        (case, given)
        for case, given in zip(cases, answers, strict=True)
        if given | {"detail": 0} != case["answer"] | {"detail": 0}
    ]
    assert len(cases) > 100 and wrong == []


def test_streams_packets_and_scripts_that_nobody_thought_of(shipped):
    """Streams cut anywhere, packets in any order, long scripts of the client and of
    procedures.
    """
    program = harness.build_testee(shipped.icd)
    asked = list(wire_random.requests(shipped.icd, 60))
    assert harness.differences(shipped.icd, program, asked) == []


def test_changed_requests_are_answered_like_the_reference(shipped):
    vectors = wire.vectors_of(shipped.icd)
    asked = [
        request
        for request, _ in wire_changed.requests(
            shipped.icd, vectors, random.Random(7), 3000
        )
    ]
    assert (
        harness.differences(shipped.icd, harness.build_testee(shipped.icd), asked) == []
    )


def test_noise_before_a_message_costs_nothing_but_the_noise(shipped):
    link = links.link(shipped.icd, "cubeacp")
    noise = random.Random(1).randbytes(1 << 20)
    if noise.endswith(bytes([link.framing.escape])):
        noise = noise[:-1] + b"\0"
    message = bytes.fromhex("1f1f1fff00")
    stream = noise + uart_encode(link, message)
    request = {"op": "uart_events", "node": "cubeacp", "chunks": [stream.hex()]}
    [answer] = harness.ask(
        harness.build_testee(shipped.icd), [json.dumps(request).encode()]
    )
    assert answer["events"][-1] == {
        "event": "message",
        "kind": "other",
        "bytes": message.hex(),
    }
    found = [event for event in answer["events"] if event["event"] == "message"]
    lengths = sum(len(uart_encode(link, bytes.fromhex(one["bytes"]))) for one in found)
    assert answer["discarded"] + answer["pending"] + lengths == len(stream)


def test_a_node_of_which_the_icd_says_little(tmp_path):
    """Another framing, numbers most significant byte first; what is not described is
    refused.
    """
    (tmp_path / "small.yaml").write_text(SMALL)
    icd = harness.read(tmp_path / "small.yaml")
    link, source = links.link(icd, "small"), random.Random(3)
    asked = [wire_random.stream(link, source) for _ in range(500)]
    asked += [
        {"op": "uart_encode", "bytes": "10" + source.randbytes(9).hex()}
        for _ in range(50)
    ]
    script = [
        {"at": 0, "telecommand": 16, "bytes": "1010"},
        {"at": 4, "receive": "10021001"},
        {"at": 1 << 31},
    ]
    asked += [
        {"op": "client", "bus": bus, "script": script} for bus in ("uart", "can", "i2c")
    ]
    asked += [
        {"op": "checksum", "name": "crc8", "bytes": ""},
        {"op": "procedure", "name": "list", "script": []},
        {"op": "dos_time", "value": 3},
    ]
    assert harness.differences(icd, harness.build_testee(icd), asked) == []


def test_a_node_without_a_protocol_has_no_link(shipped):
    texts = harness.texts(shipped.icd)
    assert (
        "LINK" in texts["src/cubeacp/mod.rs"]
        and "LINK" not in texts["src/cubemag/mod.rs"]
    )


def test_without_any_protocol_there_is_no_wire_layer(strange):
    assert not [
        name
        for name, text in harness.texts(strange.icd).items()
        if "wire" in name or "crate::wire" in text
    ]
