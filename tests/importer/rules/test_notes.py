"""Findings of rules: rows with one cause are one finding, which names every place."""

from __future__ import annotations

from icdgen.diagnostics import Place
from icdgen.import_results.findings import SourcePlace
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.rule import TableRule

FIRST, SECOND = Place("rules.yaml", 4, 5), Place("rules.yaml", 12, 5)


def rows(notes: Notes) -> list[tuple]:
    """Return message, line, further lines and place in the profile of each finding."""
    return [
        (finding.message, finding.spot.line, [row.line for row in finding.also], place)
        for finding in notes.import_findings
        for place in [finding.place]
    ]


def test_rows_of_each_rule_are_counted_at_the_place_of_that_rule():
    """The rules fail for the same reason, and each must be corrected in the profile."""
    notes = Notes()
    for line, place in ((1, FIRST), (2, SECOND), (3, FIRST), (4, FIRST)):
        spot = SourcePlace(line=line, order=0)
        notes.error("IMP023", f"row {line}", spot, "correct it", place, f"Level {line}")
    assert rows(notes) == [
        ("row 1; the same in 2 more rows: `Level 3`, `Level 4`", 1, [3, 4], FIRST),
        ("row 2", 2, [], SECOND),
    ]


def test_findings_that_differ_in_code_severity_or_help_stay_separate():
    notes, spot = Notes(), SourcePlace(line=1)
    notes.error("IMP023", "first", spot, "correct it", example="a")
    notes.error("IMP024", "code", spot, "correct it", example="a")
    notes.error("IMP023", "help", spot, "remove it", example="a")
    notes.warn("IMP023", "severity", spot, "correct it", example="a")
    notes.error("IMP023", "second", spot, "correct it", example="a")
    assert [finding.message for finding in notes.import_findings] == [
        "first; the same in 1 more row",
        "code",
        "help",
        "severity",
    ]
    assert [finding.severity for finding in notes.import_findings] == [
        "error",
        "error",
        "error",
        "warning",
    ]


def test_findings_without_an_example_are_never_merged_and_come_first():
    notes, spot = Notes(), SourcePlace(line=1)
    notes.error("IMP023", "grouped", spot, "correct it", example="a")
    notes.error("IMP023", "single", spot, "correct it")
    notes.error("IMP023", "single", spot, "correct it")
    assert [finding.message for finding in notes.import_findings] == [
        "single",
        "single",
        "grouped",
    ]


def test_a_finding_lists_four_other_examples_and_the_number_of_tables():
    def message(count: int, tables: int) -> str:
        notes = Notes()
        for index in range(count):
            spot = SourcePlace(line=index, order=index % tables)
            notes.warn("IMP023", "bad", spot, "correct it", example=f"{index}" * 50)
        (finding,) = notes.import_findings
        assert finding.also == tuple(
            SourcePlace(line=index, order=index % tables) for index in range(1, count)
        )
        return finding.message

    shown = [f"`{f'{index}' * 40}`" for index in range(5)]
    assert message(2, 1) == f"bad; the same in 1 more row: {shown[1]}"
    assert message(5, 1) == f"bad; the same in 4 more rows: {', '.join(shown[1:5])}"
    assert message(6, 2) == (
        f"bad; the same in 5 more rows of 2 tables: {', '.join(shown[1:5])}, ..."
    )


def test_rows_that_a_rule_drops_are_counted_with_three_different_examples():
    rules = [TableRule("state", FIRST), TableRule("errors", SECOND)]
    notes = Notes()
    for text in ("Sum", "Sum", "", "x" * 60):
        notes.drop(rules[0], "skip", text)
    for text in ("a", "b", "c", "d"):
        notes.drop(rules[1], "skip", text)
    notes.drop(rules[0], "stop", "End")
    notes.finish(rules)
    assert [
        (finding.code, finding.severity, finding.place, finding.message)
        for finding in notes.import_findings
    ] == [
        ("IMP108", "note", place, f"rule {message}")
        for place, message in (
            (FIRST, f"`state`: `skip` drops 4 rows: `Sum`, ``, `{'x' * 50}`"),
            (SECOND, "`errors`: `skip` drops 4 rows: `a`, `b`, `c` ..."),
            (FIRST, "`state`: `stop` drops 1 row: `End`"),
        )
    ]
