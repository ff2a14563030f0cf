"""Every NaN payload survives decoding and encoding."""

from __future__ import annotations

import math
import struct

import pytest

from icdgen.icd.places import raw_fields_in
from tests.python.reference import cases

NANS32 = (
    0x7FC00000,
    0xFFC00000,
    0x7F800001,
    0xFF800001,
    0x7FBFFFFF,
    0x7FFFFFFF,
    0xFFFFFFFF,
    0x7FA12345,
    0x7FC54321,
)
NANS64 = (
    0x7FF8000000000000,
    0x7FF0000000000001,
    0xFFF7FFFFFFFFFFFF,
    0xFFFFFFFFFFFFFFFF,
    0x7FF123456789ABCD,
)
ALIKE32 = (
    0,
    0x80000000,
    1,
    0x007FFFFF,
    0x00800000,
    0x7F7FFFFF,
    0x7F800000,
    0xFF800000,
    0x3DCCCCCD,
)
ALIKE64 = (
    0,
    1 << 63,
    1,
    0x000FFFFFFFFFFFFF,
    0x7FEFFFFFFFFFFFFF,
    0x7FF0000000000000,
    0x3FB999999999999A,
)


def test_every_bit_pattern_comes_back(package):
    floats, checked = package.module("_floats"), 0
    for case in cases(package):
        for field in raw_fields_in(case.message.layout):
            if field.type != "float":
                continue
            patterns = (*NANS32, *ALIKE32) if field.bits == 32 else (*NANS64, *ALIKE64)
            for bits in patterns:
                message = case.cls()
                attribute = case.infos[field.name].attribute
                value = (
                    floats.float32(bits) if field.bits == 32 else floats.float64(bits)
                )
                setattr(message, attribute, value)
                frame = message.to_bytes()
                again = case.cls.from_bytes(frame)
                found = getattr(again, attribute)
                assert (
                    floats.float32_bits(found)
                    if field.bits == 32
                    else floats.float64_bits(found)
                ) == bits
                assert again.to_bytes() == frame
                checked += 1
    assert checked


def test_nans_are_ordinary_floats(shipped):
    cls = shipped.module("cubemag").PrimaryMagnetometerMeasurement
    frame = struct.pack("<III?", 0x7F800001, 0xFFC12345, 0x3F800000, True)
    message = cls.from_bytes(frame)
    assert type(message.x_axis) is float
    assert math.isnan(message.x_axis)
    assert math.copysign(1, message.y_axis) == -1
    assert message.z_axis == 1.0
    assert message.to_bytes() == frame


def test_infinities_that_cancel_out_are_not_mistaken_for_nans(shipped):
    cls = shipped.module("cubemag").PrimaryMagnetometerMeasurement
    frame = struct.pack("<fff?", math.inf, -math.inf, 0.1, True)
    message = cls.from_bytes(frame)
    assert (message.x_axis, message.y_axis) == (math.inf, -math.inf)
    assert message.to_bytes() == frame


def test_a_nan_made_by_a_program_is_encoded_as_the_usual_one(shipped):
    cls = shipped.module("cubemag").PrimaryMagnetometerMeasurement
    assert cls(x_axis=math.nan).to_bytes()[:4] == struct.pack("<I", 0x7FC00000)


@pytest.mark.parametrize("bits", [0x7FF0000000000001, 0xFFF0000010000000])
def test_a_payload_too_fine_for_32_bits_stays_a_nan(shipped, bits):
    floats = shipped.module("_floats")
    found = floats.float32_bits(floats.float64(bits))
    assert math.isnan(floats.float32(found))
    assert found >> 31 == bits >> 63
