"""Changes of enumerations and of the fields with their values."""

from __future__ import annotations

import pytest

from icdgen.diff.compare import Comparison
from tests.diff.cases import compared_texts, rows_of

CODES = "DIF204 DIF205 DIF206 DIF207 DIF208".split()
# Old and new members of `Mode`, the field with its values, and the changes.
USED = "Used by `Status: State` and `Status: Last`."


def member(code: str, kind: str, message: str, was: str, now: str, *places) -> tuple:
    return (code, kind, message, was, now, *places, USED)


CASES = {
    "another name": ("{value: 0, name: Idle}", "{value: 0, name: Broken}", [
        member("DIF205", "error", "0 of `Mode` is `Broken`, was `Idle`",
               "Idle", "Broken", "Idle", "Broken")]),
    "another spelling": ("{value: 0, name: Safe Mode}", "{value: 0, name: safe-mode}", []),
    "another value": ("{value: 0, name: Idle}", "{value: 3, name: Idle}", [
        member("DIF206", "error", "`Idle` of `Mode` is 3, was 0", "0", "3", "0", "3")]),
    "another end": ("{value: 2, to: 4, name: Idle}", "{value: 2, to: 5, name: Idle}", [
        member("DIF206", "error", "`Idle` of `Mode` is 2 to 5, was 2 to 4",
               "2 to 4", "2 to 5", "2", "2")]),
    "a range": ("{value: 2, name: Idle}", "{value: 2, to: 3, name: Idle}", [
        member("DIF206", "error", "`Idle` of `Mode` is 2 to 3, was 2",
               "2", "2 to 3", "2", "2")]),
    "removed": ("{value: 0, name: Idle}, {value: 7, to: 9, name: Run}", "{value: 0, name: Idle}", [
        member("DIF207", "warning", "7 to 9 of `Mode` has no name now, was `Run`",
               "7 to 9 = Run", "", "Run", None)]),
    "added": ("{value: 1, name: Idle}", "{value: 1, name: Idle}, {value: 0, name: Run}", [
        member("DIF208", "addition", "0 of `Mode` is `Run`; it had no name",
               "", "0 = Run", None, "Run")]),
}  # fmt: skip
STATUS = """\
messages:
  - name: Status
    id: 130
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: State, type: enum, enum: Mode}
      - {at: 8, bits: 8, name: Last, type: enum, enum: Mode}
"""


@pytest.mark.parametrize("case", CASES)
def test_another_member_is_reported_with_the_fields_that_have_it(tmp_path, case):
    old, new, expected = CASES[case]
    texts = (
        f"enums:\n  - {{name: Mode, members: [{m}]}}\n{STATUS}" for m in (old, new)
    )
    assert rows_of(compared_texts(tmp_path, *texts), *CODES) == expected


def test_members_that_no_field_has_are_reported_without_fields(tmp_path):
    texts = (
        f"enums:\n  - {{name: Mode, members: [{{value: {value}, name: Idle}}]}}\n"
        "messages: []\n"
        for value in (0, 1)
    )
    (row,) = rows_of(compared_texts(tmp_path, *texts, is_checked=False), *CODES)
    assert row == (
        "DIF206", "error", "`Idle` of `Mode` is 1, was 0", "0", "1", "0", "1"
    )  # fmt: skip


ENUMS = """\
enums:
  - {name: Mode, members: [{value: 0, name: Idle}, {value: 1, name: Run}, {value: 9, name: Fast}, {value: 5, name: Slow}]}
  - {name: Phase, members: [{value: 0, name: Idle}, {value: 1, name: Eclipse}, {value: 7, name: Sun}]}
  - {name: Colour, members: [{value: 0, name: Idle}, {value: 1, name: Run}, {value: 5, name: Slow}, {value: 9, to: 12, name: Fast}]}
"""
# Type and enumeration of the old and of the new field, and the change.
FIELDS = {
    "State": ("enum, enum: Mode", "enum, enum: Phase", (
        "error", "the values of `State` are those of `Phase`, were those of `Mode`",
        "Mode", "Phase", "Mode", "Phase",
        "Another sense: 1.", "Without a name now: `Slow` and `Fast`.")),
    "Same": ("enum, enum: Mode", "enum, enum: Colour", (
        "error", "the values of `Same` are those of `Colour`, were those of `Mode`",
        "Mode", "Colour", "Mode", "Colour")),
    "Named": ("uint", "enum, enum: Mode", (
        "warning", "the values of `Named` now have names, as in `Mode`",
        "", "Mode", "uint", "Mode")),
    "Unnamed": ("enum, enum: Mode", "uint", (
        "warning", "the values of `Unnamed` no longer have names; they were in `Mode`",
        "Mode", "", "Mode", "uint")),
    "Equal": ("enum, enum: Mode", "enum, enum: Mode", None),
}  # fmt: skip


@pytest.fixture(scope="module")
def comparison(tmp_path_factory) -> Comparison:
    old, new = (
        ENUMS
        + "messages:\n  - name: Status\n    id: 130\n    kind: telemetry\n    length: 5\n    fields:\n"
        + "".join(
            f"      - {{at: {8 * number}, bits: 8, name: {name}, type: {field[side]}}}\n"
            for number, (name, field) in enumerate(FIELDS.items())
        )
        for side in (0, 1)
    )
    folder = tmp_path_factory.mktemp("enumerations")
    return compared_texts(folder, old, new, is_checked=False)


@pytest.mark.parametrize("name", FIELDS)
def test_a_field_with_other_names_of_its_values_is_reported(comparison, name):
    rows = [row for row in rows_of(comparison, "DIF204") if f"`{name}`" in row[2]]
    expected = FIELDS[name][2]
    assert rows == ([] if expected is None else [("DIF204", *expected)])


def test_a_renamed_enumeration_is_no_other_enumeration(tmp_path):
    text = f"enums:\n  - {{name: Mode, members: [{{value: 0, name: Idle}}]}}\n{STATUS}"
    renamed = text.replace("name: Mode", "name: Modes").replace(
        "enum: Mode", "enum: Modes"
    )
    codes = {change.code for change in compared_texts(tmp_path, text, renamed).changes}
    assert "DIF303" in codes and "DIF204" not in codes
