"""Data of messages for the JavaScript codec: every key of a field, and no other."""

from __future__ import annotations

import json

import pytest

from icdgen.backends.html.plan import enum_plan, integer, message_plan
from tests.icd.files import loaded, status
from tests.limits import assert_limits

ENUMS = """\
enums:
  - {name: Mode, members: [{value: 0, name: Idle}, {value: 1, to: 3, name: Run}]}
"""
FIELDS = (
    "at: 0, bits: 8, name: Mode, type: enum, enum: Mode",
    "at: 8, bits: 8, name: Key, type: uint, const: 0",
    "at: 16, bits: 12, name: Heat, type: int, unit: C, formula: raw*0.5 - 3, min: -40.5, below: 100",
    "at: 28, bits: 1, name: Flag, type: bool",
    "at: 32, bits: 8, name: Wear, type: uint, when: {Mode: [1, 2]}, special: [{value: 0, meaning: none}]",
    "at: 8, bits: 4, name: Low, type: uint, view: true",
    "at: 40, bits: 16, name: Mask, type: uint, display: hex",
    "at: 56, bits: 32, name: Rate, type: float, display: {digits: 3}",
    "at: 88, bits: 8, name: Scaled, type: uint, formula: raw*0.25, display: {decimals: 2}",
    "at: 96, bits: 16, name: Label, type: text",
    "at: 112, bits: 16, name: Data, type: bytes",
    "at: 128, bits: 16, count: 2, name: Words, type: uint, byte_order: big",
    "at: 160, bits: 4, count: 2, name: Halves, type: uint",
)
PLANS = {
    "Mode": {"type": "enum", "bits": 8, "pieces": [[0, 0, 8, 0]], "enum": "Mode"},
    "Key": {"type": "uint", "bits": 8, "pieces": [[1, 0, 8, 0]], "const": 0},
    "Heat": {
        "type": "int",
        "bits": 12,
        "signed": True,
        "pieces": [[2, 0, 8, 0], [3, 0, 4, 8]],
        "scale": [1, -6, 2],
        "unit": "C",
        "limits": {"min": [-81, 2], "below": [100, 1]},
    },
    "Flag": {"type": "bool", "bits": 1, "pieces": [[3, 4, 1, 0]]},
    "Wear": {
        "type": "uint",
        "bits": 8,
        "pieces": [[4, 0, 8, 0]],
        "special": [[0, "none"]],
        "when": [[0, [1, 2]]],
    },
    "Low": {"type": "uint", "bits": 4, "view": True, "pieces": [[1, 0, 4, 0]]},
    "Mask": {
        "type": "uint",
        "bits": 16,
        "pieces": [[5, 0, 8, 0], [6, 0, 8, 8]],
        "base": ["0x", 16, 4],
    },
    "Rate": {
        "type": "float",
        "bits": 32,
        "pieces": [[7, 0, 8, 0], [8, 0, 8, 8], [9, 0, 8, 16], [10, 0, 8, 24]],
        "digits": 3,
    },
    "Scaled": {
        "type": "uint",
        "bits": 8,
        "pieces": [[11, 0, 8, 0]],
        "scale": [1, 0, 4],
        "decimals": 2,
        "fixed": True,
    },
    "Label": {"type": "bytes", "bits": 16, "text": True, "first": 12},
    "Data": {"type": "bytes", "bits": 16, "first": 14},
    "Halves[0]": {"type": "uint", "bits": 4, "pieces": [[20, 0, 4, 0]]},
    "Halves[1]": {"type": "uint", "bits": 4, "pieces": [[20, 4, 4, 0]]},
}
WORDS = {
    "array": "Words",
    "count": 2,
    "step": 2,
    "fields": [
        {
            "type": "uint",
            "bits": 16,
            "pieces": [[16, 0, 8, 8], [17, 0, 8, 0]],
        }
    ],
}


def plan_of(folder, text: str, represented=()) -> dict:
    result = loaded(folder, text)
    assert result.ok, [finding.message for finding in result.findings]
    (node,) = result.icd.nodes
    plan = message_plan(node.messages[0], node, represented)
    return json.loads(json.dumps(plan))


def test_a_field_has_each_key_that_applies_and_no_other(tmp_path):
    plan = plan_of(tmp_path, ENUMS + status(*FIELDS, length=21))
    fields = {
        field.get("name", field.get("array")): field for field in plan.pop("fields")
    }
    assert plan == {"name": "Status", "length": 21, "conditional": True}
    words = fields.pop("Words")
    assert words == WORDS
    assert fields == {name: {"name": name, **keys} for name, keys in PLANS.items()}


def test_an_array_that_a_page_shows_once_is_marked(tmp_path):
    text = ENUMS + status(*FIELDS, length=21)
    for names in ((), ("Words",), ("Halves",)):
        fields = plan_of(tmp_path, text, names)["fields"]
        marked = [field["array"] for field in fields if field.get("isShownOnce")]
        assert marked == (["Words"] if names == ("Words",) else [])


PARTS = """\
structs:
  - {name: Point, length: 3, fields: [
      {at: 0, bits: 8, name: X, type: uint}, {at: 8, bits: 16, name: "Y", type: uint}]}
messages:
  - name: Status
    id: 1
    kind: telemetry
    length: 3
    fields:
      - {at: 0, bits: 8, name: First, type: uint}
      - {at: 8, bits: 8, name: Last, type: uint}
      - {at: 16, bits: 8, name: Size, type: uint}
      - {at: 24, name: Points, struct: Point, count: First, up_to: 4}
      - {at: 24, after: Points, bits: 16, name: Levels, type: uint, count: {field: Last, plus: 1}, up_to: 3}
      - {at: 24, after: Levels, name: Data, type: bytes, size: Size, up_to: 9}
      - {at: 24, after: Data, bits: 16, name: CRC, type: uint}
"""


def test_variable_length_parts_have_their_counters_and_the_last_one_is_the_tail(
    tmp_path,
):
    plan = plan_of(tmp_path, PARTS)
    fields = plan.pop("fields")
    assert plan == {
        "name": "Status",
        "length": 3 + 12 + 6 + 9 + 2,
        "fewest": 3 + 2 + 2,
        "inner": [
            {"counter": 0, "begin": 3, "step": 3, "most": 4, "plus": 0},
            {"counter": 1, "begin": 15, "step": 2, "most": 3, "plus": 1},
        ],
        "tail": {
            "part": "Data", "counter": "Size", "least": 21, "step": 1, "most": 9, "behind": 2,
        },
    }  # fmt: skip
    assert [field.get("name") or field.get("array") for field in fields] == [
        "First", "Last", "Size", "Points", "Levels", "Data", "CRC",
    ]  # fmt: skip
    points, levels, data, crc = fields[3:]
    assert [field["name"] for field in points["fields"]] == ["X", "Y"]
    assert (points["count"], points["step"], levels["count"]) == (4, 3, 3)
    assert all(field["inner"] for field in points["fields"])
    assert data["isOpen"] and "isOpen" not in crc and "inner" not in crc


def test_other_fields_are_named_by_their_index_among_all_elements(tmp_path):
    """Indices count the elements of arrays in front of a field."""
    text = status(
        "at: 0, bits: 8, count: 3, name: Levels, type: uint",
        "at: 24, bits: 8, name: Mode, type: uint",
        "at: 32, bits: 8, name: Wear, type: uint, when: {Mode: 0}",
        "at: 40, bits: 8, name: Size, type: uint",
        length=6,
    )
    text += "    derived: [{name: Sum, formula: 'Size*2 + Mode'}]\n"
    plan = plan_of(tmp_path, text)
    wear, _, total = plan["fields"][2:]
    assert wear["when"] == [[3, [0]]]
    assert total["name"] == "Sum" and sorted(total["derived"][0]) == [3, 5]
    assert plan["conditional"] is True


def test_ranges_of_members_have_their_last_value(tmp_path):
    text = ENUMS.replace("value: 0,", "value: -2, to: 0,")
    (enum,) = loaded(tmp_path, text + status()).icd.nodes[0].enums
    assert enum_plan(enum) == [[-2, "Idle", 0], [1, "Run", 3]]


@pytest.mark.parametrize("sign", [1, -1])
def test_integers_that_a_double_does_not_have_are_texts(sign):
    assert_limits(lambda value: integer(sign * value) == sign * value, most=2**53 - 1)
    assert integer(sign * 2**53) == str(sign * 2**53)
