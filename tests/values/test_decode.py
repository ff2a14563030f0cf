"""The output of ``icdgen decode`` for a frame."""

from __future__ import annotations

import json
import struct

import pytest

from icdgen.loading import load
from icdgen.values.hexadecimal import parse_hex
from icdgen.values.text import to_text
from tests.values.decoding import decode


def test_the_table_for_people(icd):
    frame = decode(icd, "top", "17", parse_hex("2efb 0a00 5b 3d"))
    assert to_text(frame) == (
        "top: Set Speed (telecommand 17), 6 bytes\n"
        "2e fb 0a 00 5b 3d\n"
        "\n"
        "field                raw   value  unit   remarks\n"
        "-----------------  -----  ------  -----  ----------------------\n"
        "Commanded X speed  -1234  -12.34  deg/s\n"
        "Commanded Y speed     10     0.1  deg/s\n"
        "Magic Number          91      91         must be 90 (0x5A)\n"
        "Timeout               61      61  s      above the maximum 60 s\n"
    )


def test_the_form_for_machines(icd):
    frame = decode(icd, "top", "Set Speed", parse_hex("2efb 0a00 5a ff"))
    assert json.loads(json.dumps(frame.to_json(), allow_nan=False)) == {
        "node": "top",
        "message": "Set Speed",
        "kind": "telecommand",
        "id": 17,
        "length": 6,
        "bytes": "2efb0a005aff",
        "fields": [
            {"name": "Commanded X speed", "type": "int", "raw": -1234, "value": -12.34, "physical": -12.34,
             "exact": "-617/50", "unit": "deg/s"},
            {"name": "Commanded Y speed", "type": "int", "raw": 10, "value": 0.1, "physical": 0.1, "exact": "1/10",
             "unit": "deg/s"},
            {"name": "Magic Number", "type": "uint", "raw": 90, "value": 90},
            {"name": "Timeout", "type": "uint", "raw": 255, "value": 255, "unit": "s", "remarks": ["no timeout"]},
        ],
    }  # fmt: skip


def everything(icd, **parts):
    values = {
        "flags": 0,
        "mode": 0,
        "ratio": 1.0,
        "precise": 0.0,
        "code": bytes(4),
        "wide": 0,
        "angle": 0,
        "gain": 0,
        "rest": 0,
    }
    values |= parts
    return decode(
        icd, "top", "Everything", struct.pack("<BBfd4sQqBB", *values.values())
    )


def texts(frame):
    return {row.field.name: row.text for row in frame.rows}


def test_every_type_in_words(icd):
    frame = everything(
        icd,
        flags=0xFF,
        mode=7,
        ratio=0.1,
        precise=0.1,
        code=b"\x01\x02\xfe\xff",
        wide=2**64 - 1,
        angle=2**63 - 1,
        gain=1,
    )
    assert texts(frame) == {
        "Enabled": "true",
        "Small": "-1",
        "Mode": "Auto reset",
        "Ratio": "0.1",
        "Precise": "0.1",
        "Key = Code": "01 02 fe ff",
        "Wide": "18446744073709551615",
        "Wide angle": "5.124095576030431e+18",
        "BDot gain": "0.3",
    }
    assert frame.to_json()["set_id"] == 20 and frame.to_json()["get_id"] == 150


def test_what_the_icd_does_not_know_is_shown_as_it_came(icd):
    frame = everything(icd, mode=13, ratio=float("nan"), precise=float("-inf"))
    rows = {
        row["name"]: row
        for row in json.loads(json.dumps(frame.to_json(), allow_nan=False))["fields"]
    }
    assert texts(frame)["Mode"] == "unknown 13"
    assert (rows["Mode"]["raw"], rows["Mode"]["value"]) == (13, None)
    assert rows["Mode"]["remarks"] == ["no member of Switch"]
    assert (rows["Ratio"]["raw"], rows["Ratio"]["value"]) == ("7fc00000", "nan")
    assert rows["Ratio"]["remarks"] == ["not a number"]
    assert (rows["Precise"]["raw"], rows["Precise"]["value"]) == (
        "fff0000000000000",
        "-inf",
    )


@pytest.mark.parametrize("name", ["ratio", "precise"])
def test_a_negative_zero_keeps_its_sign(icd, name):
    frame = everything(icd, **{name: -0.0})
    (row,) = (row for row in frame.rows if row.field.name.lower() == name)
    result = row.to_json()
    assert row.text == "-0.0"
    assert repr(result["value"]) == repr(result["physical"]) == "-0.0"


def test_all_values_of_a_range_have_its_name(icd):
    named = {
        value: everything(icd, mode=value).rows[2] for value in (31, 32, 40, 47, 48)
    }
    assert [row.text for row in named.values()] == [
        "unknown 31",
        *["Reserved"] * 3,
        "unknown 48",
    ]
    assert [row.remarks for row in named.values()] == [
        ("no member of Switch",),
        (),
        (),
        (),
        ("no member of Switch",),
    ]
    assert named[40].to_json() == {
        "name": "Mode",
        "type": "enum",
        "raw": 40,
        "value": "Reserved",
        "enum": "Switch",
    }


@pytest.mark.parametrize(
    ("value", "remarks"),
    [
        (float("nan"), ("not known",)),
        (-float("nan"), ("not known",)),
        (-9999.0, ("no data",)),
        (-9998.0, ()),
    ],
)
def test_special_values_of_floats_are_shown_and_every_nan_is_special(
    icd, value, remarks
):
    assert everything(icd, precise=value).rows[4].remarks == remarks


def test_limits_that_exclude_their_bound(icd):
    frame = everything(icd, ratio=0.0)
    assert frame.rows[3].remarks == ("must be above 0 %",)
    assert everything(icd, ratio=1e-30).rows[3].remarks == ()


def test_reserved_bits_that_are_set_are_pointed_out(icd):
    assert everything(icd).remarks == ()
    frame = everything(icd, rest=0x10)
    assert frame.remarks == ("reserved bits 280 to 287 are not 0",)
    assert to_text(frame).endswith("\nnote: reserved bits 280 to 287 are not 0\n")


def test_the_bit_order_of_the_node_that_declares_the_message_holds(icd):
    frame = decode(icd, "top", "Shared State", b"\x1a\xbc\x00")
    assert texts(frame) == {"Main Switch": "On", "Level": str(0xABC)}
    assert frame.node.name == "top"


def test_a_message_without_fields(icd):
    assert (
        to_text(decode(icd, "top", "42", b"")) == "top: 42 (telecommand 21), 0 bytes\n"
    )


def test_names_cannot_write_to_the_terminal(tmp_path):
    path = tmp_path / "odd.yaml"
    path.write_text(
        "icdgen: 1\nnode: {name: odd, title: Odd, byte_order: little, bit_order: lsb0}\nmessages:\n"
        '  - {name: "A\\x1b[2J[bold]", id: 1, kind: telecommand, length: 1,\n'
        '     fields: [{at: 0, bits: 8, name: "B\\n\\x1b]0;x\\x07[/]", type: uint}]}\n',
        encoding="utf-8",
    )
    frame = decode(load([path], check=False).icd, "odd", "1", b"\x01")
    for width in (None, 20):
        text = to_text(frame, width)
        assert all(c.isprintable() for c in text.replace("\n", ""))
        assert "A\\u{1b}[2J[bold]" in text


def test_a_text_is_shown_readably_and_its_raw_value_is_its_bytes(icd):
    data = b"1.2\x1b\xff\0rest?!"
    assert len(data) == 12
    shown = decode(icd, "top", "Version", data)
    software, hardware = shown.rows
    assert (software.text, hardware.text) == ("1.2\x1b\ufffd", "?!")
    assert software.to_json() == {
        "name": "Software", "type": "text", "raw": data[:10].hex(), "value": "1.2\x1b\ufffd",
    }  # fmt: skip
    assert "\x1b" not in to_text(shown)


def test_a_derived_value_without_a_display_format_is_rounded(tmp_path):
    """0.1 + 0.2 is 0.30000000000000004 as a double."""
    file = tmp_path / "demo.yaml"
    file.write_text(
        "icdgen: 1\n"
        "node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}\n"
        "messages:\n"
        "  - name: Status\n"
        "    id: 1\n"
        "    kind: telemetry\n"
        "    length: 1\n"
        "    fields: [{at: 0, bits: 8, name: Raw, type: uint}]\n"
        '    derived: [{name: Sum, formula: "Raw*0.1 + 0.2"}]\n'
    )
    frame = decode(load([file]).icd, "demo", "Status", b"\1")
    assert frame.rows[1].text == "0.3"
