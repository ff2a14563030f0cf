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


def changed(old: str, new: str, given_keys=frozenset()) -> tuple[str, list[str]]:
    """Return the text behind the head, and the changes."""
    updated = update(HEAD + old, "pump.yaml", yaml.safe_load(new), given_keys)
    text = updated.text.split("bit_order: lsb0}\n")[-1].split("bit_order: lsb0\n")[-1]
    return text.strip("\n"), updated.changes


ENUM = "enums: [{{name: {}, {}members: [{{value: 0, name: {}}}]}}]\n"
IN_TABLE = "source: {table: 7}, "


@pytest.mark.parametrize(
    ("old", "new", "changes"),
    [
        # Enumerations are found again by name or by table, members by their value.
        (ENUM.format("A", "", "x"), ENUM.format("A", "", "y"),
         ["~ enumeration `A`: member 0 `y`: name `x` -> `y`"]),
        (ENUM.format("A", IN_TABLE, "x"), ENUM.format("B", IN_TABLE, "x"),
         ["~ enumeration `B`: name `A` -> `B`"]),
        (ENUM.format("A", IN_TABLE, "x"), ENUM.format("B", "source: {table: 8}, ", "x"),
         ["+ enumeration `B`", "- enumeration `A`"]),
        (ENUM.format("A", "", "x"), ENUM.format("B", "", "x"),
         ["+ enumeration `B`", "- enumeration `A`"]),
        # Structs have fields like messages; bits of logs are found again by number.
        ("structs: [{name: P, length: 1, fields: [{at: 0, bits: 8, name: a, type: uint}]}]",
         "structs: [{name: P, length: 2, fields: [{at: 0, bits: 8, name: a, type: int}]}]",
         ["~ struct `P`: length `1` -> `2`",
          "~ struct `P`: field `a`: type `uint` -> `int`"]),
        ("structs: [{name: P, length: 1}]", "structs: [{name: Q, length: 1}]",
         ["+ struct `Q`", "- struct `P`"]),
        ("loggable: [{bit: 0, id: 3}, {bit: 1, id: 4}, {bit: 3, id: 9}]",
         "loggable: [{bit: 0, id: 5}, {bit: 1, id: 4}, {bit: 2, id: 4}]",
         ["~ loggable bit 0: id `3` -> `5`", "+ loggable bit 2", "- loggable bit 3"]),
        ("loggable: [{bit: 0, id: 3}, {bit: 0, id: 4}]",
         "loggable: [{bit: 0, id: 3}, {bit: 0, id: 5}]",
         ["~ loggable bit 0: id `4` -> `5`"]),
        ("messages: [{name: A, id: 0}]", "messages: [{name: B, id: 0}]",
         ["~ message `B` (0): name `A` -> `B`"]),
        ("messages: [{name: A, set_id: 3, get_id: 131}]",
         "messages: [{name: B, set_id: 3, get_id: 132}]",
         ["+ message `B` (3/132)", "- message `A` (3/131)"]),
        # A telecommand and telemetry can share an id.
        ("messages: [{name: A, kind: telecommand, id: 0}]",
         "messages: [{name: B, kind: telemetry, id: 0}]",
         ["+ message `B` (0)", "- message `A` (0)"]),
        ("messages: [{name: A, kind: configuration, set_id: 3, get_id: 131}]",
         "messages: [{name: B, kind: configuration, set_id: 3, get_id: 131}]",
         ["~ message `B` (3/131): name `A` -> `B`"]),
        ("messages: [{name: A}]", "messages: [{name: B}]",
         ["+ message `B`", "- message `A`"]),
        # A message with both, name and id, precedes one with the name alone.
        ("messages: [{name: A, id: 1}, {name: A, id: 2}]",
         "messages: [{name: A, id: 2}, {name: A, id: 3}]",
         ["~ message `A` (3): id `1` -> `3`"]),
        # A field that moved keeps its name, one that was renamed its place.
        ("messages: [{name: A, id: 0, fields: [{at: 0, name: a}, {at: 8, name: b}]}]",
         "messages: [{name: A, id: 0, fields: [{at: 0, name: c}, {at: 8, name: a}]}]",
         ["+ message `A` (0): field `c`", "~ message `A` (0): field `a`: at `0` -> `8`",
          "- message `A` (0): field `b`"]),
        ("messages: [{name: A, id: 0, fields: [{at: 0, name: a}]}]",
         "messages: [{name: A, id: 0, fields: [{at: 0, name: b}]}]",
         ["~ message `A` (0): field `b`: name `a` -> `b`"]),
        ("messages: [{name: A, id: 0}]",
         "messages: [{name: A, id: 0, fields: [{at: 0, name: a}]}]",
         ["+ message `A` (0): field `a`"]),
        # Places in the manual and summaries are no facts of the device.
        ("messages: [{name: A, id: 0}]",
         "messages: [{name: A, id: 0, source: {page: 3}, summary: X, length: 0}]",
         ["~ message `A` (0): length (absent) -> `0`"]),
        ("messages: [{name: A, id: 0, length: 4, allow: [a]}]",
         "messages: [{name: A, id: 0}]",
         ["~ message `A` (0): length `4` -> (absent)",
          "~ message `A` (0): allow ['a'] -> (absent)"]),
        ("messages: [{name: A, id: 0, x: [1]}]",
         f"messages: [{{name: A, id: 0, x: [{'a' * 57}]}}]",
         ["~ message `A` (0): x [1] -> ..."]),
        ("messages: [{name: A, id: 0, x: [1]}]",
         f"messages: [{{name: A, id: 0, x: [{'a' * 56}]}}]",
         [f"~ message `A` (0): x [1] -> ['{'a' * 56}']"]),
        ("", "formula_for: {telecommand: raw}",
         ["~ formula_for (absent) -> {'telecommand': 'raw'}"]),
        ("formula_for: {telecommand: raw}", "{}",
         ["~ formula_for {'telecommand': 'raw'} -> (absent)"]),
        ("formula_for: {telecommand: raw}", "formula_for: {telemetry: raw}",
         ["~ formula_for {'telecommand': 'raw'} -> {'telemetry': 'raw'}"]),
        ("missing: [{name: A, id: 3}]", "missing: [{name: A, id: 4}, {name: B}, {name: C}]",
         ["+ missing B", "+ missing C"]),
    ],
)  # fmt: skip
def test_changes_of_each_section_are_listed(old, new, changes):
    text, listed = changed(old, new)
    assert listed == changes
    # The same import again changes nothing.
    assert changed(text, new) == (text, [])


def test_keys_of_users_stay_unless_the_source_gives_them():
    old = "messages: [{name: A, id: 0, hazard: x, summary: Ours., source: {page: 3, note: see}, also: [{table: 7, page: 1}]}]"
    new = "messages: [{name: A, id: 0, hazard: z, summary: Theirs., source: {page: 4}, also: [{table: 7, page: 2}]}]"
    text, changes = changed(old, new)
    (message,) = yaml.safe_load(text)["messages"]
    assert changes == []
    assert message == {
        "name": "A",
        "id": 0,
        "hazard": "x",
        "summary": "Ours.",
        "source": {"page": 4, "note": "see"},
        "also": [{"table": 7, "page": 2}],
    }
    text, changes = changed(old, new, frozenset({"hazard"}))
    assert changes == ["~ message `A` (0): hazard `x` -> `z`"]
    (message,) = yaml.safe_load(text)["messages"]
    assert (message["hazard"], message["summary"]) == ("z", "Ours.")


def test_further_places_of_other_tables_are_replaced():
    old = "messages: [{name: A, id: 0, also: [{table: 7, note: see}]}]"
    text, changes = changed(old, old.replace("7, note: see", "8"))
    assert yaml.safe_load(text)["messages"][0]["also"] == [{"table": 8}]
    assert changes == [
        "~ message `A` (0): also [{'table': 7, 'note': 'see'}] -> [{'table': 8}]"
    ]
