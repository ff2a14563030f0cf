"""The checksums of an envelope: CRCs, Fletcher's, sums and exclusive ors. Slow and obvious."""

from __future__ import annotations

from icdgen.icd import checksum
from icdgen.protocol import crc
from icdgen.protocol.envelope import CRC, Check


def compute(check: Check, data: bytes) -> int:
    """The checksum of all that it covers, as a number."""
    form = check.crc
    if check.kind == CRC:
        return crc.compute(form, data)
    return checksum.plain(check.kind, data, form.width, form.init, form.xor_out)
