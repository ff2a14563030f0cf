"""Enumerations are integers with names, and store values that have no name."""

from __future__ import annotations

import copy
import json
import pickle

import pytest


def test_every_member_has_the_value_and_the_name_of_the_manual(package):
    for node in package.icd.nodes:
        module = package.module(node.name)
        assert list(module.ENUMS) == [enum.name for enum in node.enums]
        for enum in node.enums:
            enumeration = getattr(module, module.ENUMS[enum.name])
            assert [(member.value, member.label) for member in enumeration] == [
                (end.value, m.name) for m in enum.members for end in m.ends
            ]
            assert all(member.is_known for member in enumeration)


@pytest.fixture(scope="module")
def mode(shipped):
    return shipped.module("cubeacp").ConModeSelect


@pytest.mark.parametrize("value", [77, 255, 256, 65535, (1 << 64) - 1])
def test_unknown_values_are_stored(mode, value):
    unknown = mode(value)
    assert unknown == value
    assert isinstance(unknown, mode)
    assert (unknown.name, unknown.label, unknown.is_known) == (
        f"UNKNOWN_{value}",
        "",
        False,
    )
    assert unknown not in list(mode)
    assert pickle.loads(pickle.dumps(unknown)) == unknown
    assert copy.deepcopy(unknown) == unknown
    assert json.dumps({"mode": unknown}) == f'{{"mode": {value}}}'


@pytest.mark.parametrize(
    ("value", "name"),
    [
        (-1, "UNKNOWN_MINUS_1"),
        (-(1 << 63), f"UNKNOWN_MINUS_{1 << 63}"),
        (2, "UNKNOWN_2"),
    ],
)
def test_unknown_values_of_a_signed_enumeration_are_stored(odd, value, name):
    signed = odd.module("odd").Signed
    assert (signed(value), signed(value).name, signed(value).is_known) == (
        value,
        name,
        False,
    )
    assert pickle.loads(pickle.dumps(signed(value))) == value
    for value_out_of_range in (1 << 63, -(1 << 63) - 1):
        with pytest.raises(ValueError):
            signed(value_out_of_range)


def test_values_of_a_range_have_its_name_and_are_stored(odd):
    wide = odd.module("odd").WideEnum
    assert (wide.A_RANGE_FIRST, wide.A_RANGE_LAST) == (100, 200)
    assert [wide(value).label for value in (99, 100, 101, 199, 200, 201)] == [
        "",
        *['A " range'] * 4,
        "",
    ]
    assert (wide(150).name, wide(150).is_known, wide(150)) == ("A_RANGE_150", True, 150)
    assert pickle.loads(pickle.dumps(wide(150))).label == 'A " range' and wide(
        150
    ) is wide(150)


def test_an_unknown_value_is_always_the_same_object(mode):
    assert mode(200) is mode(200)


@pytest.mark.parametrize("value", [-1, 1 << 64, "1", None, 1.5])
def test_values_that_no_enumeration_can_store_are_refused(mode, value):
    with pytest.raises(ValueError):
        mode(value)


def test_members_are_printed_identically_by_every_python(mode):
    member = next(iter(mode))
    assert str(member) == f"{member}" == str(member.value)
    assert repr(member) == f"<ConModeSelect.{member.name}: {member.value}>"
