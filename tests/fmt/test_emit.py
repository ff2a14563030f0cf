"""Canonical YAML from trees of plain values."""

from __future__ import annotations

import pytest

from icdgen.icd import schema
from icdgen.icd.fmt.emit import Spelled, canonical_yaml


@pytest.mark.parametrize(
    ("spelling", "value", "written"),
    [("0x5a", 0x5A, "0x5A"), ("0x05", 5, "0x05"), ("10", 10, "10"), ("-7", -7, "-7")],
)
def test_a_number_keeps_its_spelling(spelling, value, written):
    number = Spelled(spelling)
    assert number == value and number.spelling == spelling
    assert canonical_yaml({"icdgen": 1, "zz": number}).endswith(f"zz: {written}\n")


def test_a_tree_is_written_in_the_order_and_layout_of_the_schema():
    tree = {
        "messages": [
            {"kind": "telemetry", "id": Spelled("0x82"), "name": "Status", "length": 2,
             "fields": [{"name": "Mode", "at": 0, "bits": 8, "type": "uint"},
                        {"type": "bool", "name": "Is on?", "at": 8, "bits": 1}]},
        ],
        "node": {"title": "true", "name": "demo"},
        "icdgen": 1,
        "zz": {"none": None, "yes": True, "no": False, "list": [1, "2", 0.5]},
    }  # fmt: skip
    assert canonical_yaml(tree) == (
        f"{schema.LINE}\n"
        """\
icdgen: 1
node:
  name: demo
  title: "true"

messages:
  - name: Status
    id: 0x82
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Mode,     type: uint}
      - {at: 8, bits: 1, name: "Is on?", type: bool}

zz: {none: null, "yes": true, "no": false, list: [1, "2", 0.5]}
"""
    )
