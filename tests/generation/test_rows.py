"""Rows of the tables for reviews: one per field, with its message and all keys."""

from __future__ import annotations

import pytest

from icdgen.backends.tables import CsvBackend, XlsxBackend
from icdgen.backends.tables.rows import HEADINGS, of_node
from icdgen.loading import load
from tests.icd.files import loaded, status, write

HEAD = """\
enums:
  - {name: Mode, members: [{value: 0, name: Idle}, {value: 3, name: "Runs, slowly"}]}
structs:
  - name: Point
    length: 3
    fields:
      - {at: 0, bits: 8, name: X, type: uint, unit: m, formula: raw*0.1}
      - {at: 8, bits: 8, name: "Y", type: int, count: 2}
"""


def rows_of(folder, text):
    result = load([write(folder, text)], check=False)
    assert not result.findings, [finding.message for finding in result.findings]
    rows = of_node(result.icd.nodes[0])
    assert all(len(row) == len(HEADINGS) for row in rows)
    return [
        {
            heading: cell
            for heading, cell in zip(HEADINGS, row, strict=True)
            if cell != ""
        }
        for row in rows
    ]


def fields_of(folder, *fields, length=8):
    message = {"Message": "Status", "ID": 130, "Kind": "telemetry", "Length": length}
    rows = rows_of(folder, HEAD + status(*fields, length=length))
    assert all(row.items() >= message.items() for row in rows)
    return [
        {heading: cell for heading, cell in row.items() if heading not in message}
        for row in rows
    ]


@pytest.mark.parametrize(
    ("keys", "cells"),
    [
        ("bits: 8, type: uint", {"Bits": 8, "Type": "uint8"}),
        ("bits: 5, type: int", {"Bits": 5, "Type": "int5"}),
        ("bits: 32, type: float", {"Bits": 32, "Type": "float32"}),
        ("bits: 1, type: bool", {"Bits": 1, "Type": "bool"}),
        ("bits: 24, type: bytes", {"Bits": 24, "Type": "bytes"}),
        ("bits: 24, type: text", {"Bits": 24, "Type": "text"}),
        (
            "bits: 8, type: enum, enum: Mode, const: 3",
            {
                "Bits": 8,
                "Type": "enum",
                "Enumeration": "Mode",
                "Members": "0: Idle; 3: Runs, slowly",
                "Constant": 3,
            },
        ),
        (
            "bits: 8, type: uint, unit: m/s, formula: raw*0.5, min: 0, max: 9.5, "
            "summary: Speed",
            {
                "Bits": 8,
                "Type": "uint8",
                "Unit": "m/s",
                "Formula": "raw*0.5",
                "Min": 0,
                "Max": "9.5",
                "Description": "Speed",
            },
        ),
        ("bits: 8, type: uint, count: 3", {"Bits": 8, "Type": "uint8", "Count": 3}),
        (
            "bits: 8, type: uint, below: 9, special: [{value: 255, meaning: none}]",
            {
                "Bits": 8,
                "Type": "uint8",
                "Further": 'below: 9; special: [{"value": 255, "meaning": "none"}]',
            },
        ),
        (
            "bits: 8, type: uint, byte_order: big, const: 0",
            {"Bits": 8, "Type": "uint8", "Constant": 0, "Further": "byte_order: big"},
        ),
    ],
)
def test_a_field_has_its_place_and_its_keys(tmp_path, keys, cells):
    (row,) = fields_of(tmp_path, f"at: 24, name: Rate, {keys}")
    assert row == {"Byte": 3, "Bit": 0, "Name": "Rate", **cells}


def test_a_position_is_a_byte_and_a_bit(tmp_path):
    rows = fields_of(
        tmp_path,
        "at: 0, bits: 7, name: A, type: uint",
        "at: 7, bits: 2, name: B, type: uint",
        "at: 9, bits: 1, name: C, type: bool",
    )
    assert [(row["Byte"], row["Bit"]) for row in rows] == [(0, 0), (0, 7), (1, 1)]


def test_overlays_have_no_row(tmp_path):
    rows = fields_of(
        tmp_path,
        "at: 0, bits: 8, name: A, type: uint",
        "at: 0, bits: 4, name: Low, type: uint, view: true",
    )
    assert [row["Name"] for row in rows] == ["A"]


def test_fields_of_a_struct_have_its_name_and_repeated_ones_their_group(tmp_path):
    rows = fields_of(
        tmp_path,
        "at: 8, name: One, struct: Point",
        "at: 32, name: Many, struct: Point, count: 2",
    )
    x = {"Bits": 8, "Type": "uint8", "Unit": "m", "Formula": "raw*0.1"}
    y = {"Bits": 8, "Type": "int8"}
    group = {"Repeated group": "Many", "Count": 2}
    assert rows == [
        {"Byte": 1, "Bit": 0, "Name": "One.X", **x},
        {"Byte": 2, "Bit": 0, "Name": "One.Y 1", **y},
        {"Byte": 3, "Bit": 0, "Name": "One.Y 2", **y},
        {"Byte": 4, "Bit": 0, "Name": "X", **x, **group},
        {"Byte": 5, "Bit": 0, "Name": "Y 1", **y, **group},
        {"Byte": 6, "Bit": 0, "Name": "Y 2", **y, **group},
    ]


def test_parts_of_variable_length_have_their_counter_and_no_length_of_the_message(
    tmp_path,
):
    text = HEAD + status(
        "at: 0, bits: 8, name: Number, type: uint",
        "at: 8, bits: 16, name: Data, type: uint, count: Number, up_to: 5",
        length=1,
    )
    number, data = rows_of(tmp_path, text)
    assert "Length" not in number
    assert number["Name"] == "Number"
    assert {key: data[key] for key in ("Bits", "Counter", "Up to", "Byte")} == {
        "Bits": 16,
        "Counter": "Number",
        "Up to": 5,
        "Byte": 1,
    }


def test_bytes_of_variable_length_have_8_bits_and_points_of_a_group_its_counter(
    tmp_path,
):
    text = HEAD + status(
        "at: 0, name: Text, type: text, size: rest, up_to: 7", length=0
    )
    (row,) = rows_of(tmp_path, text)
    assert "Further" not in row
    assert {key: row[key] for key in ("Bits", "Counter", "Up to", "Type")} == {
        "Bits": 8,
        "Counter": "rest",
        "Up to": 7,
        "Type": "text",
    }
    text = HEAD + status("at: 0, name: Many, struct: Point, count: rest, up_to: 7",
                         length=0)  # fmt: skip
    assert [
        (row["Repeated group"], row["Counter"], row["Up to"], row["Name"])
        for row in rows_of(tmp_path, text)
    ] == [("Many", "rest", 7, name) for name in ("X", "Y 1", "Y 2")]


MESSAGES = """\
messages:
  - {name: Zero, id: 0, kind: telecommand, length: 0, summary: Stops, group: Basics}
  - name: Config
    set_id: 3
    get_id: 255
    kind: configuration
    length: 1
    fields: [{at: 0, bits: 8, name: Key, type: uint}]
"""


def test_a_message_without_fields_has_one_row_with_its_own_cells(tmp_path):
    zero, config = rows_of(tmp_path, MESSAGES)
    assert zero == {
        "Message": "Zero",
        "ID": 0,
        "Kind": "telecommand",
        "Group": "Basics",
        "Length": 0,
        "Message description": "Stops",
    }
    assert (config["Set ID"], config["Get ID"], "ID" in config) == (3, 255, False)


INCLUDING = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
include: [common.yaml]
# common.yaml
icdgen: 1
node: {name: common, title: Common, byte_order: little, bit_order: lsb0}
messages:
  - {name: Zero, id: 0, kind: telecommand, length: 0, summary: "Stops, at once"}
"""


def test_a_node_without_own_messages_has_no_table(tmp_path):
    icd = loaded(tmp_path, INCLUDING).icd
    assert {node.name for node in icd.nodes} == {"demo", "common"}
    ((path, text),) = CsvBackend().files(icd, None)
    assert str(path) == "common.csv"
    assert text.splitlines()[0] == ",".join(HEADINGS)
    assert text.splitlines()[1] == (
        'Zero,0,,,telecommand,,0,"Stops, at once",,,,,,,,,,,,,,,,,,'
    )
    assert text.endswith("\n") and "\r" not in text
    for backend in (CsvBackend(), XlsxBackend()):
        assert list(backend.identifiers(icd)) == []
