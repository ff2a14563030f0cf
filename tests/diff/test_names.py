"""The report shows names and types of generated code that change."""

from __future__ import annotations

from icdgen.diff.reports.json import document
from tests.diff.cases import FOLDER, compared, compared_texts

RENAMED_NODE = """\
icdgen: 1
node: {{name: {node}, title: Demo, byte_order: little, bit_order: lsb0}}
enums:
  - {{name: Mode, members: [{{value: 0, name: Idle}}]}}
structs:
  - {{name: Part, length: 1, fields: [{{at: 0, bits: 8, name: Mode, type: enum, enum: Mode}}]}}
messages:
  - name: Status
    id: 130
    kind: telemetry
    length: 3
    fields:
      - {{at: 0, name: Part, struct: Part}}
      - {{at: 8, bits: 8, name: Mode, type: enum, enum: Mode}}
      - {{at: 16, bits: 8, name: Count, type: {type}}}
"""


def test_a_retyped_field_of_a_renamed_node_is_reported_without_the_types_that_only_have_a_new_prefix(
    tmp_path,
):
    old = RENAMED_NODE.format(node="demo", type="uint")
    new = RENAMED_NODE.format(node="probe", type="int")
    changes = compared_texts(tmp_path, old, new).changes
    retyped = [change.message for change in changes if change.code == "DIF307"]
    assert retyped == ["`Count` has another type in C and Rust"]


def test_functions_for_elements_and_contained_messages_are_names_of_their_message():
    changes = document(compared(FOLDER / "DIF127"))["changes"]
    names = next(
        change["generated"] for change in changes if change["code"] == "DIF127"
    )
    assert {
        "demo_satellites_read_satellites",
        "demo_satellites_write_satellites",
    } <= set(names["c"])
    assert {"read_satellites", "write_satellites"} <= set(names["rust"])
