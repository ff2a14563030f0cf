"""Facts of the protocol are initialisers of the types in the runtime for C."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.backends.c.facts import TableRow, fact_value, has_presence_flag
from icdgen.backends.c.kinds import length_type
from icdgen.protocol.declared import U16, U32, FactKind, ProtocolFact
from tests.limits import assert_limits


def fact(kind, **more):
    return ProtocolFact("rate", kind, "rate", "rate", **more)


@pytest.mark.parametrize(
    ("kind", "value", "text"),
    [
        (FactKind.NUMBER, 1000, "1000u"),
        (FactKind.SIZE, 12, "12u"),
        (FactKind.TIME, 50, "50u"),
        (FactKind.OCTET, 5, "0x05u"),
        (FactKind.OCTET, 0xC0, "0xc0u"),
        (FactKind.CODE, 0x1021, "0x1021u"),
        (FactKind.CODE, 5, "0x5u"),
        (FactKind.FLAG, True, "true"),
        (FactKind.FLAG, False, "false"),
        (FactKind.SPAN, (3, 2), "{3u, 2u}"),
        (FactKind.BUSES, ("uart", "can"), "5u"),
        (FactKind.BUSES, ("i2c",), "2u"),
        (FactKind.BUSES, (), "0u"),
    ],
)
def test_a_value_is_spelled_as_its_kind(kind, value, text):
    assert fact_value(fact(kind), value) == text


@pytest.mark.parametrize(
    ("more", "unknown", "zero"),
    [
        # Without 0 as a valid value, 0 means that the value is unknown.
        ({"least": 1}, "0u", "0u"),
        ({"least": 0, "holds": U16}, "-1", "0"),
        ({"least": 0, "holds": U32}, "false, 0u", "true, 0u"),
    ],
)
def test_an_unknown_value_differs_from_each_valid_value(more, unknown, zero):
    optional = fact(FactKind.NUMBER, default=None, **more)
    assert fact_value(optional, None) == unknown
    assert fact_value(optional, 0) == zero


def test_a_presence_flag_is_needed_if_no_negative_value_is_left():
    def is_minus_one(holds):
        return not has_presence_flag(fact(FactKind.NUMBER, default=None, holds=holds))

    assert_limits(is_minus_one, most=0x7FFF_FFFF)
    assert not has_presence_flag(fact(FactKind.NUMBER, default=7))
    assert not has_presence_flag(fact(FactKind.NUMBER, default=None, least=1))


@pytest.mark.parametrize(
    ("row", "text"),
    [
        (TableRow("{1u}"), "{1u},"),
        (TableRow("{1u}", "Reset"), "{1u}, /* Reset */"),
        (
            TableRow("{1u}", "Reset", "USE_RESET"),
            "#if USE_RESET\n        {1u}, /* Reset */\n#endif",
        ),
    ],
)
def test_a_row_of_a_table_has_its_comment_and_its_condition(row, text):
    assert str(row) == text


def link_of(longest, *fields, overhead=0):
    packet = SimpleNamespace(
        fields=[
            SimpleNamespace(role=role, mask=mask, unit=unit, plus=plus)
            for role, mask, unit, plus in fields
        ],
        overhead=overhead,
    )
    stream = SimpleNamespace(longest=longest, packets=[packet])
    return SimpleNamespace(facts=SimpleNamespace(stream=stream))


@pytest.mark.parametrize("role", ["length", "response_length"])
def test_lengths_have_64_bits_if_a_length_field_says_more_than_31_bits(role):
    def is_small(largest, unit=1, plus=0, overhead=0):
        mask = (largest - abs(plus) - overhead) // unit
        link = link_of(0, (role, mask, unit, plus), overhead=overhead)
        return length_type([link]) == "int_fast32_t"

    most = 0x7FFF_FFFF
    assert_limits(is_small, most=most)
    assert_limits(lambda n: is_small(n, plus=-6, overhead=9), most=most)
    assert_limits(lambda n: is_small(n, plus=6), most=most)
    assert_limits(lambda n: is_small(n, unit=4, plus=3), most=most, step=4)


def test_lengths_depend_on_the_longest_packet_but_not_on_other_fields():
    def type_of(link):
        return length_type([SimpleNamespace(facts=SimpleNamespace(stream=None)), link])

    assert_limits(
        lambda longest: type_of(link_of(longest)) == "int_fast32_t", most=0x7FFF_FFFF
    )
    assert type_of(link_of(0, ("id", 1 << 40, 1, 0))) == "int_fast32_t"
    assert length_type([]) == "int_fast32_t"
