"""Changes of errata and notes: kind, words, old and new text, and places."""

from __future__ import annotations

import pytest

from icdgen.diff.changes.errata import _PARTS, _kind, _plain
from icdgen.icd.erratum import Erratum
from tests.diff.cases import compared_texts, rows_of

STATUS = """\
messages:
  - name: Status
    id: 130
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 16, name: Voltage, type: uint, unit: mV}
# errata/demo.yaml
errata: 1
node: demo
"""
ERRATUM = """\
  - id: D-001
    title: Wrong unit
    where: {message: Status, field: Voltage}
    tables: [3]
    printed: {unit: mV}
    held: {unit: V}
    why: Too small.
    evidence: Table 98.
    confidence: certain
"""
NOTE = """\
  - id: D-002
    title: Late
    where: {message: Status}
    what: It comes late.
    evidence: Measured.
"""
BOTH = f"{STATUS}entries:\n{ERRATUM}notes:\n{NOTE}"
NOTES = f"{STATUS}entries: []\nnotes:\n{NOTE}"
HELD = "holds unit: V"


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            STATUS + "entries: []\n", BOTH,
            [
                ("DIF403", "note", f"erratum D-001 is new ({HELD}): Wrong unit",
                 "", "Wrong unit", None, "D-001"),
                ("DIF403", "note", "note D-002 is new: Late", "", "Late", None, "D-002"),
            ],
        ),
        (
            BOTH, NOTES,
            [("DIF404", "note", f"erratum D-001 is gone ({HELD}): Wrong unit",
              "Wrong unit", "", "D-001", None)],
        ),
        (
            BOTH, BOTH.replace("held: {unit: V}", "held: {unit: kV}"),
            [("DIF405", "note", "erratum D-001 says otherwise (held): Wrong unit",
              "holds unit: V", "holds unit: kV", "D-001", "D-001")],
        ),
        (
            BOTH, BOTH.replace("Table 98", "Table 99").replace("certain", "likely"),
            [("DIF405", "note",
              "erratum D-001 says otherwise (evidence and confidence): Wrong unit",
              "Table 98.", "Table 99.", "D-001", "D-001")],
        ),
        (
            BOTH, BOTH.replace("Wrong unit", "Unit").replace("[3]", "[4]"),
            [("DIF405", "note", "erratum D-001 says otherwise (title and tables): Unit",
              "Wrong unit", "Unit", "D-001", "D-001")],
        ),
        (
            BOTH, BOTH.replace("comes late", "is late"),
            [("DIF405", "note", "note D-002 says otherwise (why): Late",
              "It comes late.", "It is late.", "D-002", "D-002")],
        ),
        (BOTH, BOTH, []),
    ],
)  # fmt: skip
def test_another_decision_is_reported_with_its_texts_and_places(
    tmp_path, old, new, expected
):
    comparison = compared_texts(tmp_path, old, new, is_checked=False)
    codes = ("DIF403", "DIF404", "DIF405")
    assert rows_of(comparison, *codes) == expected
    wheres = [c.where for c in comparison.changes if c.code in codes]
    assert [(where.node, where.erratum) for where in wheres] == [
        ("demo", "D-001" if "D-001" in row[2] else "D-002") for row in expected
    ]


def erratum(**values) -> Erratum:
    words = {"id": "D-001", "title": "T", "why": "W", "evidence": "E"}
    return Erratum(**{**words, "confidence": "certain", **values})


@pytest.mark.parametrize(
    ("entry", "kind"),
    [
        (erratum(is_note=True), "a note"),
        (erratum(is_note=True, changes=True, held=(("bits", 8),)), "a note"),
        (erratum(changes=False), "changes nothing"),
        (erratum(changes=True, held=(("bits", 8), ("view", True), ("unit", None))),
         "holds bits: 8, view: true, unit: (absent)"),
        (erratum(changes=True, held=(("bits", 0), ("view", False))),
         "holds bits: 0, view: false"),
    ],
)  # fmt: skip
def test_the_kind_of_a_decision_has_its_values_as_in_yaml(entry, kind):
    assert _kind(entry) == kind


def test_a_value_is_cut_to_40_characters():
    assert _plain("a" * 40) == "a" * 40
    assert _plain("a" * 41) == "a" * 37 + "..."


def test_each_part_of_a_decision_is_compared():
    fields = {field for field in Erratum.__dataclass_fields__ if field != "source"}
    assert fields - {"id", "changes"} == set(_PARTS)
