"""Rows of the field table of a message, grids of flags, and its drawing and frames."""

from __future__ import annotations

from icdgen.backends.html import all_facts, fields
from icdgen.backends.html.drawing import draw_frame
from icdgen.backends.html.examples import _cell, example_frames, page_vectors
from icdgen.backends.html.relations import Relations
from icdgen.backends.html.sections import field_sections
from icdgen.loading import load
from icdgen.protocol import facts
from tests.conformance.icds import LINKS
from tests.conftest import ROOT
from tests.icd.files import loaded, status
from tests.limits import assert_limits

MODE = "enums: [{name: Mode, members: [{value: 0, name: Idle}]}]\n"
FIELDS = (
    "at: 0, bits: 8, name: Mode, type: enum, enum: Mode",
    "at: 8, bits: 8, name: Heat, type: int, unit: C, formula: raw*-0.5",
    "at: 24, bits: 8, name: Wear, type: uint, when: {Mode: 0}",
    "at: 32, bits: 8, name: Table, type: uint, points: [[0, 1], [255, 7]]",
    "at: 40, bits: 64, name: Rate, type: float",
)
DERIVED = "    derived: [{name: Double, formula: 'Rate*2', unit: s}]\n"


def relations_of(folder, text):
    result = loaded(folder, text)
    assert result.ok, [finding.message for finding in result.findings]
    relations = Relations(result.icd)
    return relations, relations.icd.nodes[0].messages[0]


def test_a_row_has_range_resolution_unit_formula_and_remarks(tmp_path):
    relations, message = relations_of(
        tmp_path, MODE + status(*FIELDS, length=13) + DERIVED
    )
    rows = fields.rows(message, relations.links)
    assert [(row.key, row.at, row.bits, row.name, row.type) for row in rows] == [
        (1, 0, 8, "Mode", "enum"),
        (2, 8, 8, "Heat", "int8"),
        (0, 16, 8, "", ""),
        (3, 24, 8, "Wear", "uint8"),
        (4, 32, 8, "Table", "uint8"),
        (5, 40, 64, "Rate", "float64"),
        (6, rows[6].at, rows[6].bits, "Double", "derived"),
    ]
    mode, heat, gap, wear, table, _, double = rows
    assert (mode.enum_url, mode.anchor) == ("demo/enum-mode.html", "field-mode")
    assert (heat.raw, heat.physical) == ("−128 … 127", "−63.5 … 64")
    assert (heat.resolution, heat.formula) == ("0.5", "raw*-0.5")
    assert (heat.unit, heat.unit_url) == ("C", "units.html#unit-c")
    assert (gap.field, gap.anchor, list(gap.notes)) == (None, "", [])
    assert list(wear.notes) == ["Only there if Mode is Idle"]
    assert list(table.notes) == ["Points 0: 1, 255: 7"] and table.formula == ""
    assert (double.formula, double.unit, list(double.notes)) == ("Rate*2", "s", [])
    columns = ["raw", "physical", "resolution", "unit", "formula"]
    assert fields.columns_of(rows) == columns
    assert fields.columns_of(rows[:1]) == []


def test_six_flags_are_a_grid(tmp_path):
    def is_grid(count: int) -> bool:
        flags = [f"at: {n}, bits: 1, name: Flag {n}, type: bool" for n in range(count)]
        last = "at: 8, bits: 8, name: Last, type: uint"
        relations, message = relations_of(tmp_path, status(*flags, last))
        sections = field_sections(message, relations.links.repeats(message))
        rows = fields.rows(message, relations.links)
        (shown,) = fields.split(rows, sections)
        flat = [r for row in shown for r in getattr(row, "flags", [row])]
        assert flat == rows
        return isinstance(shown[0], fields.FlagRow)

    assert_limits(is_grid, least=6)


def test_each_run_of_reserved_bits_is_in_one_section(tmp_path):
    """They can be in front of all fields, between two sections, and at the end."""
    texts = [f"at: {16 * n + 8}, bits: 8, name: F{n}, type: uint" for n in range(17)]
    text = status(*texts, length=35).replace(
        "length: 35", "length: 35\n    reserved: 1"
    )
    relations, message = relations_of(tmp_path, text)
    sections = field_sections(message, relations.links.repeats(message))
    rows = fields.rows(message, relations.links)
    first, second = fields.split(rows, sections)
    assert [*first, *second] == rows and len(rows) == 35
    assert [row.at for row in (first[0], first[-1], second[0])] == [0, 144, 152]


def test_a_shape_links_to_its_field_and_has_the_color_of_its_type(tmp_path):
    relations, message = relations_of(tmp_path, MODE + status(*FIELDS, length=13))
    (node,) = relations.icd.nodes
    drawn = draw_frame(message, node, relations.links, 2, 5)
    assert [(shape.key, shape.kind, shape.anchor) for shape in drawn.shapes] == [
        (3, "uint", "field-wear"),
        (4, "uint", "field-table"),
    ]
    assert drawn.plan == {
        "across": 2, "cell": 58.5, "left": 64, "top": 24, "row": 34, "rows": [0, 2], "first": 2,
    }  # fmt: skip
    one = draw_frame(message, node, relations.links, 0, 1)
    assert [number for _, number in one.columns] == list("76543210")
    assert [shape.kind for shape in one.shapes] == ["enum"]


def test_frames_show_curves_doubles_and_each_part_at_its_greatest_length(tmp_path):
    relations, message = relations_of(tmp_path, MODE + status(*FIELDS, length=13))
    (node,) = relations.icd.nodes
    _, ones = example_frames(message, node)
    cells = {
        field.name: tuple(cell)
        for field, cell in zip(message.fields, ones.cells, strict=True)
    }
    assert cells["Table"] == ("255", "7") and cells["Wear"] == ("", "not there")
    assert cells["Rate"] == ("0x" + "F" * 16, "nan")
    rows, are_all = page_vectors(message, node)
    frames = [frame for _, frame in rows]
    assert are_all and len(set(frames)) == len(frames) > 3
    purposes = [why for why, _ in rows]
    assert purposes[0] != "chosen values 0"
    text = status(
        "at: 0, bits: 8, name: A, type: uint",
        "at: 8, bits: 8, name: First, type: uint, count: A, up_to: 2",
        "at: 8, after: First, bits: 8, name: Last, type: uint, count: rest, up_to: 5",
        length=1,
    )
    relations, message = relations_of(tmp_path, text)
    _, ones = example_frames(message, relations.icd.nodes[0])
    assert len(ones.frame) == 1 + 2 + 5


def test_the_protocol_page_has_each_fact_once_with_links_and_reasons():
    shown = {}
    for path in (ROOT / "examples" / "links" / "wheel.yaml", LINKS / "battery.yaml"):
        relations = Relations(load([path]).icd)
        node = relations.icd.nodes[0]
        node_facts = facts.of(relations.icd, node)
        parts = all_facts.facts_of_code(node_facts)
        before = [len(part.rows) for part in parts]
        tables = all_facts.with_remaining_facts(
            relations, node_facts, parts, relations.icd.protocol_of(node)
        )
        assert [len(part.rows) for part in parts] == before
        shown[node.name] = {
            table.anchor: [(row.about, row.value, row.url) for row in table.rows]
            for table in tables
        }
    wheel, battery = shown["wheel"], shown["battery"]
    assert wheel["facts-link-commands"][0] == (
        "Ack: The telemetry",
        "Ack",
        "wheel/ack.html",
    )
    assert wheel["facts-link-commands"][7:] == [
        ("Reasons: No such telecommand", "Unknown command", ""),
        ("Reasons: Wrong length", "Bad length", ""),
        ("Reasons: A value is not allowed", "Out of range", ""),
        ("Reasons: Wrong checksum: clients send the telecommand again at once", "Bad CRC", ""),
    ]  # fmt: skip
    assert battery["facts-link-buses-i2c"] == [
        ("Write: The address without the read/write bit", "0x20", "")
    ]
    assert battery["facts-link-buses-uart"][0] == ("Line: Bits a second", "115,200", "")
    gap = ("Shortest time between two transmissions", "0 ms", "")
    assert gap in battery["facts-link-client"]
    assert battery["facts-link-buses-uart-framing"][0] == (
        "The escape byte",
        "0x1F",
        "",
    )
    assert battery["facts-link-packets"][-1] == (
        "Acknowledge",
        "from device; buses uart; header: id of 8 bits, status of 8 bits (Error)",
        "",
    )
    assert "facts-link-checksums-crc" not in battery


def test_assumed_facts_have_their_reason_and_seeds_are_with_their_checksum():
    relations = Relations(load([ROOT / "examples" / "links" / "wheel.yaml"]).icd)
    node_facts = facts.of(relations.icd, relations.icd.nodes[0])
    reasons = {
        row.about: row.why
        for part in all_facts.facts_of_code(node_facts)
        for row in part.rows
        if row.why
    }
    assert set(reasons.values()) == {each.why for each in node_facts.assumptions}
    relations = Relations(load([ROOT / "examples" / "links" / "mavlink1.yaml"]).icd)
    (node,) = relations.icd.nodes
    node_facts = facts.of(relations.icd, node)
    section = relations.icd.protocol_of(node)
    assert any("seeds" in each for each in section["link"]["checksums"].values())
    tables = all_facts.with_remaining_facts(relations, node_facts, [], section)
    assert [table.anchor for table in tables if "checksum" in table.anchor] == []


def test_keys_without_a_fact_have_the_meaning_of_the_schema():
    about = all_facts._about
    assert about({"description": "sent first (name of a message)"}, "x") == "Sent first"
    assert about({"description": "name of a message"}, "stop_request") == "Stop request"
    assert about({}, "stop_request") == "Stop request"
    text = all_facts._value_text
    assert text({"$ref": "#/$defs/byte"}, "start", 5) == "0x05"
    assert text({}, "address_7bit", 87) == "0x57"
    assert (text({}, "size", 1000), text({}, "check", True)) == ("1,000", "yes")


def test_bits_of_a_float_have_all_digits(tmp_path):
    _, message = relations_of(tmp_path, MODE + status(*FIELDS, length=13))
    assert _cell(message.fields[4], 1).raw == "0x0000000000000001"
