"""A device that obeys the syntax of the link ends every procedure within its limits,
whatever it says.
"""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from icdgen_runtime._errors import RangeError
from icdgen_runtime.wire.transfer import Download

from icdgen.loading import load
from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from tests.conftest import ROOT
from tests.hostile.conversation import PROCEDURES, converse, over_a_session
from tests.hostile.devices import KINDS, Device, at_random, honest
from tests.hostile.requests import end_of_request

BOARD = ROOT / "tests" / "protocol" / "keys" / "board.yaml"


@pytest.fixture(scope="module")
def board():
    icd = load([BOARD]).icd
    return link_of(icd, facts.of(icd, icd.node("board")))


def about(row: dict) -> str:
    return " ".join(str(row[key]) for key in ("do", "bus", "size") if key in row)


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


@given(st.integers(0, 1 << 32), st.sampled_from(["uart", "i2c", "can"]))
@settings(max_examples=300)
def test_a_request_ends_in_its_time_whatever_else_the_device_sends(board, seed, bus):
    ended = end_of_request(board, bus, seed)
    assert len(ended.outcomes) == 1


@pytest.mark.parametrize("left", [0, 1, 100])
def test_a_download_near_4_gib_ends_at_the_limit_of_the_icd(board, left):
    files = board.files
    form = files.download._replace(max_bytes=(1 << 32) - 2)
    link = board._replace(files=files._replace(download=form))
    download = Download(link, "uart", 2, 1)
    download._offset = form.max_bytes - left
    device, now = Device(link, "download", honest), 0
    while download.result is None:
        for event in device.answer(download.next(now)):
            now += 1
            download.event(now, event)
    assert download.result == "limit"
    assert len(download.data) == left // files.block_bytes * files.block_bytes


def test_a_size_above_the_limit_of_the_icd_is_refused(board):
    most = board.files.download.max_bytes
    Download(board, "uart", 2, 1, most)
    with pytest.raises(RangeError, match=f"0 to {most}"):
        Download(board, "uart", 2, 1, most + 1)
