"""Every statement of a table and its rule is in the result, or there is a finding."""

from __future__ import annotations

import pytest

from icdgen.diagnostics import Findings
from tests.importer.rules.test_rules import (
    HEADING,
    NODE,
    RULE,
    fields,
    findings_of,
    read,
)

BIG = NODE.replace("little", "big")


def test_a_meaning_of_map_is_not_a_word_of_map(tmp_path):
    rules = RULE.replace("Byte: byte", "Byte: byte, Bit: bit") + (
        '    width: unit\n    map: {bit: {"7": "0", "6": "1", "0": "7"}}\n'
    )
    rows = "Byte\tName\tType\tBit\n0\tReady\tbool\t7\n0\tHot\tbool\t6\n0\tOn\tbool\t0\n"
    assert fields(read(tmp_path, HEADING + rows, rules)[1]) == [
        (0, 1, "Ready"),
        (1, 1, "Hot"),
        (7, 1, "On"),
    ]


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
    [
        ("mA/(rpm·s)", "mA/(rpm·s)"),
        ("(V)", "V"),
        ("(V/(m·s))", "V/(m·s)"),
        ("(N)·(m)", "(N)·(m)"),
        ("[V]", "V"),
    ],
)
def test_a_unit_keeps_its_parentheses(tmp_path, printed, unit):
    rows = f"Byte\tName\tType\tUnit\n0\tGain\tu16\t{printed}\n"
    tree = read(
        tmp_path, HEADING + rows, RULE.replace("Type: type}", "Type: type, Unit: unit}")
    )[1]
    assert tree["messages"][0]["fields"][0]["unit"] == unit


def test_descriptions_from_two_columns_are_joined(tmp_path):
    rows = "Byte\tName\tType\tMeaning\tNote\n0\tGain\tu16\tOf the loop\tRead at start\n2\tLoad\tu8\t\tIn steps\n"
    rules = RULE.replace("Type: type}", "Type: type, Meaning: text, Note: text}")
    result, _ = read(tmp_path, HEADING + rows, rules)
    (message,) = [
        entry.content for entry in result.survey.results if entry.what == "message"
    ]
    assert [field.described.prose for field in message.fields] == [
        "Of the loop; Read at start",
        "In steps",
    ]


def test_reserved_rows_at_the_end_are_reserved_bytes_of_the_message(tmp_path):
    rows = "Byte\tName\tType\n0\tMode\tu8\n1\tReserved\tu8\n2\tLoad\tu8\n3\tReserved\tu16\n5\tReserved\tu8\n"
    assert read(tmp_path, HEADING + rows, RULE)[1]["messages"][0]["reserved"] == 3
    result, tree = read(
        tmp_path, HEADING + rows, RULE.replace("kind:", "length: 8, kind:")
    )
    # No row of the table describes bytes 6 and 7.
    assert "reserved" not in tree["messages"][0]
    assert "no field covers bit 48 to 63" in findings_of(result, "IMP035")[0]
    tree = read(
        tmp_path, HEADING + "Byte\tName\tType\n0\tReserved\tu8\n1\tMode\tu8\n", RULE
    )[1]
    assert "reserved" not in tree["messages"][0]


def test_a_field_of_a_repeated_group_has_the_enumeration_that_its_description_names(
    tmp_path,
):
    rules = RULE.replace("Type: type}", "Type: type, Text: text}") + (
        "    each: {group: Cells, count: 4}\n"
        "  - {what: enumeration, tables: {head: Value | Member}, message: {caption: '{enumeration:[A-Z][a-z]+$}'},\n"
        "     columns: {Value: value, Member: member}}\n"
    )
    rows = "Byte\tName\tType\tText\n0\tState\tenum8\tsee Table 2\n\nTable 2: Modes\n\nValue\tMember\n0\toff\n1\ton\n"
    words = (
        NODE
        + 'phrases: {enumeration: ["see {table}"]}\ntypes: {enum8: {type: enum, bits: 8}}\n'
    )
    result, tree = read(tmp_path, HEADING + rows, rules, words)
    assert tree["structs"][0]["fields"][0].get("enum") == "Modes", [
        t.message for t in result.import_findings
    ]


@pytest.mark.parametrize(
    ("what", "right", "wrong", "role", "kinds"),
    [
        (
            "bits",
            "Flag: name",
            "Flag: length",
            "length",
            "`what: message`, `registers`, `index`, `list`",
        ),
        (
            "bits",
            "{of: State}",
            "{of: State, kind: telemetry}",
            "kind",
            "`what: message`, `registers`, `index`, `list`",
        ),
        ("bits", "each: {", "each: {mask: FF, ", "mask", "`what: loggable`"),
        (
            "bits",
            "width: unit",
            "set: [{where: {name: .}, id: 2}]",
            "id",
            "`what: message`, `registers`, `index`, `list`",
        ),
        (
            "lookup",
            "Flag: name",
            "Flag: points",
            "bit",
            "`what: message`, `registers`, `loggable`, `bits`",
        ),
    ],
)
def test_a_role_that_this_kind_of_rule_does_not_use_is_an_error(
    tmp_path, what, right, wrong, role, kinds
):
    rules = (
        "rules:\n  - tables: {head: Bit | Flag}\n    message: {of: State}\n    columns: {Bit: bit, Flag: name}\n"
        "    each: {type: bool}\n    width: unit\n"
    )
    assert rules.count(right) == 1
    rules = rules.replace("  - tables", f"  - what: {what}\n    tables").replace(
        right, wrong
    )
    with pytest.raises(Findings) as caught:
        read(tmp_path, HEADING, rules)
    finding = next(
        f
        for f in caught.value.findings
        if f"`what: {what}` does not use the role `{role}`" in f.message
    )
    assert kinds in finding.help and finding.place.line > 2


def test_a_column_names_the_enumeration_of_a_field(tmp_path):
    rules = RULE.replace("Type: type}", "Type: type, Values: enumeration}") + (
        "  - {what: enumeration, tables: {head: Value | Member}, message: {enumeration: Modes},\n"
        "     columns: {Value: value, Member: member}}\n"
    )
    rows = "Byte\tName\tType\tValues\n0\tState\tu8\tModes\n\nModes\n\nValue\tMember\n0\toff\n1\ton\n"
    field = read(tmp_path, HEADING + rows, rules)[1]["messages"][0]["fields"][0]
    assert (field["type"], field.get("enum")) == ("enum", "Modes")
    result, _ = read(tmp_path, HEADING + rows.replace("u8\tModes", "u8\tStates"), rules)
    assert (
        "there is no enumeration `States`" in findings_of(result, "IMP050")[0]
        and result.failed
    )
    result, _ = read(
        tmp_path, HEADING + rows.replace("u8\tModes", "float\tModes"), rules
    )
    assert (
        "a field of the type float cannot have the enumeration `Modes`"
        in findings_of(result, "IMP050")[0]
    )


BITS = """  - what: bits
    tables: {head: Bit | Flag}
    message: {of: State}
    columns: {Bit: bit, Flag: name}
    width: unit
    each: {type: bool}
"""
TWO_MESSAGES = "".join(
    f"Motor {name} (0x2{id})\n\nByte\tName\tType\n0\tLoad\tu8\n{id}\tState\tu8\n\n"
    for id, name in ((1, "A"), (2, "B"))
)
FLAGS = "Its bits:\n\nBit\tFlag\n7\tReady\n0\tOn\n"


@pytest.mark.parametrize(
    ("chosen", "divided"),
    [("", "AB"), (", name: Motor A", "A"), (", name: Motor B", "B")],
)
def test_bits_divide_the_field_in_all_messages_or_in_the_one_that_the_rule_names(
    tmp_path, chosen, divided
):
    _, tree = read(
        tmp_path,
        TWO_MESSAGES + FLAGS,
        RULE + BITS.replace("of: State", "of: State" + chosen),
    )
    for message, at in zip(tree["messages"], (8, 16), strict=True):
        is_divided = message["name"][-1] in divided
        own = (
            [(at, 1, "On"), (at + 7, 1, "Ready")] if is_divided else [(at, 8, "State")]
        )
        assert fields({"messages": [message]}) == [(0, 8, "Load"), *own]


def test_bits_of_a_message_that_does_not_exist_are_an_error(tmp_path):
    result, _ = read(
        tmp_path,
        TWO_MESSAGES + FLAGS,
        RULE + BITS.replace("of: State", "of: State, name: Motor C"),
    )
    assert (
        "there is no field `State` in a message `Motor C`"
        in findings_of(result, "IMP107")[0]
        and result.failed
    )


def test_bits_divide_a_field_of_a_repeated_group_within_the_group(tmp_path):
    rows = "Motor (0x21)\n\nByte\tName\tType\n0\tState\tu8\n\n"
    _, tree = read(
        tmp_path, rows + FLAGS, RULE + "    each: {group: Cell, count: 4}\n" + BITS
    )
    assert [(f["at"], f["name"]) for f in tree["structs"][0]["fields"]] == [
        (0, "On"),
        (7, "Ready"),
    ]
    assert [(f["at"], f["count"]) for f in tree["messages"][0]["fields"]] == [(0, 4)]


RANGES = r"""rules:
  - tables: {head: Byte | Bits | Name | Type}
    message: {before: '^{message} \({id}\)', kind: telemetry}
    columns: {Byte: '^{byte}(?:-{last_byte})?$', Bits: '^{bit}(?:-{last_bit})?$', Name: name, Type: type}
"""


@pytest.mark.parametrize(
    ("byte_order", "bit_order", "mode", "count"),
    [
        (
            "big",
            "lsb0",
            (52, 4, None),
            (52, 12, "msb0"),
        ),  # bits 7 to 4 of byte 6; the rest and byte 7
        ("little", "lsb0", (60, 4, None), (48, 12, None)),
        (
            "big",
            "msb0",
            (60, 4, None),
            (48, 12, None),
        ),  # bit 0 is the most significant bit of byte 6
    ],
)
def test_bits_in_a_range_of_bytes_count_in_its_value(
    tmp_path, byte_order, bit_order, mode, count
):
    rows = "Byte\tBits\tName\tType\n6-7\t15-12\tMode\tuint\n6-7\t11-0\tCount\tuint\n"
    node = NODE.replace("little", byte_order).replace("lsb0", bit_order)
    _, tree = read(tmp_path, HEADING + rows, RANGES, node)
    places = {
        f["name"]: (f["at"], f["bits"], f.get("bit_order"))
        for f in tree["messages"][0]["fields"]
    }
    assert places == {"Mode": mode, "Count": count}


def test_a_single_bit_in_a_range_of_bytes_is_one_bit(tmp_path):
    rows = "Byte\tBits\tName\tType\n0-1\t15\tReady\tbool\n0-1\t0\tOn\tbool\n"
    assert fields(
        read(tmp_path, HEADING + rows, RANGES + "    width: unit\n", BIG)[1]
    ) == [
        (7, 1, "Ready"),
        (8, 1, "On"),
    ]


@pytest.mark.parametrize(
    ("row", "bit_order", "help"),
    [
        (
            "6\t15-12",
            "lsb0",
            "state all bytes in which the bits are numbered: the roles `byte` and `last_byte`",
        ),
        ("6-7\t19-16", "lsb0", "bits are numbered from 0 to 15 in these bytes"),
        ("6-7\t19-16", "msb0", "bits are numbered from 0 to 15 in these bytes"),
    ],
)
def test_a_bit_that_its_bytes_do_not_have_is_an_error(tmp_path, row, bit_order, help):
    rows = f"Byte\tBits\tName\tType\n{row}\tMode\tuint\n"
    result, _ = read(tmp_path, HEADING + rows, RANGES, BIG.replace("lsb0", bit_order))
    (import_finding,) = [t for t in result.import_findings if t.code == "IMP105"]
    assert (
        "the place of bit" in import_finding.message
        and help in import_finding.help
        and result.failed
    )


def test_bits_in_several_bytes_need_an_order_that_a_value_can_have(tmp_path):
    rows = "Byte\tBits\tName\tType\n6-7\t15-12\tMode\tuint\n"
    result, _ = read(tmp_path, HEADING + rows, RANGES, NODE.replace("lsb0", "msb0"))
    assert (
        "the place of bit 15 in bytes 6 to 7 is not clear"
        in findings_of(result, "IMP105")[0]
    )


def test_the_repeated_group_of_the_reference_is_read(tmp_path):
    rules = (
        "rules:\n  - tables: {head: Byte | Name}\n    message: {before: '^{message} \\({id}\\)', kind: telemetry}\n"
        "    columns: {Byte: '^{byte}(?:-{last_byte})?$', Name: name}\n    each: {type: uint}\n    width: unit\n"
        "    set: [{where: {name: ^Cell}, group: Cells, stride: 3, counter: Number, up_to: 8}]\n"
    )
    rows = "Byte\tName\n0\tNumber\n1-2\tCell voltage\n3\tCell state\n"
    result, tree = read(tmp_path, HEADING + rows, rules)
    assert [(f["at"], f["bits"], f["name"]) for f in tree["structs"][0]["fields"]] == [
        (0, 16, "Cell voltage"),
        (16, 8, "Cell state"),
    ]
    cells = tree["messages"][0]["fields"][1]
    assert (cells["at"], cells["count"], cells["up_to"]) == (
        8,
        "Number",
        8,
    ) and not result.failed


def test_a_preceding_pattern_matches_the_dash_of_an_empty_cell(tmp_path):
    rows = "Byte\tName\tType\tScale\n0\tMode\tu8\t–\n1\tLoad\tu8\t0.5\n"
    rules = RULE.replace(
        "Type: type}", "Type: type, Scale: ['^{default:[-–—]}$', scale]}"
    )
    result, tree = read(tmp_path, HEADING + rows, rules)
    assert [f.get("formula") for f in tree["messages"][0]["fields"]] == [
        None,
        "raw*0.5",
    ] and not result.failed
