"""Rules of limits of physical values: the interval that they leave, and the texts."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from types import SimpleNamespace

import pytest

from icdgen.icd.meanings import Limits
from icdgen.icd.rules.limits import Bounds, bounds
from tests.icd.files import codes, status
from tests.icd.rules.reported import reported

CHOICES = [None, Fraction(1), Fraction(2)]
ALL_LIMITS = [Limits(*four) for four in product(CHOICES, repeat=4)]
GRID = [Fraction(quarter, 4) for quarter in range(13)]


def satisfies(value: Fraction, limits: Limits) -> bool:
    """Return whether a value satisfies each limit."""
    return (
        (limits.min is None or value >= limits.min)
        and (limits.above is None or value > limits.above)
        and (limits.max is None or value <= limits.max)
        and (limits.below is None or value < limits.below)
    )


def is_within(value: Fraction, interval: Bounds) -> bool:
    low, high, above, below = interval
    is_low = low is not None and (value < low or (value == low and above))
    is_high = high is not None and (value > high or (value == high and below))
    return not is_low and not is_high


def test_bounds_contain_the_values_that_satisfy_all_limits():
    """A quarter of an integer is within each interval that has a value at all."""
    for limits in ALL_LIMITS:
        interval = bounds(SimpleNamespace(limits=limits))
        inside = [value for value in GRID if satisfies(value, limits)]
        assert [value for value in GRID if is_within(value, interval)] == inside
        assert interval.is_empty == (inside == []), limits


def test_a_field_without_limits_is_unbounded():
    interval = bounds(SimpleNamespace(limits=None))
    assert interval == (None, None, False, False)
    assert not interval.is_empty


def field(keys: str, type: str = "int", bits: int = 8) -> str:
    return status(f"at: 0, bits: {bits}, name: Angle, type: {type}, {keys}", length=1)


HELP = "correct them: `min` and `above` are lower limits, `max` and `below` are upper limits"  # fmt: skip


@pytest.mark.parametrize(
    ("keys", "marked", "shown"),
    [
        ("max: 3, min: 4", "3", "`min: 4` and `max: 3`"),
        ("below: 3, above: 3", "3", "`above: 3` and `below: 3`"),
        ("below: 3, max: 2, above: 4", "2", "`above: 4` and `max: 2` and `below: 3`"),
        (
            "below: 2, max: 9, above: 2, min: 1",
            "9",
            "`min: 1` and `above: 2` and `max: 9` and `below: 2`",
        ),
    ],
)
def test_limits_without_a_value_are_all_listed(keys, marked, shown, tmp_path):
    """Lower limits first, in any order of the file, and marked at an upper one."""
    text = f"{shown} leave no value for `Angle`"
    assert reported(tmp_path, field(keys), "ICD033") == [(9, marked, text, HELP)]


@pytest.mark.parametrize(
    ("keys", "key", "marked"),
    [
        ("below: 4, max: 3, above: 2, min: 1", "min", "1"),
        ("below: 4, max: 3, above: 2", "above", "2"),
        ("below: 4, max: 3", "max", "3"),
        ("below: 4", "below", "4"),
    ],
)
@pytest.mark.parametrize(("type", "bits"), [("bool", 1), ("bytes", 8), ("text", 8)])
def test_the_first_limit_of_a_type_without_numbers_is_reported(
    keys, key, marked, type, bits, tmp_path
):
    found = reported(tmp_path, field(keys, type, bits), "ICD033")
    text = f"`{key}` has no meaning for type `{type}`"
    assert found == [(9, marked, text, f"remove `{key}`")]


@pytest.mark.parametrize(
    ("keys", "type", "bits", "code"),
    [
        ("max: -1", "float", 32, None),
        ("max: -1", "uint", 32, "ICD034"),
        ("above: 1", "bool", 1, "ICD033"),
        ("max: -1", "bytes", 32, "ICD033"),
    ],
)
def test_only_integers_are_compared_with_raw_values(keys, type, bits, code, tmp_path):
    text = status(
        f"at: 0, bits: {bits}, name: A, type: {type}, {keys}", length=(bits + 7) // 8
    )
    assert codes(tmp_path, text) == ([code] if code else [])


@pytest.mark.parametrize(
    ("keys", "marked", "shown", "values"),
    [
        ("min: 128", "128", "`min: 128`", "-128 to 127"),
        ("above: 127", "127", "`above: 127`", "-128 to 127"),
        ("max: -129", "-129", "`max: -129`", "-128 to 127"),
        ("below: -128", "-128", "`below: -128`", "-128 to 127"),
        ("max: 300, above: 200", "200", "`above: 200` and `max: 300`", "-128 to 127"),
        ("above: 200, min: 201", "201", "`min: 201` and `above: 200`", "-128 to 127"),
        ("max: -200, below: -201", "-200", "`max: -200` and `below: -201`", "-128 to 127"),
        ("min: 65, formula: raw/2", "65", "`min: 65`", "-64 to 63.5"),
        ("min: 65, formula: 0-raw/2", "65", "`min: 65`", "-63.5 to 64"),
        ("above: 0.1, below: 0.2, formula: raw/3", "0.1", "`above: 0.1` and `below: 0.2`", "-42.6667 to 42.3333"),
    ],
)  # fmt: skip
def test_limits_beyond_the_values_of_a_field_are_listed_with_these(
    keys, marked, shown, values, tmp_path
):
    text = f"no value of `Angle` is within {shown}"
    assert reported(tmp_path, field(keys), "ICD034") == [
        (9, marked, text, f"its values go from {values}")
    ]
