"""Manuals as text with tab-separated tables, and the typical defects of such texts."""

from __future__ import annotations

from pathlib import Path

import pytest

from icdgen.diagnostics import Findings
from tests.importer.conftest import imported

MESSAGE = """\
Table 7: Pump State Telemetry Format

ID\t140\tFrame Length (bytes)\t\t\t4
Description\tState of the pump
Channels\tOffset (bits)\tLength (bits)\tName\tData Type\tDescription
\t0\t16\tPressure\tINT\tPressure. Formatted value is obtained using the formula: (formatted value) [kPa] = RAWVAL*0.1
\t16\t8\tMode\tENUM\tMode. Possible values are in Table 8: PumpMode Enumeration Values
\t24\t1\tValve Open\tBOOL\tValve open
"""
TITLES = "Channels\tOffset (bits)\tLength (bits)\tName\tData Type\tDescription"
ENUM = """
Table 8: PumpMode Enumeration Values

Numeric Value\tName\tDescription
0\tOff\tOff
1\tRunning\tRunning
"""


PUMP = Path(__file__).with_name("pump.yaml")
LISTED = """  - rule: frames
    what: list
    tables: {caption: '^List of .*Telemetry Frames$', head: ID | Name}
    message: {caption: '^List of (?:{node} )?Telemetry Frames$', kind: telemetry}
    columns: {ID: id, Name: message, Description: message_text, Length (bytes): length}
    group_rows: true
"""


def read(tmp_path, text: str, rules: str = ""):
    """Return the result of an import by the rules of the pump and ``rules``."""
    path = tmp_path / "pump.txt"
    path.write_text(text, encoding="utf-8")
    profile = PUMP.read_text(encoding="utf-8").replace("phrases:", f"{rules}phrases:")
    (tmp_path / "rules.yaml").write_text(profile, encoding="utf-8")
    result, trees = imported(path, tmp_path / "rules.yaml")
    return result, trees["pump"]


def fields(tree) -> list[tuple]:
    return [
        (f["at"], f["bits"], f["name"], f["type"])
        for f in tree["messages"][0]["fields"]
    ]


WHOLE = [
    (0, 16, "Pressure", "int"),
    (16, 8, "Mode", "enum"),
    (24, 1, "Valve Open", "bool"),
]


def test_a_message_and_its_enumeration_are_read(tmp_path):
    _, tree = read(tmp_path, MESSAGE + ENUM)
    message = tree["messages"][0]
    assert (message["name"], message["id"], message["kind"], message["length"]) == (
        "Pump State",
        140,
        "telemetry",
        4,
    )
    assert fields(tree) == WHOLE
    assert message["fields"][0] | {} == {
        "at": 0,
        "bits": 16,
        "name": "Pressure",
        "type": "int",
        "unit": "kPa",
        "formula": "raw*0.1",
    }
    assert tree["enums"][0]["members"] == [
        {"value": 0, "name": "Off"},
        {"value": 1, "name": "Running"},
    ]


@pytest.mark.parametrize(
    ("what", "torn"),
    [
        ("a blank line", MESSAGE.replace("\t16\t8", "\n\t16\t8")),
        ("what a converter puts below the first row of a page", MESSAGE.replace("\t24\t1", "----" + 5 * "\t----" + "\n\t24\t1")),
        ("a lost first cell", MESSAGE.replace("\t24\t1", "24\t1")),
        ("a repeated heading row", MESSAGE.replace("\t24\t1", f"\n{TITLES}\n\t24\t1")),
        ("a formula torn before its factor", MESSAGE.replace("= RAWVAL*0.1", "=\n\n\t\t\t\t\tRAWVAL*0.1")),
        ("a rest that is repeated", MESSAGE.replace("\t24\t1", "\n\t\t\t\t\tTable 8: PumpMode Enumeration Values\n\t24\t1")),
        ("headings in two lines", MESSAGE.replace(
            "Channels\tOffset (bits)\tLength (bits)\tName\tData Type\tDescription",
            "Channels\tOffset\tLength\tName\tData\tDescription\n\t(bits)\t(bits)\t\tType")),
        ("a caption with a blank before its colon", MESSAGE.replace("Table 7:", "Table 7 :")),
        ("a code listing before it", "```\nTable 7: x\tID 9\n```\n" + MESSAGE),
        ("text that begins like a caption", MESSAGE + "\nTable 9: Valve Telemetry Format and the like are not explained.\n"),
    ],
)  # fmt: skip
def test_typical_defects_of_the_text_are_repaired(tmp_path, what, torn):
    assert torn != MESSAGE
    _, tree = read(tmp_path, torn + ENUM)
    assert len(tree["messages"]) == 1
    assert fields(tree) == WHOLE
    assert tree["messages"][0]["fields"][0]["formula"] == "raw*0.1"
    assert tree["messages"][0]["fields"][1]["enum"] == "PumpMode"
    assert (tree["messages"][0]["id"], tree["messages"][0]["length"]) == (140, 4)


def findings_of(result, code: str) -> list[str]:
    return [t.message for t in result.import_findings if t.code == code]


def test_unreadable_content_is_reported(tmp_path):
    text = (
        MESSAGE.replace("\t16\t8\t", "\tl6\t8\t")
        .replace("RAWVAL*0.1", "RAWVAL**2")
        .replace("BOOL", "WORD")
        + ENUM
    )
    result, tree = read(tmp_path, text)
    assert fields(tree) == [(0, 16, "Pressure", "int")]
    assert "formula" not in tree["messages"][0]["fields"][0]
    assert (
        "field `Mode`: `bit` is `l6`, which is not a number"
        in findings_of(result, "IMP023")[0]
    )
    assert "a formula is there and cannot be read" in findings_of(result, "IMP040")[0]
    assert "the type `WORD` is unknown" in findings_of(result, "IMP026")[0]
    assert "no field covers bit 16 to 31" in findings_of(result, "IMP035")[0]
    assert result.failed


def test_a_reference_to_a_table_that_is_not_there_is_reported(tmp_path):
    result, tree = read(tmp_path, MESSAGE)
    assert "points to table 8, which is not there" in findings_of(result, "IMP050")[0]
    assert tree["messages"][0]["fields"][1]["type"] == "uint"


def test_number_and_title_that_point_to_different_tables_are_reported(tmp_path):
    other = ENUM.replace("8:", "9:").replace("PumpMode", "ValveMode")
    result, tree = read(
        tmp_path, MESSAGE.replace("Table 8:", "Table 9:") + ENUM + other
    )
    assert (
        "points to table 9 by number and to table 8" in findings_of(result, "IMP051")[0]
    )
    assert tree["messages"][0]["fields"][1]["enum"] == "PumpMode"


def test_a_text_that_contradicts_its_formula_stays_and_is_reported(tmp_path):
    text = (
        MESSAGE.replace(
            "Formatted value is obtained", "Raw parameter value is obtained"
        )
        + ENUM
    )
    result, tree = read(tmp_path, text)
    assert tree["messages"][0]["fields"][0]["formula_for"] == "raw"
    assert (
        "`Pressure` is announced as giving the raw value"
        in findings_of(result, "IMP041")[0]
    )


RAW = MESSAGE.replace(
    "Formatted value is obtained", "Raw parameter value is obtained"
).replace(
    "\t24\t1\tValve Open\tBOOL\tValve open\n",
    "\t24\t8\tLevel\tUINT\tLevel. Raw parameter value is obtained using the formula: (formatted value) [%] = RAWVAL*0.5\n",
)


def test_a_text_that_contradicts_every_formula_of_a_kind_is_stored_once(tmp_path):
    _, tree = read(tmp_path, RAW + ENUM)
    assert tree["formula_for"] == {"telemetry": "raw"}
    assert [
        field["formula"]
        for field in tree["messages"][0]["fields"]
        if "formula" in field
    ] == ["raw*0.1", "raw*0.5"]
    assert not [
        field for field in tree["messages"][0]["fields"] if "formula_for" in field
    ]


LIST = """\
Table 1: List of Telemetry Frames

ID\tName\tDescription\tLength (bytes)
General\t\t\t
140\tPump State\tState - Table 7: Pump State Telemetry Format\t6
141\tTank State\tState - Table 9: Tank State Telemetry Format\t2

"""


def test_lists_and_details_that_disagree_are_reported(tmp_path):
    result, tree = read(tmp_path, LIST + MESSAGE + ENUM, LISTED)
    assert tree["messages"][0]["listed"] == {"length": 6}
    assert tree["messages"][0]["group"] == "General"
    assert (
        "its length is `4`, the list (table 1) says `6`"
        in findings_of(result, "IMP060")[0]
    )
    assert tree["missing"][0]["id"] == 141
    assert "`Tank State` is listed" in findings_of(result, "IMP061")[0]


def test_a_table_without_a_rule_is_named(tmp_path):
    result, _ = read(
        tmp_path, "Table 3: Colours\n\nShade\tHue\nred\t1\n\n" + MESSAGE + ENUM
    )
    assert findings_of(result, "IMP100") == [
        "no rule applies to table 1 with the headings `Shade | Hue`"
    ]


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "the file is empty"),
        (b"nothing but prose\n", "the document has no table"),
        (b"ID\t1\n\xff\xfe\n", "not UTF-8"),
        (b"PK\x03\x04 a zip archive", "icdgen does not read this kind of document"),
    ],
)
def test_a_text_without_anything_to_import_is_a_finding(tmp_path, data, message):
    (tmp_path / "pump.txt").write_bytes(data)
    with pytest.raises(Findings) as error:
        imported(tmp_path / "pump.txt", PUMP)
    assert message in error.value.findings[0].message


def test_a_field_that_names_no_table_has_no_enumeration(tmp_path):
    tables = MESSAGE.replace(
        " Possible values are in Table 8: PumpMode Enumeration Values", ""
    )
    result, tree = read(tmp_path, tables + ENUM)
    assert "field `Mode`: its values are not given" in findings_of(result, "IMP050")[0]
    assert tree["messages"][0]["fields"][1]["type"] == "uint"


def test_a_cell_that_the_source_leaves_out_is_put_back_only_where_the_rule_says_so(
    tmp_path,
):
    text = MESSAGE.replace("\t24\t1", "24\t1") + ENUM
    assert fields(read(tmp_path, text)[1]) == WHOLE
    without = PUMP.read_text(encoding="utf-8").replace("    absent: [Channels]\n", "")
    (tmp_path / "rules.yaml").write_text(without, encoding="utf-8")
    result, trees = imported(tmp_path / "pump.txt", tmp_path / "rules.yaml")
    assert result.failed and fields(trees["pump"]) == WHOLE[:2]


def test_headings_in_two_rows_are_found_without_a_key_for_them(tmp_path):
    text = (
        MESSAGE.replace(
            TITLES,
            "Channels\tOffset\tLength\tName\tData\tDescription\n\t(bits)\t(bits)\t\tType\t",
        )
        + ENUM
    )
    result, tree = read(tmp_path, text)
    assert fields(tree) == WHOLE and not result.failed
