"""Columns and numbers of logs: unique names, sizes, byte orders, and values."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest

from icdgen.logfile.columns import columns_of, unique
from icdgen.logfile.rows import reader
from icdgen.logfile.strided import numbers_at
from tests.icd.files import loaded, status

np = pytest.importorskip("numpy")


@pytest.mark.parametrize("size", range(1, 9))
@pytest.mark.parametrize("order", ["little", "big"])
def test_numbers_of_each_size_are_those_of_their_bytes(size, order):
    data, stride = random.Random(size).randbytes(11 * 7 + 3), 11
    for at in range(stride - size + 1):
        result = numbers_at(data, stride, at, size, order == "little")
        assert result.tolist() == [
            int.from_bytes(data[i * stride + at :][:size], order) for i in range(7)
        ]


def test_signed_numbers_and_a_given_count():
    data = bytes([0xFF, 0x01, 0x80, 0x02, 0x7F])
    assert numbers_at(data, 2, 0, 1, True, "i").tolist() == [-1, -128]
    assert numbers_at(data, 2, 0, 1, True, "i", 3).tolist() == [-1, -128, 127]
    assert numbers_at(data, 2, 0, 3, False, "u", 2).tolist() == [0xFF0180, 0x80027F]
    assert numbers_at(data, 2, 0, 2, True, "u", 0).tolist() == []
    assert numbers_at(data, 6, 0, 1, True).tolist() == []
    assert numbers_at(b"\xfe" + b"\xff" * 7, 8, 0, 8, True, "i").tolist() == [-2]


ENUM = "enums:\n  - {name: Mode, members: [{value: 0, name: Idle}, {value: 2, name: Run}]}\n"
FIELDS = (
    "at: 0, bits: 3, name: Mass, type: uint",
    "at: 3, bits: 1, name: Flag, type: bool",
    "at: 4, bits: 4, name: Mode, type: enum, enum: Mode",
    "at: 8, bits: 12, name: Delta, type: int",
    "at: 20, bits: 12, name: Wide, type: uint, unit: mV, formula: raw*0.5 - 3",
    "at: 32, bits: 32, name: Level, type: float",
    "at: 64, bits: 24, name: Label, type: text",
    "at: 88, bits: 16, name: Blob, type: bytes",
    "at: 104, bits: 16, name: Step, type: int",
    "at: 120, bits: 4, name: Trim, type: int",
    "at: 124, bits: 8, name: Odd, type: uint",
    "at: 132, bits: 4, name: End, type: uint",
)
ENTRY = bytes.fromhex(
    "aabb" + "2d" + "ff2f01" + "cdcccc3d" + "414200" + "c0de" + "feff" + "3e92"
)


@pytest.fixture
def parts(tmp_path):
    result = loaded(tmp_path, ENUM + status(*FIELDS, length=17))
    assert [f.message for f in result.findings] == []
    return result.icd, result.icd.nodes[0].messages[0]


def test_each_type_of_column_has_the_value_of_its_bits(parts):
    values = {c.name: reader(c)(ENTRY) for c in columns_of(*parts, start=2)}
    assert values == {
        "status__mass": 5,
        "status__flag": True,
        "status__mode": "Run",
        "status__delta": -1,
        "status__wide_mv": 0x012 * 0.5 - 3,
        "status__level": 0.1,
        "status__label": "AB",
        "status__blob": "c0de",
        "status__step": -2,
        "status__trim": -2,
        "status__odd": 0x23,
        "status__end": 9,
    }


def test_an_unknown_value_of_an_enumeration_is_named(parts):
    (mode,) = (c for c in columns_of(*parts) if c.name == "status__mode")
    assert reader(mode)(b"\x7f") == "unknown 7"
    assert reader(mode)(b"\xf0") == "unknown 15"
    assert reader(mode)(b"\x0f") == "Idle"


def test_fields_beyond_the_length_have_no_column(parts):
    names = [c.name for c in columns_of(*parts, length=8)]
    assert names[-1] == "status__level" and len(names) == 6
    assert [c.name for c in columns_of(*parts, length=7)] == names[:-1]


def test_columns_have_first_byte_and_size_in_the_entry(parts):
    columns = {c.name: (c.at, c.size) for c in columns_of(*parts, start=100)}
    assert columns["status__mass"] == (100, 1)
    assert columns["status__delta"] == (101, 2)
    assert columns["status__wide_mv"] == (102, 2)
    assert columns["status__step"] == (113, 2)


def test_repeated_names_and_the_name_of_the_time_get_a_number(parts):
    (column, *_) = columns_of(*parts)
    names = ["a", "time", "a", "a_2", "a", "b"]
    result = unique(replace(column, name=name) for name in names)
    assert [c.name for c in result] == ["a", "time_2", "a_2", "a_2_2", "a_3", "b"]
