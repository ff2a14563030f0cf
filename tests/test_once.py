"""A cached value is computed once for each object."""

from __future__ import annotations

from icdgen.once import cached_by_owner, cached_property


class Owner:
    def __init__(self, value: int | None) -> None:
        self.value, self.calls = value, 0

    @cached_property
    def doubled(self) -> int | None:
        """Twice the value."""
        self.calls += 1
        return self.value and 2 * self.value


@cached_by_owner
def halved(owner: Owner) -> int | None:
    """Half the value."""
    owner.calls += 1
    return owner.value and owner.value // 2


def test_a_cached_property_is_computed_once_for_each_object():
    owner, other = Owner(4), Owner(5)
    assert (owner.doubled, owner.doubled, other.doubled) == (8, 8, 10)
    assert (owner.calls, other.calls) == (1, 1)
    assert owner.__dict__["doubled"] == 8
    assert Owner.doubled.__doc__ == "Twice the value."


def test_a_function_of_an_object_is_computed_once_for_each_object():
    owner, other = Owner(4), Owner(6)
    assert (halved(owner), halved(owner), halved(other)) == (2, 2, 3)
    assert (owner.calls, other.calls) == (1, 1)
    assert halved.__name__ == "halved"
    # It ends with the object: another object may get the same address.
    assert owner.__dict__["_halved"] == 2


def test_none_and_zero_are_cached_too():
    for value in (None, 0):
        owner = Owner(value)
        assert [halved(owner), halved(owner), owner.doubled, owner.doubled] == [
            value
        ] * 4
        assert owner.calls == 2


def test_two_functions_have_separate_values():
    @cached_by_owner
    def negated(owner: Owner) -> int:
        return -owner.value

    owner = Owner(4)
    assert (negated(owner), halved(owner), negated(owner)) == (-4, 2, -4)
