"""The importer reads factors, signs of units, wide ids, chapter numbers and frames in
lines.
"""

from __future__ import annotations

import pytest

from tests.importer.rules.test_rules import fields, findings_of, read

HEADING = "5 Telemetry\n\n5.1 State (0x21)\n\n"
NODE = "profile: 1\nnode: {byte_order: little, bit_order: lsb0}\n"
FACTORS = r"""rules:
  - tables: {head: Offset (bits) | Length (bits) | Name | Type}
    message: {heading: '^[\d.]+ {message} \({id}\)$', kind: telemetry}
    columns: {Offset (bits): bit, Length (bits): bits, Name: name, Type: type, COLUMN}
"""


@pytest.mark.parametrize(
    ("heading", "cell", "formula", "unit"),
    [
        ("Scale", "0.01", "raw*0.01", None),
        ("Scale", "10 mV", "raw*10", "mV"),
        ("Scale", "10mV", "raw*10", "mV"),
        ("Unit", "m/s", None, "m/s"),
        ("Unit", "1/s", None, "1/s"),
        ("Scale", "1e-7", "raw*1e-7", None),
        ("Scale", "2^-20", "raw/1048576", None),
        ("Scale", "1/256", "raw/256", None),
        ("Scale", "0.25 °C/LSB", "raw*0.25", "C"),
        ("Unit", "°C", None, "C"),
        ("Unit", "\u2103", None, "C"),
        ("Unit", "degC", None, "C"),
        ("Scale", "10 \u2126", "raw*10", "ohm"),
        ("Unit", "\u03a9", None, "ohm"),
        ("Unit", "\u00b5A", None, "uA"),
        ("Unit", "\u03bcs", None, "us"),
        ("Scale", "LSB = 0.5 dps", "raw*0.5", "dps"),
    ],
)
def test_factors_and_signs_of_units_become_formulas_and_units(
    tmp_path, heading, cell, formula, unit
):
    table = (
        f"Offset (bits)\tLength (bits)\tName\tType\t{heading}\n0\t16\tA\tINT\t{cell}\n"
    )
    role = {"Scale": "Scale: formula", "Unit": "Unit: unit"}[heading]
    _, tree = read(tmp_path, HEADING + table, FACTORS.replace("COLUMN", role), NODE)
    field = tree["messages"][0]["fields"][0]
    assert (field.get("formula"), field.get("unit")) == (formula, unit)


@pytest.mark.parametrize("cell", ["10^-3 T", "0.1 to 0.5", "see 3.1", "sqrt(raw)"])
def test_a_factor_that_cannot_be_read_is_an_error_and_not_guessed(tmp_path, cell):
    table = f"Offset (bits)\tLength (bits)\tName\tType\tScale\n0\t16\tA\tINT\t{cell}\n"
    result, tree = read(
        tmp_path, HEADING + table, FACTORS.replace("COLUMN", "Scale: formula"), NODE
    )
    assert "formula" not in tree["messages"][0]["fields"][0]
    assert findings_of(result, "IMP040") and result.failed


def test_a_unit_that_is_not_built_in_is_declared_with_its_sign_in_letters(tmp_path):
    table = "Offset (bits)\tLength (bits)\tName\tType\tUnit\n0\t16\tA\tINT\tk\u03a9\n"
    _, tree = read(
        tmp_path, HEADING + table, FACTORS.replace("COLUMN", "Unit: unit"), NODE
    )
    assert tree["units"] == [
        {"symbol": "k\u03a9", "identifier": "kohm", "quantity": "not stated"}
    ]


BYTES = "Offset\tSize\tName\tType\n0\t1\tMode\tU8\n1\t2\tSpeed\tU16\n3\t4\tTime\tU32\n"
RULE = r"""rules:
  - tables: {head: Offset | Size | Name | Type}
    message: {heading: '^[\d.]+ {message} \({id}\)$', kind: telemetry}
    columns: {Offset: byte, Size: bytes, Name: name, Type: type}
"""


def test_an_id_that_the_node_has_no_room_for_is_one_line_of_the_report(tmp_path):
    text = f"5 Telemetry\n\n5.1 Fast (0x107)\n\n{BYTES}\n5.2 Slow (0x21)\n\n{BYTES}"
    result, tree = read(tmp_path, text, RULE, NODE)
    assert [m["name"] for m in tree["messages"]] == ["Slow"]
    assert "its id 263 (0x107) is above 255" in findings_of(result, "IMP037")[0]
    _, tree = read(tmp_path, text, RULE, NODE.replace("lsb0}", "lsb0, id_bits: 16}"))
    assert [m["id"] for m in tree["messages"]] == [263, 33] and tree["node"][
        "id_bits"
    ] == 16


def test_bytes_or_bits_are_stated_and_never_inferred(tmp_path):
    text = HEADING + BYTES
    assert fields(read(tmp_path, text, RULE, NODE)[1]) == [
        (0, 8, "Mode"),
        (8, 16, "Speed"),
        (24, 32, "Time"),
    ]
    result, _ = read(
        tmp_path,
        text,
        RULE.replace("Offset: byte, Size: bytes", "Offset: bit, Size: bits"),
        NODE,
    )
    (message,) = findings_of(result, "IMP105")
    assert (
        "its type `U8` has 8 bits, its size is 1; the same in 2 more rows: `Speed`, `Time`"
        in message
    )


def test_a_heading_that_gives_an_id_without_a_table_is_reported(tmp_path):
    text = f"{HEADING}{BYTES}\n6 Telecommands\n\n6.1 Halt (0x12)\n\nStops it.\n\n6.2 Notes\n"
    result, tree = read(tmp_path, text, RULE, NODE)
    assert [m["name"] for m in tree["messages"]] == ["State"]
    assert findings_of(result, "IMP039") == [
        "`6.1 Halt (0x12)` gives the id of a message, and no table below it was read as one"
    ]
    inner, _ = read(
        tmp_path,
        f"5 Telemetry\n\n5.1 State (0x21)\n\n5.1.1 Layout\n\n{BYTES}",
        RULE,
        NODE,
    )
    assert not findings_of(inner, "IMP039")


CHAPTERS = """5 Telemetry

Table {a}1: Motor State Telemetry Format

Channels	Offset (bits)	Length (bits)	Name	Type	Description
	0	8	Mode	ENUM	Possible values are in Table {b}1

Table {b}1: Modes Enumeration Values

Numeric Value	Name	Description
0	Off	off
1	On	on
"""
CHAPTER_RULES = r"""rules:
  - tables: {head: Channels | Offset (bits)}
    message: {caption: '^{message} Telemetry Format$', id: 33, kind: telemetry}
    columns: {Offset (bits): bit, Length (bits): bits, Name: name, Type: type, Description: text}
    ignore: [Channels]
  - what: enumeration
    tables: {head: Numeric Value | Name}
    message: {caption: '^{enumeration} Enumeration Values$'}
    columns: {Numeric Value: value, Name: member, Description: text}
variables: {raw: [RAWVAL]}
"""


@pytest.mark.parametrize(("a", "b"), [("5-", "6-"), ("7.5.", "7.6."), ("", "1")])
def test_tables_numbered_by_chapter_are_found_by_their_numbers(tmp_path, a, b):
    _, tree = read(tmp_path, CHAPTERS.format(a=a, b=b), CHAPTER_RULES, NODE)
    [message] = tree["messages"]
    assert message["fields"][0]["enum"] == "Modes"
    # Ids of an ICD are integers.
    assert message.get("source", {}).get("table") == (None if a else 1)


LINES = "Byte0~Byte1: voltage, 10 mV\nByte2~Byte3: current, 1 mA\nByte4: state\n"
LINE_RULES = r"""rules:
  - tables: {head: Byte | Name}
    message: {heading: '^[\d.]+ {message} \({id}\)$', kind: telemetry}
    columns: {Byte: '^{byte}(?:-{last_byte})?$', Name: ['^{name:\w+}, {scale} {unit}$', name]}
    width: unit
    each: {type: uint}
"""


def test_a_frame_in_lines_is_a_table(tmp_path):
    _, tree = read(tmp_path, HEADING + LINES, LINE_RULES, NODE)
    assert [
        (f["at"], f["bits"], f["name"], f.get("formula"), f.get("unit"))
        for f in tree["messages"][0]["fields"]
    ] == [
        (0, 16, "voltage", "raw*10", "mV"),
        (16, 16, "current", None, "mA"),
        (32, 8, "state", None, None),
    ]


@pytest.mark.parametrize("wrong", ["Byte1~Byte2", "Byte3~Byte4", "By?te2"])
def test_a_byte_that_is_missing_between_lines_is_reported(tmp_path, wrong):
    result, _ = read(
        tmp_path, HEADING + LINES.replace("Byte2~Byte3", wrong), LINE_RULES, NODE
    )
    assert findings_of(result, "IMP035") or findings_of(result, "IMP105")


def test_a_cell_below_a_heading_that_melt_does_not_use_is_an_error(tmp_path):
    rules = r"""rules:
  - tables: {head: Byte0 | Byte1}
    message: {heading: '^[\d.]+ {message} \({id}\)$', kind: telemetry}
    columns: {"*": name}
    melt: '^Byte{byte}$'
    each: {type: uint}
"""
    _, tree = read(tmp_path, f"{HEADING}Byte0\tByte1\tByte2\na\tb\tc\n", rules, NODE)
    assert fields(tree) == [(0, 8, "a"), (8, 8, "b"), (16, 8, "c")]
    result, _ = read(tmp_path, f"{HEADING}Byte0\tByte1\tB?yte2\na\tb\tc\n", rules, NODE)
    assert "gives the column `B?yte2` no role: `c`" in findings_of(result, "IMP102")[0]
