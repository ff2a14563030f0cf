"""CRCs, bit by bit."""

from __future__ import annotations

from icdgen.protocol.sections import Crc


def compute(crc: Crc, data: bytes) -> int:
    """The CRC of the bytes."""
    if not data and crc.empty is not None:
        return crc.empty
    value, top = crc.init, 1 << (crc.width - 1)
    for byte in data:
        for position in range(8):
            bit = byte >> (position if crc.reflect_in else 7 - position) & 1
            out = bool(value & top) != bool(bit)
            value = (value << 1 & (top << 1) - 1) ^ (crc.polynomial if out else 0)
    if crc.reflect_out:
        value = int(f"{value:0{crc.width}b}"[::-1], 2)
    return value ^ crc.xor_out
