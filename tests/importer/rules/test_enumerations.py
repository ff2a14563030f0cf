"""Fields get exactly the enumeration that their table names."""

from __future__ import annotations

import pytest

from tests.importer.rules.test_rules import findings_of, read

COMMAND = """Table 1: Command data

Byte\tName\tType\tMeaning
0\tAction\tuint8\t{action}
1\tMode\tuint8\t{mode}

"""
VALUES = """Table 2: Switch action and charge mode

Enumeration\tValue\tName
Switch action\t0\tOff
\t1\tOn
Charge mode\t2\tSlow
\t3\tFast
"""
RULES = r"""rules:
  - tables: {head: Byte | Name | Type | Meaning}
    message: {name: Command, id: 1, kind: telecommand}
    columns: {Byte: byte, Name: name, Type: type, Meaning: PATTERN}
  - tables: {head: Enumeration | Value | Name}
    what: enumeration
    columns: {Enumeration: enumeration, Value: value, Name: member}
    fill: [Enumeration]
"""


def enumerations(tree) -> dict[str, list[str]]:
    return {
        enum["name"]: [member["name"] for member in enum["members"]]
        for enum in tree.get("enums", [])
    }


def test_a_table_with_a_column_of_names_gives_several_enumerations(tmp_path):
    text = COMMAND.format(action="Switch action", mode="Charge mode") + VALUES
    result, tree = read(tmp_path, text, RULES.replace("PATTERN", "enumeration"))
    assert enumerations(tree) == {
        "Switch action": ["Off", "On"],
        "Charge mode": ["Slow", "Fast"],
    }
    assert [field["enum"] for field in tree["messages"][0]["fields"]] == [
        "Switch action",
        "Charge mode",
    ]
    assert not [
        finding for finding in result.import_findings if finding.severity == "error"
    ]


@pytest.mark.parametrize("name", ["Switch action and charge mode", "Switch action and"])
def test_the_caption_of_a_table_of_several_enumerations_names_none_of_them(
    tmp_path, name
):
    text = COMMAND.format(action=name, mode="Charge mode") + VALUES
    result, tree = read(tmp_path, text, RULES.replace("PATTERN", "enumeration"))
    assert findings_of(result, "IMP050") == [
        f"table 1 (`Command data`), field `Action`: there is no enumeration `{name}`"
    ]
    assert [field["type"] for field in tree["messages"][0]["fields"]] == [
        "uint",
        "enum",
    ] and result.failed


def test_the_number_of_a_table_of_several_enumerations_does_not_choose_one(tmp_path):
    text = (
        COMMAND.format(action="Coded as in Table 2", mode="Coded as in Table 2")
        + VALUES
    )
    phrases = "phrases:\n  enumeration: ['Coded as in {table}']\n"
    rules = RULES.replace("PATTERN}", "text}\n    each: {bits: 8}")
    result, _ = read(tmp_path, text.replace("uint8", "enum"), phrases + rules)
    assert (
        "which has 2 enumerations: `Switch action` and `Charge mode`"
        in findings_of(result, "IMP050")[0]
    )


def test_a_title_that_begins_two_enumerations_names_neither(tmp_path):
    values = VALUES.replace("Switch action and charge mode", "Switch").replace(
        "Charge mode", "Switch mode"
    )
    text = COMMAND.format(action="Switch", mode="Switch mode") + values
    result, _ = read(tmp_path, text, RULES.replace("PATTERN", "enumeration"))
    assert len(findings_of(result, "IMP050")) == 1 and result.failed


def test_the_fields_of_bits_have_enumerations_and_these_the_source_of_their_table(
    tmp_path,
):
    text = "Table 1: Command data\n\nByte\tName\tType\n0\tSetup\tuint8\n\n"
    text += "Table 2: Bits of Setup\n\nBits\tName\tMeaning\n0-3\tAction\tSwitch action\n4-7\tState\t0 = idle, 1 = busy\n\n"
    text += VALUES.replace("Table 2", "Table 3")
    rules = RULES.replace(" | Meaning", "").replace(", Meaning: PATTERN", "")
    rules += r"""  - tables: {head: Bits | Name | Meaning}
    what: bits
    message: {of: Setup}
    columns: {Bits: '^{bit}-{last_bit}$', Name: name, Meaning: ['^{members:0 = .*}$', enumeration]}
    each: {type: uint}
    width: unit
"""
    result, tree = read(tmp_path, text, rules)
    assert [(f["name"], f.get("enum")) for f in tree["messages"][0]["fields"]] == [
        ("Action", "Switch action"),
        ("State", "State"),
    ]
    sources = {enum["name"]: enum["source"]["table"] for enum in tree["enums"]}
    assert sources["State"] == 2 and sources["Switch action"] == 3
    assert not [
        finding for finding in result.import_findings if finding.severity == "error"
    ]


def test_each_of_several_tables_of_values_belongs_to_the_message_above_it(tmp_path):
    text = "".join(
        f"{name} ({id})\n\nByte\tName\tType\n0\tMode\tuint8\n\n"
        f"Values:\n\nValue\tMeaning\n{values}\n"
        for id, (name, values) in enumerate(
            {
                "Pump": "0\tOff\n1\tOn\n",
                "Valve": "2\tClosed\n3\tOpen\n",
                "Heater": "4\tCold\n5\tWarm\n",
            }.items(),
            start=1,
        )
    )
    rules = r"""rules:
  - tables: {head: Byte | Name | Type}
    message: {before: '^{message} \({id}\)', kind: telemetry}
    columns: {Byte: byte, Name: name, Type: type}
  - tables: {head: Value | Meaning}
    what: enumeration
    message: {of: Mode}
    columns: {Value: value, Meaning: member}
"""
    _, tree = read(tmp_path, text, rules)
    members = enumerations(tree)
    assert {
        message["name"]: members[message["fields"][0]["enum"]]
        for message in tree["messages"]
    } == {
        "Pump": ["Off", "On"],
        "Valve": ["Closed", "Open"],
        "Heater": ["Cold", "Warm"],
    }
