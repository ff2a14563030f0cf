"""Fields by bit position get the order of the message or their own order, and
overlapping fields become overlay fields.
"""

from __future__ import annotations

import pytest

from icdgen.definitions.frames import (
    BIG,
    LITTLE,
    FrameBits,
    laid_out,
    usual_order,
    values_of_condition,
)
from icdgen.definitions.model import Definitions


def uint(name, **more):
    return {"name": name, "type": "uint", **more}


def message_of(*placed, length=8, order=LITTLE):
    """Return the message of these fields, and code and text of each finding."""
    to = Definitions("a.dbc")
    fields = [(field, FrameBits(*place)) for field, place in placed]
    message = laid_out({"name": "Status", "length": length}, fields, order, to)
    return message, [
        (each.code, each.severity, each.message, each.help)
        for each in to.import_findings
    ]


def rows(message):
    return [
        (field["name"], field["at"], field["bits"], field.get("view"))
        for field in message["fields"]
    ]


def mask_by_text(place):
    """Return the mask from bytes that are written as text of binary digits."""
    numbered = "".join(
        "1" if place.at <= at < place.at + place.bits else "0" for at in range(32)
    )
    octets = [numbered[at : at + 8] for at in range(0, 32, 8)]
    if place.order == LITTLE:
        octets = [octet[::-1] for octet in octets]
    return sum(int(octet, 2) << 8 * number for number, octet in enumerate(octets))


def test_a_mask_has_the_bits_of_each_byte_in_either_order():
    for order in (LITTLE, BIG):
        for at in range(20):
            for bits in range(1, 12):
                place = FrameBits(at, bits, order)
                assert place.mask == mask_by_text(place), place


def test_bits_within_a_byte_are_the_same_bits_in_the_other_order():
    for at in range(20):
        for bits in range(1, 12):
            place = FrameBits(at, bits, LITTLE)
            other = place.counted(BIG)
            is_within = at % 8 + bits <= 8
            assert place.is_within_byte == is_within
            assert other.order == (BIG if is_within else LITTLE)
            assert other.mask == place.mask and other.bits == bits
            assert other.counted(LITTLE) == place
            assert place.counted(LITTLE) is place


@pytest.mark.parametrize(
    ("places", "order"),
    [
        ((), LITTLE), ([(0, 16, BIG)], BIG), ([(0, 16, BIG), (16, 16, LITTLE)], LITTLE),
        ([(0, 16, BIG), (16, 16, LITTLE), (39, 2, BIG)], BIG),
        # Fields within a byte have no byte order.
        ([(0, 8, BIG), (8, 1, BIG), (16, 16, LITTLE)], LITTLE),
        ([(0, 8, LITTLE), (8, 1, LITTLE), (16, 16, BIG)], BIG),
    ],
)  # fmt: skip
def test_the_order_of_a_device_is_that_of_most_fields_of_several_bytes(places, order):
    assert usual_order(FrameBits(*place) for place in places) == order


def test_fields_come_by_position_and_state_an_order_that_differs_from_the_message():
    message, findings = message_of(
        (uint("Array", count=2), (40, 4, BIG)),
        (uint("Big", min=0), (24, 16, BIG)),
        (uint("Flag"), (16, 1, BIG)),
        (uint("Little"), (0, 16, LITTLE)),
    )
    big = {"byte_order": "big", "bit_order": "msb0"}
    assert findings == []
    assert message == {
        "name": "Status",
        "length": 8,
        "reserved": 2,
        "fields": [
            {"at": 0, "bits": 16, **uint("Little")},
            # Bit 0 of a byte counted from the most significant one is its bit 7.
            {"at": 23, "bits": 1, **uint("Flag")},
            {"at": 24, "bits": 16, **uint("Big", min=0), **big},
            # Another order would reverse the elements.
            {"at": 40, "bits": 4, **uint("Array", count=2), **big},
        ],
    }


@pytest.mark.parametrize("order", [LITTLE, BIG])
def test_a_message_states_the_order_of_all_its_fields_of_several_bytes(order):
    other = LITTLE if order == BIG else BIG
    keys = {
        LITTLE: {"byte_order": "little", "bit_order": "lsb0"},
        BIG: {"byte_order": "big", "bit_order": "msb0"},
    }[other]
    message, _ = message_of(
        (uint("Flag"), (16, 3, order)),
        (uint("Speed"), (0, 12, other)),
        order=order,
    )
    assert message == {
        "name": "Status",
        "length": 8,
        **keys,
        "reserved": 5,
        "fields": [
            {"at": 0, "bits": 12, **uint("Speed")},
            {"at": 21, "bits": 3, **uint("Flag")},
        ],
    }


def test_the_mapping_of_a_field_stays_the_same_object():
    field = uint("Mode")
    message, _ = message_of((field, (0, 8, LITTLE)))
    assert message["fields"][0] is field


def test_a_message_without_fields_has_only_reserved_bytes():
    assert message_of(length=3)[0] == {"name": "Status", "length": 3, "reserved": 3}
    assert message_of(length=0)[0] == {"name": "Status", "length": 0}


def test_bytes_that_a_field_begins_are_not_reserved():
    for bits, reserved in ((8, 2), (9, 1), (16, 1), (17, None)):
        message, _ = message_of((uint("A"), (0, bits, LITTLE)), length=3)
        assert message.get("reserved") == reserved, bits


HELP = "the smaller ones are imported as overlay fields, which can be read but not set"


def test_the_smaller_of_overlapping_fields_is_an_overlay_field():
    message, findings = message_of(
        (uint("Small"), (4, 4, LITTLE)),
        (uint("Large"), (0, 16, LITTLE)),
        (uint("Beside"), (16, 4, LITTLE)),
    )
    assert rows(message) == [
        ("Large", 0, 16, None),
        ("Small", 4, 4, True),
        ("Beside", 16, 4, None),
    ]
    text = "message `Status`: `Small` and `Large` overlap"
    assert findings == [("IMP071", "warning", text, HELP)]


def test_the_first_of_equal_fields_that_overlap_owns_the_bits():
    message, _ = message_of(
        (uint("First"), (0, 8, LITTLE)), (uint("Second"), (0, 8, LITTLE))
    )
    assert rows(message) == [("First", 0, 8, None), ("Second", 0, 8, True)]


@pytest.mark.parametrize(
    ("count", "shown"),
    [
        (3, "`A0` and `Large`, `A1` and `Large`, `A2` and `Large`"),
        (4, "`A0` and `Large`, `A1` and `Large`, `A2` and `Large` and 1 more"),
    ],
)
def test_a_finding_shows_three_overlaps_and_counts_the_others(count, shown):
    small = [(uint(f"A{at}"), (at, 1, LITTLE)) for at in range(count)]
    _, findings = message_of((uint("Large"), (0, 8, LITTLE)), *small)
    assert [text for _, _, text, _ in findings] == [
        f"message `Status`: {shown} overlap"
    ]


def test_bits_that_only_overlay_fields_cover_become_fields_within_bytes():
    message, _ = message_of(
        (uint("Owner"), (0, 12, LITTLE)),
        (uint("Over"), (11, 7, LITTLE)),
        (uint("Alias", view=True), (30, 11, LITTLE)),
        (uint("Part", view=True), (31, 1, LITTLE)),
    )
    assert rows(message) == [
        ("Owner", 0, 12, None),
        ("Over", 11, 7, True),
        ("Bits from 12", 12, 4, None),
        ("Bits from 16", 16, 2, None),
        ("Alias", 30, 11, True),
        ("Bits from 30", 30, 2, None),
        ("Part", 31, 1, True),
        ("Bits from 32", 32, 8, None),
        ("Bits from 40", 40, 1, None),
    ]
    assert message["fields"][2] == {"at": 12, "bits": 4, **uint("Bits from 12")}
    assert message["reserved"] == 2


def test_bits_of_overlay_fields_are_counted_in_the_order_of_the_message():
    message, _ = message_of(
        (uint("Alias", view=True), (4, 12, BIG)), order=BIG, length=2
    )
    assert rows(message) == [
        ("Alias", 4, 12, True),
        ("Bits from 0", 4, 4, None),
        ("Bits from 8", 8, 8, None),
    ]


@pytest.mark.parametrize(
    ("first", "second", "is_exclusive"),
    [
        ({"Mode": 1}, {"Mode": 2}, True), ({"Mode": 0}, {"Mode": [1, 2]}, True),
        ({"Mode": [0, 1]}, {"Mode": [1, 2]}, False),
        ({"Mode": 1, "Page": 0}, {"Mode": 1, "Page": 1}, True),
        ({"Mode": 1}, {"Page": 1}, False), ({"Mode": 1}, {"Mode": 1}, False),
    ],
)  # fmt: skip
def test_optional_fields_share_bits_if_their_conditions_exclude_each_other(
    first, second, is_exclusive
):
    message, findings = message_of(
        (uint("A", when=first), (8, 8, LITTLE)),
        (uint("B", when=second), (8, 8, LITTLE)),
        (uint("Mode"), (0, 8, LITTLE)),
    )
    names = [name for name, _, _, _ in rows(message)]
    text = "message `Status`, `B` is left out: it is optional, and overlaps `A`"
    assert names == (["Mode", "A", "B"] if is_exclusive else ["Mode", "A"])
    assert [(code, text) for code, _, text, _ in findings] == (
        [] if is_exclusive else [("IMP091", text)]
    )


def test_an_optional_field_that_a_permanent_one_overlaps_is_left_out():
    message, findings = message_of(
        (uint("B", when={"Mode": 1}), (4, 4, LITTLE)),
        (uint("A"), (0, 8, LITTLE)),
        (uint("C", when={"Mode": 1}), (8, 4, LITTLE)),
    )
    assert [name for name, _, _, _ in rows(message)] == ["A", "C"]
    assert [code for code, _, _, _ in findings] == ["IMP091"]


def test_a_condition_has_the_values_of_a_list_or_a_single_one():
    assert values_of_condition([1, 2]) == [1, 2]
    assert values_of_condition(0) == [0]
