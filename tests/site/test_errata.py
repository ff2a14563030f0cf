"""Values of the page of errata: entries by node, places, and changed values."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.backends.html import errata
from icdgen.backends.html.relations import Relations
from tests.icd.files import loaded

FIELDS = "\n".join(
    f"      - {{at: {8 * n}, bits: 8, name: Level {n}, type: uint}}" for n in range(7)
)
ICD = f"""\
enums:
  - {{name: Mode, members: [{{value: 0, name: Idle}}]}}
messages:
  - name: Levels
    id: 0
    kind: telemetry
    length: 7
    fields:
{FIELDS}
  - {{name: Alone, id: 255, kind: telemetry, length: 1, fields: [
      {{at: 0, bits: 8, name: Mode, type: enum, enum: Mode}}]}}
# errata/demo.yaml
errata: 1
node: demo
entries:
  - id: DEM-001
    title: Wrong unit
    where: {{message: Levels, fields: [Level 0, Level 1, Level 2, Level 3, Level 4, Level 5, Level 6]}}
    printed: {{unit: ~}}
    held: {{unit: V}}
    why: Measured.
    evidence: Table 4.
    confidence: open
notes:
  - id: DEM-002
    title: Unclear
    where: [{{message: Levels}}, {{message: Alone, field: Mode}}]
    what: Not stated.
    evidence: Table 5.
    confidence: certain
"""


@pytest.fixture
def values(tmp_path):
    result = loaded(tmp_path, ICD)
    assert result.ok, [finding.message for finding in result.findings]
    return errata.values(Relations(result.icd))


def test_errata_come_before_notes_with_anchors_of_their_node(values):
    (group,) = values["groups"]
    assert [(anchor, title) for anchor, title, _ in group.kinds] == [
        ("demo-errata", "Errata"),
        ("demo-notes", "Notes"),
    ]
    ids = [[entry.erratum.id for entry in entries] for *_, entries in group.kinds]
    assert ids == [["DEM-001"], ["DEM-002"]]


def test_six_places_are_shown_and_each_message_is_named_once(values):
    (group,) = values["groups"]
    ((erratum,), (note,)) = (entries for *_, entries in group.kinds)
    assert [place.text for place in erratum.places] == [
        f"Levels: Level {n}" for n in range(6)
    ]
    assert [place.text for place in erratum.more] == ["Levels: Level 6"]
    assert erratum.messages == ["Levels"]
    assert [place.text for place in note.places] == ["Levels", "Alone: Mode"]
    assert (note.more, note.messages) == ([], ["Levels", "Alone"])


def test_filters_list_messages_by_name_and_levels_by_certainty(values):
    assert values["messages"] == ["Alone", "Levels"]
    assert values["levels"] == ["certain", "open"]


def test_a_node_without_errata_has_no_group(tmp_path):
    result = loaded(tmp_path, "messages: []\n")
    assert errata.values(Relations(result.icd)) == {
        "groups": [],
        "messages": [],
        "levels": [],
    }


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, "absent"), (True, "true"), (False, "false"), (0, "0"), ("M", "M")],
)
def test_a_changed_value_is_shown_as_in_yaml(value, text):
    assert errata.shown(value) == text


def test_a_change_has_the_printed_and_the_corrected_value():
    pairs = {
        "printed": (("bits", 8), ("unit", None)),
        "held": (("unit", "V"), ("at", 3)),
    }
    rows = [("unit", "absent", "V"), ("at", "absent", "3")]
    assert errata.changed(SimpleNamespace(**pairs, changes=True)) == rows
    assert errata.changed(SimpleNamespace(**pairs, changes=False)) == []
