"""Positions, byte orders, roles and empty cells are read as the rule states. Anything
ambiguous is a finding.
"""

from __future__ import annotations

import pytest

from icdgen.diagnostics import Findings
from tests.importer.rules.test_rules import HEADING, RULE, fields, findings_of, read

ENDS = RULE.replace(
    "Byte: byte", r"Byte: '^{byte}\.{bit}(?:-(?:{last_byte}\.)?{end_bit})?$'"
)


def node(byte_order: str, bit_order: str) -> str:
    return f"profile: 1\nnode: {{byte_order: {byte_order}, bit_order: {bit_order}, id_bits: 16}}\n"


def placed(tree: dict) -> list[tuple]:
    fields = tree["messages"][0]["fields"]
    return [
        (f["name"], f["at"], f["bits"], f.get("byte_order"), f.get("bit_order"))
        for f in fields
    ]


@pytest.mark.parametrize("order", [("little", "lsb0"), ("big", "msb0")])
def test_a_range_from_a_bit_of_one_byte_to_a_bit_of_another_has_all_bits_between(
    tmp_path, order
):
    rows = "Byte\tName\tType\n0.0-3\tMode\tuint\n0.4-1.3\tSpeed\tuint\n1.4-3.7\tLoad\tuint\n4.2\tOn\tbool\n"
    tree = read(tmp_path, HEADING + rows, ENDS + "    width: unit\n", node(*order))[1]
    assert fields(tree) == [
        (0, 4, "Mode"),
        (4, 8, "Speed"),
        (12, 20, "Load"),
        (34, 1, "On"),
    ]


@pytest.mark.parametrize("printed", ["0.7-1.0", "0.0-1.7"])
def test_the_size_tells_how_a_range_over_big_endian_bytes_is_printed(tmp_path, printed):
    rows = f"Byte\tName\tType\n{printed}\tSpeed\tuint16\n"
    tree = read(tmp_path, HEADING + rows, ENDS, node("big", "lsb0"))[1]
    assert placed(tree) == [("Speed", 0, 16, None, None)]


def test_a_part_of_big_endian_bytes_is_read_by_significance_if_that_gives_its_size(
    tmp_path,
):
    rules = ENDS.replace("Type: type}", "Type: type, Bits: bits}").replace(
        "Byte | Name | Type", "Byte | Name | Type | Bits"
    )
    rows = "Byte\tName\tType\tBits\n0.3-1.4\tLevel\tuint\t8\n1.3-1.0\tMode\tuint\t4\n0.7-0.4\tState\tuint\t4\n"
    result, tree = read(tmp_path, HEADING + rows, rules, node("big", "lsb0"))
    # the low half of byte 0 and the high half of byte 1: bits 4 to 11 counted from the
    # most significant one
    assert ("Level", 4, 8, None, "msb0") in placed(tree)
    assert findings_of(result, "IMP035") == [] and not result.failed


@pytest.mark.parametrize("printed", ["0.4-1.3", "0.3-1.3"])
def test_a_range_that_can_be_read_in_two_ways_is_an_error(tmp_path, printed):
    rows = f"Byte\tName\tType\n{printed}\tSpeed\tuint\n"
    result, _ = read(tmp_path, HEADING + rows, ENDS, node("big", "lsb0"))
    assert (
        "to bit 3 of byte 1 is not clear" in findings_of(result, "IMP105")[0]
        and result.failed
    )


def test_a_pattern_that_takes_a_bit_of_the_last_byte_for_one_of_all_bytes_is_refused(
    tmp_path,
):
    with pytest.raises(Findings) as caught:
        read(tmp_path, HEADING, ENDS.replace("end_bit", "last_bit"))
    assert "{byte}.{bit}-{last_byte}.{end_bit}" in caught.value.findings[0].help


def test_four_columns_of_bytes_and_bits_need_the_role_of_the_bit_of_the_last_byte(
    tmp_path,
):
    rules = RULE.replace("Byte | Name | Type", "From | Bit | To").replace(
        "Byte: byte", "From: byte, Bit: bit, To: last_byte, End: last_bit"
    )
    rows = "From\tBit\tTo\tEnd\tName\tType\n0\t4\t1\t3\tSpeed\tuint\n"
    result, _ = read(tmp_path, HEADING + rows, rules)
    assert "is not clear" in findings_of(result, "IMP105")[0]
    tree = read(tmp_path, HEADING + rows, rules.replace("last_bit", "end_bit"))[1]
    assert fields(tree) == [(4, 8, "Speed")]


def test_bytes_in_a_list_are_a_range_if_they_are_consecutive(tmp_path):
    rows = "Byte\tName\tType\n0, 1\tSpeed\tuint\n2 and 3\tLoad\tuint\n4\tMode\tu8\n"
    assert fields(read(tmp_path, HEADING + rows)[1]) == [
        (0, 16, "Speed"),
        (16, 16, "Load"),
        (32, 8, "Mode"),
    ]


@pytest.mark.parametrize("printed", ["0, 2", "3 and 5", "0 & 4-5"])
def test_a_list_of_separate_places_is_padding_or_an_error(tmp_path, printed):
    rows = f"Byte\tName\tType\n{printed}\tSpeed\tuint\n"
    result, _ = read(tmp_path, HEADING + rows)
    assert (
        f"its bytes `{printed}` are not consecutive" in findings_of(result, "IMP105")[0]
        and result.failed
    )
    patterns = RULE.replace(
        "Byte: byte", "Byte: '^{byte}(?:(?:, | and | & ){last_byte})?'"
    )
    result, _ = read(tmp_path, HEADING + rows.replace("0 & 4-5", "0 & 4"), patterns)
    assert (
        "lists two places that are not consecutive" in findings_of(result, "IMP105")[0]
        and result.failed
    )


def test_padding_in_several_places_covers_them(tmp_path):
    rules = (
        RULE.replace("Byte: byte", "Byte: byte, Bits: '{bit:.+}'") + "    width: unit\n"
    )
    rows = "Byte\tBits\tName\tType\n0\t0\tOn\tbool\n0\t1, 3-5\tReserved\tuint\n0\t2\tHot\tbool\n0\t6, 7\tMode\tuint\n"
    rules = rules.replace("Byte | Name", "Byte | Bits | Name")
    result, tree = read(tmp_path, HEADING + rows, rules)
    assert fields(tree) == [(0, 1, "On"), (2, 1, "Hot"), (6, 2, "Mode")]
    assert findings_of(result, "IMP035") == [] and not result.failed


def test_a_field_in_the_other_bit_order_leaves_no_bits_uncovered(tmp_path):
    rows = "Byte\tBit\tName\tType\n0\t4-7\tMode\tuint\n0-1\t4-11\tSpeed\tuint\n1\t0-3\tState\tuint\n"
    rules = RULE.replace("head: Byte", "head: Byte | Bit").replace(
        "Byte: byte", "Byte: '^{byte}(?:-{last_byte})?$', Bit: '^{bit}-{last_bit}$'"
    )
    result, tree = read(tmp_path, HEADING + rows, rules, node("big", "lsb0"))
    assert ("Speed", 4, 8, None, "msb0") in placed(tree)
    assert findings_of(result, "IMP035") == []
    result, _ = read(
        tmp_path,
        HEADING + rows.replace("0\t4-7\tMode\tuint\n", ""),
        rules,
        node("big", "lsb0"),
    )
    assert findings_of(result, "IMP035") == ["table 1: no field covers bit 4 to 7"]
    rows = rows.replace("\tMode", "\tReserved").replace("\tSpeed", "\tReserved")
    assert (
        findings_of(
            read(tmp_path, HEADING + rows, rules, node("big", "lsb0"))[0], "IMP035"
        )
        == []
    )


def test_two_columns_of_one_role_contradict_each_other_or_are_joined(tmp_path):
    rules = RULE.replace("Type: type}", "Type: type, Signal: name}")
    rows = "Byte\tName\tType\tSignal\n0\tMode\tu8\tMode\n1\tLoad\tu8\tCurrent\n2\tHeat\tu8\tWarmth\n"
    result, _ = read(tmp_path, HEADING + rows, rules)
    (message,) = findings_of(result, "IMP102")
    assert (
        "the columns `Name` and `Signal` both give the role `name`: `Load` and `Current`"
        in message
    )
    assert "1 more row: `Heat | Warmth`" in message and result.failed
    result, tree = read(
        tmp_path, HEADING + rows, RULE.replace("Name: name", "Name + Signal: name")
    )
    assert fields(tree)[1] == (8, 8, "LoadCurrent") and not result.failed
    # Each row has a value in one of the two columns.
    rows = "Byte\tName\tType\tSignal\n0\tMode\tu8\t\n1\t\tu8\tCurrent\n"
    assert fields(read(tmp_path, HEADING + rows, rules)[1]) == [
        (0, 8, "Mode"),
        (8, 8, "Current"),
    ]


def test_a_line_of_a_cell_and_a_column_that_give_one_role_contradict_each_other(
    tmp_path,
):
    rules = RULE.replace(
        "{Byte: byte, Name: name, Type: type}", "{Name: name, Type: type}"
    )
    rules += "    lines: {Byte: '^Byte{byte}: {name}$'}\n"
    rows = "Byte\tName\tType\nByte0: Speed\tLoad\tu8\n"
    result, _ = read(tmp_path, HEADING + rows, rules)
    assert (
        "the line `Byte0: Speed` gives the role `name`"
        in findings_of(result, "IMP102")[0]
        and result.failed
    )


@pytest.mark.parametrize(
    ("stated", "rows", "lacking"),
    [
        ("", "0\tLoad\tu8\n", []),
        ("", "0\tSpeed\tu16\n", ["byte_order"]),
        ("byte_order: big", "0\tSpeed\tu16\n", []),
        ("", "0\tOn\tbool\n", ["bit_order"]),
        (
            "bit_order: msb0",
            "0\tOn\tbool\n1\tSpeed\tu16\n3\tLoad\tfloat\n",
            ["byte_order"],
        ),
    ],
)
def test_an_order_that_fields_depend_on_must_be_stated(tmp_path, stated, rows, lacking):
    words = f"profile: 1\nnode: {{id_bits: 16{', ' + stated if stated else ''}}}\n"
    result, _ = read(tmp_path, HEADING + "Byte\tName\tType\n" + rows, RULE, words)
    messages = findings_of(result, "IMP109")
    assert [
        key
        for key in ("byte_order", "bit_order")
        if any(f"`{key}`" in m for m in messages)
    ] == lacking
    assert result.failed == bool(lacking)


@pytest.mark.parametrize("dash", ["-", "–", "—", "n/a"])
def test_a_dash_is_an_empty_cell_for_roles_and_none_for_join(tmp_path, dash):
    rules = (
        RULE.replace(
            "Type: type}", "Type: type, Scale: '^{scale} {unit}$', Text: text}"
        )
        + "    join: [Text]\n"
    )
    rows = f"Byte\tName\tType\tScale\tText\n0\tLoad\tu8\t{dash}\t{dash}\n1\tHeat\tu8\t0.5 degC\tInside\n"
    result, tree = read(tmp_path, HEADING + rows, 'empty: ["n/a"]\n' + rules)
    assert fields(tree) == [(0, 8, "Load"), (8, 8, "Heat")] and not result.failed
    assert (
        "formula" not in tree["messages"][0]["fields"][0]
        and tree["messages"][0]["fields"][1]["formula"] == "raw*0.5"
    )
    assert [
        t.message for t in result.import_findings if t.code in ("IMP103", "IMP104")
    ] == []


def test_rows_that_do_not_match_a_pattern_are_one_finding(tmp_path):
    rows = "Byte\tName\tType\n" + "".join(f"No. {n}\tLoad {n}\tu8\n" for n in range(9))
    rules = RULE.replace("Byte: byte", "Byte: '^{byte}$'")
    result, _ = read(tmp_path, HEADING + rows, rules)
    (message,) = findings_of(result, "IMP103")
    assert (
        "takes `No. 0`; the same in 8 more rows: `No. 1`, `No. 2`, `No. 3`, `No. 4`, ..."
        in message
    )


def test_fields_without_a_type_are_one_finding_for_all_tables(tmp_path):
    rows = "Byte\tName\tType\n0\tLoad\t\n1\tHeat\t\n\n"
    result, _ = read(tmp_path, HEADING + rows + "Tank state (0x22)\n\n" + rows)
    (message,) = findings_of(result, "IMP026")
    assert (
        "field `Load`: its type is not stated; the same in 3 more rows of 2 tables: `Heat`"
        in message
    )
    assert {result.sure_of(table) for table in result.tables} == {"doubtful"}


def test_a_word_of_an_index_for_a_kind_must_be_translated(tmp_path):
    index = "  - what: index\n    tables: {head: Id | Message}\n    columns: {Id: id, Message: message, Dir: kind}\n"
    rows = "Byte\tName\tType\n0\tMode\tu8\nAll messages:\nId\tMessage\tDir\n0x21\tMotor state\tTM\n"
    rules = RULE.replace(", kind: telemetry", "") + index
    result, _ = read(tmp_path, HEADING + rows, rules)
    assert (
        any(
            "row of `Motor state`: its kind `TM` is none of" in m
            for m in findings_of(result, "IMP031")
        )
        and result.failed
    )
    _, tree = read(
        tmp_path, HEADING + rows, rules + "    map: {kind: {TM: telemetry}}\n"
    )
    assert tree["messages"][0]["kind"] == "telemetry"


def test_rows_of_a_list_state_the_kinds_of_their_messages(tmp_path):
    listed = "  - what: list\n    tables: {head: Id | Message}\n    columns: {Id: id, Message: message, Dir: kind}\n"
    rows = "Byte\tName\tType\n0\tMode\tu8\nAll messages:\nId\tMessage\tDir\n0x21\tMotor state\tTM\n0x21\tHalt\tTC\n"
    rules = (
        RULE.replace(", kind: telemetry", "")
        + listed
        + "    map: {kind: {TM: telemetry, TC: telecommand}}\n"
    )
    result, tree = read(tmp_path, HEADING + rows, rules)
    assert tree["messages"][0]["kind"] == "telemetry"
    assert [entry["kind"] for entry in tree["missing"]] == [
        "telecommand"
    ] and not result.failed
