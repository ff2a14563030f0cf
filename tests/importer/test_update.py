"""An ICD that is imported again has the new facts, and keeps the additions of its
user.
"""

from __future__ import annotations

import yaml

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
