"""NaNs in Python: ordinary floats whose payload survives decoding and encoding."""

from __future__ import annotations

import math
import struct

import pytest


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


def test_a_nan_of_a_program_is_encoded_as_the_default_nan(shipped):
    cls = shipped.module("cubemag").PrimaryMagnetometerMeasurement
    assert cls(x_axis=math.nan).to_bytes()[:4] == struct.pack("<I", 0x7FC00000)


@pytest.mark.parametrize("bits", [0x7FF0000000000001, 0xFFF0000010000000])
def test_a_nan_whose_payload_needs_64_bits_stays_a_nan_in_32_bits(shipped, bits):
    floats = shipped.module("_floats")
    float_bits = floats.float32_bits(floats.float64(bits))
    assert math.isnan(floats.float32(float_bits))
    assert float_bits >> 31 == bits >> 63
