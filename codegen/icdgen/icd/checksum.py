"""Checksum algorithms, bit by bit, for the rules and for tests of the runtimes."""

from __future__ import annotations

from functools import reduce
from operator import xor

CRC, FLETCHER, FLETCHER_255, SUM, XOR = KINDS = (
    "crc",
    "fletcher",
    "fletcher_255",
    "sum",
    "xor",
)


def crc(
    data: bytes,
    width: int,
    polynomial: int,
    init: int,
    reflect_in: bool,
    reflect_out: bool,
    xor_out: int,
) -> int:
    """Return the CRC of ``data``, with the parameters of the Rocksoft model, which CRC
    catalogues use.
    """
    value, top = init, 1 << (width - 1)
    for byte in data:
        for position in range(8):
            bit = byte >> (position if reflect_in else 7 - position) & 1
            feedback = bool(value & top) != bool(bit)
            value = (value << 1 & (top << 1) - 1) ^ (polynomial if feedback else 0)
    # Only the result is reflected: the register always shifts to the left, and
    # `reflect_in` decides which bit of a byte comes first.
    if reflect_out:
        value = int(f"{value:0{width}b}"[::-1], 2)
    return value ^ xor_out


def plain(kind: str, data: bytes, width: int, init: int, xor_out: int) -> int:
    """Return a Fletcher checksum, a sum or an XOR of ``data``.

    The high half of a Fletcher checksum is the second sum; ``init`` and ``xor_out``
    have the same layout.
    """
    if kind in (FLETCHER, FLETCHER_255):
        modulus = 255 if kind == FLETCHER_255 else 256
        first, second = init & 0xFF, init >> 8
        for byte in data:
            first = (first + byte) % modulus
            second = (second + first) % modulus
        value = second << 8 | first
    elif kind == SUM:
        value = (init + sum(data)) % (1 << width)
    else:
        value = reduce(xor, data, init)
    return value ^ xor_out
