"""Every language ends a procedure with a hostile device at the same step, with the same
result.
"""

from __future__ import annotations

import json
from itertools import product
from pathlib import Path

import pytest

from icdgen.protocol import facts
from icdgen.runtime_objects import reference
from icdgen.runtime_objects.links import link_of
from tests.conformance import ROOT
from tests.conformance.build import build
from tests.conformance.compare import difference
from tests.conformance.driver import Testee
from tests.conformance.icds import icd_of
from tests.conformance.languages import all_languages
from tests.hostile.conversation import PROCEDURES, converse, over_a_session
from tests.hostile.devices import KINDS, at_random
from tests.hostile.requests import end_of_request

BOARD = ROOT / "tests" / "protocol" / "keys" / "board.yaml"
RANDOM_DEVICES = 40  # for each procedure
RANDOM_REQUESTS = 100  # on each bus


@pytest.fixture(scope="module")
def icd():
    return icd_of([Path(BOARD)])


@pytest.fixture(scope="module")
def conversations(icd) -> list[tuple[str, dict, dict]]:
    """Return description, request and response of each conversation."""
    link = link_of(icd, facts.of(icd, icd.node("board")))
    recorded = []
    for row in PROCEDURES:
        kinds = {kind.__name__: kind for kind in KINDS}
        kinds |= {f"random {seed}": at_random(seed) for seed in range(RANDOM_DEVICES)}
        for name, kind in kinds.items():
            script = converse(link, row, kind).script
            request = {"op": "procedure", "node": "board", **row, "script": script}
            answer = reference.answer(icd, request)
            recorded.append((f"{row} {name}", request, answer))
    return recorded


def differences_of(icd, recorded: list[tuple[str, dict, dict]], name: str) -> list:
    """Return the answers of a language that differ."""
    testee = Testee(build(all_languages()[name], icd))
    answers = testee.ask([json.dumps(request).encode() for _, request, _ in recorded])
    assert testee.close() == 0, testee.complaint()
    return [
        (about, difference_text)
        for (about, _, good), answer in zip(recorded, answers, strict=True)
        if (difference_text := difference(good, answer))
    ]


def test_the_conversations_end_in_every_way(conversations):
    ends = {answer["steps"][-1]["result"] for _, _, answer in conversations}
    assert ends == {
        "done", "refused", "busy", "timeout", "failed", "length", "limit", "rounds", "checksum",
    }  # fmt: skip


@pytest.mark.parametrize("name", ["python", "c-sanitizers"])
def test_every_language_gives_up_on_a_hostile_device_at_the_same_step(
    icd, conversations, name
):
    assert differences_of(icd, conversations, name) == []


@pytest.fixture(scope="module")
def clients(icd) -> list[tuple[str, dict, dict]]:
    """Return description, request and response of the client of each session, and of
    clients with one request.
    """
    link = link_of(icd, facts.of(icd, icd.node("board")))
    recorded = []
    for row in PROCEDURES:
        for kind in KINDS if row.get("bus", "uart") == "uart" else ():
            _, _, script = over_a_session(link, row, kind)
            request = {"op": "client", "node": "board", "bus": "uart", "script": script}
            answer = reference.answer(icd, request)
            recorded.append((f"{row} {kind.__name__}", request, answer))
    for bus, seed in product(("uart", "i2c", "can"), range(RANDOM_REQUESTS)):
        script = end_of_request(link, bus, seed).script
        request = {"op": "client", "node": "board", "bus": bus, "script": script}
        recorded.append((f"{bus} {seed}", request, reference.answer(icd, request)))
    return recorded


@pytest.mark.parametrize("name", ["python", "c-sanitizers", "rust-debug"])
def test_a_client_does_the_same_with_a_hostile_device(icd, clients, name):
    assert all(answer["ok"] for _, _, answer in clients)
    assert differences_of(icd, clients, name) == []


@pytest.mark.parametrize("name", ["python", "c-sanitizers"])
def test_a_download_above_the_limit_of_the_icd_is_refused(icd, name):
    testee = Testee(build(all_languages()[name], icd))
    request = {"op": "procedure", "node": "board", "name": "download", "script": []}
    inputs = [{"type": 2, "counter": 1, "size": size} for size in (800, 801)]
    answers = testee.ask(
        [json.dumps({**request, "inputs": each}).encode() for each in inputs]
    )
    replies = [json.loads(answer or b"{}") for answer in answers]
    assert replies[0]["ok"] and replies[1] == {"ok": False, "error": "range"}, replies
    testee.close()
