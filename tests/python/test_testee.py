"""The testee of the conformance tests answers every request, even an invalid one."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest


@pytest.fixture(scope="module")
def ask(shipped):
    """Function that sends a request to the testee of the imported package."""
    return lambda **request: shipped.answer(json.dumps(request).encode())


ANGLES = {"node": "cubeacp", "kind": "telemetry", "id": 146}


def test_frames_are_decoded(ask):
    answer = ask(op="decode", bytes="2efb0a000000", **ANGLES)
    assert answer["ok"]
    assert answer["raw"] == {
        "Estimated Roll Angle": -1234,
        "Estimated Pitch Angle": 10,
        "Estimated Yaw Angle": 0,
    }
    assert answer["physical"]["Estimated Roll Angle"] == "c028ae147ae147ae"
    assert answer["bytes"] == "2efb0a000000"


def test_common_messages_are_found_in_every_node_that_includes_them(ask):
    for node in ("common", "cubeacp", "bootloader"):
        assert ask(op="decode", node=node, kind="telecommand", id=1, bytes="5a")["ok"]
    assert (
        ask(op="decode", node="cubemag", kind="telecommand", id=1, bytes="5a")["error"]
        == "unknown-id"
    )


def test_a_configuration_message_has_two_ids(ask):
    for id in (120, 247):
        assert ask(
            op="decode", node="common", kind="configuration", id=id, bytes="00" * 16
        )["ok"]


@pytest.mark.parametrize(
    "line",
    [
        b"",
        b"{",
        b"[]",
        b"null",
        b"\xff\xfe",
        b"[" * 100_000,
        b'{"op": ' * 100_000,
        b"9" * 10_000,
        b'{"op": "\\ud800"}',
        b'{"op": []}',
    ],
)
def test_an_invalid_request_is_refused(shipped, line):
    answer = shipped.answer(line)
    assert (answer["ok"], answer["error"]) == (False, "request")
    assert json.dumps(answer)


def test_the_program_answers_each_line_until_the_end_of_its_input(shipped):
    lines = [b"enum 0 0 999999", b"node 2", b"decode 2 1 255 "]
    done = subprocess.run(
        [sys.executable, "-B", "-m", "icdgen_messages._testee"],
        cwd=shipped.folder,
        input=b"\n".join(lines) + b"\n",
        capture_output=True,
    )
    assert done.returncode == 0 and not done.stderr
    assert done.stdout.splitlines()[1:] == [
        b"ok node_type=10 interface_version=7",
        b"refused unknown-id",
    ]
