"""Value names become members with unique names, special values, or shared
enumerations.
"""

from __future__ import annotations

import pytest

from icdgen.definitions.enumerations import (
    Enumerations,
    is_enumeration,
    members,
    special,
)
from icdgen.definitions.model import Definitions
from tests.limits import assert_limits


def findings(notes):
    return [
        (finding.code, finding.severity, finding.message, finding.help)
        for finding in notes.import_findings
    ]


def test_consecutive_values_of_one_name_are_a_range():
    notes = Definitions("")
    choices = {5: "B", 3: "A", 1: "A", 2: "A", 4: " ", 0: "Off\n"}
    assert members(choices, 0, 7, "`Mode`", notes) == [
        {"value": 0, "name": "Off"},
        {"value": 1, "to": 3, "name": "A"},
        {"value": 5, "name": "B"},
    ]
    assert not notes.import_findings


def test_equal_names_get_their_value_and_are_reported():
    notes = Definitions("")
    choices = {0: "A", 2: "A", 3: "A", 5: "A 2", 7: "B"}
    assert members(choices, 0, 7, "`Mode`", notes) == [
        {"value": 0, "name": "A 0"},
        {"value": 2, "to": 3, "name": "A 2 of `Mode`"},
        {"value": 5, "name": "A 2"},
        {"value": 7, "name": "B"},
    ]
    assert findings(notes) == [
        (
            "IMP073",
            "warning",
            "`Mode`: `A` is the name of 0, 2",
            "each is imported with its value behind the name",
        )
    ]


@pytest.mark.parametrize(
    ("outside", "shown"),
    [
        ([8], "8"),
        ([-1, 8], "-1, 8"),
        ([8, 9, 10, 11, 12], "8, 9, 10, 11, 12"),
        ([8, 9, 10, 11, 12, 13], "8, 9, 10, 11, 12 ..."),
    ],
)
def test_names_of_values_out_of_range_are_left_out_and_reported(outside, shown):
    notes = Definitions("")
    choices = dict.fromkeys(outside, "Far") | {0: "First", 7: "Last"}
    assert members(choices, 0, 7, "`Mode`", notes) == [
        {"value": 0, "name": "First"},
        {"value": 7, "name": "Last"},
    ]
    message = f"`Mode`: it never has the value {shown}, which has a name"
    assert findings(notes) == [
        ("IMP074", "warning", message, "the name is left out"),
    ]


def test_a_name_has_at_most_400_characters():
    def is_kept(length):
        (member,) = members({0: "a" * length}, 0, 7, "`Mode`", Definitions(""))
        return member["name"] == "a" * length

    assert_limits(is_kept, most=400)


ZERO_TO_TWO = [{"value": 0, "to": 1, "name": "A"}, {"value": 2, "name": "B"}]
AROUND_ZERO = [{"value": -1, "name": "A"}, {"value": 0, "to": 1, "name": "B"}]


@pytest.mark.parametrize(
    ("item", "named", "expected"),
    [
        ({"type": "uint"}, ZERO_TO_TWO, True),
        ({"type": "uint"}, [], False),
        ({"type": "float"}, ZERO_TO_TWO, False),
        ({"type": "bool"}, ZERO_TO_TWO, False),
        ({"type": "uint", "formula": "raw*2"}, ZERO_TO_TWO, False),
        ({"type": "uint", "points": []}, ZERO_TO_TWO, False),
        ({"type": "int"}, ZERO_TO_TWO, False),
        ({"type": "int"}, AROUND_ZERO, True),
        # With unit or limits only if each value has a name.
        ({"type": "uint", "unit": "V"}, ZERO_TO_TWO, False),
        ({"type": "uint", "unit": "V", "max": 2}, ZERO_TO_TWO, True),
        ({"type": "uint", "max": 3}, ZERO_TO_TWO, False),
        ({"type": "uint", "max": 2.5}, ZERO_TO_TWO, True),
        ({"type": "uint", "min": -9, "max": 2}, ZERO_TO_TWO, True),
        ({"type": "uint", "below": 3}, ZERO_TO_TWO, True),
        ({"type": "uint", "below": 2.5}, ZERO_TO_TWO, True),
        ({"type": "uint", "below": 3.5}, ZERO_TO_TWO, False),
        ({"type": "uint", "above": 0, "max": 2}, ZERO_TO_TWO[1:], False),
        ({"type": "uint", "above": 1, "max": 2}, ZERO_TO_TWO[1:], True),
        ({"type": "uint", "above": 1.5, "max": 2}, ZERO_TO_TWO[1:], True),
        ({"type": "uint", "above": 0.5, "max": 2}, ZERO_TO_TWO[1:], False),
        ({"type": "uint", "min": 1.5, "max": 2}, ZERO_TO_TWO[1:], True),
        ({"type": "int", "min": -1, "max": 1}, AROUND_ZERO, True),
        ({"type": "int", "min": -2, "max": 1}, AROUND_ZERO, False),
        ({"type": "uint", "min": 6}, [{"value": 6, "to": 7, "name": "A"}], True),
        ({"type": "uint", "min": 5}, [{"value": 6, "to": 7, "name": "A"}], False),
    ],
)
def test_a_quantity_is_an_enumeration_only_if_each_value_has_a_name(
    item, named, expected
):
    assert is_enumeration(item, 3, named) == expected


def test_each_value_of_a_range_is_a_special_value():
    assert special(ZERO_TO_TWO, "`Mode`", Definitions("")) == {
        "special": [
            {"value": 0, "meaning": "A 0"},
            {"value": 1, "meaning": "A 1"},
            {"value": 2, "meaning": "B"},
        ]
    }
    assert special([], "`Mode`", Definitions("")) == {}


@pytest.mark.parametrize("first", [0, 1])
def test_a_number_has_at_most_1024_special_values(first):
    def is_accepted(count):
        rest = [{"value": at, "name": f"N{at}"} for at in range(first)]
        long = {"value": first, "to": count - 2, "name": "Long"}
        notes = Definitions("")
        named = [*rest, long, {"value": count - 1, "name": "Last"}]
        values = special(named, "`Mode`", notes)["special"]
        if findings(notes):
            assert findings(notes) == [
                (
                    "IMP090",
                    "warning",
                    f"`Mode`: 1 of {len(named)} names are left out, from `Last` on",
                    "a number has at most 1,024 special values: put the names into its `summary`",
                )
            ]
            assert [value["value"] for value in values] == list(range(1024))
            return False
        assert [value["value"] for value in values] == list(range(count))
        return True

    assert_limits(is_accepted, most=1024)


def assigned(*uses):
    """Return the enumeration of each field, and the declared ones, for the name,
    owner and members of each field.
    """
    enums = Enumerations()
    items = [{} for _ in uses]
    for item, (name, owner, *texts) in zip(items, uses, strict=True):
        named = [{"value": value, "name": text} for value, text in enumerate(texts)]
        enums.assign_enumeration(item, name, owner, named)
    declared = {
        enum["name"]: [member["name"] for member in enum["members"]]
        for enum in enums.declared()
    }
    return [item["enum"] for item in items], declared


def test_fields_of_equal_name_and_values_share_an_enumeration():
    assert assigned(("Mode", "A", "Off"), ("Mode", "B", "Off")) == (
        ["Mode", "Mode"],
        {"Mode": ["Off"]},
    )


def test_enumerations_of_one_name_get_the_owner_and_then_a_number():
    uses = [
        ("Mode", "A", "Off"),
        ("Mode", "A", "On"),
        ("Mode", "B", "Off"),
        ("Mode", "A", "Off"),
        ("Mode", "A", "Idle"),
        ("State", "A", "On"),
    ]
    assert assigned(*uses) == (
        ["A Mode", "A Mode 2", "B Mode", "A Mode", "A Mode 3", "State"],
        {
            "A Mode": ["Off"],
            "A Mode 2": ["On"],
            "B Mode": ["Off"],
            "A Mode 3": ["Idle"],
            "State": ["On"],
        },
    )


def test_ranges_of_members_are_declared():
    enums, item = Enumerations(), {}
    enums.assign_enumeration(item, "Mode", "A", ZERO_TO_TWO)
    assert enums.declared() == [{"name": "Mode", "members": ZERO_TO_TWO}]


def test_an_enumeration_has_neither_unit_nor_limits():
    enums, notes = Enumerations(), Definitions("")
    names = {value: f"N{value}" for value in range(4)}
    item = {"type": "uint", "unit": "V", "min": 0, "max": 3, "above": -1, "below": 4}
    enums.assign_value_names(item, 2, names, "Mode", "A", "`Mode`", notes)
    enums.declared()
    assert item == {"type": "enum", "enum": "Mode"}
    text = {"type": "text"}
    enums.assign_value_names(text, 2, {9: "Far"}, "Mode", "A", "`Mode`", notes)
    assert text == {"type": "text"} and not notes.import_findings
