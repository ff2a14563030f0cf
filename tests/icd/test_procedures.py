"""Words of procedures: owners of values, and steps within steps."""

from __future__ import annotations

import pytest

from icdgen.icd.procedures import name_of, nested_steps


@pytest.mark.parametrize(
    ("value", "parts"),
    [
        ("offset", ("", "offset")),
        ("block.offset", ("block", "offset")),
        ("ready.Block Length", ("ready", "Block Length")),
        ("ready.Cells[0].State", ("ready", "Cells[0].State")),
        ("ready.", ("ready", "")),
    ],
)
def test_a_value_has_the_owner_in_front_of_the_first_dot(value, parts):
    assert name_of(value) == parts


def step(name: str, **keys) -> dict:
    return {"id": name, **keys}


def test_steps_within_a_step_follow_it_in_their_order():
    steps = [
        step("a", repeat=[step("b", repeat=[step("c")]), step("d")]),
        "no step",
        step(
            "e",
            missing={"each": [step("j")], "steps": [step("k")]},
            blocks={"steps": [step("h"), step("i")], "each": [step("f"), step("g")]},
            repeat="no list",
        ),
        step("l", blocks=[step("x")], missing=None),
    ]
    assert "".join(each["id"] for each in nested_steps(steps)) == "abcdefghijkl"


@pytest.mark.parametrize("steps", [None, {}, "steps", 0, ({"id": "a"},)])
def test_anything_but_a_list_has_no_steps(steps):
    assert list(nested_steps(steps)) == []
