"""The diff recognises renamed and moved objects and reports its certainty."""

from __future__ import annotations

import pytest

from icdgen.diff.compare import compare
from icdgen.diff.similar import extends, likeness, same_sense
from icdgen.loading import load
from tests.diff.cases import compared_texts
from tests.icd.files import HEAD

AXES = [
    f"{{at: {16 * n}, bits: 16, name: {axis} Rate, type: int, unit: deg/s, formula: raw*0.01}}"
    for n, axis in enumerate("ABC")
]


def message(name: str, id: int, *fields: str, length: int = 6) -> str:
    rows = "".join(f"      - {field}\n" for field in fields)
    return f"  - name: {name}\n    id: {id}\n    kind: telemetry\n    length: {length}\n    fields:\n{rows}"


def changes(tmp_path, old: str, new: str) -> list:
    texts = (f"messages:\n{text}" for text in (old, new))
    return compared_texts(tmp_path, *texts).changes


def codes(changed: list) -> list[str]:
    return [change.code for change in changed]


def test_the_same_layout_under_another_name_is_a_rename(tmp_path):
    reported = changes(
        tmp_path, message("Rates", 130, *AXES), message("Gyro Rates", 130, *AXES)
    )
    assert codes(reported) == ["DIF301"]
    assert reported[0].certainty in ("likely", "certain") and reported[0].was == "Rates"


def test_the_same_layout_under_another_name_and_id_is_a_rename(tmp_path):
    reported = changes(
        tmp_path, message("Rates", 130, *AXES), message("Gyro Rates", 131, *AXES)
    )
    assert codes(reported) == ["DIF103", "DIF301"]
    assert 0 < reported[0].confidence < 1


def test_another_layout_under_another_name_is_another_message(tmp_path):
    other = "{at: 0, bits: 48, name: Blob, type: bytes}"
    assert codes(changes(tmp_path, message("Rates", 130, *AXES), message("Image", 131, other))) == [
        "DIF102", "DIF101", "DIF311", "DIF306",
    ]  # fmt: skip


def test_a_short_frame_of_the_same_form_is_no_rename(tmp_path):
    byte = "{at: 0, bits: 8, name: %s, type: uint}"
    reported = changes(
        tmp_path,
        message("Heater", 130, byte % "Level", length=1),
        message("Door", 140, byte % "Angle", length=1),
    )
    assert {"DIF101", "DIF102"} <= set(codes(reported))


def test_names_decide_where_messages_change_places(tmp_path):
    """Two messages that swap their ids are not reported as swapping their names."""
    reported = changes(
        tmp_path,
        message("One", 130, *AXES) + message("Two", 131, *AXES),
        message("One", 131, *AXES) + message("Two", 130, *AXES),
    )
    assert sorted(set(codes(reported))) == ["DIF103", "DIF104"]


@pytest.mark.parametrize("count", [1, 3])
def test_an_insertion_is_one_change_however_many_fields_follow(tmp_path, count):
    many = [f"{{at: {8 * n}, bits: 8, name: F{n}, type: uint}}" for n in range(40)]
    new = [f"{{at: {8 * n}, bits: 8, name: New {n}, type: uint}}" for n in range(count)]
    moved = [
        row.replace(f"at: {8 * n},", f"at: {8 * (n + count)},")
        for n, row in enumerate(many)
    ]
    reported = changes(
        tmp_path,
        message("M", 130, *many, length=40),
        message("M", 130, *new, *moved, length=40 + count),
    )
    assert codes(reported) == ["DIF106", "DIF108", *["DIF311"] * count]
    assert (
        "40 fields lie" in reported[1].message
        and f"{count} byte" in reported[1].message
    )


def test_a_field_that_grew_moves_the_fields_after_it(tmp_path):
    old = [
        "{at: 0, bits: 8, name: A1, type: uint}",
        "{at: 8, bits: 8, name: B1, type: uint}",
        "{at: 16, bits: 8, name: C1, type: uint}",
    ]
    new = [
        "{at: 0, bits: 16, name: A1, type: uint}",
        "{at: 16, bits: 8, name: B1, type: uint}",
        "{at: 24, bits: 8, name: C1, type: uint}",
    ]
    reported = changes(
        tmp_path, message("M", 130, *old, length=3), message("M", 130, *new, length=4)
    )
    assert codes(reported) == ["DIF106", "DIF108", "DIF110", "DIF307"]
    assert reported[1].message.startswith("`A1` has 16 bits, had 8: 2 fields")


def test_a_field_renamed_after_an_insertion_is_a_rename(tmp_path):
    old = [
        "{at: 0, bits: 8, name: Count, type: uint}",
        "{at: 8, bits: 16, name: Bus Voltage, type: uint, unit: mV}",
    ]
    new = ["{at: 0, bits: 8, name: Fresh, type: uint}", "{at: 8, bits: 8, name: Count, type: uint}",
           "{at: 16, bits: 16, name: Main Bus Voltage, type: uint, unit: mV}"]  # fmt: skip
    reported = changes(
        tmp_path, message("M", 130, *old, length=3), message("M", 130, *new, length=4)
    )
    assert codes(reported) == ["DIF106", "DIF108", "DIF311", "DIF302"]


def test_fields_added_at_the_end_of_a_frame_are_reported(tmp_path):
    length, *_ = changes(
        tmp_path, message("M", 130, AXES[0], length=2), message("M", 130, *AXES)
    )
    assert (
        length.message
        == "`M` has 6 bytes, had 2: it gained `B Rate` and `C Rate` at its end"
    )
    assert "The first 2 bytes are as they were." in length.details


def test_a_message_moved_to_another_node_is_not_removed(tmp_path):
    for side, where in (("old", "one"), ("new", "two")):
        (tmp_path / side).mkdir()
        for name in ("one", "two"):
            text = HEAD.replace("demo", name) + (
                f"messages:\n{message('M', 130, *AXES)}" if name == where else ""
            )
            (tmp_path / side / f"{name}.yaml").write_text(text)
    reported = compare(
        *(load([tmp_path / side]).icd for side in ("old", "new"))
    ).changes
    assert codes(reported) == ["DIF133", "DIF132", "DIF310"] or codes(reported) == [
        "DIF132",
        "DIF133",
        "DIF310",
    ]


@pytest.mark.parametrize(
    "first, other, expected",
    [
        ("Unkown Reset Cause", "Unknown Reset Cause", True),
        ("Initialise", "initialize", True),
        ("3V3 Current", "Current 3V3", True),
        ("Boot-Success", "boot success", True),
        ("Enabled", "Disabled", False),
        ("On", "Off", False),
        ("Mode 1", "Mode 2", False),
        ("Active", "Inactive", False),
        ("Lock", "Unlock", False),
        ("Maximum", "Minimum", False),
        ("Set", "Reset", False),
        ("Version 12345", "Version 12354", False),
    ],
)
def test_a_typing_error_is_distinguished_from_another_meaning(first, other, expected):
    assert same_sense(first, other) is same_sense(other, first) is expected


def test_a_longer_name_has_the_same_meaning_unless_it_negates():
    assert extends("Mode", "Control Mode") and extends("Control Mode", "Mode")
    assert not extends("Valid", "Not Valid") and not extends("Roll", "Pitch")


def test_likeness_is_symmetric_and_bounded():
    names = ["Roll Angle", "Pitch Angle", "Angle of Roll", "", "X"]
    for name in names:
        for other in names:
            assert (
                likeness(name, other) == likeness(other, name)
                and 0 <= likeness(name, other) <= 1
            )
