"""Expressions of Kaitai Struct: conditions, linear formulas and counts."""

from __future__ import annotations

import pytest

from icdgen.definitions.kaitai_expressions import (
    Equality,
    Masked,
    counted,
    equalities,
    linear_function,
    number,
)
from icdgen.definitions.model import NotSupported


def comparison(path, value, mask=None, is_negated=False):
    return Equality(Masked(path, mask), value, is_negated)


@pytest.mark.parametrize(
    ("condition", "comparisons"),
    [
        ("flag", [comparison("flag", "true")]),
        ("not flag", [comparison("flag", "true", is_negated=True)]),
        ("a == 1", [comparison("a", "1")]),
        ("a != 1", [comparison("a", "1", is_negated=True)]),
        ("not (a) != 1", [comparison("a", "1")]),
        ("0x10 == a", [comparison("a", "0x10")]),
        ("kind.to_i == 2", [comparison("kind", "2")]),
        ("kind == kinds::power", [comparison("kind", "kinds::power")]),
        ("(head.flags & 0x13) == 3", [comparison("head.flags", "3", 0x13)]),
        ("(a == 1) and (flag)", [comparison("a", "1"), comparison("flag", "true")]),
        ("a == 1 and flag", [comparison("a", "1"), comparison("flag", "true")]),
        # Names contain the operator.
        ("command == 1", [comparison("command", "1")]),
        (
            "standby and operand != 2",
            [
                comparison("standby", "true"),
                comparison("operand", "2", is_negated=True),
            ],
        ),
    ],
)
def test_a_condition_is_a_conjunction_of_comparisons(condition, comparisons):
    assert equalities(condition) == comparisons


@pytest.mark.parametrize(
    "condition", ["a > 3", "a or b", "a + 1 == 3", "", "a == 1 and", "a[0] == 1"]
)
def test_another_condition_is_quoted_in_the_report(condition):
    with pytest.raises(NotSupported) as raised:
        equalities(condition)
    assert (
        str(raised.value)
        == f"it depends on `{condition}`, which is more than equalities of fields"
    )


def test_a_condition_has_at_most_400_characters():
    assert equalities("a" * 400) == [comparison("a" * 400, "true")]
    with pytest.raises(NotSupported):
        equalities("a" * 401)


@pytest.mark.parametrize(
    ("text", "value"),
    [("true", 1), ("False", 0), ("0x10", 16), ("-3", -3), ("kinds::power", 7)],
)
def test_a_compared_value_is_a_number_or_a_member(text, value):
    assert number(text, {"kinds": {3: "places", 7: "power"}}.__getitem__) == value


@pytest.mark.parametrize("text", ["'x'", "kinds::other", "1.5"])
def test_another_compared_value_is_not_supported(text):
    with pytest.raises(NotSupported, match="it depends on whether a field is"):
        number(text, {"kinds": {3: "places"}}.__getitem__)


@pytest.mark.parametrize(
    ("text", "is_integer", "function"),
    [
        ("a * 0.5 - 40", False, ("a", "raw*0.5 - 40")),
        ("(head.a - 3) / 2.0", True, ("head.a", "(raw - 3)/2.0")),
        ("a / 2", False, ("a", "raw/2")),
        ("a / 2", True, None),  # drops the remainder
        ("a ^ 2", False, None),  # exclusive or
        ("a * a", False, None),
        ("a * a + a", False, None),
        ("a + b", False, None),
        ("5", False, None),
        ("a * 0", False, None),
        ("a" * 400, False, ("a" * 400, "raw")),
        ("a" * 401, False, None),
    ],
)
def test_only_a_linear_function_of_one_field_is_a_formula(text, is_integer, function):
    assert linear_function(text, is_integer) == function


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("length", ("length", 0)),
        ("length - 4", ("length", -4)),
        ("2 + head.length", ("head.length", 2)),
        ("length * 2", None),
        ("length + 0.5", None),
        ("7", None),
    ],
)
def test_a_count_is_a_field_and_a_constant(text, count):
    assert counted(text) == count
