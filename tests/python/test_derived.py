"""Derived values are read-only attributes, and values in dictionaries and columns."""

from __future__ import annotations

import struct
from random import Random

import pytest


@pytest.fixture(scope="module")
def derived(odd):
    return odd.module("odd").Derived


def test_a_derived_value_cannot_be_set(derived):
    message = derived()
    with pytest.raises(AttributeError):
        message.longitude_deg = 1.0
    with pytest.raises(TypeError):
        derived(longitude_deg=1.0)


def test_derived_values_follow_the_fields_of_a_message(derived):
    message = derived(lon=5)
    assert [info.attribute for info in derived.VIEWS] == [
        "low",
        "longitude_deg",
        "power_v",
        "class_name",
        "mixed",
    ]
    assert list(message.as_dict())[-4:] == list(message.as_dict(physical=True))[-4:]
    assert (
        derived.from_dict(message.as_dict())
        == derived.from_json(message.to_json(physical=True))
        == message
    )


@pytest.mark.parametrize("physical", [False, True])
def test_columns_of_derived_values_have_the_bits_of_single_frames(derived, physical):
    generator = Random(1)
    frames = [generator.randbytes(24) for _ in range(300)] + [bytes(24)]
    columns = derived.decode_many(b"".join(frames), physical=physical)
    for name in ("longitude_deg", "power_v", "class_name", "mixed"):
        expected = [
            struct.pack("<d", getattr(derived.from_bytes(frame), name))
            for frame in frames
        ]
        assert [struct.pack("<d", value) for value in columns[name]] == expected, name
    table = derived.decode_table(b"".join(frames), physical=physical)
    assert table.schema.field("longitude_deg").metadata == {
        b"name": b"longitude",
        b"unit": b"deg",
    }
