"""Damage that a profile lists is repaired in the tables, with a note for each repair."""

from __future__ import annotations

import pytest

from icdgen.importer import profile
from icdgen.importer.document import SourceCell, SourceRow, SourceTable
from icdgen.importer.repairs import mend_tables


def mended(folder, damage: str, *rows: str, **keys) -> tuple[list[str], list[str]]:
    """Return the rows of a table after the repair, and the messages of the notes."""
    path = folder / "profile.yaml"
    path.write_text(f"profile: 1\ndamage: [{damage}]\nrules: []\n", encoding="utf-8")
    cells = [[SourceCell(text) for text in row.split(" | ")] for row in rows]
    table = SourceTable(number=7, rows=[SourceRow(row) for row in cells], **keys)
    notes = mend_tables([table], profile.load(path))
    assert {(note.code, note.severity) for note in notes} <= {("IMP028", "note")}
    return [row.shown for row in table.rows], [note.message for note in notes]


@pytest.mark.parametrize(
    ("rows", "repaired", "times"),
    [
        (("0 | Rate", "8 | Mode"), ("0 | Rate", "8 | Mode"), ""),
        (("0 | Vo1t", "8 | Mode"), ("0 | Volt", "8 | Mode"), "1 time"),
        (("0 | Mode", "8 | Vo1t"), ("0 | Mode", "8 | Volt"), "1 time"),
        (
            ("Vo1t | Vo1t Vo1t", "8 | Vo1ts"),
            ("Volt | Volt Volt", "8 | Vo1ts"),
            "3 times",
        ),
    ],
)
def test_a_note_counts_all_repairs_of_a_word_in_a_table(
    rows, repaired, times, tmp_path
):
    damage = "{printed: Vo1t, meant: Volt}"
    result, notes = mended(tmp_path, damage, *rows, caption="Motor")
    text = f"table 7 (`Motor`): `Vo1t` is taken for `Volt` {times}, as the profile says"
    assert (result, notes) == (list(repaired), [text] if times else [])


@pytest.mark.parametrize(
    ("label", "before", "repaired"),
    [
        (7, 16, ["0 | Rate", "Wheel", "16 | Mode", "16 | Level"]),
        (7, 0, ["Wheel", "0 | Rate", "16 | Mode", "16 | Level"]),
        (7, 8, None),
        (8, 16, None),
    ],
)
def test_a_lost_group_heading_is_put_back_once_before_its_row(
    label, before, repaired, tmp_path
):
    rows = ["0 | Rate", "16 | Mode", "16 | Level"]
    damage = f"{{table: {label}, before: {before}, group: Wheel}}"
    result, notes = mended(tmp_path, damage, *rows, caption="Motor", label=7)
    text = f"the group heading `Wheel` is put back before {before}"
    assert result == (repaired or rows)
    assert notes == (
        [f"table 7 (`Motor`): {text}, as the profile says"] if repaired else []
    )
