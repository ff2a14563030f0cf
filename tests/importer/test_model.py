"""Bits that the fields of a message cover, and the lists of its node."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.import_results.findings import SourcePlace
from icdgen.importer.descriptions import Described
from icdgen.importer.document import SourceTable
from icdgen.importer.model import (
    Extent,
    Listed,
    NodeParts,
    ReadEnum,
    ReadField,
    ReadList,
    ReadLog,
    ReadMessage,
    ReadStruct,
)

TABLE = SourceTable(number=1)


def field(at: int, bits: int, count: int = 0, **facts) -> ReadField:
    spot = SourcePlace(line=5)
    return ReadField("Rate", at, bits, "uint", Described(), spot, count, facts=facts)


def message(length: int | None, *fields: ReadField, **keys) -> ReadMessage:
    return ReadMessage(
        "State", "telemetry", TABLE, length=length, fields=list(fields), **keys
    )


@pytest.mark.parametrize(
    ("item", "end"),
    [
        (field(8, 16), 24), (field(8, 16, 1), 24), (field(8, 16, 3), 56),
        (field(8, 16, count=2), 40), (field(8, 16, up_to=4), 8),
        (field(8, 16, 3, up_to=0), 8),
    ],
)  # fmt: skip
def test_a_field_ends_behind_all_its_elements_of_a_fixed_number(item, end):
    assert item.end == end


def test_the_number_of_elements_in_the_facts_precedes():
    item = field(0, 8, 3)
    item.facts["count"] = 5
    assert item.end == 40


def test_bits_have_other_numbers_in_the_other_bit_order():
    extent = Extent(6, 10, "lsb0")
    assert extent.numbers_in("lsb0") == [6, 7, 8, 9]
    assert extent.numbers_in("msb0") == [1, 0, 15, 14]


FIELDS = st.lists(st.tuples(st.integers(0, 40), st.integers(1, 9), st.booleans()))


@given(st.integers(0, 5), FIELDS, FIELDS, st.sampled_from(["lsb0", "msb0"]))
def test_gaps_are_the_bits_that_nothing_covers(length, fields, reserved, bit_order):
    other = "msb0" if bit_order == "lsb0" else "lsb0"
    read = message(length, bit_order=bit_order)
    covered = set()
    for source, items in (("field", fields), ("reserved", reserved)):
        for at, size, is_other in items:
            order = other if is_other else bit_order
            if source == "field":
                facts = {"bit_order": order} if is_other else {}
                read.fields.append(field(at, size, **facts))
            else:
                read.reserved.append(Extent(at, at + size, order))
            for bit in range(at, at + size):
                covered.add(bit // 8 * 8 + 7 - bit % 8 if is_other else bit)
    free = [bit for bit in range(8 * length) if bit not in covered]
    shown = [bit for first, last in read.gaps for bit in range(first, last + 1)]
    assert shown == free
    runs = pairwise(read.gaps)
    assert all(a[1] + 1 < b[0] for a, b in runs)


RESERVED = Extent(16, 32, "lsb0")


@pytest.mark.parametrize(
    ("read", "number"),
    [
        (message(4, field(0, 16), reserved=[RESERVED]), 2),
        (message(4, field(0, 9), reserved=[Extent(9, 32, "lsb0")]), 2),
        (message(4, field(0, 8), reserved=[Extent(8, 32, "lsb0")]), 3),
        (message(4, reserved=[Extent(0, 32, "lsb0")]), 4),
        # A gap within the used bytes does not matter, one behind them does.
        (message(4, field(0, 4), field(8, 8), reserved=[RESERVED]), 2),
        (message(4, field(0, 16), reserved=[Extent(16, 31, "lsb0")]), 0),
        (message(4, field(0, 16), reserved=[Extent(24, 32, "lsb0")]), 0),
        (message(4, field(0, 16)), 0), (message(2, field(0, 16)), 0),
        (message(1, field(0, 16)), 0),
        (message(None, field(0, 16), reserved=[RESERVED]), 0),
        (message(4, field(0, 16), field(16, 8, up_to=2), reserved=[RESERVED]), 0),
    ],
)  # fmt: skip
def test_bytes_at_the_end_are_reserved_if_nothing_else_is_in_them(read, number):
    assert read.reserved_bytes == number


def test_all_fields_are_those_of_the_message_and_of_each_struct():
    fields = [field(at, 8) for at in (0, 8, 16, 24)]
    structs = [ReadStruct("A", 1, fields[1:2]), ReadStruct("B", 2, fields[2:])]
    read = message(4, fields[0], structs=structs)
    assert [item.at for item in read.all_fields] == [0, 8, 16, 24]
    read.id, read.set_id, read.get_id = 1, 2, 3
    assert read.ids == (1, 2, 3)


def test_contents_are_in_the_list_of_their_class():
    contents = [message(1), ReadEnum("A", [], TABLE), ReadList("", "", []), ReadLog([])]
    for index, content in enumerate(contents):
        parts = NodeParts("pump", "Pump")
        parts.add_content(content)
        lists = [parts.messages, parts.enums, parts.lists, parts.logs]
        expected = [[content] if at == index else [] for at in range(4)]
        assert lists == expected
        # A list alone is no content of an ICD.
        assert parts.has_contents is (index != 2)
    assert not NodeParts("pump", "Pump").has_contents
    missing = Listed("telemetry", "A", None, 1, None, None, "", SourcePlace())
    assert not NodeParts("pump", "Pump", missing=[missing]).has_contents
