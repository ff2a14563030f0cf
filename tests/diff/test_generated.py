"""Names and types in generated code before and after a change, complete for a field, a
message and a member.
"""

from __future__ import annotations

import pytest

from icdgen.diff.generated import Generated, Name, _stem, is_renamed, may_rename
from icdgen.diff.pairs import Pair
from tests.conftest import DEMO
from tests.diff.cases import compared_texts

MESSAGE = [
    Name("c", "estimated_roll", "demo_telemetry"),
    Name("c", "demo_estimated_roll_t"),
    Name("c", "demo_estimated_roll_init"),
    Name("c", "demo_estimated_roll_fields"),
    Name("c", "DEMO_ESTIMATED_ROLL_LENGTH"),
    Name("c", "DEMO_ESTIMATED_ROLL_ID"),
    Name("c", "demo_estimated_roll_decode"),
    Name("c", "demo_estimated_roll_encode"),
    Name("c", "demo_estimated_roll_misfit"),
    Name("python", "EstimatedRoll"),
    Name("rust", "EstimatedRoll"),
]
FIELD = [
    Name("c", "roll_angle", "demo_estimated_roll"),
    Name("c", "demo_estimated_roll_roll_angle_deg"),
    Name("c", "demo_estimated_roll_set_roll_angle_deg"),
    Name("c", "demo_estimated_roll_roll_angle_mdeg"),
    Name("c", "demo_estimated_roll_set_roll_angle_mdeg"),
    Name("python", "roll_angle", "EstimatedRoll"),
    Name("python", "roll_angle_deg", "EstimatedRoll"),
    Name("python", "roll_angle_mdeg", "EstimatedRoll"),
    Name("rust", "roll_angle", "EstimatedRoll"),
    Name("rust", "roll_angle_deg", "EstimatedRoll"),
    Name("rust", "set_roll_angle_deg", "EstimatedRoll"),
    Name("rust", "roll_angle_deg_f32", "EstimatedRoll"),
    Name("rust", "roll_angle_mdeg", "EstimatedRoll"),
    Name("rust", "set_roll_angle_mdeg", "EstimatedRoll"),
]
MEMBER = [
    Name("c", "DEMO_MODE_IDLE"),
    Name("python", "IDLE", "Mode"),
    Name("rust", "Idle", "Mode"),
]
ROLL = "name: Estimated Roll\n"


@pytest.fixture
def compare(tmp_path):
    """Return a function that changes the ICD, and returns the names and the pairs by
    the old names of message or enumeration and of its part.
    """

    def run(*replacements: tuple[str, str]) -> tuple[Generated, dict[str, Pair]]:
        new = DEMO
        for old_text, new_text in replacements:
            assert old_text in new
            new = new.replace(old_text, new_text, 1)
        comparison = compared_texts(tmp_path, DEMO, new, is_checked=False)
        pairs: dict[str, Pair] = {}
        for node in comparison.match.nodes:
            for owner in node.declared:
                name = (owner.before or owner.any).name
                pairs[name] = owner
                for part in owner.parts:
                    pairs[f"{name}: {(part.before or part.any).name}"] = part
        return comparison.context.generated, pairs

    return run


def test_a_message_a_field_and_a_member_have_their_names_in_each_language(compare):
    # A part has a pair only if anything of its message differs.
    generated, pairs = compare(
        (ROLL, f"{ROLL}    summary: New.\n"), ("value: 0", "value: 2")
    )
    assert list(generated.old(pairs["Estimated Roll"])) == MESSAGE
    assert list(generated.old(pairs["Estimated Roll: Roll Angle"])) == FIELD
    assert list(generated.old(pairs["Mode: Idle"])) == MEMBER
    for pair in pairs.values():
        assert generated.old(pair) == generated.new(pair)
        assert generated.renamed(pair) == []


def test_a_renamed_message_keeps_the_names_of_its_fields_but_their_scope(compare):
    generated, pairs = compare((ROLL, "name: Filtered Roll\n"))
    message = pairs["Estimated Roll"]
    assert [(a, b.text) for a, b in generated.renamed(message)] == [
        (
            name,
            name.text.replace("estimated", "filtered")
            .replace("ESTIMATED", "FILTERED")
            .replace("Estimated", "Filtered"),
        )
        for name in MESSAGE
    ]
    field = pairs["Estimated Roll: Roll Angle"]
    assert generated.renamed(field) == []
    assert generated.new(field)[1].text == "demo_filtered_roll_roll_angle_deg"
    assert is_renamed(message) and not is_renamed(field)


def test_a_renamed_field_of_a_renamed_message_has_its_real_new_names(compare):
    generated, pairs = compare(
        (ROLL, "name: Filtered Roll\n"), ("name: Roll Angle", "name: Roll Turn")
    )
    field = pairs["Estimated Roll: Roll Angle"]
    changes = [(a.text, b.text) for a, b in generated.renamed(field)]
    assert changes[:2] == [
        ("roll_angle", "roll_turn"),
        ("demo_estimated_roll_roll_angle_deg", "demo_filtered_roll_roll_turn_deg"),
    ]
    assert len(changes) == len(FIELD)


def test_names_that_only_one_side_has_are_removed_or_added(compare):
    scaled, unscaled = "type: int, unit: deg, formula: raw*0.01", "type: int"
    generated, pairs = compare((scaled, unscaled))
    field = pairs["Estimated Roll: Roll Angle"]
    removed = [(a.text, b) for a, b in generated.renamed(field)]
    gone = [name for name in FIELD if name.text != "roll_angle"]
    assert sorted(removed) == sorted((name.text, None) for name in gone)


def test_a_renamed_member_and_enumeration(compare):
    generated, pairs = compare(("name: Idle", "name: Rest"))
    assert [(a, b.text) for a, b in generated.renamed(pairs["Mode: Idle"])] == [
        (MEMBER[0], "DEMO_MODE_REST"),
        (MEMBER[1], "REST"),
        (MEMBER[2], "Rest"),
    ]
    assert generated.renamed(pairs["Mode"]) == []
    assert generated.renamed(pairs["Mode: Run"]) == []


@pytest.mark.parametrize(
    ("old", "new", "types"),
    [
        (
            "bits: 16, name: Roll Angle, type: int",
            "bits: 16, name: Roll Angle, type: uint",
            [("c", "int16_t", "uint16_t"), ("rust", "i16", "u16")],
        ),
        (
            "bits: 16, name: Roll Angle, type: int",
            "bits: 9, name: Roll Angle, type: int",
            [],
        ),
        (
            "bits: 16, name: Roll Angle, type: int",
            "bits: 8, name: Roll Angle, type: int",
            [("c", "int16_t", "int8_t"), ("rust", "i16", "i8")],
        ),
        ("name: Roll Angle", "name: Roll Turn", []),
    ],
)
def test_a_type_differs_in_the_languages_that_show_it(compare, old, new, types):
    generated, pairs = compare((old, new))
    assert generated.retyped(pairs["Estimated Roll: Roll Angle"]) == types


def test_a_renamed_enumeration_is_no_other_type(compare):
    # All names of the enumeration, and of the field that uses it.
    generated, pairs = compare(
        ("- name: Mode", "- name: Control Mode"), ("enum: Mode}", "enum: Control Mode}")
    )
    assert generated.retyped(pairs["Estimated Roll: Mode"]) == []
    assert [b.text for _, b in generated.renamed(pairs["Mode"])] == [
        "demo_control_mode_t",
        "demo_control_mode_name",
        "ControlMode",
        "ControlMode",
    ]


@pytest.mark.parametrize(
    ("change", "name", "expected"),
    [
        ((ROLL, "name: Filtered Roll\n"), "Estimated Roll", True),
        ((ROLL, f"{ROLL}    identifier: Turn\n"), "Estimated Roll", True),
        ((ROLL, f"{ROLL}    summary: New.\n"), "Estimated Roll", False),
        (("unit: deg", "unit: rad"), "Estimated Roll: Roll Angle", True),
        (("raw*0.01", "raw*0.02"), "Estimated Roll: Roll Angle", True),
        (("raw*0.01", "raw*0.02"), "Estimated Roll: Mode", False),
        (("type: int,", "type: uint,"), "Estimated Roll: Roll Angle", True),
        (("at: 16, bits: 4", "at: 18, bits: 4"), "Estimated Roll: Mode", False),
        (("value: 0", "value: 3"), "Mode: Idle", False),
        (("name: Idle", "name: Rest"), "Mode: Idle", True),
        (("name: Idle", "name: Rest"), "Mode: Run", False),
    ],
)
def test_names_can_only_differ_if_something_differs_that_decides_them(
    compare, change, name, expected
):
    generated, pairs = compare(change)
    assert may_rename(pairs[name]) is expected
    if not expected:
        assert generated.renamed(pairs[name]) == []


@pytest.mark.parametrize(
    ("language", "scope", "stem"),
    [
        ("c", "modules of x", None),
        ("c", "files of x", None),
        ("c", "file scope", ""),
        ("c", "members of demo_status_t", "demo_status"),
        ("c", "members of DEMO_T_t", "demo_t"),
        ("python", "members of demo.Status", "Status"),
        ("rust", "members of Status", "Status"),
    ],
)
def test_a_member_is_mentioned_together_with_its_type(language, scope, stem):
    assert _stem(language, scope) == stem
