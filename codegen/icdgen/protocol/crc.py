"""CRCs of the parameters that an ICD gives."""

from __future__ import annotations

from icdgen.icd import checksum
from icdgen.protocol.sections import Crc


def compute(crc: Crc, data: bytes) -> int:
    """The CRC of the bytes."""
    if not data and crc.empty is not None:
        return crc.empty
    return checksum.crc(data, crc.width, crc.polynomial, crc.init, crc.reflect_in, crc.reflect_out, crc.xor_out)


def byte_table(crc: Crc) -> list[int]:
    """Return the register after each of the 256 bytes, most significant bit first, if it was 0 before."""
    top, mask = 1 << crc.width - 1, (1 << crc.width) - 1
    table = []
    for byte in range(256):
        register = 0
        for position in reversed(range(8)):
            is_odd = bool(register & top) != bool(byte >> position & 1)
            register = register << 1 & mask ^ (crc.polynomial if is_odd else 0)
        table.append(register)
    return table
