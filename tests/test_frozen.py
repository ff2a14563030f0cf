"""Classes that `icdgen.frozen` generates behave like `dataclasses` and
`typing.NamedTuple`: equality, hash, `repr` and construction.
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
    class Example:
        name: str
        at: int = 0
        source: list = dataclasses.field(
            default_factory=list, compare=False, repr=False
        )
        protocol: dict = dataclasses.field(default_factory=dict, hash=False)

    return Example


@pytest.mark.parametrize("dataclass", [dataclasses.dataclass, frozen])
def test_values_have_the_same_equality_hash_and_repr(dataclass):
    example = _fields(dataclass)
    assert (
        example("a", 1, [1]) == example("a", 1, [2])
        and example("a", 1) != example("a", 2)
        and example("a") != "a"
    )
    assert example("a") != example("a", protocol={1: 2})
    assert len({example("a", 1, [1]), example("a", 1, [2]), example("b")}) == 2
    assert hash(example("a", protocol={1: 2})) == hash(example("a"))
    assert repr(example("a", 1, [1])).endswith("Example(name='a', at=1, protocol={})")
    assert not hasattr(example("a"), "__dict__")


@pytest.mark.parametrize("dataclass", [dataclasses.dataclass, frozen])
def test_objects_are_constructed_alike(dataclass):
    @dataclass(frozen=True, kw_only=True)
    class Example:
        name: str
        at: int = 0
        source: list = dataclasses.field(default_factory=list)

    @dataclass(frozen=True)
    class More(Example):
        first: int

    first, second = Example(name="a"), Example(at=2, name="b", source=[1])
    assert (first.name, first.at, first.source, second.source) == (
        "a",
        0,
        [],
        [1],
    ) and first.source is not Example(name="a").source
    more = More(7, name="c")
    assert (more.first, more.name, more.at) == (7, "c", 0) and dataclasses.replace(
        more, at=3
    ) == More(7, name="c", at=3)
    for wrong in (
        lambda: Example("a"),
        lambda: Example(),
        lambda: Example(name="a", no=1),
        lambda: More(name="a"),
    ):
        with pytest.raises(TypeError):
            wrong()


def test_without_eq_an_object_is_only_equal_to_itself():
    @frozen(frozen=True, eq=False, repr=False)
    class Example:
        name: str

    assert Example("a") != Example("a") and len({Example("a"), Example("a")}) == 2


def test_a_field_of_another_class_is_never_equal():
    assert Member(1, "a") != Limits() and Member(1, "a") == Member(1, "a")
    assert dataclasses.replace(
        Scalar(name="a", at=0, bits=8, type="uint"), at=8
    ) == Scalar(name="a", at=8, bits=8, type="uint")


@pytest.mark.parametrize("base", [typing.NamedTuple, NamedTuple])
def test_named_tuples_behave_like_those_of_typing(base):
    class Example(base):
        """A range."""

        first: int
        last: int = 7

        @property
        def length(self) -> int:
            return self.last - self.first

        def __str__(self) -> str:
            return f"{self.first} to {self.last}"

    example = Example(2)
    assert example == (2, 7) == Example(first=2, last=7) and example.length == 5
    assert (str(example), repr(example)) == ("2 to 7", "Example(first=2, last=7)")
    assert example._replace(first=3).length == 4 and Example._field_defaults == {
        "last": 7
    }
    assert (Example.__name__, Example.__module__, Example.__doc__) == (
        "Example",
        __name__,
        "A range.",
    )
    for wrong in (
        lambda: Example(),
        lambda: Example(1, 2, 3),
        lambda: Example(1, no=2),
    ):
        with pytest.raises(TypeError):
            wrong()
    with pytest.raises(AttributeError):
        example.first = 3
