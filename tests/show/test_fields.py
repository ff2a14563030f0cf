"""The table of fields has all facts of the fields of a message."""

from __future__ import annotations

from icdgen.loading import load
from icdgen.show.fields import field_table

ICD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
structs:
  - {name: Cell, length: 2, fields: [{at: 0, bits: 16, name: Voltage, type: uint, unit: mV}]}
messages:
  - name: Status
    id: 1
    kind: telemetry
    length: 17
    fields:
      - {at: 0, bits: 8, name: Mode, type: uint, const: 7, aliases: [Kind]}
      - {at: 8, bits: 4, name: Level, type: int, min: -3, above: -4, max: 5}
      - {at: 16, bits: 16, name: Rate, type: int, unit: deg/s, formula: raw*0.5 + 1, special: [{value: -1, meaning: none}]}
      - {at: 32, bits: 8, name: Later, type: uint, when: {Mode: 7}, summary: At times.}
      - {at: 48, bits: 12, count: 2, name: Words, type: uint, byte_order: big, bit_order: msb0}
      - {at: 72, name: Cells, struct: Cell, count: 3}
      - {at: 120, name: Only, struct: Cell, count: 1}
  - name: Record
    id: 2
    kind: telemetry
    length: 1
    fields:
      - {at: 0, bits: 8, name: Count, type: uint}
      - {at: 8, name: Cells, struct: Cell, count: Count, up_to: 3}
"""
TABLES = {
    "Status": """\
offset    bits  type      name             unit   resolution    from       to  notes
------  ------  --------  ---------------  -----  ----------  ------  -------  ---------------------------------------------------
     0       8  uint      Mode                                     0      255  also called Kind; always 7
     8       4  int       Level                                   -3        5  above -4
    12       4  reserved
    16      16  int       Rate             deg/s         0.5  -16383  16384.5  -1: none
    32       8  uint      Later                                    0      255  only there if Mode is 7; At times.
    40       8  reserved
    48  2 x 12  uint      Words                                    0     4095  big-endian, bit 0 of a byte is the most significant
    72  3 x 16  uint      Cells[].Voltage  mV                      0    65535  3 times, every 2 bytes
   120  1 x 16  uint      Only[].Voltage   mV                      0    65535  once
""",
    "Record": """\
offset    bits  type  name             unit  from     to  notes
------  ------  ----  ---------------  ----  ----  -----  ---------------------------------------------------
     0       8  uint  Count                     0    255
     8  3 x 16  uint  Cells[].Voltage  mV       0  65535  as many as Count says; up to 3 times, every 2 bytes
""",
}


def test_the_table_of_a_message_has_all_facts_of_its_fields(tmp_path):
    (tmp_path / "demo.yaml").write_text(ICD, encoding="utf-8")
    loaded = load([tmp_path])
    assert loaded.findings == []
    node = loaded.icd.node("demo")
    tables = {message.name: field_table(message, node) for message in node.messages}
    assert tables == TABLES
