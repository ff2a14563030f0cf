"""Checksums of all kinds."""

from __future__ import annotations

from functools import reduce
from operator import xor
from typing import Union

from .._hints import Buffer
from .crc import Crc
from .errors import need
from .link import Link
from .packet_formats import CheckForm, ChecksumAlgorithm


def checksum(link: Link, name: str, data: Buffer) -> int:
    """Return the checksum with this name in the ICD. Raise `UnsupportedError`.

    ``data`` ends with the seed of the message if the checksum has ``seeds``.
    """
    algorithm = need(link.checksums.get(name), f"link: checksums: {name}")
    return check(algorithm, bytes(data))


def check(form: Union[CheckForm, ChecksumAlgorithm], data: bytes) -> int:
    """Return the checksum of ``data`` as a number."""
    crc = form.crc
    if form.kind == "crc":
        return Crc(crc).feed(data).result()
    if form.kind == "sum":
        result = (crc.init + sum(data)) & ((1 << crc.width) - 1)
    elif form.kind == "xor":
        result = reduce(xor, data, crc.init)
    else:
        modulus = 255 if form.kind == "fletcher_255" else 256
        first, second = crc.init & 0xFF, crc.init >> 8
        for byte in data:
            first += byte
            second += first
        result = second % modulus << 8 | first % modulus
    return result ^ crc.xor_out
