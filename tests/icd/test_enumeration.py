"""Members of enumerations: ranges, widths, and numbers without a member."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from icdgen.icd.enumeration import Enum, Member
from icdgen.icd.layout import integer_range


def enum(*ranges: tuple[int, int | None]) -> Enum:
    members = [Member(value, f"M{n}", to=to) for n, (value, to) in enumerate(ranges)]
    return Enum("Kind", tuple(members))


def test_a_member_has_the_values_of_its_range():
    single, several = Member(3, "Three"), Member(-2, "Some", to=0)
    assert (single.last, single.values) == (3, "3")
    assert (several.last, several.values) == (0, "-2 to 0")


def test_code_has_constants_for_both_ends_of_a_range():
    single = Member(3, "Three", "Tres")
    assert single.ends == (single,)
    several = Member(1, "Some", summary="Few.", to=4, aliases=("s",))
    assert several.ends == (
        Member(1, "Some", "Some first", "Few.", aliases=("s",)),
        Member(4, "Some", "Some last", "Few.", aliases=("s",)),
    )
    named = Member(0, "Some", "Any", to=0)
    assert [end.identifier for end in named.ends] == ["Any first", "Any last"]


def test_the_first_member_with_a_value_names_it():
    kind = enum((4, 6), (0, None), (6, 8))
    names = [member and member.name for member in map(kind.member_of, range(-1, 10))]
    assert names == [None, "M1", None, None, None, "M0", "M0", "M0", "M2", "M2", None]
    assert kind.member_of(b"\4") is None


@settings(max_examples=60)
@given(
    st.lists(
        st.tuples(st.integers(-40, 40), st.none() | st.integers(0, 30)).map(
            lambda pair: (pair[0], None if pair[1] is None else pair[0] + pair[1])
        ),
        min_size=1,
        max_size=6,
    )
)
def test_a_field_of_these_bits_holds_all_values_and_no_narrower_one_does(ranges):
    kind = enum(*ranges)
    ends = [end for member in kind.members for end in (member.value, member.last)]
    assert kind.signed == (min(ends) < 0)

    def fits(bits: int, *values: int) -> bool:
        low, high = integer_range(bits, kind.signed)
        return all(low <= value <= high for value in values)

    assert fits(kind.bits, *ends)
    assert kind.bits <= 1 or not fits(kind.bits - 1, *ends)
    for value in ends:
        bits = kind.bits_for(value)
        # 0 bits represent the value 0 of an unsigned field.
        assert fits(max(bits, 1), value) and (bits <= 1 or not fits(bits - 1, value))
    widest = kind.widest
    assert kind.bits == max(kind.bits_for(widest.value), kind.bits_for(widest.last))
    taken = {n for member in kind.members for n in range(member.value, member.last + 1)}
    assert kind.unnamed == next(n for n in range(100) if n not in taken)


def test_the_widest_member_is_that_with_the_last_value_of_all():
    assert enum((0, 9), (5, None)).widest.name == "M0"
    assert enum((5, None), (0, 9)).widest.name == "M1"
    assert enum((-9, None), (7, None)).widest.name == "M0"
    assert enum((-8, None), (7, None)).widest.name == "M1"


def test_an_enumeration_without_members_has_one_bit_and_no_widest_member():
    assert (enum().bits, enum().widest, enum().unnamed) == (1, None, 0)
    assert not enum().signed


@pytest.mark.parametrize(
    ("ranges", "unnamed"),
    [
        ([(0, 2**64 - 2)], 2**64 - 1),
        ([(0, 2**64 - 1)], None),
        ([(1, 2**64 - 1)], 0),
        ([(-5, -1)], 0),
    ],
)
def test_a_number_without_a_member_has_at_most_64_bits(ranges, unnamed):
    assert enum(*ranges).unnamed == unnamed
