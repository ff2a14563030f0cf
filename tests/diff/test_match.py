"""Renames and moves are found as such, and the diff says how sure it is."""

from __future__ import annotations

import pytest

from icdgen.diff.compare import compare
from icdgen.diff.similar import extends, likeness, same_sense
from icdgen.loading import load
from tests.icd.files import HEAD, write

AXES = [
    f"{{at: {16 * n}, bits: 16, name: {axis} Rate, type: int, unit: deg/s, formula: raw*0.01}}"
    for n, axis in enumerate("ABC")
]


def message(name: str, id: int, *fields: str, length: int = 6) -> str:
    rows = "".join(f"      - {field}\n" for field in fields)
    return f"  - name: {name}\n    id: {id}\n    kind: telemetry\n    length: {length}\n    fields:\n{rows}"


def changes(tmp_path, old: str, new: str) -> list:
    sides = []
    for name, text in (("old", old), ("new", new)):
        (tmp_path / name).mkdir()
        write(tmp_path / name, f"{HEAD}messages:\n{text}")
        loaded = load([tmp_path / name])
        assert loaded.findings == []
        sides.append(loaded.icd)
    return compare(*sides).changes


def codes(found: list) -> list[str]:
    return [change.code for change in found]


def test_the_same_layout_under_another_name_is_a_rename(tmp_path):
    found = changes(
        tmp_path, message("Rates", 130, *AXES), message("Gyro Rates", 130, *AXES)
    )
    assert codes(found) == ["DIF301"]
    assert found[0].certainty in ("likely", "certain") and found[0].was == "Rates"


def test_the_same_layout_under_another_name_and_id_is_one_too(tmp_path):
    found = changes(
        tmp_path, message("Rates", 130, *AXES), message("Gyro Rates", 131, *AXES)
    )
    assert codes(found) == ["DIF103", "DIF301"]
    assert 0 < found[0].sure < 1


def test_another_layout_under_another_name_is_another_message(tmp_path):
    other = "{at: 0, bits: 48, name: Blob, type: bytes}"
    assert codes(changes(tmp_path, message("Rates", 130, *AXES), message("Image", 131, other))) == [
        "DIF102", "DIF101", "DIF311", "DIF306",
    ]  # fmt: skip


def test_a_short_frame_is_not_taken_for_another_of_the_same_form(tmp_path):
    byte = "{at: 0, bits: 8, name: %s, type: uint}"
    found = changes(
        tmp_path,
        message("Heater", 130, byte % "Level", length=1),
        message("Door", 140, byte % "Angle", length=1),
    )
    assert {"DIF101", "DIF102"} <= set(codes(found))


def test_names_decide_where_messages_change_places(tmp_path):
    """Two messages that swap their ids are not two that swap their names."""
    found = changes(
        tmp_path,
        message("One", 130, *AXES) + message("Two", 131, *AXES),
        message("One", 131, *AXES) + message("Two", 130, *AXES),
    )
    assert sorted(set(codes(found))) == ["DIF103", "DIF104"]


@pytest.mark.parametrize("count", [1, 3])
def test_an_insertion_is_one_change_however_many_fields_follow(tmp_path, count):
    many = [f"{{at: {8 * n}, bits: 8, name: F{n}, type: uint}}" for n in range(40)]
    new = [f"{{at: {8 * n}, bits: 8, name: New {n}, type: uint}}" for n in range(count)]
    moved = [
        row.replace(f"at: {8 * n},", f"at: {8 * (n + count)},")
        for n, row in enumerate(many)
    ]
    found = changes(
        tmp_path,
        message("M", 130, *many, length=40),
        message("M", 130, *new, *moved, length=40 + count),
    )
    assert codes(found) == ["DIF106", "DIF108", *["DIF311"] * count]
    assert "40 fields lie" in found[1].message and f"{count} byte" in found[1].message


def test_a_field_that_grew_moves_those_behind_it(tmp_path):
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
    found = changes(
        tmp_path, message("M", 130, *old, length=3), message("M", 130, *new, length=4)
    )
    assert codes(found) == ["DIF106", "DIF108", "DIF110", "DIF307"]
    assert found[1].message.startswith("`A1` has 16 bits, had 8: 2 fields")


def test_a_field_renamed_behind_an_insertion_is_still_found(tmp_path):
    old = [
        "{at: 0, bits: 8, name: Count, type: uint}",
        "{at: 8, bits: 16, name: Bus Voltage, type: uint, unit: mV}",
    ]
    new = ["{at: 0, bits: 8, name: Fresh, type: uint}", "{at: 8, bits: 8, name: Count, type: uint}",
           "{at: 16, bits: 16, name: Main Bus Voltage, type: uint, unit: mV}"]  # fmt: skip
    found = changes(
        tmp_path, message("M", 130, *old, length=3), message("M", 130, *new, length=4)
    )
    assert codes(found) == ["DIF106", "DIF108", "DIF311", "DIF302"]


def test_a_frame_that_gained_fields_at_its_end_is_said_to(tmp_path):
    length, *_ = changes(
        tmp_path, message("M", 130, AXES[0], length=2), message("M", 130, *AXES)
    )
    assert (
        length.message
        == "`M` has 6 bytes, had 2: it gained `B Rate` and `C Rate` at its end"
    )
    assert "The first 2 bytes are as they were." in length.details


def test_a_message_that_another_node_declares_now_is_not_gone(tmp_path):
    for side, where in (("old", "one"), ("new", "two")):
        (tmp_path / side).mkdir()
        for name in ("one", "two"):
            text = HEAD.replace("demo", name) + (
                f"messages:\n{message('M', 130, *AXES)}" if name == where else ""
            )
            (tmp_path / side / f"{name}.yaml").write_text(text)
    found = compare(*(load([tmp_path / side]).icd for side in ("old", "new"))).changes
    assert codes(found) == ["DIF133", "DIF132", "DIF310"] or codes(found) == [
        "DIF132",
        "DIF133",
        "DIF310",
    ]


@pytest.mark.parametrize(
    "one, other, expected",
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
def test_a_slip_of_the_pen_is_told_from_another_sense(one, other, expected):
    assert same_sense(one, other) is same_sense(other, one) is expected


def test_a_name_that_says_more_extends_the_other_unless_it_denies_it():
    assert extends("Mode", "Control Mode") and extends("Control Mode", "Mode")
    assert not extends("Valid", "Not Valid") and not extends("Roll", "Pitch")


def test_likeness_is_symmetric_and_bounded():
    names = ["Roll Angle", "Pitch Angle", "Angle of Roll", "", "X"]
    for one in names:
        for other in names:
            assert (
                likeness(one, other) == likeness(other, one)
                and 0 <= likeness(one, other) <= 1
            )
