"""Golden vectors of variable-length messages detect a counter field that is too narrow."""

from __future__ import annotations

import pytest

from icdgen.loading import load
from icdgen.vectors.make import make_vectors

ICD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
messages:
  - name: Levels
    id: 1
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Count, type: uint}
      - {at: 8, bits: 8, name: Size, type: uint}
"""
ARRAY = "      - {at: 16, bits: 8, name: Levels, type: uint, count: Count, up_to: 9}\n"
ARRAY_AND_BYTES = (
    ARRAY
    + "      - {at: 16, after: Levels, name: Rest, type: bytes, size: Size, up_to: 9}\n"
)


@pytest.mark.parametrize(
    ("parts", "counters"), [(ARRAY, [0]), (ARRAY_AND_BYTES, [0, 1])]
)
def test_a_frame_is_rejected_only_because_of_the_highest_bit_of_a_counter(
    tmp_path, parts, counters
):
    (tmp_path / "demo.yaml").write_text(ICD + parts, encoding="utf-8")
    icd = load([tmp_path / "demo.yaml"]).icd
    (message,) = make_vectors(icd, icd.node("demo")).messages
    frames = {row.frame for row in message.rows}
    for byte in counters:
        rejected = [frame for frame in message.refused_frames if frame[byte] & 0x80]
        # The same frames with the highest bit of the counter cleared must be valid.
        without = [
            frame[:byte] + bytes([frame[byte] & 0x7F]) + frame[byte + 1 :]
            for frame in rejected
        ]
        lengths = {len(frame) for frame in frames}
        assert any(
            2 + sum(frame[counter] for counter in counters) == len(frame)
            and len(frame) in lengths
            for frame in without
        )


@pytest.mark.parametrize(
    ("plus", "counts"), [(0, {0, 1, 2, 5, 8, 9}), (3, {3, 4, 5, 6, 8, 9})]
)
def test_the_numbers_of_elements_at_and_next_to_both_limits_are_tested(
    tmp_path, plus, counts
):
    part = ARRAY.replace("count: Count", f"count: {{field: Count, plus: {plus}}}")
    (tmp_path / "demo.yaml").write_text(ICD + part, encoding="utf-8")
    icd = load([tmp_path / "demo.yaml"]).icd
    (message,) = make_vectors(icd, icd.node("demo")).messages
    assert {len(row.frame) - 2 for row in message.rows} >= counts
