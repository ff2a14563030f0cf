"""Texts that users type for a field: the complete messages, and the texts that two
readings fit.
"""

from __future__ import annotations

import pytest

from icdgen.loading import load
from icdgen.values.entry import parse_raw, parse_value, without_unit
from icdgen.values.errors import BadValue
from icdgen.values.find import find_message
from tests.icd.files import write

ICD = """\
enums:
  - name: Switch
    members:
      - {value: 0, name: "Off"}
      - {value: 1, name: "2"}
      - {value: 2, name: Auto reset, aliases: [again]}
      - {value: 4, to: 6, name: Spare}
      - {value: 8, name: Level 9}
messages:
  - name: Status
    id: 130
    kind: telemetry
    length: 23
    fields:
      - {at: 0,  bits: 8,  name: Mode,  type: enum, enum: Switch}
      - {at: 8,  bits: 8,  name: Flag,  type: bool}
      - {at: 16, bits: 8,  name: Level, type: uint, unit: m, max: 200,
         special: [{value: 255, meaning: Alarm}, {value: 0, meaning: "7"}]}
      - {at: 24, bits: 16, name: Speed, type: int, unit: deg/s, formula: raw/2}
      - {at: 40, bits: 32, name: Ratio, type: float, unit: "%", max: 5, special: [{value: -1, meaning: none}]}
      - {at: 72, bits: 24, name: Label, type: text}
      - {at: 96, bits: 16, name: Key,   type: bytes}
      - {at: 0,  bits: 16, name: Both,  type: uint, view: true}
      - {at: 112, bits: 8, name: Plain, type: uint}
"""

MEMBERS = "; members: 0 Off, 1 2, 2 Auto reset, 4 to 6 Spare, 8 Level 9"
TRUTH = "is neither true nor false (nor yes, no, on, off, 1, 0)"


@pytest.fixture(scope="module")
def fields(tmp_path_factory):
    loaded = load([write(tmp_path_factory.mktemp("entry"), ICD)], check=False)
    assert loaded.findings == []
    message = find_message(loaded.icd, "demo", "status")
    return {each.name: each for each in loaded.icd.longest_frame(message)}


@pytest.mark.parametrize(
    ("name", "text", "value", "raw"),
    [
        ("Mode", "off", 0, 0),
        ("Mode", "AUTO", 2, 2),
        ("Mode", "reset auto", 2, 2),
        ("Mode", "again", 2, 2),
        ("Mode", "0x2", 2, 2),
        ("Mode", "1", 1, 1),
        ("Mode", "5", 5, 5),
        ("Mode", "77", 77, 77),
        ("Mode", "9", 9, 9),
        ("Flag", "ON", 1, 1),
        ("Flag", "yes", 1, 1),
        ("Flag", "True", 1, 1),
        ("Flag", "1", 1, 1),
        ("Flag", "no", 0, 0),
        ("Flag", "off", 0, 0),
        ("Flag", "FALSE", 0, 0),
        ("Flag", "0", 0, 0),
        ("Level", "alarm", 255, None),
        ("Level", "7", 0, 7),
        ("Level", "0b11 m", 3, None),
        ("Level", "12m", 12, None),
        ("Level", "0x10", 16, 16),
        ("Speed", "1.5deg/s", 3, None),
        ("Speed", "-3", -6, -3),
        ("Speed", "0.25", 0, None),
        ("Speed", "0.75", 2, None),
        ("Ratio", "NONE", 0xBF800000, None),
        ("Ratio", "1 %", 0x3F800000, 0x3F800000),
        ("Ratio", "-0", 0x80000000, 0x80000000),
        ("Label", "ab", b"ab\0", None),
        ("Key", "01 fe", b"\x01\xfe", b"\x01\xfe"),
    ],
)
def test_a_text_is_a_value_or_with_raw_the_raw_value(fields, name, text, value, raw):
    field = fields[name]
    assert parse_value(field, text) == value
    if raw is not None:
        assert parse_raw(field, text) == parse_value(field, text, raw=True) == raw


@pytest.mark.parametrize(
    ("name", "text", "is_raw", "message", "help"),
    [
        ("Mode", "2", False, f"`2` fits several members{MEMBERS}", ""),
        ("Mode", "spare", False, f"`spare` is 4 to 6: give the number{MEMBERS}", ""),
        ("Mode", "auto off", False, f"`auto off` is no member of Switch{MEMBERS}", ""),
        ("Mode", "", False, f"`` is no member of Switch{MEMBERS}", ""),
        ("Flag", "2", False, f"`2` {TRUTH}", ""),
        ("Level", "x", False, "`x` is not a number (in m)", ""),
        ("Level", "x", True, "`x` is not a whole number", ""),
        ("Level", "3/2", False, "3/2 is not a whole number", ""),
        ("Level", "alarm", True, "`alarm` is not a whole number", ""),
        ("Level", "12 m", True, "`12 m` is not a whole number", ""),
        ("Plain", "x", False, "`x` is not a number", ""),
        ("Speed", "1.5", True, "`1.5` is not a whole number", ""),
        ("Speed", "0x10", False, "`0x10` is not a number (in deg/s)", ""),
        ("Ratio", "1e99", False, "takes at most 5 %, not 1e99", ""),
        ("Ratio", "-1e99", False, "-1e99 is beyond what a 32-bit float can represent", ""),
        ("Ratio", "1e99", True, "1e99 is beyond what a 32-bit float can represent", ""),
        ("Ratio", "0X1", False, "`0X1` is not a number; the bits of a float can be given with --raw", ""),
        ("Ratio", "none", True, "`none` is not a number", ""),
        ("Label", "abcd", False, "`abcd` is not of up to 3 ASCII characters", ""),
        ("Label", "\xe9", False, "`\xe9` is not of up to 3 ASCII characters", ""),
        ("Key", "01", False, "2 bytes are needed, 1 given", ""),
        ("Key", "010203", True, "2 bytes are needed, 3 given", ""),
        ("Both", "1", False, "an overlay field has no bits of its own", "set the fields that have them"),
        ("Both", "1", True, "an overlay field has no bits of its own", "set the fields that have them"),
    ],
)  # fmt: skip
def test_a_text_that_is_no_value_is_refused(fields, name, text, is_raw, message, help):
    with pytest.raises(BadValue) as caught:
        parse_value(fields[name], text, raw=is_raw)
    assert (str(caught.value), caught.value.help) == (message, help)


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("12 m", "12"),
        ("12m", "12"),
        ("12  m", "12"),
        ("12 M", "12 M"),
        ("m", "m"),
        ("Alarm", "Alarm"),
        ("1. m", "1. m"),
        ("12", "12"),
    ],
)
def test_a_unit_is_removed_behind_a_digit(fields, text, number):
    assert without_unit(fields["Level"], text) == number
    assert without_unit(fields["Plain"], text) == text
