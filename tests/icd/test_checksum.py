"""Checksums have the check values of catalogues, and initial and final values."""

from __future__ import annotations

import binascii
import random
import zlib

import pytest

from icdgen.icd import checksum

CHECK = b"123456789"


@pytest.mark.parametrize(
    ("parameters", "value"),
    [
        ((8, 0x07, 0, False, False, 0), 0xF4),  # CRC-8/SMBUS
        ((8, 0x31, 0xFF, False, False, 0), 0xF7),  # CRC-8/NRSC-5
        ((12, 0x80F, 0, False, True, 0), 0xDAF),  # CRC-12/UMTS reflects only the result
        ((16, 0x1021, 0xFFFF, False, False, 0xFFFF), 0xD64E),  # CRC-16/GENIBUS
        ((16, 0x8005, 0, True, True, 0), 0xBB3D),  # CRC-16/ARC
        ((32, 0x1EDC6F41, 0xFFFFFFFF, True, True, 0xFFFFFFFF), 0xE3069283),  # iSCSI
    ],
)
def test_crcs_have_the_check_values_of_the_catalogue(parameters, value):
    assert checksum.crc(CHECK, *parameters) == value


def test_the_crc_of_no_bytes_is_the_initial_value():
    assert checksum.crc(b"", 8, 0x07, 0x12, True, False, 0) == 0x12
    assert checksum.crc(b"", 8, 0x07, 0x12, True, True, 0) == 0x48
    assert checksum.crc(b"", 8, 0x07, 0x12, False, False, 0xF0) == 0xE2


def test_crcs_of_random_data_agree_with_the_standard_library():
    source = random.Random(1)
    for size in range(12):
        data = source.randbytes(size)
        expected = zlib.crc32(data)
        ones = 0xFFFFFFFF
        assert checksum.crc(data, 32, 0x04C11DB7, ones, True, True, ones) == expected
        assert checksum.crc(data, 16, 0x1021, 7, False, False, 0) == binascii.crc_hqx(
            data, 7
        )


@pytest.mark.parametrize(
    ("kind", "data", "width", "init", "xor_out", "value"),
    [
        ("fletcher_255", b"abcde", 16, 0, 0, 0xC8F0),
        ("fletcher_255", b"abcdef", 16, 0, 0, 0x2057),
        ("fletcher_255", b"\xff", 16, 0, 0, 0),
        ("fletcher", b"\xff", 16, 0, 0, 0xFFFF),
        ("fletcher", b"\x01\x02", 16, 0, 0, 0x0403),
        ("fletcher", b"\x01\x02", 16, 0x0500, 0, 0x0903),
        ("fletcher", b"\x01\x02", 16, 0x0005, 0x00FF, 0x0EF7),
        ("sum", b"\xff\x02", 8, 0, 0, 0x01),
        ("sum", b"\xff\x02", 16, 0x10, 0, 0x111),
        ("sum", b"\xff\x01", 8, 0, 0xFF, 0xFF),
        ("xor", b"\x12\x34", 8, 0, 0, 0x26),
        ("xor", b"\x12\x34", 8, 0x01, 0xFF, 0xD8),
        ("xor", b"", 8, 0x5A, 0, 0x5A),
    ],
)
def test_simple_checksums_start_with_their_initial_value(
    kind, data, width, init, xor_out, value
):
    assert checksum.plain(kind, data, width, init, xor_out) == value
