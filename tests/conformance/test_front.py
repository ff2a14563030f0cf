"""The front answers what it can decide, asks the program for everything else, and
rejects malformed replies.
"""

from __future__ import annotations

import json
import shlex
import sys

import pytest

from tests.conformance.driver import Testee
from tests.conformance.front import Front
from tests.conformance.front.plan import plan
from tests.conformance.front.program import Died
from tests.conformance.icds import shipped

ANGLES = {"node": "cubeacp", "kind": "telemetry", "id": 146}


@pytest.fixture(scope="module")
def front_plan():
    return plan(shipped())


def ask(front_plan, reply: str, **request) -> tuple[dict, list[str]]:
    """Return the answer if the program replies ``reply`` to every line, and the lines
    that it got.
    """
    lines: list[str] = []

    def program(line: str) -> str:
        lines.append(line)
        return reply

    return Front(front_plan, program).answer(json.dumps(request).encode()), lines


def test_a_request_becomes_indices_and_hex_and_the_answer_names(front_plan):
    reply = "ok bytes=2efb field raw=-1234 physical=13846508457334753198 field raw=10 physical=0 field raw=0 physical=0"
    answer, lines = ask(front_plan, reply, op="decode", bytes="2EFB", **ANGLES)
    assert lines == ["decode 2 1 146 2efb"]
    assert answer["raw"]["Estimated Roll Angle"] == -1234
    assert answer["physical"]["Estimated Roll Angle"] == "c028ae147ae147ae"
    assert answer["bytes"] == "2efb"


@pytest.mark.parametrize(
    "request_",
    [
        {
            "op": "decode",
            "node": "cubeacp",
            "kind": "telemetry",
            "id": 146,
            "bytes": "0",
        },
        {"op": "encode", **ANGLES, "raw": {"no such": 1}},
        {"op": "encode", **ANGLES, "raw": {}},
        {"op": "decode", "node": "nobody", "kind": "telemetry", "id": 146, "bytes": ""},
        {
            "op": "can_split",
            "kind": "no such",
            "id": 1,
            "source": 1,
            "destination": 2,
            "bytes": "",
        },
        {"op": "uart_events", "chunks": ["0"]},
    ],
)
def test_an_invalid_request_is_refused_without_the_program(front_plan, request_):
    answer, lines = ask(front_plan, "ok", **request_)
    assert (answer["ok"], lines) == (False, [])


def test_the_generated_code_checks_ranges_and_ids(
    front_plan,
):
    raw = {
        "Estimated Roll Angle": 10**30,
        "Estimated Pitch Angle": 0,
        "Estimated Yaw Angle": 0,
    }
    answer, lines = ask(
        front_plan, "refused range at=0", op="encode", raw=raw, **ANGLES
    )
    assert lines == [f"encode 2 1 146 r{10**30} r0 r0"]
    assert answer == {"ok": False, "error": "range", "field": "Estimated Roll Angle"}
    nowhere = {**ANGLES, "op": "decode", "id": 255, "bytes": ""}
    answer, lines = ask(front_plan, "refused unknown-id", **nowhere)
    assert (answer["error"], lines) == ("unknown-id", ["decode 2 1 255 "])
    # Generated code that accepts an id that it must refuse.
    assert ask(front_plan, "ok bytes=", **nowhere)[0]["error"] == "dispatcher"


def test_a_log_must_decode_equally_in_one_piece_and_in_chunks(front_plan):
    replies = iter(["ok truncated=0", "ok truncated=0", "ok truncated=1"])
    front = Front(front_plan, lambda line: next(replies))
    assert front.answer(b'{"op": "log_decode", "bytes": "0102"}')["error"] == "pieces"


@pytest.mark.parametrize(
    "reply", ["", "nonsense", "key=value", "refused", "refused a b"]
)
def test_a_malformed_reply_gives_no_answer(front_plan, reply):
    with pytest.raises(Died):
        ask(front_plan, reply, op="node", node="cubeacp")


def test_a_program_that_dies_leaves_no_answer_and_its_status(front_plan, tmp_path):
    (tmp_path / "plan.json").write_text(json.dumps(front_plan))
    program = "import sys; print('ok node_type=1') if input() == 'node 0' else None; sys.stdout.flush(); input(); sys.exit(7)"
    front = "tests/conformance/front/__main__.py"
    testee = Testee(
        [
            sys.executable,
            front,
            str(tmp_path / "plan.json"),
            *shlex.split(f'{sys.executable} -c "{program}"'),
        ]
    )
    lines = [
        json.dumps({"op": "node", "node": name}).encode()
        for name in ("common", "cubeacp", "cubeacp")
    ]
    first, *later_answers = testee.ask(lines)
    assert json.loads(first) == {"ok": True, "node_type": 1, "interface_version": None}
    assert later_answers == [None, None] and testee.deaths == 1
