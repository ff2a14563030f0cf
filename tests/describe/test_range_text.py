"""Error messages name the range that type and limits allow together."""

from __future__ import annotations

import re

import pytest

from icdgen.describe.bounds import range_text
from icdgen.loading import load

HEAD = "icdgen: 1\nnode: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}\nmessages:\n"


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ("bits: 8, type: uint", "0 to 255"),
        ("bits: 8, type: uint, max: 60, unit: s", "0 to 60 s"),
        (
            "bits: 16, type: int, formula: raw*0.1, min: -40, below: 125, unit: C",
            "-40 to below 125 C",
        ),
        ("bits: 8, type: uint, above: 0", "above 0 to 255"),
        ("bits: 8, type: uint, points: [[0, 10], [255, 20]], max: 15", "10 to 15"),
        ("bits: 32, type: float, above: 0", "above 0"),
        ("bits: 32, type: float, max: 5", "at most 5"),
        ("bits: 32, type: float", ""),
        ("bits: 32, type: float, min: -1, below: 1, unit: s", "-1 to below 1 s"),
        ("bits: 32, type: float, min: 0", "at least 0"),
        ("bits: 32, type: float, below: 0", "below 0"),
        ("bits: 8, type: uint, below: 255", "0 to below 255"),
        ("bits: 8, type: int, formula: raw * -2, max: 0", "-254 to 0"),
        ("bits: 8, type: uint, points: [[0, 20], [255, -10]]", "-10 to 20"),
    ],
)
def test_the_range_is_that_of_type_and_limits(tmp_path, keys, text):
    file = tmp_path / "demo.yaml"
    bits = int(re.search(r"bits: (\d+)", keys)[1])
    length = bits // 8
    field = f"{{at: 0, name: Value, {keys}}}"
    file.write_text(
        f"{HEAD}  - {{name: Set, id: 1, kind: telecommand, length: {length}, fields: [{field}]}}\n"
    )
    loaded = load([file])
    assert [finding.message for finding in loaded.findings] == []
    assert range_text(loaded.icd.nodes[0].messages[0].fields[0]) == text
