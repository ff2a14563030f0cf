"""Rules are applied to the tables of a document: results, and what nothing reads."""

from __future__ import annotations

import re

import pytest

from icdgen.diagnostics import Place
from icdgen.importer import profile
from icdgen.importer.document import SourceTable
from icdgen.importer.model import ReadEnum
from icdgen.importer.rules.explain import explain
from icdgen.importer.rules.interpret import Interpretation, interpret
from icdgen.importer.rules.rule import Correction
from tests.importer.rules.small import RULES, column, pattern, rule, table
from tests.limits import assert_limits

WORDS = profile.load()
COLUMNS = [column("Byte", "byte"), column("Name", "name")]
STATE = {
    "head": "Byte | Name",
    "columns": COLUMNS,
    "each": {"type": "u8"},
    "literals": {"kind": "telemetry"},
    "sources": {"before": [pattern(r"^{message} \({id}\)$", 6)]},
}
BEFORE = "State (0x21)"


def read(*tables: SourceTable, rules, own=None) -> Interpretation:
    for number, source in enumerate(tables, 1):
        source.number = number
    return interpret(list(tables), profile.Profile(WORDS.data, own or {}, list(rules)))


def state(*rows: str, before=(BEFORE,), **keys) -> SourceTable:
    return table("Byte|Name", *rows or ("0|Mode",), before=list(before), **keys)


def shown(result: Interpretation) -> list[tuple[str, str, str]]:
    return [(f.code, f.severity, f.message) for f in result.survey.import_findings]


def messages(result: Interpretation) -> list[tuple]:
    return [
        (r.content.name, r.content.id, [f.name for f in r.content.fields])
        for r in result.survey.results
        if r.what == "message" and r.content is not None
    ]


def test_each_table_has_a_result_in_the_order_of_the_document():
    tables = [table("Pin|Use", "1|x"), state(), table("A|B", "0|1")]
    rules = [rule(**STATE), rule("pins", head="Pin | Use", what="ignore")]
    result = read(*tables, rules=rules)
    assert [r.what for r in result.survey.results] == [
        "background",
        "message",
        "not understood",
    ]
    assert messages(result) == [("State", 0x21, ["Mode"])]
    assert shown(result) == [
        ("IMP100", "warning", "no rule applies to table 3 with the headings `A | B`"),
        ("IMP108", "note", "rule `pins` ignores 1 table: `Pin | Use`"),
    ]
    assert result.attributes[2] == {
        "kind": "telemetry",
        "message": "State",
        "id": "0x21",
    }


def test_tables_without_a_rule_are_listed_by_their_headings_up_to_eight():
    def numbers(count: int) -> str:
        tables = [table("A|B", f"{n}|x") for n in range(count)]
        result = read(*tables, table("C|D"), state(), rules=[rule(**STATE)])
        (_, _, message), (_, _, other) = shown(result)
        assert message.endswith(" with the headings `A | B`")
        assert other.startswith(f"no rule applies to table {count + 1} ")
        return message.split(" to ")[1].split(" with")[0]

    assert numbers(2) == "tables 1, 2"
    assert numbers(8) == "tables 1, 2, 3, 4, 5, 6, 7, 8"
    assert numbers(9) == "tables 1, 2, 3, 4, 5, 6, 7, 8 ..."


def test_a_rule_that_reads_no_table_is_reported():
    rules = [rule(**STATE), rule("second", **STATE), rule("third", head="X")]
    result = read(state(), state(before=["B (2)"]), rules=rules)
    assert shown(result) == [
        (
            "IMP101",
            "error",
            "rule `second` applies to no table; 2 tables go to rules before it",
        ),
        ("IMP101", "error", "rule `third` applies to no table"),
    ]


def test_a_correction_that_matches_no_row_is_reported():
    where = {"name": re.compile("^Load$"), "byte": re.compile("0")}
    correction = Correction(where, {"type": "u16"}, Place(RULES, 30))
    result = read(state(), rules=[rule(**STATE, corrections=[correction])])
    text = "`set` of rule `state` matches no row: name: ^Load$, byte: 0"
    assert shown(result) == [("IMP101", "error", text)]
    assert result.survey.import_findings[0].place == Place(RULES, 30)
    # Of a rule that reads no table, only the rule is reported.
    unused = rule("x", head="X", corrections=[correction])
    assert len(shown(read(state(), rules=[rule(**STATE), unused]))) == 1


def test_the_nearest_text_gives_the_roles_and_the_rule_precedes_it():
    texts = ["A (1)", "B (2)", "prose"]
    assert messages(read(state(before=texts), rules=[rule(**STATE)]))[0][:2] == ("B", 2)
    stated = STATE | {"literals": {"kind": "telemetry", "id": "9"}}
    assert messages(read(state(before=texts), rules=[rule(**stated)]))[0][:2] == (
        "B",
        9,
    )
    by_heading = STATE | {"sources": {"heading": [pattern(r"{message} \({id}\)")]}}
    own = rule(**by_heading)
    source = state(headings=["A (1)", "B (2)"])
    assert messages(read(source, rules=[own]))[0][:2] == ("B", 2)


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        (table("ID|0x21", "Byte|Name", "0|x"), ("0x21", None)),
        # The rows above the headings are one text, behind the single rows.
        (table("ID|", "0x21|", "Byte|Name", "0|x"), (None, "0x21")),
        (table("x", "Byte|Name", "ID|0x21"), ("0x21", None)),
    ],
)
def test_rows_and_the_rows_above_the_headings_are_texts(source, expected):
    keys = {"sources": {"row": [pattern(r"^ID \| {id}$")]}, "optional": {"row"}}
    roles = read(source, rules=[rule(**STATE | keys)]).attributes[1]
    assert roles.get("id") == (expected[0] or expected[1])


def test_a_source_without_a_match_is_reported_unless_it_is_optional():
    text = (
        r"table 1: no text of `before` matches `^{message} \({id}\)$` of rule `state`"
    )
    result = read(state(before=[]), rules=[rule(**STATE)])
    assert ("IMP103", "error", text) in shown(result)
    assert result.survey.import_findings[0].place == Place(RULES, 6)
    result = read(state(before=[]), rules=[rule(**STATE, optional={"before"})])
    assert "IMP103" not in [code for code, *_ in shown(result)]
    # Another text gives all roles of the pattern.
    given = STATE | {"literals": {"id": "1", "message": "A"}}
    result = read(state(before=[]), rules=[rule(**given)])
    assert "IMP103" not in [code for code, *_ in shown(result)]


@pytest.mark.parametrize(
    ("caption", "values"),
    [
        ("State 0x21", None),
        ("State 33", None),
        ("State 34", "`0x21` in its before, `34` in its caption"),
        ("State 21h", None),
    ],
)
def test_two_sources_with_different_ids_are_reported(caption, values):
    sources = {**STATE["sources"], "caption": [pattern("^State {id}$")]}
    own = rule(**STATE | {"sources": sources})
    text = f"table 1 (`{caption}`): rule `state` reads two values of `id`: {values}"
    found = shown(read(state(caption=caption), rules=[own]))
    assert found == ([("IMP110", "error", text)] if values else [])


def test_kinds_are_compared_by_their_meanings():
    sources = {
        "before": [pattern(r"^{message} \({id}\) {kind}$")],
        "caption": [pattern("^State {kind}$")],
    }
    own = STATE | {"sources": sources, "literals": {}}
    own["map"] = {"kind": {"tm": "telemetry", "down": "telemetry", "tc": "telecommand"}}
    source = state(before=["State (1) TM"], caption="State down")
    result = read(source, rules=[rule(**own)])
    assert shown(result) == [] and result.attributes[1]["kind"] == "telemetry"
    source = state(before=["State (1) TM"], caption="State TC")
    ((code, _, message),) = shown(read(source, rules=[rule(**own)]))
    assert code == "IMP110" and message.endswith(
        "`TM` in its before, `TC` in its caption"
    )


@pytest.mark.parametrize(
    ("text", "is_reported"),
    [
        ("6.1 Motor (0x21)", True),
        ("6.1 Motor 21h", True),
        ("6.1 Motor", False),
        ("0x6 Motor (0x21)", False),
        ("6 Add", False),
    ],
)
def test_a_plain_id_beside_a_hexadecimal_number_is_a_warning(text, is_reported):
    own = STATE | {"sources": {"before": [pattern("^{id}")]}}
    own["literals"] = {"kind": "telemetry", "message": "A"}
    found = shown(read(state(before=[text]), rules=[rule(**own)]))
    number = "21h" if "21h" in text else "0x21"
    warning = (
        f"table 1: rule `state` takes the id `6`, and the same text has `{number}`"
    )
    assert found == ([("IMP104", "warning", warning)] if is_reported else [])


ROWS = STATE | {
    "head": "Msg",
    "sources": {},
    "columns": [
        column("Msg", "message"),
        column("ID", "id"),
        column("Len", "length"),
        column("Name", "name"),
    ],
}


def test_rows_of_a_table_are_messages_with_their_fields():
    source = table("Msg|ID|Len|Name", "A|1|2|x", "B|2||", "A|1|0x2|y", "|3||z")
    result = read(source, rules=[rule(**ROWS)])
    assert messages(result) == [("A", 1, ["x", "y"]), ("B", 2, []), ("", 3, ["z"])]
    assert shown(result) == []
    differing = table("Msg|ID|Len|Name", "A|1|2|x", "A|1||y", "A|1|3|z")
    text = (
        "table 1, message `A`: rule `state` reads two values of `length`: `2` and `3` in "
        "its rows"
    )
    assert shown(read(differing, rules=[rule(**ROWS)])) == [("IMP110", "error", text)]


def test_a_table_without_columns_of_roles_is_a_message_without_fields():
    keys = STATE | {"columns": [], "ignore": ["Byte", "Name"]}
    assert messages(read(state(), rules=[rule(**keys)])) == [("State", 0x21, [])]
    # Without a name and an id, it is none.
    keys["sources"] = {}
    result = read(state(), rules=[rule(**keys)])
    assert messages(result) == [] and result.parts == []


VALUES = {
    "head": "Value | Name",
    "what": "enumeration",
    "columns": [column("Value", "value"), column("Name", "member")],
    "literals": {"enumeration": "Modes"},
}


def test_rows_of_values_need_a_value_and_a_name():
    source = table("Value|Name", "0|Off", "0x1 0|On", "-|x", "2|", "a|y")
    result = read(source, rules=[rule(**VALUES)])
    (enum,) = [r.content for r in result.survey.results]
    assert isinstance(enum, ReadEnum)
    assert [(m.value, m.name) for m in enum.members] == [(0, "Off"), (0x10, "On")]
    text = "table 1: the row `{}` gives no value and name"
    assert shown(result) == [
        ("IMP023", "error", text.format(row)) for row in ("- | x", "2", "a | y")
    ]


def test_orders_on_which_fields_depend_must_be_stated():
    def findings(*sizes: str, own=None) -> list[str]:
        columns = [column("Size", "bits"), column("Name", "name")]
        keys = STATE | {"head": "Size", "columns": columns, "each": {"type": "uint"}}
        rows = [f"{size}|F{n}" for n, size in enumerate(sizes)]
        source = table("Size|Name", *rows, before=[BEFORE])
        result = read(source, rules=[rule(**keys)], own=own)
        assert {code for code, *_ in shown(result)} <= {"IMP109"}
        return [message for *_, message in shown(result)]

    byte_order = (
        "the profile does not state `byte_order`, on which {} of several bytes {}; read "
        "with `byte_order: little`"
    )
    bit_order = (
        "the profile does not state `bit_order`, on which {} of a part of a byte {}; "
        "read with `bit_order: lsb0`"
    )
    assert findings("8", "8") == []
    assert findings("8", "16") == [byte_order.format("`F1`", "depends")]
    assert findings("4", "4", "8") == [
        bit_order.format("`F0` and 1 more field", "depend")
    ]
    # A field of 8 bits over two bytes depends on both.
    assert findings("4", "8", "4") == [
        byte_order.format("`F1`", "depends"),
        bit_order.format("`F0` and 2 more fields", "depend"),
    ]
    node = {"byte_order": "little", "bit_order": "lsb0"}
    assert findings("4", "8", "4", own={"node": node}) == []


def test_ids_of_messages_without_a_table_are_reported_once():
    first = state(before=[BEFORE, "Load (0x22)", BEFORE])
    last = table("A|B", before=["Load (0x22)", "0x22", "Rest (x)"])
    last.after = ["End (35)"]
    rules = [rule(**STATE), rule("rest", head="A", what="ignore")]
    found = [f for f in shown(read(first, last, rules=rules)) if f[0] == "IMP039"]
    text = "`{}` gives the id of a message, and no table below it was read as one"
    assert found == [
        ("IMP039", "warning", text.format(line)) for line in ("Load (0x22)", "End (35)")
    ]


def test_the_explanation_of_a_table_has_rules_columns_parts_and_findings():
    rules = [
        rule("pins", head="Pin", what="ignore"),
        rule(
            **STATE
            | {"ignore": ["Note"], "columns": [*COLUMNS, column("Unit?", "unit")]}
        ),
    ]
    source = table(
        "Byte|Name|Note|Unit|Rest",
        "0|Mode|x|V|y",
        before=["older"] * 4 + [BEFORE, "long" * 40],
        caption="Motor",
        headings=["4 Motor", "4.1 State"],
    )
    result = read(table("X"), source, rules=rules)
    unread = "table 2 (`Motor`): rule `state` gives the column `Rest` no role: `y`"
    assert explain(result, 2).split("\n") == [
        "table 2 (`Motor`), line 1: 2 rows, 5 columns",
        "  caption: Motor",
        "  heading: 4 Motor",
        "  heading: 4.1 State",
        *["  before:  older"] * 3,
        f"  before:  {BEFORE}",
        f"  before:  {'long' * 30}",
        "  headings of columns: Byte | Name | Note | Unit | Rest",
        "  rule `pins` (2) does not apply: the headings differ: `Pin` is wanted as cell 1, the table has `Byte`",
        "  rule `state` (2) applies: message",
        "    1 row below the headings",
        "    column `Byte`: `byte`",
        "    column `Name`: `name`",
        "    column `Note`: ignored",
        "    column `Unit`: `unit`",
        "    column `Rest`: no role",
        "    message: kind = `telemetry`, message = `State`, id = `0x21`",
        "      bit    0 +8  uint  Mode V",
        f"  error[IMP102] (line 1): {unread}",
    ]
    first, *_, unapplied, unread = explain(result, 1).split("\n")
    assert first == "table 1, line 1: 1 row, 1 column"
    assert [unapplied, unread] == [
        "  no rule applies: the table is not imported",
        "  warning[IMP100] (line 1): no rule applies to table 1 with the headings `X`",
    ]


def test_texts_of_parts_are_shortened_in_an_explanation():
    def is_whole(length: int) -> bool:
        name = "n" * length
        source = table("Value|Name", f"0|{name}")
        text = explain(read(source, rules=[rule(**VALUES)]), 1)
        assert f"      value 0: {name[:60]}\n" in f"{text}\n"
        return name in text

    assert_limits(is_whole, most=60)


def test_the_enumeration_of_a_field_is_none_of_its_message():
    columns = [*COLUMNS, column("Values", "members"), column("Enum", "enumeration")]
    source = table(
        "Byte|Name|Values|Enum",
        "0|A|0: Off; 1: On|",
        "1|B|0: Off|Mode",
        before=[BEFORE],
    )
    result = read(source, rules=[rule(**STATE | {"columns": columns})])
    assert messages(result) == [("State", 0x21, ["A", "B"])]
    enums = [r.content for r in result.survey.results if r.what == "enumeration"]
    assert [(e.name, len(e.members)) for e in enums] == [("A", 2), ("Mode", 1)]
    assert explain(result, 1).split("\n")[-5:] == [
        "      bit    0 +8  enum  A",
        "        value 0: Off",
        "        value 1: On",
        "      bit    8 +8  enum  B",
        "        value 0: Off",
    ]
