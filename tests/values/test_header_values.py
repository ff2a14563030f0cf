"""``--header ROLE=NUMBER``: values of header fields that the sender chooses."""

from __future__ import annotations

import pytest

from icdgen.errors import UserError
from icdgen.loading import load
from icdgen.protocol import facts
from icdgen.values.chosen import chosen_values
from tests.conftest import ROOT
from tests.limits import assert_limits

ICD = load([ROOT / "examples" / "links" / "mavlink2.yaml"]).icd
FACTS = facts.of(ICD, ICD.nodes[0])


def is_accepted(*texts: str) -> bool:
    try:
        chosen_values(FACTS, texts)
    except UserError:
        return False
    return True


def test_values_are_numbers_in_any_notation():
    chosen = ("source=9", " flags = 0x0A")
    assert chosen_values(FACTS, chosen) == {"source": 9, "flags": 10}
    assert chosen_values(FACTS, ()) == {}


def test_a_value_has_the_range_of_its_bits():
    assert_limits(lambda number: is_accepted(f"source={number}"), least=0, most=255)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("source", "does not fit"),
        ("source=", "does not fit"),
        ("source=x", "does not fit"),
        ("sauce=1", "has a field `sauce`"),
        ("=1", "has a field ``"),
    ],
)
def test_a_value_that_the_header_cannot_have_is_refused(text, words):
    with pytest.raises(UserError, match=words):
        chosen_values(FACTS, [text])
