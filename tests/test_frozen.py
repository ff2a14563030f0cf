"""Classes of the model are values: equal, hashed and shown as those of `dataclasses`
are.
"""

from __future__ import annotations

import dataclasses
import typing

import pytest

from icdgen.frozen import NamedTuple
from icdgen.frozen import dataclass as frozen
from icdgen.icd.layout import Scalar
from icdgen.icd.model import Limits, Member


def _fields(dataclass):
    @dataclass(frozen=True, slots=True)
    class One:
        name: str
        at: int = 0
        source: list = dataclasses.field(
            default_factory=list, compare=False, repr=False
        )
        protocol: dict = dataclasses.field(default_factory=dict, hash=False)

    return One


@pytest.mark.parametrize("dataclass", [dataclasses.dataclass, frozen])
def test_values_compare_hash_and_show_themselves_alike(dataclass):
    one = _fields(dataclass)
    assert (
        one("a", 1, [1]) == one("a", 1, [2])
        and one("a", 1) != one("a", 2)
        and one("a") != "a"
    )
    assert one("a") != one("a", protocol={1: 2})
    assert len({one("a", 1, [1]), one("a", 1, [2]), one("b")}) == 2
    assert hash(one("a", protocol={1: 2})) == hash(one("a"))
    assert repr(one("a", 1, [1])).endswith("One(name='a', at=1, protocol={})")
    assert not hasattr(one("a"), "__dict__")


@pytest.mark.parametrize("dataclass", [dataclasses.dataclass, frozen])
def test_objects_begin_alike(dataclass):
    @dataclass(frozen=True, kw_only=True)
    class One:
        name: str
        at: int = 0
        source: list = dataclasses.field(default_factory=list)

    @dataclass(frozen=True)
    class More(One):
        first: int

    one, other = One(name="a"), One(at=2, name="b", source=[1])
    assert (one.name, one.at, one.source, other.source) == (
        "a",
        0,
        [],
        [1],
    ) and one.source is not One(name="a").source
    more = More(7, name="c")
    assert (more.first, more.name, more.at) == (7, "c", 0) and dataclasses.replace(
        more, at=3
    ) == More(7, name="c", at=3)
    for wrong in (
        lambda: One("a"),
        lambda: One(),
        lambda: One(name="a", no=1),
        lambda: More(name="a"),
    ):
        with pytest.raises(TypeError):
            wrong()


def test_without_eq_an_object_is_equal_to_itself_alone():
    @frozen(frozen=True, eq=False, repr=False)
    class One:
        name: str

    assert One("a") != One("a") and len({One("a"), One("a")}) == 2


def test_a_field_of_another_class_is_never_equal():
    assert Member(1, "a") != Limits() and Member(1, "a") == Member(1, "a")
    assert dataclasses.replace(
        Scalar(name="a", at=0, bits=8, type="uint"), at=8
    ) == Scalar(name="a", at=8, bits=8, type="uint")


@pytest.mark.parametrize("base", [typing.NamedTuple, NamedTuple])
def test_named_tuples_are_those_of_typing(base):
    class One(base):
        """A range."""

        first: int
        last: int = 7

        @property
        def length(self) -> int:
            return self.last - self.first

        def __str__(self) -> str:
            return f"{self.first} to {self.last}"

    one = One(2)
    assert one == (2, 7) == One(first=2, last=7) and one.length == 5
    assert (str(one), repr(one)) == ("2 to 7", "One(first=2, last=7)")
    assert one._replace(first=3).length == 4 and One._field_defaults == {"last": 7}
    assert (One.__name__, One.__module__, One.__doc__) == (
        "One",
        __name__,
        "A range.",
    )
    for wrong in (lambda: One(), lambda: One(1, 2, 3), lambda: One(1, no=2)):
        with pytest.raises(TypeError):
            wrong()
    with pytest.raises(AttributeError):
        one.first = 3
