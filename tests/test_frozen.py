"""Classes of the model are values: equal, hashed and shown as those of `dataclasses` are."""

from __future__ import annotations

import dataclasses

import pytest

from icdgen.frozen import dataclass as frozen
from icdgen.frozen import rare
from icdgen.icd.model import Field, Limits, Member


def _fields(dataclass):
    @dataclass(frozen=True, slots=True)
    class One:
        name: str
        at: int = 0
        source: list = dataclasses.field(default_factory=list, compare=False, repr=False)
        protocol: dict = dataclasses.field(default_factory=dict, hash=False)

    return One


@pytest.mark.parametrize("dataclass", [dataclasses.dataclass, frozen])
def test_values_compare_hash_and_show_themselves_alike(dataclass):
    one = _fields(dataclass)
    assert one("a", 1, [1]) == one("a", 1, [2]) and one("a", 1) != one("a", 2) and one("a") != "a"
    assert one("a") != one("a", protocol={1: 2})
    assert len({one("a", 1, [1]), one("a", 1, [2]), one("b")}) == 2
    assert hash(one("a", protocol={1: 2})) == hash(one("a"))
    assert repr(one("a", 1, [1])).endswith("One(name='a', at=1, protocol={})")
    assert not hasattr(one("a"), "__dict__")


def test_without_eq_an_object_is_equal_to_itself_alone():
    @frozen(frozen=True, eq=False, repr=False)
    class One:
        name: str

    assert One("a") != One("a") and len({One("a"), One("a")}) == 2


def test_a_field_of_another_class_is_never_equal():
    assert Member(1, "a") != Limits() and Member(1, "a") == Member(1, "a")
    assert dataclasses.replace(Field("a", 0, 8, "uint"), at=8) == Field("a", 8, 8, "uint")


@rare(frozen=True)
class Rare:
    """Few are made of it."""

    first: int
    second: str = "b"
    more: dict = dataclasses.field(default_factory=dict)


def test_an_object_of_a_rare_class_has_what_it_is_given_and_its_defaults():
    one, other = Rare(1), Rare(1, second="c")
    assert (one.first, one.second, one.more) == (1, "b", {}) and other.second == "c"
    assert one.more is not other.more and one != Rare(1)
    assert dataclasses.replace(one, first=2).first == 2


@pytest.mark.parametrize("given, named", [((), {}), ((1, "b", {}, 4), {}), ((1,), {"first": 2}), ((1,), {"fourth": 2})])
def test_a_rare_class_refuses_what_its_declaration_does_not_allow(given, named):
    with pytest.raises(TypeError, match="Rare is made of first, second, more"):
        Rare(*given, **named)


def test_what_is_given_by_name_only_is_not_taken_by_its_place():
    @rare(frozen=True, kw_only=True)
    class Named:
        only: int

    assert Named(only=1).only == 1
    with pytest.raises(TypeError):
        Named(1)
