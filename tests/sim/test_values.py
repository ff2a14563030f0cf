"""Frames of the simulator start with allowed values; set values stay in their range."""

from __future__ import annotations

import pytest

from icdgen import codec
from icdgen.sim.values import Values, allowed_values, raw_of
from tests.icd.files import loaded, status

ENUM = "enums:\n  - {name: Mode, members: [{value: 3, name: Idle}, {value: 2, name: Run}]}\n"


def values_of(folder, *fields: str, length: int, enum: str = "") -> Values:
    result = loaded(folder, enum + status(*fields, length=length))
    assert [f.message for f in result.findings if f.severity == "error"] == []
    return Values(result.icd, result.icd.nodes[0])


def field_of(folder, attributes: str, bits: int = 8):
    values = values_of(
        folder, f"at: 0, bits: {bits}, name: Level, {attributes}", length=bits // 8
    )
    (message,) = values.messages.values()
    (field,) = values.icd.longest_frame(message)
    return values, message, field


@pytest.mark.parametrize(
    ("attributes", "expected"),
    [
        ("type: uint", 0),
        ("type: uint, min: 5", 5),
        ("type: int, max: -5", -5),
        ("type: uint, above: 5", 6),
        ("type: int, below: -5", -6),
        ("type: uint, const: 7", 7),
        ("type: uint, unit: V, formula: raw*0.5, min: 1", 2),
        ("type: uint, unit: V, formula: raw*0.5, min: 1.2", 3),
        ("type: int, unit: V, formula: raw*-1, min: 4", -4),
        ("type: uint, unit: V, formula: raw - 100, min: 1", 101),
    ],
)
def test_a_frame_starts_with_the_allowed_value_nearest_to_zero(
    tmp_path, attributes, expected
):
    values, message, _ = field_of(tmp_path, attributes)
    assert allowed_values(values.icd, message) == {"Level": expected}
    assert codec.decode(values.icd.nodes[0], message, values.frame(message)) == {
        "Level": expected
    }


def test_an_enumeration_starts_with_its_first_member(tmp_path):
    values = values_of(
        tmp_path,
        "at: 0, bits: 8, name: Mode, type: enum, enum: Mode",
        "at: 8, bits: 16, name: Blob, type: bytes",
        length=3,
        enum=ENUM,
    )
    (message,) = values.messages.values()
    assert values.raw(message)["Blob"] == b"\0\0"
    assert values.raw(message)["Mode"] in (2, 3)


@pytest.mark.parametrize(
    ("attributes", "value", "expected"),
    [
        ("type: uint", 7.4, 7),
        ("type: uint", -0.6, 0),
        ("type: uint", 255.4, 255),
        ("type: uint", 256, 255),
        ("type: int", -129, -128),
        ("type: int", 128, 127),
        ("type: int", -1.6, -2),
        ("type: uint, unit: V, formula: raw*0.5 - 10", 2.2, 24),
        ("type: uint, unit: V, formula: raw*0.5 - 10", -11, 0),
        ("type: uint, unit: V, formula: raw*0.5 - 10", 1000, 255),
    ],
)
def test_a_physical_value_becomes_the_nearest_raw_value_in_range(
    tmp_path, attributes, value, expected
):
    _, _, field = field_of(tmp_path, attributes)
    assert raw_of(field, value) == expected


def test_a_float_has_the_bits_of_the_value(tmp_path):
    _, _, field = field_of(tmp_path, "type: float", bits=32)
    assert raw_of(field, 0.1) == 0x3DCCCCCD


def test_an_update_sets_only_the_given_fields(tmp_path):
    values = values_of(
        tmp_path,
        "at: 0, bits: 8, name: Aa, type: uint",
        "at: 8, bits: 8, name: Bb, type: uint",
        length=2,
    )
    (message,) = values.messages.values()
    assert values.update(message, {"Aa": 5}) == {"Aa": 5}
    assert values.update(message, {"Bb": 6}) == {"Bb": 6}
    assert values.frame(message) == b"\5\6"
    with pytest.raises(codec.CodecError):
        values.update(message, {"Aa": 256})
    assert values.frame(message) == b"\5\6"
