"""A fact of the protocol is declared once.

The schema and the constants of the runtimes are generated from the declaration and must
be up to date.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import pytest

from icdgen.icd import schema
from icdgen.protocol.declared import (
    FactKind,
    facts_of,
    flag,
    number,
    octets,
    read_part,
    time,
)
from icdgen.protocol.sections import SECTIONS
from scripts.protocol_facts import ROOT, out_of_date

FACTS = [(path, fact) for part, path in SECTIONS.items() for fact in facts_of(part)]


def twice_the_pages(values):
    return values["pages"] * 2


@dataclass(frozen=True, kw_only=True)
class Book:
    pages: int = number("pages", "how many pages it has", 1, 9)
    sheets: int = octets("paper.sheets", "sheets of paper", default=twice_the_pages)
    lent: int = time("lent_ms", "how long it is lent", 5)
    back: bool = flag(
        "order", "whether it is read from the back", False, ("front", "back")
    )
    bound: bool = flag(
        "in", "whether it is bound", False, ("paper", "leather"), "leather"
    )


def test_schema_and_runtimes_are_generated_from_the_declarations():
    late = [str(path.relative_to(ROOT)) for path in out_of_date()]
    assert late == [], "run `python -m scripts.protocol_facts`"


def test_a_fact_that_an_icd_omits_has_the_declared_default():
    assert read_part(Book, {"pages": 3}) == Book(
        pages=3, sheets=6, lent=5, back=False, bound=False
    )


def test_a_value_of_an_icd_is_read_in_the_unit_of_the_fact():
    given = {
        "pages": 3,
        "paper": {"sheets": 4},
        "lent_ms": 2000,
        "order": "back",
        "in": ["paper", "leather"],
    }
    assert read_part(Book, given) == Book(
        pages=3, sheets=4, lent=2000, back=True, bound=True
    )


def test_without_a_key_that_has_no_default_the_part_is_not_described():
    assert read_part(Book, {"lent_ms": 2}) is None


def test_a_part_has_its_facts_in_the_order_in_which_they_are_declared():
    assert [fact.name for fact in facts_of(Book)] == [
        field.name for field in fields(Book)
    ]


@pytest.mark.parametrize(
    ("path", "fact"),
    [(path, fact) for path, fact in FACTS if fact.key and fact.most is not None],
)
def test_the_schema_has_the_limits_of_each_fact(path, fact):
    section = schema.protocol_schema()
    for key in f"{path}.{fact.key}".split("."):
        section = (
            section["additionalProperties"]
            if key == "*"
            else section["properties"][key]
        )
    if fact.kind is FactKind.OCTET:
        section = schema._follow(section)
    assert (section["minimum"], section["maximum"]) == (fact.least, fact.most)


def test_every_fact_has_a_description_and_a_range_that_its_type_can_hold():
    for path, fact in FACTS:
        assert fact.about and not fact.about.endswith("."), (path, fact.name)
        assert (fact.most or 0) <= fact.holds, (path, fact.name)
