"""An ICD that is imported again has the new facts, and keeps the additions of its
user.
"""

from __future__ import annotations

import pytest
import yaml

from icdgen.icd.fmt import format_text
from icdgen.import_results.update import update

OLD = """\
# About the file.
icdgen: 1
node:
  name: pump
  title: Pump
  byte_order: little
  bit_order: lsb0

enums:
  # About the mode.
  - name: Mode
    members:
      - {value: 0, name: Idle}  # Behind idle.
      # Above running.
      - {value: 1, name: Run, summary: Ours.}
      # At the end of the members.
    # At the end of the mode.
  - name: Unused
    members: [{value: 0, name: Zero}]

messages:
  - name: State
    id: 140
    kind: telemetry
    length: 4
    fields:
      - at: 0
        bits: 16
        name: Pressure
        type: int
        formula: raw*0.1  # Behind the formula.
        min: -5
        # At the end of the pressure.
      - {at: 16, bits: 8, name: Level, type: uint}
    # At the end of the state.
# At the end of the file.
"""
NEW = """\
enums:
  - name: Mode
    members:
      - {value: 0, name: Idle}
      - {value: 1, name: Running}
      - {value: 2, name: Failed}
messages:
  - name: State
    id: 140
    kind: telemetry
    length: 5
    fields:
      - {at: 0, bits: 16, name: Pressure, type: int, formula: raw*0.2}
      - {at: 16, bits: 8, name: Mode, type: enum, enum: Mode}
      - {at: 24, bits: 16, name: Level, type: uint}
"""


UPDATED = """\
# About the file.
icdgen: 1
node:
  name: pump
  title: Pump
  byte_order: little
  bit_order: lsb0

enums:
  # About the mode.
  - name: Mode
    members:
      - {value: 0, name: Idle}  # Behind idle.
      # Above running.
      - {value: 1, name: Running, summary: Ours.}
      - {value: 2, name: Failed}
      # At the end of the members.
    # At the end of the mode.

messages:
  - name: State
    id: 140
    kind: telemetry
    length: 5
    fields:
      # Behind the formula.
      # At the end of the pressure.
      - {at: 0,  bits: 16, name: Pressure, type: int,  formula: raw*0.2, min: -5}
      - {at: 16, bits: 8,  name: Mode,     type: enum, enum: Mode}
      - {at: 24, bits: 16, name: Level,    type: uint}
    # At the end of the state.
# At the end of the file.
"""
CHANGES = [
    "~ enumeration `Mode`: member 1 `Running`: name `Run` -> `Running`",
    "+ enumeration `Mode`: member 2 `Failed`",
    "- enumeration `Unused`",
    "~ message `State` (140): length `4` -> `5`",
    "~ message `State` (140): field `Pressure`: formula `raw*0.1` -> `raw*0.2`",
    "+ message `State` (140): field `Mode`",
    "~ message `State` (140): field `Level`: at `16` -> `24`",
    "~ message `State` (140): field `Level`: bits `8` -> `16`",
]


def test_all_comments_and_keys_of_the_user_stay_at_their_places():
    updated = update(OLD, "pump.yaml", yaml.safe_load(NEW))
    assert updated.text == UPDATED
    assert updated.changes == CHANGES


def test_an_update_with_the_same_facts_changes_nothing():
    updated = update(UPDATED, "pump.yaml", yaml.safe_load(NEW))
    assert (updated.text, updated.changes) == (UPDATED, [])


HEAD = """\
icdgen: 1
node: {name: pump, title: Pump, byte_order: little, bit_order: lsb0}
"""
A, B, C = (
    f"  - {{name: {name}, id: {id}, kind: telecommand, length: 0}}\n"
    for name, id in (("A", 1), ("B", 2), ("C", 3))
)
OURS = A.replace("length: 0", "length: 0, summary: Ours.")
LINK = "protocol:\n  link:\n    ids: {telemetry: {mask: 128}}\n"


@pytest.mark.parametrize(
    ("old", "new", "expected", "changes"),
    [
        ("", LINK, LINK, ["+ protocol"]),
        (LINK, LINK, LINK, []),
        (LINK.replace("128", "64"), LINK, LINK, ["~ protocol is another"]),
        (LINK, "{}", LINK, []),
        ("messages:\n", f"messages:\n{A}", f"messages:\n{A}", ["+ message `A` (1)"]),
        (f"messages:\n{A}", "{}", "", ["- message `A` (1)"]),
        # Old messages keep their order, new ones follow their predecessor.
        (f"messages:\n{A}{B}", f"messages:\n{A}{C}{B}", f"messages:\n{A}{C}{B}", ["+ message `C` (3)"]),
        (f"messages:\n{A}{B}", f"messages:\n{C}{B}{A}", f"messages:\n{C}{A}{B}", ["+ message `C` (3)"]),
        (f"messages:\n{A}{B}", f"messages:\n{B}{C}{A}", f"messages:\n{A}{B}{C}", ["+ message `C` (3)"]),
        # A renamed message has the same id, one with another id has the same name.
        (f"messages:\n{OURS}", f"messages:\n{A.replace('A', 'D')}", f"messages:\n{OURS.replace('A', 'D')}",
         ["~ message `D` (1): name `A` -> `D`"]),
        (f"messages:\n{OURS}", f"messages:\n{A.replace('1', '9')}", f"messages:\n{OURS.replace('1', '9')}",
         ["~ message `A` (9): id `1` -> `9`"]),
        (f"messages:\n{OURS}", f"messages:\n{A.replace('A', 'D').replace('1', '9')}",
         f"messages:\n{A.replace('A', 'D').replace('1', '9')}", ["+ message `D` (9)", "- message `A` (1)"]),
        ("units:\n  - {symbol: ohm}\n", "units: [{symbol: lx, text: lux}, {symbol: ohm}]",
         "units:\n  - {symbol: ohm}\n  - {symbol: lx, text: lux}\n", ["+ units lx"]),
    ],
)  # fmt: skip
def test_facts_are_replaced_and_objects_are_found_again(old, new, expected, changes):
    updated = update(HEAD + old, "pump.yaml", yaml.safe_load(new))
    assert updated.changes == changes
    assert updated.text == format_text(HEAD + expected, "pump.yaml")
