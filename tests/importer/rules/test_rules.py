"""The effect of each key of a rule on tables of a text. Tables of every source are
treated alike.
"""

from __future__ import annotations

import pytest

from icdgen.diagnostics import Findings
from icdgen.importer import console, profile, run

NODE = "profile: 1\nnode: {byte_order: little, bit_order: lsb0, id_bits: 16}\n"
HEADING = "Motor state (0x21)\n\n"
RULE = r"""rules:
  - tables: {head: Byte | Name | Type}
    message: {before: '^{message} \({id}\)', kind: telemetry}
    columns: {Byte: byte, Name: name, Type: type}
"""


def read(
    tmp_path, text: str, rules: str = RULE, node: str = NODE
) -> tuple[run.Result, dict]:
    (tmp_path / "motor.txt").write_text(text, encoding="utf-8")
    (tmp_path / "rules.yaml").write_text(node + rules, encoding="utf-8")
    result, trees = run.run(
        tmp_path / "motor.txt", profile.load(tmp_path / "rules.yaml"), jobs=1
    )
    return result, trees.get("motor", {})


def fields(tree: dict, message: int = 0) -> list[tuple]:
    return [
        (f["at"], f.get("bits"), f["name"])
        for f in tree["messages"][message].get("fields", [])
    ]


def findings_of(result, code: str) -> list[str]:
    return [t.message for t in result.import_findings if t.code == code]


def test_rows_are_skipped_kept_filled_and_the_table_stopped(tmp_path):
    rows = "Part\tByte\tName\tType\nA\t0\tMode\tu8\n\t1\tLoad\tu8\nB\t0\tOther\tu8\nSum\t2\t\t\nEnd\t\t\t\nA\t9\tLost\tu8\n"
    rules = (
        RULE.replace("head: Byte", "head: Part | Byte")
        + "    fill: [Part]\n    keep: {Part: A}\n    skip: ^Sum\n    stop: ^End\n"
    )
    result, tree = read(tmp_path, HEADING + rows, rules)
    assert fields(tree) == [(0, 8, "Mode"), (8, 8, "Load")]
    assert "`skip` drops 1 row: `Sum | 2`" in findings_of(result, "IMP108")[0]
    assert (
        "`keep` drops 1 row: `B | 0 | Other | u8`" in findings_of(result, "IMP108")[1]
    )


def test_offset_is_added_after_scaling_and_bias_subtracted_before(tmp_path):
    rows = "Byte\tName\tType\tScale\tOffset\n0\tVoltage\tu16\t0.1\t-400\n"
    rules = RULE.replace("Type: type}", "Type: type, Scale: scale, Offset: offset}")
    assert (
        read(tmp_path, HEADING + rows, rules)[1]["messages"][0]["fields"][0]["formula"]
        == "raw*0.1 - 400"
    )
    tree = read(
        tmp_path, HEADING + rows, rules.replace("Offset: offset", "Offset: bias")
    )[1]
    assert tree["messages"][0]["fields"][0]["formula"] == "(raw + 400)*0.1"


@pytest.mark.parametrize("text", ["0.1", ".1", "1e-3", "-2", "+5"])
def test_scales_keep_the_digits_of_the_source(tmp_path, text):
    rows = f"Byte\tName\tType\tScale\n0\tVoltage\ti16\t{text}\n"
    tree = read(
        tmp_path,
        HEADING + rows,
        RULE.replace("Type: type}", "Type: type, Scale: scale}"),
    )[1]
    wanted = {".1": "0.1", "+5": "5"}.get(text, text)
    assert tree["messages"][0]["fields"][0]["formula"] == f"raw*{wanted}"


def test_an_index_completes_messages_and_contradicts_them(tmp_path):
    rows = "Byte\tName\tType\n0\tMode\tu8\nThe messages:\n"
    rows += (
        "No.\tMessage\tDir\tLength\n0x21\tMotor state\tTM\t2\n0x22\tTank state\tTM\t1\n"
    )
    rules = RULE.replace(", kind: telemetry", "") + (
        "  - what: index\n    tables: {head: No. | Message}\n"
        "    columns: {No.: id, Message: message, Dir: kind, Length: length}\n"
        "    map: {kind: {TM: telemetry}}\n"
    )
    result, tree = read(tmp_path, HEADING + rows, rules)
    assert (tree["messages"][0]["kind"], tree["messages"][0]["length"]) == (
        "telemetry",
        2,
    )
    assert findings_of(result, "IMP061") == [
        "table 2: it lists `Tank state`, and no table describes it"
    ]
    result, _ = read(
        tmp_path, HEADING + rows, rules.replace("before: '^", "length: 1, before: '^")
    )
    assert (
        "gives `Motor state` the length 2, its own table says 1"
        in findings_of(result, "IMP060")[0]
    )


def test_bits_of_a_table_divide_a_field_in_either_byte_order(tmp_path):
    rows = "Byte\tName\tType\n0\tState\tu16\n2\tLoad\tu8\nIts bits:\nBit\tMeaning\n0\tOver voltage\n1-3\tLevel\n4-15\tReserved\n"
    rules = RULE + (
        "  - what: bits\n    tables: {head: Bit | Meaning}\n    message: {of: State}\n    width: unit\n    each: {type: uint}\n"
        "    columns: {Bit: '^{bit}(?:-{last_bit})?$', Meaning: name}\n"
    )
    assert fields(read(tmp_path, HEADING + rows, rules)[1]) == [
        (0, 1, "Over voltage"),
        (1, 3, "Level"),
        (16, 8, "Load"),
    ]
    tree = read(tmp_path, HEADING + rows, rules, NODE.replace("little", "big"))[1]
    assert fields(tree) == [(8, 1, "Over voltage"), (9, 3, "Level"), (16, 8, "Load")]
    result, _ = read(tmp_path, HEADING + rows.replace("4-15\tReserved\n", ""), rules)
    assert (
        "the bits of `State` leave out or exceed its bits: 4, 5"
        in findings_of(result, "IMP105")[0]
    )


def test_a_lookup_table_gives_points(tmp_path):
    rows = "Byte\tName\tType\n0\tTemperature\tu8\nCalibration:\nCode\tDegrees\n0\t-40\n100\t20.5\n255\t125\n"
    rules = RULE + (
        "  - what: lookup\n    tables: {head: Code | Degrees}\n    message: {of: Temperature}\n"
        "    columns: {Code: value, Degrees: points}\n"
    )
    tree = read(tmp_path, HEADING + rows, rules)[1]
    assert tree["messages"][0]["fields"][0]["points"] == [
        [0, -40.0],
        [100, 20.5],
        [255, 125.0],
    ]


def test_members_stand_in_a_cell_or_in_its_lines(tmp_path):
    rows = "Byte\tName\tType\tValues\n0\tMode\tu8\t0: off; 1: slow speed; 0x10: fast\n"
    tree = read(
        tmp_path,
        HEADING + rows,
        RULE.replace("Type: type}", "Type: type, Values: members}"),
    )[1]
    assert tree["messages"][0]["fields"][0]["enum"] == "Mode"
    assert [(m["value"], m["name"]) for m in tree["enums"][0]["members"]] == [
        (0, "off"),
        (1, "slow speed"),
        (16, "fast"),
    ]


def test_members_with_commas_in_names_are_complete(tmp_path):
    rules = RULE.replace("Type: type}", "Type: type, Values: members}")
    rows = "Byte\tName\tType\tValues\n0\tMode\tu8\t0: off, 1: slow, but steady\n"
    tree = read(tmp_path, HEADING + rows, rules)[1]
    assert [(m["value"], m["name"]) for m in tree["enums"][0]["members"]] == [
        (0, "off"),
        (1, "slow, but steady"),
    ]
    result, _ = read(tmp_path, HEADING + rows.replace("0: off", "off"), rules)
    assert (
        "`members` leaves `off`" in findings_of(result, "IMP104")[0] and result.failed
    )


@pytest.mark.parametrize(
    ("text", "value"), [("0", 0), ("0x5A", 90), ("5Ah", 90), ("7", 7)]
)
def test_a_constant_is_the_one_valid_value_also_if_it_is_0(tmp_path, text, value):
    rows = f"Byte\tName\tType\tMust be\n0\tKey\tu8\t{text}\n"
    tree = read(
        tmp_path,
        HEADING + rows,
        RULE.replace("Type: type}", "Type: type, Must be: const}"),
    )[1]
    assert tree["messages"][0]["fields"][0]["const"] == value
    result, _ = read(
        tmp_path,
        HEADING + rows.replace(f"{text}\n", "key\n"),
        RULE.replace("Type: type}", "Type: type, Must be: const}"),
    )
    assert "`const` is `key`, which is not a number" in findings_of(result, "IMP023")[0]


def test_a_rule_takes_over_the_keys_of_another(tmp_path):
    rows = "Byte\tName\tType\n0\tMode\tu8\n"
    text = f"Replies\n\n{HEADING}{rows}\nCommands\n\nMotor start (0x22)\n\n{rows}"
    rules = RULE.replace("  - tables", "  - rule: reply\n    tables").replace(
        "Type}", "Type, nth: 1}"
    )
    rules += "  - {like: reply, tables: {nth: 2}, message: {kind: telecommand}}\n"
    _, tree = read(tmp_path, text, rules)
    assert all(m["fields"] for m in tree["messages"])
    assert [(m["name"], m["kind"]) for m in tree["messages"]] == [
        ("Motor state", "telemetry")
    ]
    rules = rules.replace("nth: 2", "nth: 1")
    _, tree = read(tmp_path, text, rules)
    assert [(m["name"], m["kind"]) for m in tree["messages"]] == [
        ("Motor state", "telemetry"),
        ("Motor start", "telecommand"),
    ]


def test_a_table_is_free_for_later_rules_after_one_that_says_so(tmp_path):
    rows = "Byte\tName\tType\n0\tMode\tu8\n"
    rules = RULE.replace("Type: type}\n", "Type: type}\n    also: true\n")
    rules += "  - tables: {head: Byte}\n    message: {name: Twin, id: 0x99, kind: telecommand}\n"
    rules += "    columns: {Byte: byte, Name: name, Type: type}\n"
    _, tree = read(tmp_path, HEADING + rows, rules)
    assert [m["name"] for m in tree["messages"]] == ["Motor state", "Twin"]


def test_the_summary_counts_a_table_once_that_several_rules_read(tmp_path):
    rows = "Byte\tName\tType\n0\tMode\tu8\n"
    rules = RULE.replace("Type: type}\n", "Type: type}\n    also: true\n")
    rules += "  - tables: {head: Byte}\n    message: {name: Twin, id: 0x99, kind: telecommand}\n"
    rules += "    columns: {Byte: byte, Name: name, Type: type}\n"
    result, _ = read(tmp_path, HEADING + rows, rules)
    tables, sure, _ = console.summary(result)
    assert (tables, sure) == ("1 table: 2 messages", "read: 1 certain")


def test_a_message_may_have_no_parameters(tmp_path):
    rows = "Byte\tName\tType\n\t\t\nNote\tNote\tNote\n"
    rules = RULE + "    skip: ^Note\n"
    _, tree = read(tmp_path, HEADING + rows, rules)
    assert (tree["messages"][0]["name"], tree["messages"][0]["length"]) == (
        "Motor state",
        0,
    )


@pytest.mark.parametrize(("order", "at"), [("lsb0", 4), ("msb0", 2)])
def test_the_node_alone_says_how_registers_count(tmp_path, order, at):
    rows = "Bits\tName\n7:6\tRate\n5:4\tMode\n3:0\tGain\n"
    rules = r"""rules:
  - what: registers
    tables: {head: Bits | Name}
    message: {before: '^{message} \({id}\)', kind: configuration}
    columns: {Bits: '^{last_bit}:{bit}$', Name: name}
    each: {type: uint}
"""
    _, tree = read(tmp_path, HEADING + rows, rules, NODE.replace("lsb0", order))
    assert {f["name"]: f["at"] for f in tree["messages"][0]["fields"]}["Mode"] == at
    assert all("bit_order" not in f for f in tree["messages"][0]["fields"])


@pytest.mark.parametrize(("order", "at"), [("lsb0", 4), ("msb0", 2)])
def test_the_order_may_stand_under_nodes(tmp_path, order, at):
    rules = r"""rules:
  - what: registers
    tables: {head: Bits | Name}
    message: {before: '^{message} \({id}\)', kind: configuration}
    columns: {Bits: '^{last_bit}:{bit}$', Name: name}
    each: {type: uint}
"""
    nodes = f"nodes: [{{name: motor, byte_order: big, bit_order: {order}}}]\n"
    _, tree = read(
        tmp_path,
        HEADING + "Bits\tName\n7:6\tRate\n5:4\tMode\n3:0\tGain\n",
        nodes + rules,
        NODE,
    )
    assert (tree["node"]["bit_order"], tree["node"]["byte_order"]) == (order, "big")
    assert {f["name"]: f["at"] for f in tree["messages"][0]["fields"]}["Mode"] == at
    assert all("bit_order" not in f for f in tree["messages"][0]["fields"])


def test_nodes_of_different_orders_are_refused(tmp_path):
    nodes = (
        "nodes:\n  - {name: motor, byte_order: big}\n  - {name: tank, match: [Tank]}\n"
    )
    with pytest.raises(Findings) as caught:
        read(tmp_path, HEADING, nodes + RULE)
    (finding,) = caught.value.findings
    assert (
        "different values of `byte_order`: big and little" in finding.message
        and finding.place.line == 4
    )


def test_a_register_of_two_bytes_follows_the_byte_order_of_the_node(tmp_path):
    rows = "Bits\tName\n15:12\tRate\n11:0\tCount\n"
    rules = r"""rules:
  - what: registers
    tables: {head: Bits | Name}
    message: {before: '^{message} \({id}\)', kind: configuration}
    columns: {Bits: '^{last_bit}:{bit}$', Name: name}
    each: {type: uint}
"""
    assert fields(read(tmp_path, HEADING + rows, rules)[1]) == [
        (0, 12, "Count"),
        (12, 4, "Rate"),
    ]
    _, tree = read(tmp_path, HEADING + rows, rules, NODE.replace("little", "big"))
    count = next(f for f in tree["messages"][0]["fields"] if f["name"] == "Count")
    # The value has four bits of byte 0, then all of byte 1.
    assert (count["at"], count["bit_order"]) == (
        4,
        "msb0",
    )
    rate = next(f for f in tree["messages"][0]["fields"] if f["name"] == "Rate")
    assert (rate["at"], rate.get("bit_order")) == (4, None)


def test_a_range_of_bytes_that_may_be_an_array_is_a_question(tmp_path):
    rules = RULE.replace("Byte: byte", "Byte: '^{byte}-{last_byte}$'")
    result, tree = read(
        tmp_path,
        HEADING + "Byte\tName\tType\n0-5\tCells\tuint\n6-7\tSum\tuint\n",
        rules,
    )
    assert (
        "field `Cells`: a number of 6 bytes is unusual"
        in findings_of(result, "IMP105")[0]
    )
    rules += "    set: [{where: {name: ^Cells$}, bits: 16, count: 3}]\n"
    result, tree = read(
        tmp_path,
        HEADING + "Byte\tName\tType\n0-5\tCells\tuint\n6-7\tSum\tuint\n",
        rules,
    )
    assert findings_of(result, "IMP105") == []
    assert [
        (f["at"], f["bits"], f.get("count")) for f in tree["messages"][0]["fields"]
    ] == [(0, 16, 3), (48, 16, None)]


def test_parts_of_a_field_in_several_cells_are_one_field(tmp_path):
    rows = "Byte\tName\tType\n0\tDist_L\tu8\n1\tDist_H\tu8\n2\tLevel_H\tu8\n3\tLevel_L\tu8\n"
    rules = RULE.replace("Name: name", "Name: '^{name}_{part:[LH]}$'")
    _, tree = read(tmp_path, HEADING + rows, rules)
    dist, level = tree["messages"][0]["fields"]
    assert (dist["at"], dist["bits"], dist.get("byte_order")) == (0, 16, None)
    assert (level["at"], level["bits"], level["byte_order"]) == (16, 16, "big")


def test_head_rows_under_a_common_heading_are_one_heading(tmp_path):
    (tmp_path / "tables").mkdir()
    text = (
        'table: 1\ndocument: "motor.pdf"\nbefore: ["Motor state (0x21)"]\nrows:\n'
        '  - [{text: "Position", columns: 2}, {text: "Name", rows: 2}, {text: "Type", rows: 2}]\n'
        '  - ["Byte", "Bit"]\n  - ["0", "0", "On", "u1"]\n  - ["0", "1", "Level", "u3"]\n'
    )
    (tmp_path / "tables" / "001.table.yaml").write_text(text, encoding="utf-8")
    rules = RULE.replace(
        "head: Byte | Name | Type}",
        "head: Position | '*' | Name | Type}\n    head_rows: 2".replace("'", ""),
    )
    rules = rules.replace(
        "{head: Position | * | Name | Type}", "{head: Position | Name | Type}"
    )
    rules = rules.replace("Byte: byte", "Position Byte: byte, Position Bit: bit")
    (tmp_path / "rules.yaml").write_text(NODE + rules, encoding="utf-8")
    _, trees = run.run(
        tmp_path / "tables", profile.load(tmp_path / "rules.yaml"), jobs=1
    )
    assert fields(trees["motor"]) == [(0, 1, "On"), (1, 3, "Level")]


def test_the_page_and_the_line_of_a_row_stand_in_its_finding(tmp_path):
    result, _ = read(
        tmp_path, HEADING + "Byte\tName\tType\n0\tMode\tu8\n1\tLoad\tword\n"
    )
    import_finding = next(t for t in result.import_findings if t.code == "IMP026")
    assert (import_finding.spot.line, import_finding.severity) == (5, "error")
    assert "types: {word: {type: uint, bits: 16}}" in import_finding.help
    _, tree = read(
        tmp_path,
        HEADING + "Byte\tName\tType\n1\tLoad\tword\n",
        "types: {word: {type: uint, bits: 16}}\n" + RULE,
    )
    assert fields(tree) == [(8, 16, "Load")]


def test_the_reference_describes_every_key_and_role():
    from icdgen.icd import schema
    from icdgen.importer.rules.language import ROLES
    from tests.conftest import ROOT

    page = (ROOT / "docs" / "reference" / "import-rules.md").read_text(encoding="utf-8")
    keys = {
        *schema.definition("rule")["properties"],
        *schema.definition("rule_conditions")["properties"],
        *ROLES,
    }
    keys |= {
        key.rstrip("?")
        for key in schema.definition("rule")["properties"]["message"]["properties"]
    }
    assert [key for key in sorted(keys) if f"`{key}`" not in page] == []


def test_a_rule_without_columns_reads_a_message_without_parameters(tmp_path):
    rules = r"""rules:
  - tables: {before: 'Motor'}
    message: {before: '^{message} \({id}\)', row: '^Length \| {length}$', kind: telecommand}
    ignore: [~.]
"""
    result, tree = read(tmp_path, HEADING + "Length\t0\n", rules)
    assert [t.message for t in result.import_findings if t.severity == "error"] == []
    assert (
        tree["messages"][0]["name"],
        tree["messages"][0]["length"],
        "fields" in tree["messages"][0],
    ) == (
        "Motor state",
        0,
        False,
    )
    result, _ = read(tmp_path, HEADING + "Length\t6\n", rules)
    assert (
        "it has 6 bytes and no field" in findings_of(result, "IMP034")[0]
        and result.failed
    )


def test_each_row_of_a_table_of_commands_is_a_message_without_parameters(tmp_path):
    rules = r"""rules:
  - tables: {head: Command | Code}
    message: {kind: telecommand, length: 0}
    columns: {Command: message, Code: id, Remarks: message_text}
"""
    _, tree = read(
        tmp_path,
        "Commands\nCommand\tCode\tRemarks\nStart\t0x10\tStarts it\nHalt\t0x11\t\n",
        rules,
    )
    assert [(m["name"], m["id"], m["length"]) for m in tree["messages"]] == [
        ("Start", 16, 0),
        ("Halt", 17, 0),
    ]


def test_lists_name_the_groups_of_messages_and_what_can_be_logged(tmp_path):
    text = "List of Pump Telemetry\nID\tName\tLength\nState\t\t\n33\tMotor state\t1\n34\tTank\t2\n"
    text += "Motor state (0x21)\nByte\tName\tType\n0\tMode\tu8\nLogs\nMask\tFrame\n00 02\t33\n"
    rules = (
        RULE
        + r"""  - what: list
    tables: {head: ID | Name | Length}
    message: {before: '^List of {node} Telemetry', kind: telemetry}
    columns: {ID: id, Name: message, Length: length}
    group_rows: true
  - what: loggable
    tables: {head: Mask | Frame}
    columns: {Mask: mask, Frame: id}
"""
    )
    (tmp_path / "motor.txt").write_text(text, encoding="utf-8")
    (tmp_path / "rules.yaml").write_text(NODE + rules, encoding="utf-8")
    _, trees = run.run(
        tmp_path / "motor.txt", profile.load(tmp_path / "rules.yaml"), jobs=1
    )
    (tree,) = trees.values()
    assert (tree["node"]["name"], tree["messages"][0]["group"]) == ("pump", "State")
    assert tree["loggable"] == [{"bit": 9, "id": 33}]
    assert [tank["name"] for tank in tree["missing"]] == ["Tank"]


@pytest.mark.parametrize("printed", ["–", ""])
def test_a_reserved_row_needs_no_type(tmp_path, printed):
    text = (
        f"{HEADING}Byte\tName\tType\tBits\n0\tMode\tu8\t8\n1\tReserved\t{printed}\t72\n"
    )
    result, tree = read(
        tmp_path, text, RULE.replace("Type: type", "Type: type, Bits: bits")
    )
    assert fields(tree) == [(0, 8, "Mode")] and tree["messages"][0]["length"] == 10
    assert [t.message for t in result.import_findings if t.severity == "error"] == []


@pytest.mark.parametrize("minus", ["-", "\N{MINUS SIGN}", "\N{NON-BREAKING HYPHEN}"])
def test_a_minus_sign_of_a_pattern_is_that_of_the_document(tmp_path, minus):
    text = f"{HEADING}Byte\tName\tType\tScale\n0\tHeat\tu8\t0.5 N \N{MINUS SIGN} 55\n"
    rules = RULE.replace(
        "Type: type", f"Type: type, Scale: '^{{scale}} N {{offset:{minus} ?[\\d.]+}}$'"
    )
    _, tree = read(tmp_path, text, rules)
    assert tree["messages"][0]["fields"][0]["formula"] == "raw*0.5 - 55"
