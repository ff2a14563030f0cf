"""The checksums of an envelope: CRCs, Fletcher's, sums and exclusive ors. Slow and obvious."""

from __future__ import annotations

from functools import reduce
from operator import xor

from icdgen.protocol import crc
from icdgen.protocol.envelope import CRC, FLETCHER, FLETCHER_255, SUM, Check


def compute(check: Check, data: bytes) -> int:
    """The checksum of all that it covers, as a number."""
    form = check.crc
    if check.kind == CRC:
        return crc.compute(form, data)
    if check.kind in (FLETCHER, FLETCHER_255):
        modulus = 255 if check.kind == FLETCHER_255 else 256
        first, second = form.init & 0xFF, form.init >> 8
        for byte in data:
            first = (first + byte) % modulus
            second = (second + first) % modulus
        found = second << 8 | first
    elif check.kind == SUM:
        found = (form.init + sum(data)) % (1 << form.width)
    else:
        found = reduce(xor, data, form.init)
    return found ^ form.xor_out
