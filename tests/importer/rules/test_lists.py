"""Lists of messages and of frames of logs, and enumerations with a name."""

from __future__ import annotations

import pytest

from icdgen.import_results.findings import SourcePlace
from icdgen.importer.model import Listed, ReadLogBit
from icdgen.importer.rules.cells import Roles
from icdgen.importer.rules.lists import list_of, log_of
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.rows import DataRow
from tests.importer.rules.parts import shown
from tests.importer.rules.small import rule, table

RULE = rule("frames")
TABLE = table("ID|Name", "3|State", "4|Mode", "5|Rate")
HELP = "give columns the roles `message` and `id`, or drop the row with `skip`"


def rows(*given: dict[str, str]) -> list[Roles]:
    """Return rows with roles, from line 2; their text is the values."""
    return [
        Roles(roles, DataRow(dict(roles), source))
        for roles, source in zip(given, TABLE.rows[1:], strict=False)
    ]


def spot(line: int) -> SourcePlace:
    return SourcePlace(line=line, order=6)


def test_a_row_of_a_list_has_name_ids_length_kind_and_group():
    notes = Notes()
    given = {"kind": "telemetry", "node": " Pump\u00a0A"}
    roles = rows(
        {"message": "State", "id": "3", "length": "8", "section": "Fast"},
        {"message": "Mode", "set_id": "0x4", "get_id": "0", "kind": "configuration"},
        {"message": "Rate", "get_id": "132"},
    )
    result = list_of(RULE, TABLE, given, roles, notes)
    content = result.content
    assert (result.table, result.what) == (TABLE, "list")
    assert (content.kind, content.node) == ("telemetry", "Pump A")
    assert content.rows == [
        Listed("telemetry", "State", 8, 3, None, None, "Fast", spot(2)),
        Listed("configuration", "Mode", None, None, 4, 0, "", spot(3)),
        Listed("telemetry", "Rate", None, None, None, 132, "", spot(4)),
    ]
    assert notes.import_findings == []


def test_the_id_0_and_the_base_of_a_rule_count():
    roles = rows({"message": "State", "id": "0"}, {"message": "Mode", "id": "1F"})
    content = list_of(rule(base=16), TABLE, {}, roles, Notes()).content
    assert [(row.name, row.id) for row in content.rows] == [("State", 0), ("Mode", 31)]
    assert (content.kind, content.node) == ("", "")


def test_a_row_without_a_name_or_an_id_is_reported_and_left_out():
    notes = Notes()
    roles = rows(
        {"id": "3"}, {"message": "Mode", "length": "2"}, {"message": "Rate", "id": "5"}
    )
    result = list_of(RULE, TABLE, {}, roles, notes)
    assert [row.name for row in result.content.rows] == ["Rate"]
    assert shown(notes) == [
        ("IMP103", "error", "table 7: the row `3` gives no name"),
        ("IMP103", "error", "table 7: the row `Mode | 2` gives no id"),
    ]
    assert [f.spot for f in notes.import_findings] == [spot(2), spot(3)]
    assert {(f.help, f.place) for f in notes.import_findings} == {(HELP, RULE.place)}


def test_an_id_that_is_no_number_is_reported_at_its_row():
    notes = Notes()
    roles = rows(
        {"message": "State", "id": "x" * 50},
        {"message": "Mode", "id": "4", "length": "two"},
    )
    result = list_of(RULE, TABLE, {}, roles, notes)
    assert [(row.name, row.length) for row in result.content.rows] == [("Mode", None)]
    assert shown(notes)[0] == (
        "IMP023",
        "error",
        f"table 7: `id` is `{'x' * 40}`, which is not a number",
    )
    assert shown(notes)[1][:2] == ("IMP103", "error")
    assert shown(notes)[2] == (
        "IMP023",
        "error",
        "table 7: `length` is `two`, which is not a number",
    )
    assert [f.spot.line for f in notes.import_findings] == [2, 2, 3]


def test_a_frame_of_a_log_has_the_bit_of_its_mask_or_a_number():
    notes = Notes()
    roles = rows(
        {"mask": "00 02", "bit": "1", "id": "0", "message": "State"},
        {"bit": "0", "id": "132"},
    )
    result = log_of(RULE, TABLE, roles, notes)
    assert result.what == "loggable frames"
    assert result.content.bits == [ReadLogBit(9, 0, "State"), ReadLogBit(0, 132, "")]
    assert notes.import_findings == []


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"mask": "03", "id": "3"}, "03 | 3"), ({"id": "3"}, "3"), ({"bit": "1"}, "1"),
    ],
)  # fmt: skip
def test_a_row_of_a_log_without_a_bit_or_an_id_is_reported(given, text):
    notes = Notes()
    result = log_of(RULE, TABLE, rows(given, {"bit": "1", "id": "4"}), notes)
    assert result.content.bits == [ReadLogBit(1, 4, "")]
    (finding,) = notes.import_findings
    assert finding.message == (
        f"table 7: the row `{text}` gives no mask of one bit and no id of a frame"
    )
    assert (finding.code, finding.spot) == ("IMP103", spot(2))
    assert finding.help == "give columns the roles `mask` or `bit`, and `id`"
