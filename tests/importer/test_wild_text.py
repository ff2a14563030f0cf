"""What manuals in the wild print in other places and other units than a column of bits: ids in headings and prose, bytes, arrays,
fields within cells, factors as units."""

from __future__ import annotations

import pytest

from icdgen.importer import profile, run
from tests.importer.test_text import found

FIELDS = "Offset\tSize\tName\tType\tUnit\n0\t1\tMode\tU8\t\n1\t2\tSpeed\tU16\trpm\n3\t4\tTime\tU32\tms\n"


def read(tmp_path, text: str, words: str = ""):
    (tmp_path / "motor.txt").write_text(text, encoding="utf-8")
    path = None
    if words:
        path = tmp_path / "words.yaml"
        path.write_text("profile: 1\n" + words, encoding="utf-8")
    result, trees = run.run(tmp_path / "motor.txt", profile.load(path), jobs=1)
    return result, trees.get("motor", {})


def places(message: dict) -> list[tuple]:
    return [(f["at"], f["bits"], f["name"]) for f in message.get("fields", [])]


BYTES = [(0, 8, "Mode"), (8, 16, "Speed"), (24, 32, "Time")]


@pytest.mark.parametrize(
    ("heading", "ids", "name"),
    [
        ("Motor State (0x21)", 0x21, "Motor State"),
        ("3.2 Motor State (0x00 0x21)", 0x21, "Motor State"),
        ("Motor State: 0x0021", 0x21, "Motor State"),
        ("Motor State – 21h", 0x21, "Motor State"),
        ("Motor State\n\nTelemetry ID 33, requested by the host.", 33, "Motor State"),
        ("4.1 Motor State\n\nThe message ID: 0x21 is sent once a second.", 33, "Motor State"),
        ("Table 4: Motor State (0x21)", 33, "Motor State"),
    ],
)
def test_id_and_name_stand_in_heading_caption_or_prose(tmp_path, heading, ids, name):
    _, tree = read(tmp_path, f"5 Telemetry\n\n{heading}\n\n{FIELDS}")
    message = tree["messages"][0]
    assert (message["name"], message["id"], message["kind"], message["length"]) == (name, ids, "telemetry", 7)
    assert places(message) == BYTES


def test_a_pattern_of_the_profile_finds_what_the_shipped_ones_do_not(tmp_path):
    text = f"UBX-like: motor state\n\nHeader B5 class 12 number 0\n\n{FIELDS}"
    words = 'patterns: ["UBX-like: {name}", "class {id} number"]\ndefaults: {kind: telemetry}\n'
    assert "messages" not in read(tmp_path, text)[1]
    message = read(tmp_path, text, words)[1]["messages"][0]
    assert (message["name"], message["id"], message["kind"]) == ("motor state", 12, "telemetry")


def test_an_id_that_the_format_cannot_hold_is_one_line_of_the_report(tmp_path):
    result, tree = read(tmp_path, f"5 Telemetry\n\nNAV-PVT (0x01 0x07)\n\n{FIELDS}\nSlow (0x21)\n\n{FIELDS}")
    assert [m["name"] for m in tree["messages"]] == ["Slow"]
    assert "its id 263 (0x107) is above 255" in found(result, "IMP037")[0]


def test_a_profile_makes_room_for_wide_ids(tmp_path):
    text = f"5 Telemetry\n\nNAV-PVT (0x01 0x07)\n\n{FIELDS}\nSlow (0x21)\n\n{FIELDS}"
    _, tree = read(tmp_path, text, "node: {id_bits: 16}\n")
    assert [m["id"] for m in tree["messages"]] == [263, 33] and tree["node"]["id_bits"] == 16


def test_one_heading_gives_its_id_to_one_table(tmp_path):
    result, tree = read(tmp_path, f"5 Telemetry\n\n5.1 Motor State (0x21)\n\n{FIELDS}\nAnd further:\n\n{FIELDS}")
    assert len(tree["messages"]) == 1
    assert "no id" in found(result, "IMP031")[0]


@pytest.mark.parametrize(
    ("table", "expected"),
    [
        (FIELDS, BYTES),
        (FIELDS.replace("Size", "Length (bytes)").replace("Offset", "Byte"), BYTES),
        ("Offset\tSize\tName\tType\n0\t8\tMode\tU8\n8\t16\tSpeed\tU16\n24\t32\tTime\tU32\n", BYTES),
        ("Offset\tSize\tName\tType\n0\t1 byte\tMode\tU8\n1\t2 bytes\tSpeed\tU16\n3\t4 bytes\tTime\tU32\n", BYTES),
        ("Byte\tName\tType\n0\tMode\tUINT\n1-2\tSpeed\tUINT\nByte3~Byte6\tTime\tUINT\n", BYTES),
        ("Name\tType\nMode\tuint8_t\nSpeed\tuint16_t\nTime\tuint32_t\n", BYTES),
        ("Name\tSize (bytes)\tType\nMode\t1\tUINT\nSpeed\t2\tUINT\nTime\t4\tUINT\n", BYTES),
        ("Offset\tName\tType\n0\tMode\t1 byte, unsigned\n1\tSpeed\tunsigned 16 bit\n3\tTime\t4BYTE unsigned\n", BYTES),
    ],
)
def test_bits_and_bytes_are_told_apart(tmp_path, table, expected):
    result, tree = read(tmp_path, f"5 Telemetry\n\nState (0x21)\n\n{table}")
    assert places(tree["messages"][0]) == expected
    assert not [t for t in result.troubles if t.severity == "error" and t.code != "IMP032"]


def test_what_the_profile_says_of_a_heading_stands_above_what_comes_with_icdgen(tmp_path):
    table = "Offset\tSize\tName\tType\n0\t1\tA\tUINT\n1\t1\tB\tUINT\n"
    result, tree = read(tmp_path, f"5 Telemetry\n\nState (0x21)\n\n{table}")
    assert "messages" not in tree
    assert "nothing tells whether `Offset` and `Size` count bits or bytes" in found(result, "IMP036")[0]
    for words, scale in (("at_bytes: [Offset], bits_bytes: [Size]", 8), ("at: [Offset], bits: [Size]", 1)):
        _, tree = read(tmp_path, f"5 Telemetry\n\nState (0x21)\n\n{table}", f"headings: {{fields: {{{words}}}}}\n")
        assert places(tree["messages"][0]) == [(0, scale, "A"), (scale, scale, "B")]


def test_a_width_that_contradicts_its_type_is_an_error(tmp_path):
    result, _ = read(tmp_path, "5 Telemetry\n\nS (0x21)\n\nOffset (bits)\tLength (bits)\tName\tType\n0\t8\tA\tU16\n")
    assert "its type `U16` has 16 bits, its width is 8" in found(result, "IMP026")[0]


@pytest.mark.parametrize("kind", ["U1[3]", "uint8_t [3]", "U8 x 3", "3 x U8"])
def test_an_array_is_an_array(tmp_path, kind):
    table = f"Offset (bytes)\tName\tType\n0\tRate\t{kind}\n3\tTime\ts32[2]\n"
    result, tree = read(tmp_path, f"5 Telemetry\n\nState (0x21)\n\n{table}")
    assert tree["messages"][0]["length"] == 11
    assert places(tree["messages"][0]) == [(0, 8, "Rate"), (24, 32, "Time")]
    assert [one["count"] for one in tree["messages"][0]["fields"]] == [3, 2]
    assert not result.failed


def test_bits_that_a_cell_names_are_held_with_their_field(tmp_path):
    table = "Byte\tName\tType\tDescription\n0\tStatus\tU8\tbit 0-3: mode, bit 4: heater on; bits 5..7: spare\n"
    result, tree = read(tmp_path, f"5 Telemetry\n\nState (0x21)\n\n{table}")
    assert tree["messages"][0]["fields"][0]["bitfields"] == [
        {"at": 0, "bits": 4, "name": "mode"}, {"at": 4, "bits": 1, "name": "heater on"}, {"at": 5, "bits": 3, "name": "spare"},
    ]  # fmt: skip
    result, tree = read(tmp_path, f"5 Telemetry\n\nState (0x21)\n\n{table.replace('5..7', '4..9')}")
    assert "bitfields" not in tree["messages"][0]["fields"][0]
    assert "overlap, or do not fit" in found(result, "IMP040")[0]


@pytest.mark.parametrize(
    ("heading", "cell", "formula", "unit"),
    [
        ("Unit", "0.01", "raw*0.01", None),
        ("Unit", "10 mV", "raw*10", "mV"),
        ("Unit", "10mV", "raw*10", "mV"),
        ("Unit", "m/s", None, "m/s"),
        ("Unit", "1/s", None, "1/s"),
        ("Scale", "1e-7", "raw*1e-7", None),
        ("Scale", "2^-20", "raw/1048576", None),
        ("Scale", "1/256", "raw/256", None),
        ("Scale", "0.25 °C/LSB", "raw*0.25", "C"),
        ("Unit", "°C", None, "C"),
        ("Unit", "\u2103", None, "C"),
        ("Unit", "degC", None, "C"),
        ("Unit", "10 \u2126", "raw*10", "ohm"),
        ("Unit", "\u03a9", None, "ohm"),
        ("Unit", "\u00b5A", None, "uA"),
        ("Unit", "\u03bcs", None, "us"),
        ("Scale", "LSB = 0.5 dps", "raw*0.5", "dps"),
    ],
)
def test_a_factor_is_a_factor_wherever_it_stands(tmp_path, heading, cell, formula, unit):
    table = f"Offset (bits)\tLength (bits)\tName\tType\t{heading}\n0\t16\tA\tINT\t{cell}\n"
    _, tree = read(tmp_path, f"5 Telemetry\n\nState (0x21)\n\n{table}")
    field = tree["messages"][0]["fields"][0]
    assert (field.get("formula"), field.get("unit")) == (formula, unit)


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        ("0\tMode\n1-2\tSpeed\n3\tRange", [(0, 8, "Mode"), (8, 16, "Speed"), (24, 8, "Range")]),
        ("0\tMode\n1\tSpeed\n3\tRange", [(0, 8, "Mode"), (8, 16, "Speed"), (24, 8, "Range")]),
    ],
)
def test_bytes_and_what_they_mean_are_fields(tmp_path, rows, expected):
    table = f"Byte\tMeaning\n{rows}\n"
    result, tree = read(tmp_path, f"5 Telemetry\n\nState (0x21)\n\nLength: 4 bytes\n\n{table}")
    assert [(f["at"], f["bits"], f["name"]) for f in tree["messages"][0]["fields"]] == expected
    assert found(result, "IMP026")
    assert bool(found(result, "IMP038")) == ("-" not in rows)


def test_the_last_byte_without_a_length_and_what_stands_around_a_lost_one_are_not_guessed(tmp_path):
    text = "5 Telemetry\n\nState (0x21)\n\nByte\tMeaning\n0\tMode\n1\tSpeed\n3\tRange\n"
    result, tree = read(tmp_path, text)
    assert [f["name"] for f in tree["messages"][0]["fields"]] == ["Mode", "Speed"]
    assert len(found(result, "IMP023")) == 1
    result, tree = read(tmp_path, text.replace("1\tSpeed", "?\tSpeed"))
    assert any("Mode" in message and "3 bytes up to the next one" in message for message in found(result, "IMP038"))


def test_a_unit_that_is_not_built_in_is_declared_with_its_sign_in_letters(tmp_path):
    table = "Offset (bits)\tLength (bits)\tName\tType\tUnit\n0\t16\tA\tINT\tk\u03a9\n"
    _, tree = read(tmp_path, f"5 Telemetry\n\nState (0x21)\n\n{table}")
    assert tree["units"] == [{"symbol": "k\u03a9", "identifier": "kohm", "quantity": "not stated"}]


@pytest.mark.parametrize("cell", ["10^-3 T", "0.1 to 0.5", "see 3.1", "sqrt(raw)"])
def test_a_factor_that_cannot_be_read_is_said_and_not_guessed(tmp_path, cell):
    table = f"Offset (bits)\tLength (bits)\tName\tType\tScale\n0\t16\tA\tINT\t{cell}\n"
    result, tree = read(tmp_path, f"5 Telemetry\n\nState (0x21)\n\n{table}")
    assert "formula" not in tree["messages"][0]["fields"][0]
    assert found(result, "IMP040")


@pytest.mark.parametrize("length", ["8 + 6*N", "8+6*N", "4*n", "N + 1"])
def test_a_length_that_depends_on_a_count_is_one_line_of_the_report(tmp_path, length):
    text = f"Table 3: State Telemetry\n\nID\t7\nLength (bytes)\t{length}\n{FIELDS}"
    result, tree = read(tmp_path, text)
    assert "messages" not in tree
    assert "depends on a count" in found(result, "IMP037")[0]


GRID = "Address\tName\tR/W\tBit 7\tBit 6\tBit 5\tBit 4\tBit 3\tBit 2\tBit 1\tBit 0\n"
MAP = (
    GRID + "0x20\tCTRL\tR/W\todr[2:0]\t\t\tmode[1:0]\t\t-\tboot\ten\n0x27\tSTATUS\tR\tovr\tReserved\t\t\tready\t\t\t\n"
)


def test_each_row_of_a_register_map_is_a_message_with_its_bits(tmp_path):
    result, tree = read(tmp_path, f"Register map\n\n{MAP}")
    ctrl, status = tree["messages"]
    assert (ctrl["name"], ctrl["set_id"], ctrl["get_id"], ctrl["kind"], ctrl["length"]) == (
        "CTRL",
        32,
        32,
        "configuration",
        1,
    )
    assert sorted(places(ctrl)) == [(0, 1, "en"), (1, 1, "boot"), (3, 2, "mode"), (5, 3, "odr")]
    assert (status["name"], status["id"], status["kind"]) == ("STATUS", 0x27, "telemetry")
    assert sorted(places(status)) == [(0, 4, "ready"), (7, 1, "ovr")]
    assert "prints no types" in found(result, "IMP026")[0]


def test_the_bits_of_one_register_are_counted_from_its_lowest_one(tmp_path):
    table = "Bits\tName\tAccess\tReset\tDescription\n7:5\tODR\tR/W\t000\tRate\n4\tBOOT\tR/W\t0\tReboot\n3:0\tGAIN\tR/W\t0\tGain\n"
    other = "INT_STATUS (0x24)\n\nread-only\n\nBit\tName\tType\n2\tHigh\tBOOL\n1\tLow\tBOOL\n"
    text = f"CTRL1 register (0x20), R/W\n\n{table}\n{other}"
    words = 'patterns: ["{name} register ({hex}), {kind}"]\nheadings: {fields: {ignored: [Access, Reset]}}\n'
    _, tree = read(tmp_path, text, words)
    ctrl, status = tree["messages"]
    assert (ctrl["name"], ctrl["set_id"], places(ctrl)) == (
        "CTRL1",
        32,
        [(0, 4, "GAIN"), (4, 1, "BOOT"), (5, 3, "ODR")],
    )
    assert (status["id"], status["kind"], places(status)) == (0x24, "telemetry", [(1, 1, "Low"), (2, 1, "High")])
    _, tree = read(tmp_path, text, words + "node: {byte_order: big, bit_order: msb0}\n")
    assert places(tree["messages"][0]) == [(0, 3, "ODR"), (3, 1, "BOOT"), (4, 4, "GAIN")]


@pytest.mark.parametrize("head", ["Byte0\tByte1\tByte2\tByte3\tByte4", "Byte 1\tByte 2\tByte 3\tByte 4\tByte 5"])
def test_a_frame_whose_bytes_are_columns_is_a_message(tmp_path, head):
    text = f"5 Telemetry\n\n5.1 Motor State (0x21)\n\n{head}\nmode\tspeed\t\treserved\tflags\n"
    _, tree = read(tmp_path, text)
    assert places(tree["messages"][0]) == [(0, 8, "mode"), (8, 16, "speed"), (32, 8, "flags")]


def test_bytes_as_rows_and_bits_as_columns_are_a_message(tmp_path):
    rows = "Byte 0\tmode\t\t\t\tspeed high\t\t\t\nByte 1\ton\toff\t-\t-\tlevel\t\t\t\n"
    _, tree = read(tmp_path, f"5 Telemetry\n\n5.1 State (0x21)\n\nByte\t7\t6\t5\t4\t3\t2\t1\t0\n{rows}")
    assert sorted(places(tree["messages"][0])) == [
        (0, 4, "speed high"), (4, 4, "mode"), (8, 4, "level"), (14, 1, "off"), (15, 1, "on"),
    ]  # fmt: skip


NODE = "nodes: [{name: motor, match: [motor], bit_order: msb0, byte_order: big}]\n"


@pytest.mark.parametrize(
    "text",
    [f"Register map\n\n{MAP}", "CTRL (0x20), R/W\n\nBits\tName\n7:5\todr\n4:3\tmode\n1\tboot\n0\ten\n"],
    ids=["grid", "rows"],
)
def test_the_bit_order_of_a_node_is_that_of_its_registers(tmp_path, text):
    words = 'patterns: ["{name} ({hex}), {kind}"]\n'
    counted_up = [(0, 1, "en"), (1, 1, "boot"), (3, 2, "mode"), (5, 3, "odr")]
    counted_down = [(0, 3, "odr"), (3, 2, "mode"), (6, 1, "boot"), (7, 1, "en")]
    assert sorted(places(read(tmp_path, text, words)[1]["messages"][0])) == counted_up
    _, tree = read(tmp_path, text, words + NODE)
    assert tree["node"]["bit_order"] == "msb0"
    assert sorted(places(tree["messages"][0])) == counted_down
    _, tree = read(tmp_path, text, words + "node: {bit_order: msb0}\n" + NODE.replace("msb0", "lsb0"))
    assert tree["node"]["bit_order"] == "lsb0"
    assert sorted(places(tree["messages"][0])) == counted_up


def test_a_register_of_two_bytes_whose_order_is_not_stated_is_left_out(tmp_path):
    text = "CTRL (0x20), R/W\n\nBits\tName\n15:8\trate\n7:0\tgain\n"
    result, tree = read(tmp_path, text, 'patterns: ["{name} ({hex}), {kind}"]\n' + NODE.replace("msb0", "lsb0"))
    assert not tree
    assert "set `bit_order: msb0`" in next(t.help for t in result.troubles if t.code == "IMP037")


@pytest.mark.parametrize("headings", ["Byte\tName", "Byte\tName\tDescription", "Offset\tSize\tName\tType"])
def test_headings_without_rows_are_a_finding(tmp_path, headings):
    result, _ = read(tmp_path, f"5 Telemetry\n\nMotor State (0x21)\n\n{headings}\n\nnext\n")
    assert "it has headings for fields and no field" in found(result, "IMP024")[0]


def test_a_grid_without_an_id_is_not_guessed(tmp_path):
    result, tree = read(tmp_path, f"Byte0\tByte1\tByte2\tByte3\na\tb\tc\td\n\nState (0x21)\n\nTelemetry\n\n{FIELDS}")
    assert [m["name"] for m in tree["messages"]] == ["State"] or found(result, "IMP031")
    assert "it begins with `Byte0" in found(result, "IMP030")[0]


def test_a_heading_that_names_a_message_without_a_table_is_said(tmp_path):
    text = f"5 Telemetry\n\n5.1 Motor State (0x21)\n\n{FIELDS}\n6 Telecommands\n\n6.1 Halt (0x12)\n\nStops it.\n\n6.2 Notes\n"
    result, tree = read(tmp_path, text)
    assert [m["name"] for m in tree["messages"]] == ["Motor State"]
    (trouble,) = (t for t in result.troubles if t.code == "IMP039")
    assert "the heading `Halt (0x12)` names a message, and no table follows" in trouble.message and trouble.spot.line
    assert "{name: Halt, id: 18, kind: telecommand, length: 0}" in trouble.help
    last, _ = read(tmp_path, text.partition("6.2")[0])
    assert [t.message for t in last.troubles if t.code == "IMP039"] == [trouble.message]
    inner, tree = read(tmp_path, f"5 Telemetry\n\n5.1 Motor State (0x21)\n\n5.1.1 Layout\n\n{FIELDS}")
    assert not [t for t in inner.troubles if t.code == "IMP039"]


CHAPTERS = """5 Telemetry

Table {a}1: Motor State Telemetry Format

ID	33	Frame Length (bytes)	1
Offset (bits)	Length (bits)	Name	Data Type	Description
0	8	Mode	ENUM	Possible values are in Table {b}1

Table {b}1: Modes Enumeration Values

Numeric Value	Name	Description
0	Off	off
1	On	on
"""


@pytest.mark.parametrize(("a", "b"), [("5-", "6-"), ("7.5.", "7.6."), ("A", "B")])
def test_tables_numbered_by_chapter_are_one_manual_and_are_found_by_their_numbers(tmp_path, a, b):
    if a == "A":  # a number that goes on
        a, b = "", "1"
    result, tree = read(tmp_path, CHAPTERS.format(a=a, b=b))
    [message] = tree["messages"]
    assert message["fields"][0]["enum"] == "Modes"
    assert result.survey.found[0].table.title == f"table {a}1: Motor State Telemetry Format".replace(".", "-")
    assert message.get("source", {}).get("table") == (None if a else 1)  # what the ICD holds is a whole number


@pytest.mark.parametrize("start", ["", "Start of repeated block (Count times)\n"])
def test_a_repeated_block_below_the_fields_keeps_the_message_out_of_the_icd(tmp_path, start):
    block = "8 + 6*N\t1\tSystem\tU8\t\n9 + 6*N\t1\tSatellite\tU8\t\n"
    result, tree = read(
        tmp_path, f"5 Telemetry\n\nSatellites (0x21)\n\n{FIELDS}{start}\n{block}\nSlow (0x22)\n\n{FIELDS}"
    )
    assert [m["name"] for m in tree["messages"]] == (["Slow"] if start else ["Satellites", "Slow"])
    assert result.failed
    assert "8 + 6*N" in found(result, "IMP037")[0]


def test_a_row_that_begins_a_repeated_block_is_said_and_joined_to_nothing(tmp_path):
    rows = FIELDS + "Start of repeated block\t\t\t\t\n7\t1\tSystem\tU8\t\n"
    result, tree = read(tmp_path, f"5 Telemetry\n\nSatellites (0x21)\n\n{rows}")
    assert "`Start of repeated block`: a repeated block" in found(result, "IMP037")[0]
    assert tree["messages"][0]["fields"][2]["name"] == "Time"


def test_a_length_in_prose_that_depends_on_a_count_keeps_the_message_out(tmp_path):
    result, _ = read(tmp_path, f"5 Telemetry\n\nSatellites (0x21)\n\nThe length is 8 + 6*N bytes.\n\n{FIELDS}")
    assert "its length `8 + 6*N` depends on a count" in found(result, "IMP037")[0]


LINES = "Byte0~Byte1: voltage, 10 mV\nByte2~Byte3: current, 1 mA\nByte4: state\n"
FRAME = [(0, 16, "voltage", "raw*10", "mV"), (16, 16, "current", None, "mA"), (32, 8, "state", None, None)]


@pytest.mark.parametrize("text", [LINES, "Byte0~Byte1\tByte2~Byte3\tByte4\nvoltage, 10 mV\tcurrent, 1 mA\tstate\n"])
def test_a_frame_in_lines_or_in_ranges_of_bytes_is_a_message(tmp_path, text):
    _, tree = read(tmp_path, f"5 Telemetry\n\nPower (0x31)\n\n{text}")
    [message] = tree["messages"]
    assert [(f["at"], f["bits"], f["name"], f.get("formula"), f.get("unit")) for f in message["fields"]] == FRAME


@pytest.mark.parametrize("wrong", ["Byte1~Byte2", "Byte3~Byte4", "By?te2"])
def test_a_frame_in_lines_with_a_byte_missing_is_an_error(tmp_path, wrong):
    text = "5 Telemetry\n\nPower (0x31)\n\n" + LINES.replace("Byte2~Byte3", wrong) + "Byte5: more\n"
    result, tree = read(tmp_path, text)
    assert not tree
    assert "gives the id 0x31" in found(result, "IMP030")[0]
