"""The golden vectors of the protocol follow the published schema, show every operation,
and the reference implementation answers them.
"""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import jsonschema_rs
import pytest

import icdgen
from icdgen.loading import load
from icdgen.runtime_objects import reference
from icdgen.vectors import protocol
from tests.conformance import odd, wire
from tests.conformance.icds import LINKS, icd_of
from tests.conformance.languages import all_languages
from tests.conformance.reference import Reference

SCHEMA = json.loads(
    (Path(icdgen.__file__).parent / "protocol.schema.json").read_text(encoding="utf-8")
)


@pytest.fixture(scope="module")
def icd():
    return icd_of()


@pytest.fixture(scope="module")
def files(icd):
    return wire.vectors_of(icd)


@pytest.fixture(scope="module")
def framed():
    return wire.vectors_of(icd_of([LINKS]))


def test_the_file_follows_the_published_schema(files, framed):
    validator = jsonschema_rs.validator_for(SCHEMA)
    validator.validate(files)
    validator.validate(framed)
    broken = json.loads(json.dumps(files))
    case = next(
        c for c in broken["nodes"][0]["cases"] if c["request"]["op"] == "uart_events"
    )
    case["answer"]["events"] = [{"event": "surprise"}]
    assert not validator.is_valid(broken)


def test_every_operation_is_shown_with_success_and_where_it_can_fail_with_failure(
    files, framed
):
    nodes = (*files["nodes"], *framed["nodes"])
    seen = Counter(
        (c["request"]["op"], c["answer"]["ok"]) for n in nodes for c in n["cases"]
    )
    assert {op for op, ok in seen if ok} == set(reference.OPS)
    assert {op for op, ok in seen if not ok} >= {
        "uart_encode", "can_split", "i2c_reply", "log_encode", "log_message_decode", "dos_time",
        "index_encode", "identify", "stream_encode", "stream_encode_packet",
    }  # fmt: skip


def test_every_kind_of_event_is_shown(files):
    events = [
        e
        for n in files["nodes"]
        for c in n["cases"]
        for e in c["answer"].get("events", ())
        if "event" in e
    ]
    assert {e["event"] for e in events} >= {
        "message", "unexpected_start", "protocol_error", "overrun", "empty", "duplicate", "incomplete", "malformed", "busy",
        "unknown_type",
    }  # fmt: skip
    assert {e["kind"] for e in events if "kind" in e} >= {
        "reply",
        "acknowledge",
        "packet",
        "log",
        "other",
        "telecommand",
    }


def test_every_end_of_a_procedure_is_shown(files):
    ends = {
        case["answer"]["steps"][-1]["result"]
        for node in files["nodes"]
        for case in node["cases"]
        if case["request"]["op"] == "procedure" and case["answer"]["ok"]
    }
    assert ends - {None} == {
        "done", "refused", "busy", "timeout", "failed", "length", "checksum", "rounds", "limit",
    }  # fmt: skip


def test_the_text_is_the_same_on_every_run_and_small_enough_to_commit(icd):
    text = protocol.protocol_vectors_text(icd)
    assert text == protocol.protocol_vectors_text(icd)
    assert len(text) < 2_000_000


def test_there_is_no_file_without_a_protocol(tmp_path):
    assert protocol.protocol_vectors_text(icd_of([odd.write(tmp_path)])) is None


def test_a_node_with_the_name_of_the_file_is_reported(tmp_path):
    text = (
        "icdgen: 1\nnode: {name: protocol, title: P, byte_order: little, bit_order: lsb0}\n"
        "protocol: {link: {buses: {uart: {line: {baud_rate: 9600}}}}}\n"
        "messages: [{name: Ping, id: 1, kind: telecommand, length: 0}]\n"
    )
    path = tmp_path / "protocol.yaml"
    path.write_text(text, encoding="utf-8")
    findings = load([path]).findings
    assert [f.code for f in findings] == ["ICD071"] and "vectors" in findings[0].message


def test_the_reference_gives_the_answers_of_its_vectors(icd, files, tmp_path):
    """The tests of each language compare it with these vectors:
    `tests/*/test_wire*.py`.
    """
    (result,) = wire.run([all_languages()["reference"]], icd, files, tmp_path)
    assert result.differences == 0, "\n".join(result.shown)
    assert result.vectors > 900


def test_a_request_without_a_node_is_for_the_last_node_with_a_protocol(icd):
    ask = Reference(icd).answer
    assert ask(
        b'{"op": "checksum", "name": "crc8", "bytes": "313233343536373839"}'
    ) == {
        "ok": True,
        "crc": 0x25,
    }
    assert ask(
        b'{"op": "checksum", "name": "crc16", "bytes": "313233343536373839"}'
    ) == {
        "ok": True,
        "crc": 0x31C3,
    }
    assert ask(b'{"op": "checksum", "name": "crc8", "bytes": ""}') == {
        "ok": True,
        "crc": 0xFF,
    }
    assert ask(b'{"op": "uart_encode", "bytes": "1f00"}') == {
        "ok": True,
        "bytes": "1f7f1f1f001fff",
    }
    assert ask(b'{"op": "uart_decode", "bytes": "551f7f1f1f001fff"}') == {
        "ok": True,
        "frames": ["1f00"],
    }
    assert ask(
        b'{"op": "checksum", "name": "crc8", "node": "bootloader", "bytes": ""}'
    ) == {
        "ok": False,
        "error": "unsupported",
    }


def test_requests_that_an_icd_does_not_support_are_answered_with_an_error(
    files, tmp_path
):
    text = (
        "icdgen: 1\nnode: {name: demo, title: D, byte_order: big, bit_order: msb0}\n"
        "protocol:\n  link: {buses: {uart: {line: {baud_rate: 9600}}}}\n"
        "messages: [{name: Ping, id: 1, kind: telecommand, length: 0}]\n"
    )
    (tmp_path / "demo.yaml").write_text(text, encoding="utf-8")
    bare = icd_of([tmp_path / "demo.yaml"])
    protocol.protocol_vectors_text(bare)
    for node in files["nodes"]:
        for case in node["cases"]:
            answer = reference.answer(bare, {**case["request"], "node": "demo"})
            if case["request"]["op"] not in (
                "i2c_request",
                "i2c_reply",
                "uart_encode",
                "uart_events",
                "link_data",
            ):
                assert answer == {"ok": False, "error": "unsupported"}, case
            assert answer["ok"] or answer["error"] in (
                "unsupported",
                "unknown-id",
                "length",
                "request",
            ), case
