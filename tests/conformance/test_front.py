"""The front answers what it can decide, asks the program for the rest, and believes
nothing that is no answer.
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
def known():
    return plan(shipped())


def ask(known, said: str, **request) -> tuple[dict, list[str]]:
    """The answer if the program says ``said`` to everything, and what it was asked."""
    asked: list[str] = []

    def program(line: str) -> str:
        asked.append(line)
        return said

    return Front(known, program).answer(json.dumps(request).encode()), asked


def test_a_request_becomes_indices_and_hex_and_the_answer_names(known):
    said = "ok bytes=2efb field raw=-1234 physical=13846508457334753198 field raw=10 physical=0 field raw=0 physical=0"
    answer, asked = ask(known, said, op="decode", bytes="2EFB", **ANGLES)
    assert asked == ["decode 2 1 146 2efb"]
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
def test_what_is_wrong_with_a_request_is_refused_without_the_program(known, request_):
    answer, asked = ask(known, "ok", **request_)
    assert (answer["ok"], asked) == (False, [])


def test_whether_a_value_fits_and_an_id_leads_anywhere_is_for_the_generated_code_to_say(
    known,
):
    raw = {
        "Estimated Roll Angle": 10**30,
        "Estimated Pitch Angle": 0,
        "Estimated Yaw Angle": 0,
    }
    answer, asked = ask(known, "refused range at=0", op="encode", raw=raw, **ANGLES)
    assert asked == [f"encode 2 1 146 r{10**30} r0 r0"]
    assert answer == {"ok": False, "error": "range", "field": "Estimated Roll Angle"}
    nowhere = {**ANGLES, "op": "decode", "id": 255, "bytes": ""}
    answer, asked = ask(known, "refused unknown-id", **nowhere)
    assert (answer["error"], asked) == ("unknown-id", ["decode 2 1 255 "])
    assert (
        ask(known, "ok bytes=", **nowhere)[0]["error"] == "dispatcher"
    )  # code that takes what it must refuse


def test_a_log_that_reads_otherwise_in_pieces_is_no_answer(known):
    replies = iter(["ok truncated=0", "ok truncated=0", "ok truncated=1"])
    front = Front(known, lambda line: next(replies))
    assert front.answer(b'{"op": "log_decode", "bytes": "0102"}')["error"] == "pieces"


@pytest.mark.parametrize(
    "said", ["", "nonsense", "key=value", "refused", "refused a b"]
)
def test_what_is_no_answer_is_none(known, said):
    with pytest.raises(Died):
        ask(known, said, op="node", node="cubeacp")


def test_a_program_that_dies_leaves_no_answer_and_its_status(known, tmp_path):
    (tmp_path / "plan.json").write_text(json.dumps(known))
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
    first, *others = testee.ask(lines)
    assert json.loads(first) == {"ok": True, "node_type": 1, "interface_version": None}
    assert others == [None, None] and testee.deaths == 1
