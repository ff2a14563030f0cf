"""Nothing that a table and its rule state is lost or changed without a finding."""

from __future__ import annotations

import pytest

from tests.importer.rules.test_rules import HEADING, NODE, RULE, fields, found, read

BIG = NODE.replace("little", "big")


def test_a_meaning_of_map_is_not_a_word_of_map(tmp_path):
    rules = RULE.replace("Byte: byte", "Byte: byte, Bit: bit") + (
        '    width: unit\n    map: {bit: {"7": "0", "6": "1", "0": "7"}}\n'
    )
    rows = "Byte\tName\tType\tBit\n0\tReady\tbool\t7\n0\tHot\tbool\t6\n0\tOn\tbool\t0\n"
    assert fields(read(tmp_path, HEADING + rows, rules)[1]) == [(0, 1, "Ready"), (1, 1, "Hot"), (7, 1, "On")]


def test_map_translates_the_bits_of_melted_columns_once(tmp_path):
    rules = r"""rules:
  - tables: {head: Byte | D7 | D0}
    message: {before: '^{message} \({id}\)', kind: telemetry}
    columns: {Byte: byte, "*": name}
    melt: '^D{bit}$'
    each: {type: bool}
    map: {bit: {"7": "0", "0": "7"}, last_bit: {"7": "0", "0": "7"}}
"""
    tree = read(tmp_path, HEADING + "Byte\tD7\tD0\n0\tReady\tOn\n", rules)[1]
    assert fields(tree) == [(0, 1, "Ready"), (7, 1, "On")]


@pytest.mark.parametrize(
    ("printed", "unit"),
    [("mA/(rpm·s)", "mA/(rpm·s)"), ("(V)", "V"), ("(V/(m·s))", "V/(m·s)"), ("(N)·(m)", "(N)·(m)"), ("[V]", "V")],
)
def test_a_unit_keeps_its_parentheses(tmp_path, printed, unit):
    rows = f"Byte\tName\tType\tUnit\n0\tGain\tu16\t{printed}\n"
    tree = read(tmp_path, HEADING + rows, RULE.replace("Type: type}", "Type: type, Unit: unit}"))[1]
    assert tree["messages"][0]["fields"][0]["unit"] == unit


def test_descriptions_from_two_columns_are_joined(tmp_path):
    rows = "Byte\tName\tType\tMeaning\tNote\n0\tGain\tu16\tOf the loop\tRead at start\n2\tLoad\tu8\t\tIn steps\n"
    rules = RULE.replace("Type: type}", "Type: type, Meaning: text, Note: text}")
    result, _ = read(tmp_path, HEADING + rows, rules)
    (message,) = [found.thing for found in result.survey.found if found.what == "message"]
    assert [field.described.rest for field in message.fields] == ["Of the loop; Read at start", "In steps"]


def test_reserved_rows_at_the_end_are_reserved_bytes_of_the_message(tmp_path):
    rows = "Byte\tName\tType\n0\tMode\tu8\n1\tReserved\tu8\n2\tLoad\tu8\n3\tReserved\tu16\n5\tReserved\tu8\n"
    assert read(tmp_path, HEADING + rows, RULE)[1]["messages"][0]["reserved"] == 3
    result, tree = read(tmp_path, HEADING + rows, RULE.replace("kind:", "length: 8, kind:"))
    assert "reserved" not in tree["messages"][0]  # nothing in the table describes bytes 6 and 7
    assert "no field covers bit 48 to 63" in found(result, "IMP035")[0]
    tree = read(tmp_path, HEADING + "Byte\tName\tType\n0\tReserved\tu8\n1\tMode\tu8\n", RULE)[1]
    assert "reserved" not in tree["messages"][0]


def test_a_field_of_a_repeated_group_has_the_enumeration_that_its_description_names(tmp_path):
    rules = RULE.replace("Type: type}", "Type: type, Text: text}") + (
        "    each: {group: Cells, count: 4}\n"
        "  - {what: enumeration, tables: {head: Value | Member}, message: {caption: '{enumeration:[A-Z][a-z]+$}'},\n"
        "     columns: {Value: value, Member: member}}\n"
    )
    rows = "Byte\tName\tType\tText\n0\tState\tenum8\tsee Table 2\n\nTable 2: Modes\n\nValue\tMember\n0\toff\n1\ton\n"
    words = NODE + 'phrases: {enumeration: ["see {table}"]}\ntypes: {enum8: {type: enum, bits: 8}}\n'
    result, tree = read(tmp_path, HEADING + rows, rules, words)
    assert tree["structs"][0]["fields"][0].get("enum") == "Modes", [t.message for t in result.troubles]
