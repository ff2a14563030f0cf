"""Arrays in the simulator: an element, or all of them, are set."""

from __future__ import annotations

import pytest

from icdgen.loading import load
from icdgen.sim.control import fields_of, raw_value_of
from icdgen.values.errors import BadValue

ICD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
messages:
  - name: Heat
    id: 1
    kind: telemetry
    length: 6
    fields:
      - {at: 0, bits: 16, count: 3, name: Temperatures, type: int, unit: C, formula: raw*0.01}
"""


@pytest.fixture(scope="module")
def icd(tmp_path_factory):
    file = tmp_path_factory.mktemp("icd") / "demo.yaml"
    file.write_text(ICD, encoding="utf-8")
    return load([file]).icd


@pytest.mark.parametrize(
    ("key", "value", "raw"),
    [
        ("Temperatures", "[1, 2.5, -3]", {0: 100, 1: 250, 2: -300}),
        ("temperatures", [1, 2.5, -3], {0: 100, 1: 250, 2: -300}),  # of a script
        ("temperatures[2]", "4", {2: 400}),
        ("Temperatures[0]", 4, {0: 400}),
    ],
)
def test_values_of_an_array_come_as_a_list_and_of_an_element_as_a_number(
    icd, key, value, raw
):
    found = fields_of(icd, icd.node("demo"), "Heat", key, value)
    assert {
        one.steps[-1].element: raw_value_of(message, one, given)
        for message, one, given in found
    } == raw


def test_a_wave_of_an_array_moves_each_element(icd):
    wave = {"wave": "sine", "min": 0, "max": 1}
    found = fields_of(icd, icd.node("demo"), "Heat", "temperatures", wave)
    assert [(one.steps[-1].element, given) for _, one, given in found] == [
        (0, wave),
        (1, wave),
        (2, wave),
    ]


def test_too_few_values_are_refused(icd):
    with pytest.raises(
        BadValue, match="`temperatures` takes 3 values in brackets, 2 given"
    ):
        fields_of(icd, icd.node("demo"), "Heat", "temperatures", [1, 2])
