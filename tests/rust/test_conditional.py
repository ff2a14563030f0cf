"""Conditions of optional fields in Rust."""

from __future__ import annotations

import pytest

from icdgen.backends.rust.conditional import presence_test
from icdgen.describe import describe
from tests.features.outputs import icd_of

ICD = """\
icdgen: 1
node: {{name: demo, title: Demo, byte_order: big, bit_order: msb0}}
enums:
  - name: State
    members: [{{value: 0, name: Idle}}, {{value: 3, name: Turning}}]
messages:
  - name: Status
    id: 1
    kind: telemetry
    length: 4
    fields:
      - {{at: 0, bits: 8, name: Mode, type: uint}}
      - {{at: 8, bits: 1, name: Type, type: bool}}
      - {{at: 9, bits: 3, name: State, type: enum, enum: State}}
      - {{at: 16, bits: 16, name: Rate, type: uint, when: {}}}
"""


@pytest.mark.parametrize(
    ("when", "condition"),
    [
        ("{Mode: 7}", "self.mode == 7"),
        ("{Mode: [1, 7]}", "matches!(self.mode, 1 | 7)"),
        ("{State: Turning}", "self.state.raw() == 3"),
        ("{State: [Idle, Turning]}", "matches!(self.state.raw(), 0 | 3)"),
        ("{Type: true}", "self.r#type"),
        ("{Type: false}", "!self.r#type"),
        ("{Type: [false]}", "!self.r#type"),
        ("{Type: [false, true]}", "true"),
        ("{Type: [true, false], Mode: 0}", "true && self.mode == 0"),
    ],
)
def test_a_field_is_present_for_all_values_that_its_condition_lists(
    tmp_path, when, condition
):
    described = describe(icd_of(ICD.format(when), tmp_path))
    fields = described.nodes[0].messages[0].fields
    rate = next(field for field in fields if field.model.name == "Rate")
    assert presence_test(rate) == condition
