"""Links of the shipped ICDs: the wire layer of every language answers golden vectors,
changed and random requests as the reference does.
"""

from __future__ import annotations

import copy
import dataclasses
import json
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from icdgen.icd.model import Icd
from icdgen.runtime_objects import reference
from tests.conformance import odd_protocol, wire, wire_changed, wire_random
from tests.conformance.build import build
from tests.conformance.compare import difference
from tests.conformance.driver import Testee
from tests.conformance.icds import icd_of
from tests.conformance.languages import all_languages

# What only framed links answer: `test_links` asks them.
FRAMED_OPS = {
    "stream_encode",
    "stream_encode_packet",
    "stream_events",
    "stream_respond",
    "stream_client",
}


@pytest.fixture(scope="module")
def icd():
    return icd_of()


@pytest.fixture(scope="module")
def odd_icd(icd):
    return odd_protocol.of(icd)


@pytest.fixture(scope="module", params=["c-sanitizers", "python", "rust-debug"])
def testee(request, icd):
    program = Testee(build(all_languages()[request.param], icd))
    yield program
    assert program.close() == 0, program.complaint()


def ask(testee, **request) -> dict:
    (answer,) = testee.ask([json.dumps(request).encode()])
    assert answer is not None, testee.complaint()
    return json.loads(answer)


def differences(exchanges, testee) -> list[tuple[dict, str]]:
    """The requests that are answered otherwise than the reference does."""
    answers = testee.ask([json.dumps(request).encode() for request, _ in exchanges])
    compared = (
        (request, difference(expected, answer))
        for (request, expected), answer in zip(exchanges, answers, strict=True)
    )
    return [(request, what) for request, what in compared if what]


@pytest.mark.parametrize(
    "name",
    [
        "c-sanitizers",
        pytest.param("c-s390x", marks=pytest.mark.needs("qemu-s390x")),
        "python",
        "rust-debug",
    ],
)
def test_every_golden_vector_is_answered_as_demanded(icd, name):
    vectors = json.loads(wire.VECTORS.read_text(encoding="utf-8"))
    (result,) = wire.run([all_languages()[name]], icd, vectors)
    assert result.differences == 0, "\n".join(result.shown)
    assert result.vectors > 1000


@pytest.mark.parametrize("name", ["c-sanitizers", "python"])
def test_an_unusual_protocol_is_answered_like_the_reference(odd_icd, name):
    vectors, language = wire.vectors_of(odd_icd), all_languages()[name]
    (result,) = wire.run([language], odd_icd, vectors)
    assert result.differences == 0, "\n".join(result.shown)
    source = random.Random(7)
    exchanges = list(wire_changed.requests(odd_icd, vectors, source, 1000))
    assert differences(exchanges, Testee(build(language, odd_icd))) == []


@pytest.mark.parametrize("always", ["telecommand", "telemetry"])
def test_checksums_can_be_mandatory_in_one_direction_only(odd_icd, always):
    """Rust, too, with few messages, since it takes long to compile all of them."""
    icd, language = _with_checksums(odd_icd, always), all_languages()["rust-debug"]
    vectors = wire.vectors_of(icd)
    (result,) = wire.run([language], icd, vectors)
    assert result.differences == 0, "\n".join(result.shown)
    exchanges = list(wire_changed.requests(icd, vectors, random.Random(7), 1000))
    assert differences(exchanges, Testee(build(language, icd))) == []


def _with_checksums(odd_icd: Icd, always: str) -> Icd:
    """Return the bootloader with checksums that are mandatory in this direction and
    optional in the other.
    """
    section = odd_icd.node("cubeacp").protocol["link"]
    packets = copy.deepcopy(section["packets"])
    del packets[always]["trailer"][0]["optional"]
    bootloader = odd_icd.node("bootloader")
    protocol = {**bootloader.protocol, "link": {**section, "packets": packets}}
    return Icd(
        (odd_icd.node("common"), dataclasses.replace(bootloader, protocol=protocol))
    )


def test_changed_requests_are_answered_like_the_reference(icd, testee):
    source = random.Random(7)
    exchanges = list(wire_changed.requests(icd, wire.vectors_of(icd), source, 3000))
    assert differences(exchanges, testee) == []
    assert {request["op"] for request, _ in exchanges} == set(
        reference.OPS
    ) - FRAMED_OPS


def test_random_requests_are_answered_like_the_reference(icd, testee):
    requests = wire_random.requests(icd, 60)
    exchanges = [(request, reference.answer(icd, request)) for request in requests]
    assert differences(exchanges, testee) == []


@settings(max_examples=150, deadline=None)
@given(data=st.data())
def test_events_do_not_depend_on_how_the_stream_was_cut(testee, data):
    framing = st.sampled_from([0x1F, 0x7F, 0xFF])
    stream = bytes(
        data.draw(st.lists(st.one_of(framing, st.integers(0, 255)), max_size=80))
    )
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=6)))
    pieces = [
        stream[a:b].hex() for a, b in zip([0, *cuts], [*cuts, len(stream)], strict=True)
    ]
    uncut = ask(testee, op="uart_events", chunks=[stream.hex()])
    assert uncut["ok"] and ask(testee, op="uart_events", chunks=pieces) == uncut


def test_noise_of_a_megabyte_before_a_frame_costs_nothing_but_that_noise(testee):
    noise = random.Random(3).randbytes(1_000_000).replace(b"\x1f", b"\x1e")
    stream = noise + bytes.fromhex("1f7f1f1f1f1f1f1fffaa1fff")
    answer = ask(testee, op="uart_events", chunks=[stream.hex()])
    assert answer["events"] == [
        {"event": "message", "kind": "other", "bytes": "1f1f1fffaa"}
    ]
    assert answer["discarded"] == len(noise) and answer["pending"] == 0


def test_a_telecommand_whose_id_is_the_escape_byte_survives(testee):
    for message in ("1f00", "1f1f1fff", "00" + "1f" * 40):
        line = ask(testee, op="uart_encode", bytes=message)["bytes"]
        assert ask(testee, op="uart_decode", bytes=line) == {
            "ok": True,
            "frames": [message],
        }


@pytest.mark.parametrize("name", ["c-sanitizers", "rust-debug"])
def test_a_clock_of_32_bits_may_wrap_around(icd, name):
    testee = Testee(build(all_languages()[name], icd))
    begin = (1 << 32) - 40
    script = [
        {"at": begin, "telemetry": 128},
        {"at": begin + 39},
        {"at": 59},
        {"at": 60},
        {"at": 160},
    ]
    given_ = {"reply_timeout": 100, "retries": 1, "poll_interval": 1, "poll_timeout": 1}
    steps = ask(testee, op="client", bus="uart", settings=given_, script=script)[
        "steps"
    ]
    assert [step["deadline"] for step in steps] == [60, 60, 60, 160, None]
    assert [len(step["out"]) for step in steps] == [1, 0, 0, 1, 0]
    assert steps[-1]["events"] == [{"event": "timeout", "id": 128, "attempts": 2}]
    assert testee.close() == 0


@pytest.mark.parametrize("retries", [0, 1, 254, 255])
def test_a_request_is_sent_once_more_than_its_retries(testee, retries):
    script = [{"at": 0, "telemetry": 128}]
    script += [{"at": 10 * (sent + 1)} for sent in range(retries + 1)]
    times = {"reply_timeout": 10, "poll_interval": 1, "poll_timeout": 1}
    settings = {**times, "retries": retries}
    steps = ask(testee, op="client", bus="uart", settings=settings, script=script)[
        "steps"
    ]
    assert [len(step["out"]) for step in steps] == [1] * (retries + 1) + [0]
    assert [event for step in steps for event in step["events"]] == [
        {"event": "timeout", "id": 128, "attempts": retries + 1}
    ]
