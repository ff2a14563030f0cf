"""The wire layer of the generated C: on the golden vectors, on random requests, in odd
circumstances, and alone in a firmware.
"""

from __future__ import annotations

import json
import random
import re
import subprocess

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from icdgen.protocol import facts
from icdgen.runtime_objects import reference
from tests import links
from tests.c import harness, odd_protocol
from tests.conformance import wire, wire_changed, wire_random
from tests.conformance.build import build
from tests.conformance.compare import difference
from tests.conformance.driver import Testee
from tests.conformance.icds import icd_of
from tests.conformance.languages import all_languages

TABLE_FREE = "-DICDGEN_NO_TABLES"


@pytest.fixture(scope="module")
def icd():
    return icd_of()


@pytest.fixture(scope="module")
def vectors():
    return json.loads(wire.VECTORS.read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def testee(icd):
    found = Testee(build(all_languages()["c-sanitizers"], icd))
    yield found
    assert found.close() == 0, found.complaint()


@pytest.fixture(scope="module")
def headers(tmp_path_factory):
    return harness.generate(harness.shipped(), tmp_path_factory.mktemp("headers"))


def ask(testee, **request) -> dict:
    (answer,) = testee.ask([json.dumps(request).encode()])
    assert answer is not None, testee.complaint()
    return json.loads(answer)


@pytest.mark.parametrize("name", ["c-sanitizers", "c-s390x"])
def test_every_golden_vector_is_answered_as_demanded(icd, vectors, name):
    (result,) = wire.run([all_languages()[name]], icd, vectors)
    assert result.differences == 0, "\n".join(result.shown)
    assert result.vectors > 1000


def test_a_protocol_that_is_odd_in_every_point_is_spoken_as_well():
    icd = odd_protocol.of(harness.shipped())
    vectors, language = wire.vectors_of(icd), all_languages()["c-sanitizers"]
    (result,) = wire.run([language], icd, vectors)
    assert result.differences == 0, "\n".join(result.shown)
    agree(icd, vectors, Testee(build(language, icd)), 1000)


def test_changed_requests_are_answered_like_the_reference(icd, vectors, testee):
    agree(icd, vectors, testee)


def test_streams_packets_and_scripts_that_nobody_thought_of(icd, testee):
    asked = list(wire_random.requests(icd, 60))
    assert (
        differences(
            [(request, reference.answer(icd, request)) for request in asked], testee
        )
        == []
    )


def agree(icd, vectors, testee, count=3000):
    asked = list(wire_changed.requests(icd, vectors, random.Random(7), count))
    assert differences(asked, testee) == []
    of_framed_links = {
        "stream_encode",
        "stream_encode_packet",
        "stream_events",
        "stream_respond",
        "stream_client",
    }  # the shipped ICDs have none: tests/conformance/test_links.py asks them
    assert {request["op"] for request, _ in asked} == set(
        reference.OPS
    ) - of_framed_links


def differences(asked, testee):
    answers = testee.ask([json.dumps(request).encode() for request, _ in asked])
    found = (
        (request, difference(good, answer))
        for (request, good), answer in zip(asked, answers, strict=True)
    )
    return [(request, what) for request, what in found if what]


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
    whole = ask(testee, op="uart_events", chunks=[stream.hex()])
    assert whole["ok"] and ask(testee, op="uart_events", chunks=pieces) == whole


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


def test_time_may_wrap(testee):
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


def test_a_node_without_a_protocol_has_no_link(demo, tmp_path, headers):
    made = harness.generate(harness.read(demo), tmp_path)
    assert not list(made.rglob("icdgen_wire.*")) and not list(made.rglob("link.*"))
    assert (headers / "icdgen_wire.h").is_file()
    protocols = {
        node.name
        for node in harness.shipped().nodes
        if harness.shipped().protocol_of(node)
    }
    assert (
        {path.parent.name for path in headers.rglob("link.h")}
        == protocols
        < {n.name for n in harness.shipped().nodes}
    )


def test_every_assumption_stands_with_its_reason_where_its_value_is(headers):
    icd = harness.shipped()
    for node in icd.nodes:
        if not icd.protocol_of(node):
            continue
        text = re.sub(r"\s+(?:\* )?", " ", (headers / node.name / "link.c").read_text())
        # What switches logs on is a message like any other: the layer has no part in
        # it.
        elsewhere = ("message ", "unsolicited_log.configured_by")
        assumed = [
            a
            for a in facts.of(icd, node).assumptions
            if not a.section.startswith(elsewhere)
        ]
        assert assumed
        for assumption in assumed:
            assert f"{assumption.key}: {' '.join(assumption.why.split())}" in text, (
                assumption
            )


def test_nothing_is_called_but_functions_that_move_memory(headers, tmp_path):
    text = (headers / "icdgen_wire.h").read_text()
    names = re.findall(r"^ICDGEN_API [^;{]*?\b(icd_\w+)\(", text, re.MULTILINE)
    assert len(names) > 50 and "icd_client_start" in names
    source = tmp_path / "all.c"
    nodes = [path.parent.name for path in headers.rglob("link.h")]
    source.write_text(
        "".join(f'#include "{node}.h"\n' for node in nodes)
        + "typedef void any(void);\nany *const used[] = {"
        + ", ".join(
            f"(any *){name}" for name in [*names, *(f"{node}_link" for node in nodes)]
        )
        + "};\n"
    )
    harness.compile(
        source, "-std=c99", "-O2", "-c", f"-I{headers}", output=tmp_path / "all.o"
    )
    done = subprocess.run(
        ["nm", "-u", tmp_path / "all.o"], capture_output=True, text=True, check=True
    )
    called = {line.split()[-1] for line in done.stdout.splitlines()}
    assert called - {"_GLOBAL_OFFSET_TABLE_", "__stack_chk_fail"} <= {
        "memcpy",
        "memset",
        "memcmp",
        "memmove",
    }


PROGRAM = """
#include "cubeacp.h"
#include <stdio.h>
int main(void)
{
    static const uint8_t bytes[] = "123456789 and so on";
    for (size_t length = 0; length < sizeof bytes; ++length) {
        const uint32_t one = icd_checksum(cubeacp_crc8_checksum(), bytes, length);
        const uint32_t two = icd_checksum(cubeacp_crc16_checksum(), bytes, length);
        printf("%u %u\\n", (unsigned)one, (unsigned)two);
    }
    return 0;
}
"""


@pytest.mark.parametrize("option", [TABLE_FREE, "-DWITH_TABLES"])
def test_checksums_are_the_same_with_tables_and_without(headers, tmp_path, option):
    source = tmp_path / "crc.c"
    source.write_text(PROGRAM)
    flags = ("-std=c99", *harness.WARNINGS, *harness.SANITIZERS, option, f"-I{headers}")
    program = harness.compile(source, *flags, output=tmp_path / "crc")
    done = subprocess.run([program], capture_output=True, text=True, check=True)
    icd = harness.shipped()
    known = facts.of(icd, icd.node("cubeacp"))
    data = b"123456789 and so on\0"
    expected = [
        (
            *(
                links.crc(known.checksums[name].crc, data[:n])
                for name in ("crc8", "crc16")
            ),
        )
        for n in range(len(data))
    ]
    assert [
        tuple(map(int, line.split())) for line in done.stdout.splitlines()
    ] == expected
