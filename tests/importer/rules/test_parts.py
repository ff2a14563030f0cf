"""Names, numbers and kinds of messages that rules read."""

from __future__ import annotations

from icdgen.import_results.findings import SourcePlace
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.parts import TablePart, known_kind
from tests.importer.rules.small import rule, table


def test_a_part_is_called_by_its_table_and_its_message():
    part = TablePart(rule(base=16), table("x"), {"message": "State", "id": "21"})
    assert (part.name, part.where) == ("State", "table 7, message `State`")
    assert [part.number(role) for role in ("id", "length", "message")] == [
        0x21,
        None,
        None,
    ]
    unnamed = TablePart(rule(), table("x"), {"id": "21"})
    assert (unnamed.name, unnamed.where) == ("", "table 7")
    assert unnamed.number("id") == 21


def test_a_kind_is_one_of_three_words_or_a_finding():
    notes = Notes()
    spot = SourcePlace(line=4)
    for kind in ("telecommand", "telemetry", "configuration", ""):
        assert known_kind(kind, "table 7", spot, rule(), notes) == kind
    assert notes.import_findings == []
    assert known_kind("T" * 50, "table 7", spot, rule(), notes) == ""
    (finding,) = notes.import_findings
    assert (finding.code, finding.severity, finding.spot) == ("IMP031", "error", spot)
    assert finding.place == rule().place
    assert finding.message == (
        f"table 7: its kind `{'T' * 40}` is none of telecommand, telemetry, configuration"
    )
