"""The version step has the severest changes as its reason."""

from __future__ import annotations

from dataclasses import replace

from icdgen.diff.change import Change
from icdgen.diff.version import step
from icdgen.diff.where import Where
from tests.diff.cases import FOLDER, compared


def changes_of(*codes: str) -> list[Change]:
    """Return the first change with each code, from the fixture of its rule."""
    return [
        next(c for c in compared(FOLDER / code).changes if c.code == code)
        for code in codes
    ]


def test_breaking_changes_are_counted_by_layer_with_the_first_message():
    changes = changes_of("DIF307", "DIF201", "DIF107", "DIF302")
    assert all(change.breaks for change in changes)
    result = step(changes)
    assert result.step == "major"
    assert result.reason == (
        "1 change of the wire format, 1 change of meaning and 2 changes of generated"
        f" names or types, the first: {changes[0].message}"
    )
    assert result.deciding == ("DIF107", "DIF201", "DIF302", "DIF307")


def test_additions_decide_if_nothing_breaks():
    (change,) = changes_of("DIF107")
    addition = replace(change, addition=True)
    note = replace(change, severity="note", message="a note")
    later = replace(addition, message="later")
    result = step([note, addition, later])
    assert result == (
        "minor",
        f"nothing breaks, 2 additions, the first: {change.message}",
        ("DIF107",),
    )
    assert step([note]) == ("patch", "1 change of words only", ("DIF107",))
    assert step([addition, note, change]).step == "major"
    assert step([]) == ("none", "nothing changed", ())


def test_the_confidence_of_a_match_is_a_word_with_limits():
    (change,) = changes_of("DIF107")
    words = {
        confidence: replace(change, confidence=confidence).certainty
        for confidence in (1.0, 0.999, 0.95, 0.949, 0.7, 0.699, 0.0)
    }
    assert words == {
        1.0: "",
        0.999: "certain",
        0.95: "certain",
        0.949: "likely",
        0.7: "likely",
        0.699: "uncertain",
        0.0: "uncertain",
    }


def test_notes_are_details_certainty_and_errata():
    (change,) = changes_of("DIF107")
    change = replace(
        change,
        details=("First.", "Second."),
        confidence=0.746,
        errata=("A-1 is new", "A-2 is gone"),
    )
    assert change.notes == [
        "First.",
        "Second.",
        "Matched by similarity, likely (75%).",
        "Because erratum A-1 is new, A-2 is gone.",
    ]
    assert replace(change, details=(), confidence=1, errata=()).notes == []


def test_the_kind_of_a_change_is_addition_or_its_severity():
    (change,) = changes_of("DIF107")
    addition = replace(change, addition=True)
    assert (change.kind, addition.kind) == ("error", "addition")
    assert (change.breaks, addition.breaks) == (True, False)
    assert not replace(change, severity="note").breaks
    assert replace(change, severity="warning").breaks


def test_the_place_is_that_of_the_new_icd_if_the_object_exists_there():
    (change,) = changes_of("DIF107")
    assert change.old != change.new
    assert change.place == change.new and change.places == [change.old, change.new]
    removed = replace(change, new=None)
    assert removed.place == change.old and removed.places == [change.old]


def test_the_subject_of_a_change_has_its_names_in_backticks():
    assert str(Where("demo", "Status", "Mode")) == "demo `Status` `Mode`"
    assert str(Where("demo", enum="State", member="Idle")) == "demo `State` `Idle`"
    assert str(Where("demo", "Status")) == "demo `Status`"
    section = Where("demo", section="protocol.link", erratum="A-1")
    assert str(section) == "demo protocol.link A-1"
