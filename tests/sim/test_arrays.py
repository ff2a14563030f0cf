"""Options of the simulator set one element of an array or all elements."""

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
    assignments = fields_of(icd, icd.node("demo"), "Heat", key, value)
    assert {
        field.steps[-1].element: raw_value_of(message, field, value_)
        for message, field, value_ in assignments
    } == raw


def test_a_wave_of_an_array_moves_each_element(icd):
    wave = {"wave": "sine", "min": 0, "max": 1}
    assignments = fields_of(icd, icd.node("demo"), "Heat", "temperatures", wave)
    assert [(field.steps[-1].element, value_) for _, field, value_ in assignments] == [
        (0, wave),
        (1, wave),
        (2, wave),
    ]


def test_too_few_values_are_refused(icd):
    with pytest.raises(
        BadValue, match="`temperatures` takes 3 values in brackets, 2 given"
    ):
        fields_of(icd, icd.node("demo"), "Heat", "temperatures", [1, 2])
