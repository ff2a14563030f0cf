"""Scalars: storage, names with units, initial values, and how they lie in the frame."""

from __future__ import annotations

from itertools import count

import pytest

from icdgen.describe.storage import Storage, storage_bits
from icdgen.icd.pieces import Piece
from tests.describe.small import message_of, node_of
from tests.icd.files import status
from tests.limits import assert_limits

ENUM = "enums: [{name: Mode, members: [{value: 1, name: Idle}]}]\n"
VIEW = "at: 0, bits: 64, name: Everything, type: uint"


def field_of(folder, keys, head="", name="Rate"):
    return message_of(
        folder, f"at: 0, name: {name}, {keys}", length=16, head=head
    ).members[0]


@pytest.mark.parametrize("width", [8, 16, 32])
def test_a_raw_value_is_stored_in_the_smallest_integer_that_has_its_bits(width):
    assert_limits(lambda bits: storage_bits(bits) <= width, most=width)
    assert (storage_bits(1), storage_bits(64)) == (8, 64)


@pytest.mark.parametrize(
    ("storage", "ends"),
    [
        (Storage(8), (0, 255)),
        (Storage(8, True), (-128, 127)),
        (Storage(64), (0, (1 << 64) - 1)),
        (Storage(64, True), (-(1 << 63), (1 << 63) - 1)),
    ],
)
def test_an_integer_type_has_its_range(storage, ends):
    assert (storage.min, storage.max) == ends


@pytest.mark.parametrize(
    ("keys", "storage", "is_narrow"),
    [
        ("bits: 8, type: uint", (8, False), False),
        ("bits: 9, type: uint", (16, False), True),
        ("bits: 9, type: int", (16, True), True),
        ("bits: 33, type: int", (64, True), True),
        ("bits: 32, type: float", (32, False), False),
        # A flag has only two values, although its type has more bits.
        ("bits: 1, type: bool", (8, False), False),
        ("bits: 4, type: enum, enum: Mode", (8, False), True),
    ],
)
def test_only_integers_and_enumerations_can_store_values_beyond_their_bits(
    tmp_path, keys, storage, is_narrow
):
    field = field_of(tmp_path, keys, ENUM if "enum" in keys else "")
    assert tuple(field.storage) == storage
    assert field.is_narrow == is_narrow


def test_an_enumeration_is_stored_in_the_type_of_its_widest_field(tmp_path):
    narrow, wide = message_of(
        tmp_path,
        "at: 0, bits: 4, name: A, type: enum, enum: Mode",
        "at: 8, bits: 16, name: B, type: enum, enum: Mode",
        length=3,
        head=ENUM,
    ).members
    assert narrow.storage == wide.storage == (16, False)
    assert (narrow.is_narrow, wide.is_narrow) == (True, False)


@pytest.mark.parametrize(
    ("keys", "name", "has_physical", "is_settable"),
    [
        ("bits: 16, type: uint", "rate_physical", False, True),
        ("bits: 16, type: uint, unit: deg/s", "rate_deg_per_s", False, True),
        (
            "bits: 16, type: uint, unit: deg/s, formula: raw*2",
            "rate_deg_per_s",
            True,
            True,
        ),
        ("bits: 16, type: uint, formula: raw*2", "rate_physical", True, True),
        ("bits: 16, type: uint, formula: raw^2", "rate_physical", True, True),
        ("bits: 16, type: int, formula: raw^2", "rate_physical", True, False),
        ("bits: 16, type: text", "rate_text", True, True),
        ("bits: 16, type: bytes", "rate_physical", False, True),
    ],
)
def test_a_physical_value_has_the_unit_in_its_name(
    tmp_path, keys, name, has_physical, is_settable
):
    field = field_of(tmp_path, keys)
    assert (field.name, field.declared_name) == ("rate", "rate")
    assert field.physical_name == name
    assert field.has_physical == has_physical
    assert field.is_settable == is_settable
    assert field.is_text == ("text" in keys)
    assert field.is_scaled == ("formula" in keys)


def test_overlays_and_derived_values_are_not_settable_and_a_derived_one_has_its_unit(
    tmp_path,
):
    text = status(VIEW, "at: 0, bits: 8, name: Low, type: uint, view: true", length=8)
    text += "    derived: [{name: Twice, formula: Everything*2, unit: m}]\n"
    low, twice = node_of(tmp_path, text).messages[0].read_only_members
    assert (low.name, low.is_settable) == ("low", False)
    assert (twice.name, twice.is_settable) == ("twice_m", False)
    assert twice.physical_name == "twice_m_m"
    assert twice.pieces == ()


@pytest.mark.parametrize(
    ("keys", "raw", "physical"),
    [
        ("bits: 8, type: uint", 0, 0.0),
        ("bits: 8, type: uint, const: 255", 255, 0.0),
        ("bits: 8, type: uint, const: 255, formula: raw*0.1 - 5", 255, 20.5),
        ("bits: 8, type: int, formula: raw*0.1 - 5", 0, -5.0),
        ("bits: 8, type: uint, formula: raw^2 + 3", 0, 3.0),
        ("bits: 8, type: bytes", 0, 0.0),
    ],
)
def test_a_new_message_has_the_constant_or_zero(tmp_path, keys, raw, physical):
    field = field_of(tmp_path, keys)
    assert field.initial_raw == raw
    assert field.initial_physical == physical


@pytest.mark.parametrize(
    ("at", "keys", "is_word", "is_plain_word", "is_copied"),
    [
        (8, "bits: 8, type: uint", True, True, True),
        (8, "bits: 16, type: int", True, True, True),
        (16, "bits: 64, type: float", True, True, True),
        (4, "bits: 16, type: uint", False, False, False),
        (8, "bits: 24, type: uint", False, False, False),
        (8, "bits: 4, type: uint", False, False, False),
        (8, "bits: 24, type: bytes", False, False, True),
        (8, "bits: 16, type: text", False, False, True),
        # A word that is extended is no copy.
        (8, "bits: 8, type: enum, enum: Mode", True, False, False),
    ],
)
def test_a_word_begins_at_a_byte_and_has_a_size_of_integers(
    tmp_path, at, keys, is_word, is_plain_word, is_copied
):
    wide = "at: 96, bits: 16, name: Wide, type: enum, enum: Mode"
    field = message_of(
        tmp_path,
        f"at: {at}, name: Rate, {keys}",
        *[wide] * ("enum" in keys),
        length=14,
        head=ENUM if "enum" in keys else "",
    ).members[0]
    assert field.is_word == is_word
    assert field.is_plain_word == is_plain_word
    assert field.is_copied == is_copied


@pytest.mark.parametrize(
    ("keys", "order", "pieces"),
    [
        ("", "le", (Piece(0, 4, 4, 0), Piece(1, 0, 6, 4))),
        ("byte_order: big", "be", (Piece(0, 4, 4, 6), Piece(1, 0, 6, 0))),
        ("bit_order: msb0", "le", (Piece(0, 0, 4, 0), Piece(1, 2, 6, 4))),
        (
            "byte_order: big, bit_order: msb0",
            "be",
            (Piece(0, 0, 4, 6), Piece(1, 2, 6, 0)),
        ),
    ],
)
def test_bits_lie_in_the_orders_of_the_field_before_those_of_the_node(
    tmp_path, keys, order, pieces
):
    field = message_of(
        tmp_path, f"at: 4, bits: 10, name: Rate, type: uint, {keys}", length=2
    ).members[0]
    assert (field.order, field.pieces) == (order, pieces)
    assert field.byte_order == {"le": "little", "be": "big"}[order]


def test_bytes_and_texts_have_a_size_in_bytes(tmp_path):
    places = count()
    for kind in ("bytes", "text"):
        folder = tmp_path / str(next(places))
        folder.mkdir()
        assert field_of(folder, f"bits: 40, type: {kind}").size == 5


@pytest.mark.parametrize(
    ("keys", "bounds"),
    [
        ("bits: 8, type: uint", []),
        ("bits: 8, type: uint, min: 0", [("min", 0.0)]),
        (
            "bits: 8, type: uint, formula: raw*0.1, below: 9.5, above: 0",
            [("above", 0.0), ("below", 9.5)],
        ),
        (
            "bits: 8, type: int, min: -3, max: 7",
            [("min", -3.0), ("max", 7.0)],
        ),
    ],
)
def test_limits_are_listed_with_lower_ones_first(tmp_path, keys, bounds):
    field = field_of(tmp_path, keys)
    assert [(bound.key, bound.double) for bound in field.bounds] == bounds


def test_messages_about_other_values_say_which_can_be_set(tmp_path):
    places = count()

    def allowed(keys):
        folder = tmp_path / str(next(places))
        folder.mkdir()
        return field_of(folder, keys).allowed_text

    assert allowed("bits: 4, type: uint").endswith("0 to 15")
    assert allowed("bits: 4, type: int").endswith("-8 to 7")


def test_a_scale_has_arithmetic_and_an_integer_scale_if_its_values_are_whole(tmp_path):
    places = count()

    def field(keys):
        folder = tmp_path / str(next(places))
        folder.mkdir()
        return field_of(folder, f"bits: 8, type: uint{keys}")

    assert field("").arithmetic is field("").integer_scale is None
    assert field(", formula: raw^2").arithmetic is None
    third = field(", formula: raw/3")
    assert third.arithmetic is not None and third.integer_scale is None
    tenth = field(", formula: raw*0.1")
    assert tenth.arithmetic is tenth.arithmetic
    assert (tenth.integer_scale.per, tenth.integer_scale.factor) == (1000, 100)
