"""``icdgen show`` of what few ICDs have: structs, aliases, includes, wide ids, views."""

from __future__ import annotations

from fractions import Fraction

import pytest

from icdgen.loading import load
from icdgen.show.fields import field_table, remarks
from icdgen.show.machine import to_json
from icdgen.show.people import to_text
from icdgen.values.errors import Ambiguous, NotFound
from tests.icd.files import loaded, status, write

BASE = """\
icdgen: 1
node: {name: base, title: Base, byte_order: big, bit_order: msb0, id_bits: 16}
enums:
  - {name: Mode, aliases: [Phase], summary: Of work., members: [{value: 0, to: 3, name: Idle, aliases: [Off, Rest]}]}
structs:
  - name: Peak
    aliases: [Line, Top]
    source: {table: 7}
    length: 1
    fields: [{at: 0, bits: 8, name: Level, type: uint, summary: In steps.}]
messages:
  - {name: Peaks, id: 0x0102, kind: telemetry, length: 2, fields: [{at: 0, name: Peaks, struct: Peak, count: 2}]}
"""
USER = """\
icdgen: 1
node: {name: user, title: User, byte_order: little, bit_order: lsb0, id_bits: 16, summary: Of all.}
include: [base.yaml]
enums:
  - {name: Fault, members: [{value: 0, name: None}]}
messages:
  - name: Erase
    id: 0
    kind: telecommand
    length: 4
    reserved: 2
    group: Files
    aliases: [Wipe, Clear]
    source: {table: 5, page: 12}
    summary: Erases.
    acknowledge: reset
    hazard: Erases all files.
    fields:
      - {at: 0, bits: 8, name: Mode, type: enum, enum: Mode}
      - {at: 8, bits: 8, name: Mode 2, type: enum, enum: Mode}
  - name: All
    id: 0x0103
    kind: telemetry
    period_ms: 500
    length: 3
    contains: [{message: Peaks, at: 8}]
    fields:
      - {at: 0, bits: 8, name: Fault, type: enum, enum: Fault}
      - {at: 8, bits: 8, name: First, type: uint}
      - {at: 16, bits: 8, name: Second, type: uint}
missing: [{kind: telemetry, id: 7, name: Torque, why: Not described.}]
"""


@pytest.fixture(scope="module")
def icd(tmp_path_factory):
    folder = tmp_path_factory.mktemp("show")
    for name, text in (("base.yaml", BASE), ("user.yaml", USER)):
        (folder / name).write_text(text, encoding="utf-8")
    return load([folder], check=False).icd


def test_a_node_lists_own_messages_first_with_the_owner_of_others(icd):
    head, table, enums, missing = to_text(icd, ["user"]).split("\n\n")
    assert head.splitlines() == [
        "user: User",
        "little-endian, lsb0; ids of 16 bits; includes base",
        "Of all.",
    ]
    rows = [line.split() for line in table.splitlines()]
    assert rows[0] == "id kind name bytes fields table group of".split()
    assert rows[2:] == [
        "0 telecommand Erase 4 2 5 Files".split(),
        "259 telemetry All 3 3".split(),
        "258 telemetry Peaks 2 2 base".split(),
    ]
    assert enums == "Enumerations: Fault"
    assert missing == "Missing: telemetry 7 Torque. Not described.\n"
    telemetry = to_text(icd, ["user"], kind="telemetry")
    assert "Peaks" in telemetry and "Erase" not in telemetry
    assert "Enumerations: Fault" in to_text(icd, ["user"], kind="configuration")


def test_a_dangerous_telecommand_has_all_its_facts(icd):
    lines = to_text(icd, ["user", "wipe"]).splitlines()
    assert lines[:5] == [
        "user: Erase",
        "telecommand 0 (hex 0000); 4 bytes; the last 2 reserved; table 5; page 12; "
        "Files; restarts instead of acknowledging",
        "Erases.",
        "Also called Wipe, Clear.",
        "Dangerous: Erases all files.",
    ]
    # An enumeration of several fields is shown once, though an include declares it.
    assert lines[-6:-3] == ["Mode (enumeration)", "Of work.", "Also called Phase."]
    assert lines[-1] == "0 to 3  Idle, Off, Rest"
    assert lines.count("Mode (enumeration)") == 1


def test_a_message_names_its_period_and_what_it_repeats(icd):
    lines = to_text(icd, ["user", "All"]).splitlines()
    assert lines[1:3] == [
        "telemetry 259 (hex 0103); 3 bytes; sent every 500 ms",
        "From bit 8 it repeats Peaks.",
    ]


@pytest.mark.parametrize("name", ["Peak", "line"])
def test_items_of_an_included_node_are_found_by_name_and_alias(icd, name):
    lines = to_text(icd, ["user", name]).splitlines()
    assert lines[:3] == [
        "base: Peak",
        "struct; 1 byte; table 7",
        "Also called Line, Top.",
    ]
    assert "In steps." in lines[-1]
    with pytest.raises(NotFound):
        to_text(icd, ["base", "Fault"])


def test_structs_enumerations_and_messages_have_their_keys_in_json(icd):
    base, user = to_json(icd)["nodes"]
    assert base["structs"] == [
        {
            "name": "Peak",
            "length": 1,
            "table": 7,
            "aliases": ["Line", "Top"],
            "fields": [
                {
                    "name": "Level",
                    "bits": 8,
                    "type": "uint",
                    "summary": "In steps.",
                    "offset": 0,
                }
            ],
        }
    ]
    assert base["enums"] == [
        {
            "name": "Mode",
            "summary": "Of work.",
            "aliases": ["Phase"],
            "members": [
                {"value": 0, "name": "Idle", "to": 3, "aliases": ["Off", "Rest"]}
            ],
        }
    ]
    assert base["id_bits"] == 16 and "structs" not in user
    erase, everything = user["messages"]
    assert {key: value for key, value in erase.items() if key != "fields"} == {
        "name": "Erase",
        "kind": "telecommand",
        "length": 4,
        "id": 0,
        "reserved": 2,
        "group": "Files",
        "table": 5,
        "page": 12,
        "summary": "Erases.",
        "hazard": "Erases all files.",
        "acknowledge": "reset",
        "aliases": ["Wipe", "Clear"],
    }
    assert [field["enum"] for field in erase["fields"]] == ["Mode", "Mode"]
    assert everything["contains"] == [{"message": "Peaks", "offset": 8}]
    assert everything["period_ms"] == 500
    (peaks,) = base["messages"][0]["fields"]
    assert (peaks["struct"], peaks["count"], peaks["offset"]) == ("Peak", 2, 0)
    assert user["missing"] == [
        {"kind": "telemetry", "id": 7, "name": "Torque", "why": "Not described."}
    ]


FIELDS = (
    "at: 0, bits: 8, name: Mode, type: uint, display: hex",
    "at: 8, bits: 8, name: Heat, type: uint, points: [[0, -40], [255, 125]]",
    "at: 16, bits: 8, name: Rate, type: uint, formula: raw*0.5, display: {decimals: 2}",
    "at: 0, bits: 4, name: Low, type: uint, view: true, aliases: [Nibble, Lower]",
    "at: 24, bits: 8, name: Gain, type: int, above: -1.5, below: 100, "
    "special: [{value: 0, meaning: rest}, {value: -1, meaning: none}]",
    "at: 32, bits: 8, name: Page, type: uint, const: 0, when: {Mode: [1, 2]}",
    "at: 40, bits: 16, name: Wide, type: uint, byte_order: big, when: {Mode: 0, Gain: 7}",
)


@pytest.fixture
def status_message(tmp_path):
    result = loaded(tmp_path, status(*FIELDS, length=7))
    assert result.findings == []
    (node,) = result.icd.nodes
    return node.messages[0], node


def test_remarks_have_every_fact_without_a_column(status_message):
    message, _ = status_message
    notes = {
        field.name: list(remarks(field, message=message)) for field in message.fields
    }
    assert notes == {
        "Mode": ["displayed in hexadecimal"],
        "Heat": ["points 0: -40, 255: 125"],
        "Rate": ["displayed with 2 decimals"],
        "Low": ["also called Nibble, Lower", "a view of bits that other fields have"],
        "Gain": ["above -1.5", "below 100", "0: rest", "-1: none"],
        "Page": ["only there if Mode is 1 or 2", "always 0"],
        "Wide": ["only there if Mode is 0 and Gain is 7", "big-endian"],
    }
    (gain,) = (field for field in message.fields if field.name == "Gain")
    text = lambda value: f"<{Fraction(value)}>"  # noqa: E731
    assert list(remarks(gain, text)) == [
        "above <-3/2>",
        "below <100>",
        "<0>: rest",
        "<-1>: none",
    ]


def test_a_message_without_fields_has_an_empty_table(tmp_path):
    text = "messages: [{name: Stop, id: 1, kind: telecommand, length: 0}]\n"
    (node,) = loaded(tmp_path, text).icd.nodes
    assert field_table(node.messages[0], node) == ""


def test_a_name_of_two_messages_is_ambiguous_even_if_an_enumeration_has_it(tmp_path):
    text = (
        "enums: [{name: Mode, members: [{value: 0, name: Idle}]}]\n"
        "messages:\n"
        "  - {name: Mode, id: 1, kind: telecommand, length: 0}\n"
        "  - {name: Mode, id: 1, kind: telemetry, length: 0}\n"
    )
    icd = loaded(tmp_path, text).icd
    with pytest.raises(Ambiguous):
        to_text(icd, ["demo", "Mode"])
    assert to_text(icd, ["demo", "Mode"], kind="telemetry").startswith("demo: Mode\n")
    assert to_text(icd, ["demo", "Mode"], kind="configuration").startswith("Mode (enum")


MACHINE = """\
icdgen: 1
node:
  name: demo
  title: Demo
  byte_order: little
  bit_order: lsb0
  source: {document: Manual, version: "7"}
vocabulary: [mDeg]
structs:
  - {name: Point, length: 1, fields: [{at: 0, bits: 8, name: X, type: uint}]}
enums:
  - {name: Mode, members: [{value: 0, name: Idle}, {value: 7, name: Run}]}
messages:
  - name: Status
    id: 1
    kind: telemetry
    length: 3
    fields:
      - {at: 0, bits: 8, name: Mode, type: enum, enum: Mode, display: hex}
      - {at: 8, name: Point, struct: Point}
      - {at: 16, bits: 8, name: Heat, type: uint, formula: raw*0.5}
      - {at: 16, bits: 4, name: Low, type: uint, view: true}
    derived:
      - {name: Double, formula: Heat*2, unit: s, aliases: [Twice], display: {decimals: 1}}
# errata/demo.yaml
errata: 1
node: demo
notes:
  - {id: DEM-001, title: Places, what: W., evidence: E., confidence: certain, where: [
      {struct: Point}, {struct: Point, field: X}, {enum: Mode}, {enum: Mode, member: 7},
      {message: Status, field: Heat}]}
"""


def test_json_has_views_displays_derived_values_and_places_of_notes(tmp_path):
    result = loaded(tmp_path, MACHINE)
    assert result.ok, [finding.message for finding in result.findings]
    (node,) = to_json(result.icd)["nodes"]
    assert node["vocabulary"] == ["mDeg"]
    assert node["document"] == {"document": "Manual", "version": "7"}
    (message,) = node["messages"]
    mode, *_, low = message["fields"]
    assert mode["display"] == "hex" and low["view"] is True and "view" not in mode
    (derived,) = message["derived"]
    assert derived == {
        "name": "Double",
        "formula": "Heat*2",
        "aliases": ["Twice"],
        "unit": "s",
        "display": {"decimals": 1},
    }
    assert node["notes"][0]["places"] == [
        {"struct": "Point"},
        {"struct": "Point", "field": "X"},
        {"message": "Status", "field": "Heat"},
        {"enum": "Mode"},
        {"enum": "Mode", "member": 7},
    ]


@pytest.mark.parametrize(("count", "is_complete"), [(12, True), (13, False)])
def test_twelve_points_of_a_lookup_table_are_listed(tmp_path, count, is_complete):
    points = [[index, 2 * index] for index in range(count)]
    field = f"at: 0, bits: 8, name: Heat, type: uint, points: {points}, outside: clamp"
    result = loaded(tmp_path, status(field, length=1))
    assert result.ok, [finding.message for finding in result.findings]
    (text,) = remarks(result.icd.nodes[0].messages[0].fields[0])
    listed = ", ".join(f"{raw}: {value}" for raw, value in points)
    assert (text == f"points {listed}, clamped outside") == is_complete


def test_a_struct_of_two_elements_has_the_distance_and_a_derived_value_its_formula(
    tmp_path,
):
    text = MACHINE.replace("length: 3", "length: 4").replace(
        "{at: 8, name: Point, struct: Point}",
        "{at: 24, name: Point, struct: Point, count: 1}",
    )
    for count, words in ((1, "once"), (2, "2 times, every 1 byte")):
        changed = text.replace("count: 1", f"count: {count}").replace(
            "length: 4", f"length: {3 + count}"
        )
        (node,) = load([write(tmp_path, changed)], check=False).icd.nodes
        table = field_table(node.messages[0], node).splitlines()
        assert [line.split("  ")[-1] for line in table if "Point" in line] == [
            f"{words}; DEM-001"
        ]
    assert any("derived: Heat*2" in line and "a view" not in line for line in table)
