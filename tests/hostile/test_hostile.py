"""A device that obeys the syntax of the link cannot keep a procedure busy beyond its
limits.
"""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from icdgen_runtime._errors import RangeError
from icdgen_runtime.wire.procedures import Procedure

from icdgen.loading import load
from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from tests.conftest import ROOT
from tests.hostile.bounds import begin_at
from tests.hostile.conversation import PROCEDURES, converse, over_a_session
from tests.hostile.devices import KINDS, Device, at_random, honest
from tests.hostile.requests import end_of_request

FAR = (1 << 32) - 1
BOARD = ROOT / "tests" / "protocol" / "keys" / "board.yaml"


@pytest.fixture(scope="module")
def board():
    """A link whose procedures have only the limits of their steps."""
    icd = load([BOARD]).icd
    return limited(link_of(icd, facts.of(icd, icd.node("board"))), FAR, FAR)


def limited(link, time: int, requests: int):
    """Return a link with these limits of its procedures."""
    forms = link.procedures.items()
    changed = {n: form._replace(time=time, requests=requests) for n, form in forms}
    return link._replace(procedures=changed)


def about(row: dict) -> str:
    return " ".join(str(row[key]) for key in ("name", "bus", "inputs") if key in row)


@pytest.mark.parametrize("row", PROCEDURES, ids=about)
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
@pytest.mark.parametrize("is_slow", [False, True], ids=["fast", "slow"])
def test_a_hostile_device_ends_each_procedure_within_its_limits(
    board, row, kind, is_slow
):
    converse(board, row, kind, 900 if is_slow else 1)


@pytest.mark.parametrize(
    "row", [row for row in PROCEDURES if row.get("bus", "uart") == "uart"], ids=about
)
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_a_session_ends_within_the_limits_of_the_procedure(board, row, kind):
    over_a_session(board, row, kind)


@given(st.integers(0, 1 << 32), st.sampled_from(PROCEDURES), st.sampled_from([1, 900]))
@settings(max_examples=300)
def test_random_frames_end_each_procedure_within_its_limits(board, seed, row, latency):
    converse(board, row, at_random(seed), latency)


@pytest.mark.parametrize("row", PROCEDURES, ids=about)
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_no_procedure_sends_more_requests_than_the_limit_of_the_icd(board, row, kind):
    free = converse(board, row, kind)
    for most in (1, 5, free.requests - 1, free.requests):
        limits = max(most, 1)
        conversation = converse(limited(board, FAR, limits), row, kind)
        assert conversation.requests == min(limits, free.requests)
        is_ended = limits >= free.requests
        result = free.procedure.result if is_ended else "limit"
        assert conversation.procedure.result == result


@pytest.mark.parametrize("row", PROCEDURES, ids=about)
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_no_procedure_sends_a_request_after_the_time_of_the_icd(board, row, kind):
    for time in (0, 50, 2000):
        conversation = converse(limited(board, time, FAR), row, kind)
        result, times = conversation.procedure.result, conversation.request_times
        assert max(times) <= time
        if conversation.script[-1]["at"] > time:
            # An outcome can end it before the time is compared.
            assert result in ("limit", "refused", "busy", "timeout", "failed")


@given(st.integers(0, 1 << 32), st.sampled_from(["uart", "i2c", "can"]))
@settings(max_examples=300)
def test_a_request_ends_in_its_time_although_the_device_sends_other_messages(
    board, seed, bus
):
    ended = end_of_request(board, bus, seed)
    assert len(ended.outcomes) == 1


@pytest.mark.parametrize("left", [0, 1, 100])
def test_a_download_near_4_gib_ends_at_the_limit_of_the_icd(board, left):
    form = board.procedures["download"]
    blocks = form.blocks._replace(most=(1 << 32) - 2)
    form = form._replace(blocks=blocks)
    link = board._replace(procedures={"download": form})
    download = Procedure(link, "download", {"type": 2, "counter": 1})
    begin_at(download, blocks.most - left)
    device, now = Device(link, "download", honest), 0
    while download.result is None:
        for event in device.answer(download.next(now)):
            now += 1
            download.event(now, event)
    assert download.result == "limit"
    assert len(download.data) == left // blocks.size * blocks.size


def test_a_size_above_the_limit_of_the_icd_is_rejected(board):
    inputs = {"type": 2, "counter": 1}
    form = next(i for i in board.procedures["download"].inputs if i.name == "size")
    Procedure(board, "download", {**inputs, "size": form.most})
    with pytest.raises(RangeError, match=f"0 to {form.most}"):
        Procedure(board, "download", {**inputs, "size": form.most + 1})
