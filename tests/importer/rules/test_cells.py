"""Patterns of a rule take roles out of cells, lines of cells and melted columns."""

from __future__ import annotations

import re

import pytest

from icdgen.diagnostics import Place
from icdgen.importer.rules.cells import RoleReader, Roles, find_columns
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.rows import read_rows
from icdgen.importer.rules.rule import Correction
from tests.importer.rules.small import RULES, column, pattern, rule, table


def roles(*rows: str, words=frozenset(), **keys) -> tuple[list[Roles], list]:
    """Return the roles of a table with a head `Byte`, and the findings."""
    keys.setdefault("head", "Byte")
    notes = Notes()
    own, source = rule(**keys), table(*rows)
    titles, data = read_rows(own, source, notes)
    empty = frozenset({"-", "n/a"})
    reader = RoleReader(own, source, titles, frozenset(words), empty, notes)
    return reader.read(data), notes.import_findings


def given(*rows: str, **keys) -> list[dict[str, str]]:
    """Return the roles of each field of a table without findings."""
    result, findings = roles(*rows, **keys)
    assert findings == []
    return [field.given for field in result]


COLUMNS = [column("Byte", "byte"), column("Name", "name")]


@pytest.mark.parametrize(
    ("key", "names"),
    [
        ("Name", ["Name"]),
        ("name?", ["Name"]),
        ("~^na", ["Name"]),
        ("~^na?", ["Name"]),
        ("~x", []),
        ("Data Type", ["Data Type"]),
        ("Data\u00a0 Type", ["Data Type"]),
        ("Type", []),
        ("Name + Data Type", ["Name", "Data Type"]),
        ("Name + Type", []),
        ("1", ["Name"]),
        ("2", ["column 2"]),
        ("3", ["Data Type"]),
        ("4", ["7"]),
        ("5", []),
        ("0", []),
        # A heading that is a number precedes the number of a column.
        ("7", ["7"]),
    ],
)
def test_a_column_is_found_by_heading_pattern_or_number(key, names):
    titles = ["Name", "", "Data Type", "7"]
    assert find_columns(column(key, "name"), titles) == names


def test_cells_give_their_roles():
    assert given("Byte|Name", "0|Mo-\nde", "1|-", "n/a|X", "|Y", columns=COLUMNS) == [
        {"byte": "0", "name": "Mo-de"},
        # A dash may be a name, but is no other role.
        {"byte": "1", "name": "-"},
        {"name": "X"},
        {"name": "Y"},
    ]
    broken = ("Byte|Name", "0|Mo-\nde")
    assert given(*broken, columns=COLUMNS, words={"Mode"})[0]["name"] == "Mode"


def test_cells_of_several_columns_are_joined():
    columns = [column("Byte + Bit", r"^{byte}\.{bit}$")]
    assert given("Byte|Bit", "3|.4", columns=columns) == [{"byte": "3", "bit": "4"}]


def test_words_are_translated_without_case():
    keys = {"map": {"type": {"word": "uint16"}, "byte": {"0": "9"}}}
    columns = [column("Byte", "byte"), column("Type", "type")]
    assert given("Byte|Type", "0|WORD", "1|Words", columns=columns, **keys) == [
        {"byte": "9", "type": "uint16"},
        {"byte": "1", "type": "Words"},
    ]


def test_descriptions_of_several_columns_are_joined():
    columns = [column(key, "text") for key in ("Byte", "A", "B")]
    assert given("Byte|A|B", "x||y", "x|y|z", columns=columns) == [
        {"text": "x; y"},
        {"text": "x; y; z"},
    ]


def test_corrections_precede_cells_and_cells_precede_each():
    notes = Notes()
    correction = Correction(
        {"name": re.compile("^mode", re.I), "type": re.compile("^$")},
        {"type": "enum", "byte": "5"},
        Place(RULES, 20),
    )
    own = rule(
        head="Byte",
        columns=[*COLUMNS, column("Type", "type")],
        each={"unit": "V", "byte": "9"},
        corrections=[correction],
    )
    source = table("Byte|Name|Type", "0|Mode|", "|Mode|u8", "2|X|")
    titles, data = read_rows(own, source, notes)
    reader = RoleReader(own, source, titles, frozenset(), frozenset(), notes)
    assert [field.given for field in reader.read(data)] == [
        {"unit": "V", "byte": "5", "name": "Mode", "type": "enum"},
        {"unit": "V", "byte": "9", "name": "Mode", "type": "u8"},
        {"unit": "V", "byte": "2", "name": "X"},
    ]
    assert notes.used_corrections == {Place(RULES, 20)}
    assert Roles({"a": "1"}, data[0]).get("a") == "1"
    assert Roles({}, data[0]).get("a") == ""


def shown(findings) -> list[tuple]:
    return [
        (f.code, f.severity, f.message, f.spot.line, f.place.line, f.help)
        for f in findings
    ]


def test_two_columns_that_give_a_role_different_texts_are_reported():
    columns = [column("Byte", "name"), column("B", "name", line=8)]
    result, findings = roles("Byte|B", "x|y", "z|z", columns=columns)
    assert shown(findings) == [
        (
            "IMP102",
            "error",
            "table 7: the columns `Byte` and `B` both give the role `name`: `x` and `y`",
            2,
            8,
            "join them by `Byte + B`, give one another role, or put it under `ignore:`",
        )
    ]
    assert [field.given for field in result] == [{"name": "y"}, {"name": "z"}]


def test_missing_columns_are_reported_unless_they_are_optional():
    columns = [*COLUMNS, column("Type", "type", line=8), column("Unit?", "unit")]
    _, findings = roles(
        "Byte|Name||Note",
        "0|x||",
        columns=columns,
        keep={"Kept": ""},
        join=["Joined"],
        ignore=["Ignored"],
    )
    shows = "its columns are `Byte`, `Name`, `Note`"
    missing = "table 7: it has no column `{}` of rule `state`"
    assert shown(findings)[0] == (
        "IMP102",
        "error",
        missing.format("Type"),
        1,
        8,
        f"{shows}; `Type?` makes it optional",
    )
    assert [(f.message, f.help, f.place.line) for f in findings[1:]] == [
        (missing.format(key), shows, 2) for key in ("Kept", "Joined")
    ]


def test_a_filled_column_without_a_role_is_reported():
    rows = ("Byte|Name|Note|Unit|Remark|Size", "0|x||m|p|8", "1|y||s|q|8")
    keys = {"ignore": ["~^rem"], "keep": {"Size": ""}}
    _, findings = roles(*rows, columns=COLUMNS, **keys)
    assert shown(findings) == [
        (
            "IMP102",
            "error",
            "table 7: rule `state` gives the column `Unit` no role: `m` and 1 more",
            1,
            2,
            "give it a role under `columns:`, or name it under `ignore:`",
        )
    ]
    single = ("Byte|Name|Unit|x", "0|x|m|", "1|y||")
    _, (finding,) = roles(*single, columns=COLUMNS)
    assert finding.message.endswith("the column `Unit` no role: `m`")
    assert roles(*single, columns=COLUMNS, ignore=["Unit"])[1] == []
    assert roles(*rows, columns=COLUMNS, ignore=["Unit", "Remark", "Size"])[1] == []


def test_a_text_that_no_pattern_takes_is_reported():
    columns = [
        column("Byte", "^{byte}$", "^{byte}-{last_byte}$"),
        column("Name?", "name"),
    ]
    result, findings = roles("Byte|Name", "0-1|x", "a|y", "2|z", columns=columns)
    assert shown(findings) == [
        (
            "IMP103",
            "error",
            "table 7, column `Byte`: no pattern of rule `state` takes `a`",
            3,
            4,
            "add a pattern for it, or drop the row with `skip`",
        )
    ]
    assert [field.given for field in result] == [
        {"byte": "0", "last_byte": "1", "name": "x"},
        {"name": "y"},
        {"byte": "2", "name": "z"},
    ]


def test_text_that_a_pattern_leaves_is_a_warning():
    result, findings = roles("Byte", "0 (hex)", columns=[column("Byte", "{byte}")])
    assert shown(findings) == [
        (
            "IMP104",
            "warning",
            "table 7, column `Byte`: a pattern of rule `state` leaves `(hex)` of `0 (hex)`",
            2,
            4,
            "let the pattern take it, for instance as `{text}`",
        )
    ]
    assert result[0].given == {"byte": "0"}


def test_a_list_that_a_pattern_takes_for_a_range_is_reported():
    columns = [column("Byte", "^{byte}.{last_byte}$")]
    result, findings = roles("Byte", "0,2", "0-2", "1,2", columns=columns)
    ((code, severity, message, line, place, _),) = shown(findings)
    assert (code, severity, line, place) == ("IMP105", "error", 2, 4)
    assert message == (
        "table 7, column `Byte`: `0,2` lists two places that are not consecutive, and a "
        "pattern of rule `state` takes it for a range"
    )
    assert [field.given.get("last_byte") for field in result] == [None, "2", "2"]


MELT = {
    "head": "Byte",
    "melt": pattern("^{bit}$", 5),
    "columns": [column("Byte", "byte"), column("*", "name")],
}


def test_each_cell_below_a_melted_heading_is_a_field_with_its_range():
    result, findings = roles("Byte|7|6|5", "3|On|Level>2", "0x10|-|x|", **MELT)
    assert findings == []
    assert [(field.given, field.byte_shift) for field in result] == [
        ({"bit": "7", "last_bit": "7", "name": "On"}, 3),
        ({"bit": "5", "last_bit": "6", "name": "Level"}, 3),
        ({"bit": "7", "last_bit": "7", "name": "-"}, 16),
        ({"bit": "6", "last_bit": "6", "name": "x"}, 16),
    ]
    (field,) = roles("Byte|0", "|x", **MELT)[0]
    assert field.byte_shift == 0


def test_melted_headings_can_number_bytes_and_ranges():
    keys = MELT | {"melt": pattern("^B{byte}(?:-{last_byte})?$", 5)}
    result, findings = roles("Byte|B0-1|B2", "5|x|y", "7|z>2|", **keys)
    assert findings == []
    assert [(field.given, field.byte_shift) for field in result] == [
        ({"byte": "0", "last_byte": "1", "name": "x"}, 5),
        ({"byte": "2", "last_byte": "2", "name": "y"}, 5),
        ({"byte": "0", "last_byte": "2", "name": "z"}, 7),
    ]


def test_a_melted_row_with_missing_cells_is_reported():
    result, findings = roles("Byte|1|0", "3|x", "4|x|y", **MELT)
    ((code, severity, message, line, place, help),) = shown(findings)
    assert (code, severity, line, place) == ("IMP103", "error", 2, 5)
    assert message.startswith("table 7: the row `3 | x` has fewer cells than there are")
    assert help == "give the cells their spans in the table file (--tables)"
    assert [field.byte_shift for field in result] == [4, 4]


def test_a_melted_cell_over_another_column_is_reported():
    keys = MELT | {"ignore": ["Note"]}
    result, findings = roles("Byte|1|0|Note", "3|x|y>2", **keys)
    ((code, _, message, line, place, _),) = shown(findings)
    assert (code, line, place) == ("IMP103", 2, 5)
    assert message == (
        "table 7: the cell `y` covers the column `Note`, whose heading `melt` does not take"
    )
    assert [field.given["name"] for field in result] == ["x"]


LINES = {
    "columns": [column("Byte", "^{byte}$"), column("Size", "bytes")],
    "lines": [
        column(
            "Data",
            r"^at {bit}$",
            r"^{value}: {member}$",
            r"^{byte}/{name}$",
            r"^\({text}\)$",
            "name",
        )
    ],
}


def test_each_line_of_a_cell_that_has_a_name_is_a_field():
    rows = ("Byte|Size|Data", "3|2|(prose)\nMode\n0: Off\n1: On\n\nLoad")
    result, findings = roles(*rows, **LINES)
    assert findings == []
    assert [(field.given, field.members) for field in result] == [
        ({"byte": "3", "name": "Mode"}, [("0", "Off"), ("1", "On")]),
        ({"byte": "3", "name": "Load"}, []),
    ]


def test_a_line_with_a_position_counts_for_the_lines_below_it():
    rows = ("Byte|Size|Data", "3||A\nat 4\nB\nC\n5/D\nE\nat 6\nF", "4||G")
    assert given(*rows, **LINES) == [
        {"byte": "3", "name": "A"},
        {"byte": "3", "bit": "4", "name": "B"},
        {"byte": "3", "bit": "4", "name": "C"},
        {"byte": "5", "name": "D"},
        {"byte": "3", "name": "E"},
        {"byte": "3", "bit": "6", "name": "F"},
        {"byte": "4", "name": "G"},
    ]


def test_a_row_without_lines_that_have_names_is_a_field_itself():
    rows = ("Byte|Size|Data", "3|2|(prose)", "4|1|0: Off")
    result, findings = roles(*rows, **LINES)
    assert findings == []
    assert [(field.given, field.members) for field in result] == [
        ({"byte": "3", "bytes": "2"}, []),
        ({"byte": "4", "bytes": "1"}, [("0", "Off")]),
    ]


def test_a_line_and_a_column_that_give_a_role_different_texts_are_reported():
    columns = [column("Byte", "byte"), column("Name", "name")]
    keys = {"columns": columns, "lines": [column("Data", "^{name}$", line=11)]}
    _, findings = roles("Byte|Name|Data", "3|X|X\nY", **keys)
    assert shown(findings) == [
        (
            "IMP102",
            "error",
            "table 7, column `Data`: the line `Y` gives the role `name`, and so does "
            "another column of the row: `X`",
            2,
            11,
            "give the other column another role, or put it under `ignore:`",
        )
    ]
