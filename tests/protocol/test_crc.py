"""Checksums: those of the catalogues, and of the listings that the manual prints."""

from __future__ import annotations

import binascii

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.protocol import crc
from icdgen.protocol.sections import Crc
from tests.protocol import quick

CATALOGUE = [
    (Crc(8, 0x07, 0, False, False, 0), 0xF4),  # CRC-8/SMBUS
    (Crc(16, 0x1021, 0xFFFF, False, False, 0), 0x29B1),  # CRC-16/IBM-3740
    (Crc(16, 0x8005, 0, True, True, 0), 0xBB3D),  # CRC-16/ARC
    (
        Crc(32, 0x04C11DB7, 0xFFFFFFFF, True, True, 0xFFFFFFFF),
        0xCBF43926,
    ),  # CRC-32/ISO-HDLC
]


@pytest.mark.parametrize("parameters, check", CATALOGUE)
def test_the_check_values_of_the_catalogues(parameters, check):
    assert crc.compute(parameters, b"123456789") == check


def test_no_bytes_at_all_have_the_value_that_the_icd_gives(known):
    assert crc.compute(known.checksum.crc, b"") == 0xFF
    assert crc.compute(known.crc16, b"") == 0


@quick
@given(data=st.binary(max_size=300))
def test_the_wide_one_is_that_of_the_standard_library(known, data):
    assert crc.compute(known.crc16, data) == binascii.crc_hqx(data, 0)


@quick
@given(data=st.binary(min_size=1, max_size=300))
def test_the_narrow_one_shifts_after_the_constant_is_applied(known, data):
    register = 0
    for byte in data:
        register ^= byte
        for _ in range(8):
            register = (register ^ 0x91 if register & 1 else register) >> 1
    assert crc.compute(known.checksum.crc, data) == register
