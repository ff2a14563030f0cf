"""Vectors of multiplexed messages distinguish the messages that share an id.

The constant bytes by which generated code distinguishes them must lead to the same
message as the constants that the reference codec decodes.
"""

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
def multiplexed(tmp_path_factory) -> Icd:
    return icd_of([odd.write(tmp_path_factory.mktemp("icd"))])


def identified_by_bytes(icd: Icd, group, frame: bytes) -> object:
    """Return the message that generated code finds, in order, by length and constant
    bytes.

    If no message matches, return the common length of the messages, if the frame has
    another length.
    """
    # Variants are ordered: specific messages precede general ones.
    for variant in group:
        filled = frame.ljust(variant.message.length, b"\0")
        if len(frame) in variant.message.layout.lengths and all(
            filled[at] & mask == value for at, mask, value in constant_bytes(variant)
        ):
            return variant.message.name
    length = common_length(group)
    return length if length not in (None, len(frame)) else None


def identified_by_reference(icd: Icd, group, frame: bytes) -> object:
    try:
        message = codec.message_of_frame(
            icd, [variant.message for variant in group], frame
        )
    except codec.LengthError as error:
        return error.expected
    return message and message.name


def assert_identified_alike(icd: Icd, source: random.Random) -> int:
    """Compare both ways to identify the frames of shared ids; return the number of
    frames.
    """
    compared = 0
    for node in icd.nodes:
        rows = make_vectors(icd, node).shared
        for direction, variants_by_id in zip(
            ("telecommand", "telemetry"), ids_of(icd, node), strict=True
        ):
            for id, group in variants_by_id.items():
                frames = [
                    row.frame
                    for row in rows
                    if (row.direction, row.id) == (direction, id)
                ]
                for frame in (
                    [
                        *frames,
                        *(
                            source.randbytes(variant.message.length)
                            for variant in group
                        ),
                    ]
                    if len(group) > 1
                    else ()
                ):
                    assert identified_by_bytes(
                        icd, group, frame
                    ) == identified_by_reference(icd, group, frame), (
                        direction,
                        id,
                        frame.hex(),
                    )
                    compared += 1
    return compared


def test_constant_bytes_identify_the_same_message_as_the_reference(
    multiplexed,
):
    assert assert_identified_alike(multiplexed, random.Random(1)) > 300


@settings(max_examples=8, deadline=None)
@given(icds())
def test_constant_bytes_identify_the_same_message_in_random_icds(trees):
    with tempfile.TemporaryDirectory() as name:
        assert_identified_alike(written(trees, Path(name)), random.Random(2))


def test_every_message_of_a_shared_id_has_a_frame_and_some_frames_have_no_message(
    multiplexed,
):
    rows = make_vectors(multiplexed, multiplexed.node("apart")).shared
    covered = {(row.id, row.message) for row in rows}
    for direction in ids_of(multiplexed, multiplexed.node("apart")):
        for id, group in direction.items():
            if len(group) > 1:
                assert {(id, variant.message.name) for variant in group} <= covered
    assert {row.id for row in rows if row.message is None} >= {0x1300, 0x0601, 0x0602}
    assert {row.expected for row in rows} == {None, 2}


def test_a_general_message_takes_frames_of_no_specific_message(multiplexed):
    node = multiplexed.node("apart")
    names = [
        variant.message.name for variant in ids_of(multiplexed, node).telecommand[0x4C]
    ]
    assert names == [
        "Arm at once",
        "Reset command",
        "Short command",
        "Arm command",
        "Any command",
    ]
    messages = [
        variant.message for variant in ids_of(multiplexed, node).telecommand[0x4C]
    ]
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
        assert (
            codec.message_of_frame(multiplexed, messages, bytes.fromhex(frame)).name
            == name
        )
    assert codec.message_of_frame(multiplexed, messages, b"\x12\x35") is None
