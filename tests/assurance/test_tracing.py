"""Tables of the traceability: rows of elements and of single changes."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.backends.assurance.paper import Files
from icdgen.backends.assurance.trace import Trace, merged
from icdgen.backends.assurance.tracing import (
    SymbolsByLine,
    Tracing,
    language_title,
    vector_lines,
)
from tests.icd.files import loaded

ICD = """\
enums:
  - name: Mode
    source: {table: 4}
    members:
      - {value: 0, name: Idle}
      - {value: 7, name: Run}
messages:
  - name: Status
    id: 255
    kind: telemetry
    length: 2
    source: {table: 9, page: 31}
    fields:
      - {at: 0, bits: 8, name: Mode, type: enum, enum: Mode}
      - {at: 8, bits: 8, name: Level, type: uint, unit: V, formula: raw*0.5, summary: x}
"""


@pytest.fixture(scope="module")
def traced(tmp_path_factory):
    icd = loaded(tmp_path_factory.mktemp("icd"), ICD).icd
    (node,) = icd.nodes
    tracing = Tracing(Files([node.file]), SymbolsByLine(icd))
    return tracing, node, list(Trace(icd).elements(node))


@pytest.mark.parametrize(
    ("numbers", "text"),
    [
        ([7], "demo.json 7"),
        ([7, 8], "demo.json 7-8"),
        ([1, 3, 4, 5, 9], "demo.json 1 3-5 9"),
    ],
)
def test_lines_of_vectors_are_ranges(numbers, text):
    assert vector_lines({"demo": numbers}) == [text]


def test_lines_of_several_changes_are_united_in_order():
    results = [{"a": [3, 1], "b": []}, {"a": [2, 3]}, {"c": [9]}]
    assert merged(results) == {"a": [1, 2, 3], "c": [9]}


def test_each_line_of_the_icd_is_a_row(traced):
    tracing, _, elements = traced
    rows = list(tracing.rows(elements))
    assert [row[:10] for row in rows] == [
        ["node", "demo", "", "demo", "", "", "", "demo.yaml", "2", "byte_order little, bit_order lsb0"],
        ["enumeration", "demo", "", "Mode", "", "4", "", "demo.yaml", "4", ""],
        ["member", "demo", "Mode", "Idle", "1", "4", "", "demo.yaml", "7", "value 0"],
        ["member", "demo", "Mode", "Run", "2", "4", "", "demo.yaml", "8", "value 7"],
        ["message", "demo", "", "Status", "", "9", "31", "demo.yaml", "10", "id 255, length 2"],
        ["field", "demo", "Status", "Mode", "1", "9", "31", "demo.yaml", "16", "at 0, bits 8, type enum, enum Mode"],
        ["field", "demo", "Status", "Level", "2", "9", "31", "demo.yaml", "17", "at 8, bits 8, type uint, unit V, formula raw*0.5"],
    ]  # fmt: skip
    # Each change is detected, so no row has an unnoticed one.
    assert {row[12] for row in rows} == {"0"}
    assert [len(element.changes) for element in elements] == [
        int(row[11]) for row in rows
    ]
    assert len(tracing.columns) == len(rows[0])


def test_names_of_a_line_are_listed_by_language(traced):
    tracing, _, elements = traced
    level = list(tracing.rows(elements))[-1][14:]
    by_language = dict(zip(tracing.symbols.languages, level, strict=True))
    assert by_language["c"] == [
        "level (members of demo_status_t)",
        "demo_status_level_v (C names at file scope)",
        "demo_status_set_level_v (C names at file scope)",
        "demo_status_level_mv (C names at file scope)",
        "demo_status_set_level_mv (C names at file scope)",
    ]
    assert tracing._names("python", elements[-1]) == ["level", "level_v", "level_mv"]
    assert tracing.columns[14:17] == ("C", "Python", "Rust")


def test_each_change_is_a_row_with_its_place(traced):
    tracing, _, elements = traced
    rows = list(tracing.changes(elements))
    assert [(row[0], *row[2:10]) for row in rows if row[3] != "Level"] == [
        ("enum value", "Mode", "Idle", "value", "demo.yaml", "7", "17", "0", "-1"),
        ("enum value", "Mode", "Idle", "value", "demo.yaml", "7", "17", "0", "1"),
        ("enum value", "Mode", "Run", "value", "demo.yaml", "8", "17", "7", "6"),
        ("enum value", "Mode", "Run", "value", "demo.yaml", "8", "17", "7", "8"),
        ("id", "", "Status", "id", "demo.yaml", "11", "9", "255", "254"),
        ("id", "", "Status", "id", "demo.yaml", "11", "9", "255", "256"),
        ("length", "", "Status", "length", "demo.yaml", "13", "13", "2", "1"),
        ("length", "", "Status", "length", "demo.yaml", "13", "13", "2", "3"),
        ("offset", "Status", "Mode", "at", "demo.yaml", "16", "14", "0", "1"),
        ("offset", "Status", "Mode", "at", "demo.yaml", "16", "14", "0", "8"),
        ("width", "Status", "Mode", "bits", "demo.yaml", "16", "23", "8", "7"),
        ("width", "Status", "Mode", "bits", "demo.yaml", "16", "23", "8", "9"),
    ]
    assert {row[1] for row in rows} == {"demo"} and all(row[10] for row in rows)
    assert [(row[4], row[8], row[9]) for row in rows if row[3] == "Level"] == [
        ("at", "8", "0"),
        ("at", "8", "7"),
        ("bits", "8", "7"),
        ("type", "uint", "int"),
        ("formula", "raw*0.5", "raw*0.4"),
        ("formula", "raw*0.5", "raw*0.6"),
        ("formula", "raw*0.5", "raw*5.0"),
        ("formula", "raw*0.5", "raw*0.05"),
        ("formula", "raw*0.5", "-raw*0.5"),
        ("formula", "raw*0.5", "raw*0.5 + 1"),
    ]


def test_a_page_has_a_group_for_each_object_with_its_source(traced):
    tracing, node, elements = traced
    page = tracing.page(node, elements, (("Digest", "abc"),))
    assert (page.file, page.title) == ("trace-demo.html", "Trace: Demo")
    assert [(group.title, group.notes, len(group.rows)) for group in page.groups] == [
        ("Demo", (), 1),
        ("Mode", ("enumeration, Table 4 of the manual",), 3),
        ("Status", ("telemetry, Table 9 of the manual, page 31",), 3),
    ]
    assert (page.facts, page.data) == (
        (("Digest", "abc"),),
        ("trace.csv", "changes.csv"),
    )
    row = page.groups[1].rows[0]
    assert (row[0], row[1], row[3], row[-3:]) == (
        "",
        ["Mode"],
        "demo.yaml:4",
        ["", "", []],
    )
    for group in page.groups:
        assert {len(row) for row in group.rows} == {len(page.columns)}


def test_a_row_of_a_page_names_its_errata(traced):
    tracing, _, elements = traced
    errata = (SimpleNamespace(label="Erratum", id="DEM-001"),)
    element = SimpleNamespace(
        errata=errata,
        row=None,
        name="Level",
        source=elements[-1].source,
        model=elements[-1].model,
        changes=(
            SimpleNamespace(detected={}),
            SimpleNamespace(detected={"demo": [1]}),
        ),
        detected={"demo": [1]},
    )
    row = tracing._shown(element)
    assert row[1] == ["Level", "Erratum DEM-001"]
    assert row[-3:] == ["2", "1", ["demo.json 1"]]


def test_a_plug_in_is_named_by_its_value_on_the_command_line():
    assert language_title("rust") == "Rust"
    assert language_title("fortran") == "fortran"
