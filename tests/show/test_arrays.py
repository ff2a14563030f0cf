"""``icdgen show`` prints an array as one line, and as one object in JSON."""

from __future__ import annotations

import json

import jsonschema_rs

from icdgen.diff.inputs import shown
from icdgen.loading import load
from icdgen.show.fields import field_table
from icdgen.show.machine import SCHEMA, to_json

ICD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
messages:
  - name: Heat
    id: 1
    kind: telemetry
    length: 9
    fields:
      - {at: 0, bits: 16, count: 3, name: Temperatures, type: int, unit: C, formula: raw*0.01}
      - {at: 48, bits: 12, count: 2, name: Levels, type: uint, byte_order: big, bit_order: msb0}
"""


def read(folder):
    (folder / "demo.yaml").write_text(ICD, encoding="utf-8")
    loaded = load([folder])
    assert loaded.findings == []
    return loaded.icd


def test_an_array_is_one_line_of_the_table(tmp_path):
    node = read(tmp_path).node("demo")
    lines = field_table(node.messages[0], node).splitlines()[2:]
    assert [line.split()[:5] for line in lines] == [
        ["0", "3", "x", "16", "int"],
        ["48", "2", "x", "12", "uint"],
    ]


def test_what_is_shown_for_programs_is_read_back_with_every_element(tmp_path):
    icd = read(tmp_path)
    tree = to_json(icd)
    jsonschema_rs.validator_for(
        json.loads(SCHEMA.read_text(encoding="utf-8"))
    ).validate(tree)
    fields = tree["nodes"][0]["messages"][0]["fields"]
    assert [
        (field["name"], field["offset"], field["bits"], field["count"])
        for field in fields
    ] == [
        ("Temperatures", 0, 16, 3),
        ("Levels", 48, 12, 2),
    ]
    read_back = shown.from_bytes(json.dumps(tree).encode(), "shown").icd
    key = lambda field: (  # noqa: E731
        field.name,
        field.at,
        field.bits,
        field.scale,
        field.byte_order,
    )
    assert list(map(key, read_back.nodes[0].messages[0].fields)) == list(
        map(key, icd.nodes[0].messages[0].fields)
    )


def test_reserved_bits_of_a_repeated_struct_are_shown_once(tmp_path):
    text = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
structs:
  - name: Cell
    length: 2
    fields:
      - {at: 4, bits: 4, name: State, type: uint}
      - {at: 8, bits: 6, name: Level, type: uint, bit_order: msb0}
messages:
  - name: Cells
    id: 1
    kind: telemetry
    length: 10
    fields:
      - {at: 8, name: Cells, struct: Cell, count: 4}
"""
    (tmp_path / "demo.yaml").write_text(text, encoding="utf-8")
    node = load([tmp_path]).icd.node("demo")
    rows = [
        line.split() for line in field_table(node.messages[0], node).splitlines()[2:]
    ]
    assert [row[:2] for row in rows if "reserved" in row] == [
        ["0", "12"],
        ["16", "2"],
        ["72", "8"],
    ]
