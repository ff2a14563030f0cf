"""Every mistake in a profile is reported with its place; none gives a wrong result
without a finding.
"""

from __future__ import annotations

import pytest

from icdgen.diagnostics import Findings
from icdgen.importer import profile
from tests.importer.rules.test_rules import NODE, findings_of, read

TABLE = """4.1 Basic state (STATE) ID:0x02F4

Num\tParameter\tPosition\tLength\tRange\tFactor\tOffset\tUnit
1\tVoltage\t0\t16\t0~1000\t0.1\t0\tV
2\tCurrent\t16\t16\t-400~400\t0.1\t-400\tA
3\tLevel\t32\t8\t0~100\t1\t0\t%
"""
RULES = r"""rules:
  - rule: state
    tables: {head: Num | Parameter | Position}
    message: {heading: '\({message:\w+}\) ID:{id}$', kind: telemetry}
    columns:
      Parameter: name
      Position: bit
      Length: bits
      Range: '^{min}~{max}$'
      Factor: scale
      Offset: offset
      Unit: unit
    each: {type: uint}
    ignore: [Num]
"""


def test_the_profile_without_a_mistake_has_no_finding(tmp_path):
    result, tree = read(tmp_path, TABLE, RULES)
    assert [t.message for t in result.import_findings if t.severity != "note"] == []
    assert [(f["at"], f["name"]) for f in tree["messages"][0]["fields"]] == [
        (0, "Voltage"),
        (16, "Current"),
        (32, "Level"),
    ]


@pytest.mark.parametrize(
    ("right", "wrong", "line", "message"),
    [
        ("    ignore: [Num]", "    ignores: [Num]", 16, "unknown key `ignores`"),
        (
            "Offset: offset",
            "Offset: ofset",
            13,
            "`ofset` is neither a role nor a pattern with a role: did you mean the role `offset`?",
        ),
        (
            "{min}~{max}",
            "{mini}~{max}",
            11,
            "unknown role `mini` in the pattern `^{mini}~{max}$`: did you mean `{min}`?",
        ),
        ("'^{min}~{max}$'", "'^({min}~{max}$'", 11, "is not a regular expression"),
        (
            "'^{min}~{max}$'",
            r"'^\d+~\d+$'",
            11,
            "is neither a role nor a pattern with a role",
        ),
        (
            "each: {type: uint}",
            "each: {typ: uint}",
            15,
            "unknown role `typ`: did you mean `type`?",
        ),
        ("kind: telemetry", "kind: telemtry", 6, "`telemtry` is not a kind of message"),
        (
            "  - rule: state",
            "  - rule: state\n    like: stat",
            5,
            "there is no rule `stat` before this one",
        ),
        (
            "  - rule: state",
            "  - rule: state\n    what: messages",
            5,
            "`what` cannot be the text 'messages'",
        ),
        (
            "head: Num | Parameter",
            "head: Num | ~Para(meter",
            5,
            "`Para(meter` is not a regular expression",
        ),
        (
            "    ignore: [Num]",
            "    ignore: [Num]\n    skip: '('",
            17,
            "`(` is not a regular expression",
        ),
        (
            "    ignore: [Num]",
            "    melt: '^D{bit}$'",
            16,
            "`melt` needs the pattern of the cells",
        ),
        (
            "      Unit: unit",
            "      '*': name",
            14,
            "`*` stands for the cells of melted columns, but the rule has no `melt`",
        ),
        (
            "  - rule: state",
            "  - rule: state\n    what: enumeration",
            4,
            "the rule does not say to which field the enumeration belongs",
        ),
        (
            "'^{min}~{max}$'",
            "'^{min}~{min}$'",
            11,
            "each role may stand once in a pattern",
        ),
    ],
)
def test_a_mistake_in_the_profile_is_found_before_anything_is_read(
    tmp_path, right, wrong, line, message
):
    assert RULES.count(right) == 1
    (tmp_path / "rules.yaml").write_text(
        NODE + RULES.replace(right, wrong), encoding="utf-8"
    )
    with pytest.raises(Findings) as caught:
        profile.load(tmp_path / "rules.yaml")
    assert any(
        message in f"{f.message}: {f.help}"
        and (f.code, f.place.line) == ("IMP001", line)
        for f in caught.value.findings
    ), [(f.message, f.help, f.place.line) for f in caught.value.findings]


@pytest.mark.parametrize(
    ("right", "wrong", "code", "message"),
    [
        ("Factor: scale", "Scale: scale", "IMP102", "it has no column `Scale` of rule `state`"),
        ("Num | Parameter", "Num | Parametr", "IMP101", "rule `state` applies to no table"),
        ("rules:\n", "rules:\n  - {rule: all, tables: {head: '~.'}, what: ignore}\n", "IMP101", "1 tables go to rules before it"),
        ("Position: bit", "Position: byte", "IMP035", "no field covers bit 16 to 127"),
        ("Length: bits", "Length: bytes", "IMP105", "a number has at most 64 bits, this one 128"),
        ("Offset: offset", "Offset: bias", "IMP106", "its range has the min -400, its raw values give 40.0 to 6593.5"),
        ("      Offset: offset\n", "", "IMP102", "rule `state` gives the column `Offset` no role: `0` and 2 more"),
        ("    ignore: [Num]", "    ignore: [Num]\n    origin: 1", "IMP105", "begins before the message"),
        ("    ignore: [Num]", "    ignore: [Num]\n    skip: Current", "IMP035", "no field covers bit 16 to 31"),
        ("    ignore: [Num]", "    ignore: [Num]\n    set: [{where: {unit: ^furlong$}, type: int}]", "IMP101", "matches no row"),
        ("ID:{id}$", "ID:{id:F4}$", "IMP103", "no text of `heading` matches"),
        (r"'\({message:\w+}\) ID:{id}$'", r"'^{id:\d+}.* \({message:\w+}\)'", "IMP104", "the same text has `0x02F4`"),
        ("    each: {type: uint}\n", "", "IMP026", "its type is not stated"),
        ("Length: bits", "Length: text", "IMP105", "its size is not given"),
        ("Parameter: name", "Parameter: text", "IMP025", "gives no name"),
        ("'^{min}~{max}$'", "'^{min}'", "IMP104", "leaves `~1000` of `0~1000`"),
        (", kind: telemetry", "", "IMP031", "its rule gives no kind"),
        (" ID:{id}$'", "'", "IMP031", "its rule gives no id"),
        ("Parameter: name", "Parameter: '^{name:Volt}'", "IMP103", "no pattern of rule `state` takes `Current`"),
    ],
)  # fmt: skip
def test_a_mistake_that_shows_in_the_result_is_a_finding(
    tmp_path, right, wrong, code, message
):
    assert RULES.count(right) == 1
    result, _ = read(tmp_path, TABLE, RULES.replace(right, wrong))
    assert any(message in text for text in findings_of(result, code)), [
        (t.code, t.message) for t in result.import_findings
    ]
    if code not in ("IMP035", "IMP104", "IMP106"):
        assert result.failed


@pytest.mark.parametrize(
    ("node", "message"),
    [
        ("{byteorder: big}", "unknown key `byteorder`"),
        ("{byte_order: middle}", "`byte_order` cannot be the text 'middle'"),
        ("{id_bits: 900}", "`id_bits` must be at most 32, not 900"),
    ],
)
def test_a_mistake_in_the_facts_of_the_node_is_a_finding(tmp_path, node, message):
    path = tmp_path / "rules.yaml"
    for text in (f"node: {node}\n", f"nodes: [{{name: a, {node[1:-1]}}}]\n"):
        path.write_text(f"profile: 1\n{text}{RULES}")
        with pytest.raises(Findings) as raised:
            profile.load(path)
        assert [finding.message for finding in raised.value.findings] == [message]


def test_every_finding_about_a_rule_names_its_line(tmp_path):
    result, _ = read(tmp_path, TABLE, RULES.replace("Factor: scale", "Scale: scale"))
    import_finding = next(
        t
        for t in result.import_findings
        if t.code == "IMP102" and "no column" in t.message
    )
    assert (import_finding.place.line, import_finding.place.column) == (12, 7)
    assert "its columns are `Num`, `Parameter`" in import_finding.help


CAPTION = "Table 3: Basic state, id 0x02F4, 5 bytes\n\nNum"


@pytest.mark.parametrize(
    ("caption", "messages"),
    [
        (CAPTION, []),
        (CAPTION.replace("0x02F4", "756"), []),
        (
            CAPTION.replace("0x02F4", "0x02F5"),
            ["`0x02F5` in its caption, `0x02F4` in its heading"],
        ),
    ],
)
def test_caption_and_heading_with_different_ids_are_reported(
    tmp_path, caption, messages
):
    rules = RULES.replace(
        "{heading:", "{caption: ', id {id}, {length} bytes$', heading:"
    )
    result, _ = read(tmp_path, TABLE.replace("Num", caption, 1), rules)
    reported = findings_of(result, "IMP110")
    assert [
        text.rsplit("`id`: ")[-1] for text in reported
    ] == messages and result.failed == bool(messages)


@pytest.mark.parametrize(
    ("second", "values"),
    [
        ("TM\t2", []),
        ("HK\t0x02", []),
        ("TC\t2", ["`telemetry` and `telecommand`"]),
        ("TM\t3", ["`2` and `3`"]),
    ],
)
def test_rows_that_give_a_message_two_kinds_or_lengths_are_reported(
    tmp_path, second, values
):
    rules = r"""rules:
  - tables: {head: Id | Message | Kind | Length}
    columns: {Id: id, Message: message, Kind: kind, Length: length, Field: name, Type: type}
    map: {kind: {TM: telemetry, TC: telecommand, HK: telemetry}}
"""
    table = f"""1 Messages

Id\tMessage\tKind\tLength\tField\tType
5\tState\tTM\t2\tMode\tuint8
5\tState\t{second}\tFault\tuint8
"""
    result, _ = read(tmp_path, table, rules)
    assert [
        text.rsplit(": ")[-1].removesuffix(" in its rows")
        for text in findings_of(result, "IMP110")
    ] == values
