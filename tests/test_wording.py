"""Numbers, names and lists in sentences of messages."""

from __future__ import annotations

from icdgen.wording import count, listing, quote
from tests.limits import assert_limits


def test_a_name_of_up_to_60_characters_is_quoted_whole():
    assert_limits(lambda size: quote("x" * size) == f"`{'x' * size}`", most=60)
    assert quote("x" * 61) == f"`{'x' * 57}...`"
    assert quote(7) == "`7`" and quote("") == "``"


def test_a_number_has_a_noun_in_the_plural_unless_it_is_1():
    texts = [count(number, "bit") for number in (0, 1, 2, 1000)]
    assert texts == ["0 bits", "1 bit", "2 bits", "1,000 bits"]


def test_a_list_has_an_and_before_its_last_item():
    lists = [listing("a"), listing("ab"), listing("abc")]
    assert lists == ["a", "a and b", "a, b and c"]
