"""Golden vectors of messages with open ends: what notices that a field which counts is
narrower than it should be.
"""

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
ONE = "      - {at: 16, bits: 8, name: Levels, type: uint, count: Count, up_to: 9}\n"
TWO = (
    ONE
    + "      - {at: 16, after: Levels, name: Rest, type: bytes, size: Size, up_to: 9}\n"
)


@pytest.mark.parametrize(("parts", "counters"), [(ONE, [0]), (TWO, [0, 1])])
def test_frames_are_refused_for_the_highest_bit_of_a_count_alone(
    tmp_path, parts, counters
):
    (tmp_path / "demo.yaml").write_text(ICD + parts, encoding="utf-8")
    icd = load([tmp_path / "demo.yaml"]).icd
    (message,) = make_vectors(icd, icd.node("demo")).messages
    frames = {row.frame for row in message.rows}
    for byte in counters:
        told = [frame for frame in message.miscounted if frame[byte] & 0x80]
        without = [
            frame[:byte] + bytes([frame[byte] & 0x7F]) + frame[byte + 1 :]
            for frame in told
        ]
        lengths = {len(frame) for frame in frames}
        assert any(
            2 + sum(frame[one] for one in counters) == len(frame)
            and len(frame) in lengths
            for frame in without
        )


@pytest.mark.parametrize(
    ("plus", "counts"), [(0, {0, 1, 2, 5, 8, 9}), (3, {3, 4, 5, 6, 8, 9})]
)
def test_the_numbers_of_elements_at_both_limits_and_beside_them_are_tested(
    tmp_path, plus, counts
):
    part = ONE.replace("count: Count", f"count: {{field: Count, plus: {plus}}}")
    (tmp_path / "demo.yaml").write_text(ICD + part, encoding="utf-8")
    icd = load([tmp_path / "demo.yaml"]).icd
    (message,) = make_vectors(icd, icd.node("demo")).messages
    assert {len(row.frame) - 2 for row in message.rows} >= counts
