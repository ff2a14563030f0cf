"""Frames of ids that several messages share."""

from __future__ import annotations

import random
import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings

from icdgen import codec
from icdgen.frame_bits import constant_bytes
from icdgen.icd.model import Icd
from icdgen.icd.variants import common_length, ids_of
from icdgen.vectors.make import make_vectors
from tests.conformance import odd
from tests.conformance.icds import icd_of
from tests.conformance.random_icds import written
from tests.conformance.strategies import icds


@pytest.fixture(scope="module")
def apart(tmp_path_factory) -> Icd:
    return icd_of([odd.write(tmp_path_factory.mktemp("icd"))])


def told(icd: Icd, group, frame: bytes) -> object:
    """What generated code does: in order, by length and signs."""
    for one in group:
        whole = frame.ljust(one.message.length, b"\0")
        if len(frame) in one.message.layout.lengths and all(
            whole[at] & mask == value for at, mask, value in constant_bytes(one)
        ):
            return one.message.name
    length = common_length(group)
    return length if length not in (None, len(frame)) else None


def demanded(icd: Icd, group, frame: bytes) -> object:
    try:
        found = codec.message_of_frame(icd, [one.message for one in group], frame)
    except codec.LengthError as error:
        return error.expected
    return found and found.name


def hold(icd: Icd, source: random.Random) -> int:
    """Bytes that are looked at tell what the reference reads from fields; how many
    frames were compared.
    """
    compared = 0
    for node in icd.nodes:
        rows = make_vectors(icd, node).shared
        for direction, known in zip(
            ("telecommand", "telemetry"), ids_of(icd, node), strict=True
        ):
            for id, group in known.items():
                frames = [
                    row.frame
                    for row in rows
                    if (row.direction, row.id) == (direction, id)
                ]
                for frame in (
                    [*frames, *(source.randbytes(one.message.length) for one in group)]
                    if len(group) > 1
                    else ()
                ):
                    assert told(icd, group, frame) == demanded(icd, group, frame), (
                        direction,
                        id,
                        frame.hex(),
                    )
                    compared += 1
    return compared


def test_the_bytes_that_code_looks_at_tell_what_the_reference_reads_from_constants(
    apart,
):
    assert hold(apart, random.Random(1)) > 300


@settings(max_examples=8, deadline=None)
@given(icds())
def test_so_they_do_in_random_icds(trees):
    with tempfile.TemporaryDirectory() as name:
        hold(written(trees, Path(name)), random.Random(2))


def test_every_message_of_a_shared_id_has_a_frame_and_so_has_none_of_them(apart):
    rows = make_vectors(apart, apart.node("apart")).shared
    found = {(row.id, row.message) for row in rows}
    for direction in ids_of(apart, apart.node("apart")):
        for id, group in direction.items():
            if len(group) > 1:
                assert {(id, one.message.name) for one in group} <= found
    assert {row.id for row in rows if row.message is None} >= {0x1300, 0x0601, 0x0602}
    assert {row.expected for row in rows} == {None, 2}


def test_a_general_message_takes_what_is_none_of_the_narrower_ones(apart):
    node = apart.node("apart")
    names = [one.message.name for one in ids_of(apart, node).telecommand[0x4C]]
    assert names == [
        "Arm at once",
        "Reset command",
        "Short command",
        "Arm command",
        "Any command",
    ]
    known = [one.message for one in ids_of(apart, node).telecommand[0x4C]]
    frames = {
        "567800000000": "Arm at once",
        "567800000001": "Arm command",
        "123456789abc": "Reset command",
    }
    frames |= {
        "1234": "Short command",
        "000000000000": "Any command",
        "785600000000": "Any command",
    }
    for frame, name in frames.items():
        assert codec.message_of_frame(apart, known, bytes.fromhex(frame)).name == name
    assert codec.message_of_frame(apart, known, b"\x12\x35") is None
