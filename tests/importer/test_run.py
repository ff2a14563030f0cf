"""Result of an import: the order of its findings and the certainty of its tables."""

from __future__ import annotations

import pytest

from icdgen.import_results.findings import (
    CERTAIN,
    DOUBTFUL,
    LIKELY,
    ImportFinding,
    SourcePlace,
)
from icdgen.importer import profile, run
from icdgen.importer.document import Document, SourceCell, SourceRow, SourceTable
from icdgen.importer.model import BACKGROUND, UNKNOWN
from icdgen.importer.rules.rule import TableRule
from tests.importer.results import result_of
from tests.importer.rules.small import rule, table

FIRST, SECOND = SourceTable(number=1), SourceTable(number=2)
HERE, THERE = SourcePlace(order=0), SourcePlace(order=1)


def finding(severity: str, sure: str = LIKELY, spot=HERE, **keys) -> ImportFinding:
    code = keys.pop("code", "IMP010")
    return ImportFinding(code, "odd", spot, "", severity, sure, **keys)


@pytest.mark.parametrize(
    ("what", "findings", "sure"),
    [
        ("message", [], CERTAIN), (BACKGROUND, [], CERTAIN), (UNKNOWN, [], DOUBTFUL),
        ("message", [finding("note")], CERTAIN),
        ("message", [finding("warning")], LIKELY),
        ("message", [finding("note"), finding("warning")], LIKELY),
        ("message", [finding("note", DOUBTFUL)], DOUBTFUL),
        ("message", [finding("warning"), finding("error")], DOUBTFUL),
        ("message", [finding("error", CERTAIN)], DOUBTFUL),
        # Another table, and the document, say nothing about this table.
        ("message", [finding("error", spot=THERE)], CERTAIN),
        ("message", [finding("error", spot=SourcePlace())], CERTAIN),
        ("message", [finding("error", spot=THERE, also=(HERE,))], DOUBTFUL),
        ("message", [finding("warning", spot=SourcePlace(), also=(HERE,))], LIKELY),
        # Bits that no field covers leave the fields certain.
        ("message", [finding("error", DOUBTFUL, code="IMP035")], CERTAIN),
    ],
)  # fmt: skip
def test_findings_about_a_table_decide_its_certainty(what, findings, sure):
    result = result_of((FIRST, what), findings=findings)
    assert result.sure_of(FIRST) == sure


def test_each_table_that_a_rule_reads_is_counted_once():
    result = result_of(
        (FIRST, "message"),
        (FIRST, "enumeration"),
        (SECOND, BACKGROUND),
        (SourceTable(number=3), UNKNOWN),
        (SourceTable(number=4), "message"),
        findings=[finding("warning", spot=SourcePlace(order=3)), finding("error")],
    )
    assert result.sureness() == {DOUBTFUL: 1, CERTAIN: 1, LIKELY: 1}


def test_findings_are_sorted_by_page_line_table_and_code():
    keys = [
        (None, None, None, "IMP001"),
        (None, None, None, "IMP002"),
        (None, None, 1, "IMP001"),
        (None, 1, 0, "IMP009"),
        (None, 2, 0, "IMP001"),
        (2, None, 5, "IMP003"),
        (2, None, 6, "IMP002"),
        (10, None, 0, "IMP000"),
    ]
    findings = [
        ImportFinding(code, "", SourcePlace(page, line, None, order))
        for page, line, order, code in keys
    ]
    result = result_of(findings=findings[::-1])
    assert result.import_findings == findings


RULE = TableRule("state", rule().place, what="ignore")
BARE = Document("pump.txt")
TABLE = table("Byte|Name", "0|Level")


@pytest.mark.parametrize(
    ("tables", "rules", "message", "help"),
    [
        ([], [], "the document has no table", "is this the right document?"),
        ([], [RULE], "the document has no table", "is this the right document?"),
        ([TABLE], [RULE], "no rule gives a message", "the other findings say why"),
        ([TABLE], [], "no rule gives a message", "write rules in a profile"),
    ],
)
def test_a_document_without_a_message_is_an_error_with_its_reason(
    tables, rules, message, help
):
    words = profile.load()
    words.rules = rules
    result, trees = run.apply_rules(BARE, tables, words)
    assert trees == {} and result.failed
    (nothing,) = [t for t in result.import_findings if t.code == "IMP004"]
    assert (nothing.message, nothing.severity) == (message, "error")
    assert (nothing.sure, nothing.spot) == (DOUBTFUL, SourcePlace())
    assert help in nothing.help


def test_rules_leave_the_given_tables_as_they_are():
    words = profile.load()
    words.data["damage"] = [{"printed": "lxx", "meant": "Ixx"}]
    printed = SourceTable(1, [SourceRow([SourceCell("lxx"), SourceCell("x")])])
    result, _ = run.apply_rules(BARE, [printed], words)
    assert printed.rows[0].cells[0].text == "lxx"
    assert result.tables[0].rows[0].cells[0].text == "Ixx"
