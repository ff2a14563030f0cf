"""CRCs with the parameters of an ICD."""

from __future__ import annotations

from icdgen.icd import checksum
from icdgen.protocol.sections import Crc


def compute(crc: Crc, data: bytes) -> int:
    """Return the CRC of the bytes."""
    if not data and crc.empty is not None:
        return crc.empty
    return checksum.crc(
        data,
        crc.width,
        crc.polynomial,
        crc.init,
        crc.reflect_in,
        crc.reflect_out,
        crc.xor_out,
    )
