"""Checksums of packet formats: CRC, Fletcher, sum and exclusive or.

Reference implementation: written for clarity, not for speed.
"""

from __future__ import annotations

from icdgen.icd import checksum
from icdgen.protocol import crc
from icdgen.protocol.envelope import CRC, Check


def compute(check: Check, data: bytes) -> int:
    """Return the checksum of the covered bytes as a number."""
    form = check.crc
    if check.kind == CRC:
        return crc.compute(form, data)
    return checksum.plain(check.kind, data, form.width, form.init, form.xor_out)
