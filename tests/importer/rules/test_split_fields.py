"""Parts of split fields are joined, and bits get numbers in the order of the node."""

from __future__ import annotations

import pytest

from icdgen.import_results.findings import SourcePlace
from icdgen.importer.descriptions import Described
from icdgen.importer.rules.bit_order import ORDERS, Order, bits_of
from icdgen.importer.rules.cells import Roles
from icdgen.importer.rules.fields import FieldDraft
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.rows import DataRow
from icdgen.importer.rules.split_fields import joined_parts
from tests.importer.rules.small import rule, table

LITTLE, BIG = Order("little", "lsb0"), Order("big", "msb0")
BIG_LSB = Order("big", "lsb0")


def draft(name: str, at: int, bits: int, part=None, **keys) -> FieldDraft:
    row = Roles({}, DataRow({}, table("x").rows[0]))
    spot = SourcePlace(line=at)
    return FieldDraft(name, at, bits, "uint", Described(), spot, row, part=part, **keys)


def joined(*drafts, order=LITTLE, is_register=False, length=8):
    """Return name, first bit, size and order of each field, and the findings."""
    notes = Notes()
    fields = joined_parts(list(drafts), order, is_register, length, notes, rule())
    assert all(f.code == "IMP105" and f.place for f in notes.import_findings)
    return (
        [(f.name, f.at, f.bits, f.order) for f in fields],
        [(f.message, f.spot.line, f.help) for f in notes.import_findings],
    )


def test_fields_are_sorted_by_their_first_bits():
    drafts = [draft("B", 8, 4), draft("C", 12, 4), draft("A", 0, 8)]
    expected = [("A", 0, 8, None), ("B", 8, 4, None), ("C", 12, 4, None)]
    assert joined(*drafts) == (expected, [])


def test_parts_with_consecutive_numbers_are_one_field():
    low, high = draft("X", 6, 2, part=(0, 1)), draft("X", 9, 3, part=(3, 5))
    middle = draft("X", 8, 1, part=(2, 2))
    assert joined(high, draft("A", 0, 6), low, middle) == (
        [("A", 0, 6, None), ("X", 6, 6, None)],
        [],
    )


@pytest.mark.parametrize(
    ("parts", "numbers"),
    [
        (((0, 1), (3, 4)), "1:0, 4:3"),
        (((3, 3), (0, 1)), "1:0, 3"),
        (((0, 1), (1, 2)), "1:0, 2:1"),
        (((2, 2), (2, 2)), "2, 2"),
    ],
)
def test_parts_with_a_gap_or_an_overlap_are_no_field(parts, numbers):
    drafts = [
        draft("X", 10 * (1 + index), 1 + last - first, part=(first, last))
        for index, (first, last) in enumerate(parts)
    ]
    line = 10 if parts[0] <= parts[1] else 20
    help = "a part is missing, or two have the same number: compare with the table"
    message = f"the parts {numbers} of `X` are not consecutive"
    # Another field of the same name remains.
    assert joined(draft("X", 0, 3), *drafts) == (
        [("X", 0, 3, None)],
        [(message, line, help)],
    )


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("other", ORDERS)
def test_bits_in_another_order_give_the_field_an_order_of_its_own(order, other):
    bits = bits_of(8, 16, other)
    result, findings = joined(draft("X", 0, 16, frame_bits=bits), order=order)
    # In whole bytes, the byte order alone decides.
    assert findings == []
    ((_, at, size, own),) = result
    assert (at, size) == (8, 16)
    assert bits_of(at, size, own or order) == bits
    assert own != order


def test_bits_that_are_consecutive_in_no_order_are_reported():
    bits = [(0, 0), (0, 2)]
    help = "state the byte order of the node, or read the parts as fields of their own"
    assert joined(draft("X", 3, 2, frame_bits=bits), draft("A", 8, 8)) == (
        [("A", 8, 8, None)],
        [("the bits of `X` are not consecutive in any order", 3, help)],
    )


def test_bits_of_a_register_are_counted_from_its_last_byte():
    assert joined(draft("X", 0, 8), order=BIG, is_register=True, length=2)[0] == [
        ("X", 8, 8, None)
    ]
    assert joined(draft("X", 12, 4), order=BIG_LSB, is_register=True, length=2)[0] == [
        ("X", 4, 4, None)
    ]
    assert joined(draft("X", 0, 8), order=LITTLE, is_register=True, length=2)[0] == [
        ("X", 0, 8, None)
    ]


def test_elements_of_arrays_and_rests_stay_where_they_are_printed():
    array = draft("X", 4, 3, count=5)
    rest = draft("Y", 24, 8, facts={"count": "rest"})
    assert joined(array, rest, order=BIG_LSB) == (
        [("X", 4, 3, None), ("Y", 24, 8, None)],
        [],
    )


def test_an_array_with_bit_numbers_in_a_range_of_bytes_is_reported():
    array = draft("X", 4, 3, count=2, frame_bits=[(0, 4), (0, 5)])
    help = "give the position of an array by its first byte only"
    assert joined(array) == (
        [],
        [
            (
                "the elements of the array `X` have bit numbers in a range of bytes",
                4,
                help,
            )
        ],
    )
