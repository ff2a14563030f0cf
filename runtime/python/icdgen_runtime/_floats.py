"""Floats whose NaNs keep sign and payload.

`struct` makes signalling 32-bit NaNs quiet. Here a 32-bit NaN becomes the 64-bit one
with the same sign and payload, and goes back the same way.
"""

from __future__ import annotations

import math
import struct

from . import _types
from ._types import MessageFacts

_FLOAT32, _FLOAT64 = struct.Struct("<f"), struct.Struct("<d")
_BITS32, _BITS64 = struct.Struct("<I"), struct.Struct("<Q")

isnan = math.isnan


def is_special(value: float, special: float) -> bool:
    """Whether a number is a special value, which no comparison says of NaN: all NaNs are."""
    return value == special or (isnan(value) and isnan(special))


def float32(bits: int) -> float:
    """The number that the bits stand for; NaNs keep sign and payload."""
    if bits & 0x7F800000 == 0x7F800000 and bits & 0x007FFFFF:
        wide = (bits >> 31) << 63 | 0x7FF << 52 | (bits & 0x007FFFFF) << 29
        return float64(wide)
    (value,) = _FLOAT32.unpack(_BITS32.pack(bits))
    return float(value)


def float32_bits(value: float) -> int:
    """The bits of the nearest 32-bit float; those of a NaN keep sign and payload."""
    if isnan(value):
        wide = float64_bits(value)
        payload = wide >> 29 & 0x007FFFFF
        return wide >> 63 << 31 | 0x7F800000 | (payload or 0x00400000)
    (bits,) = _BITS32.unpack(_FLOAT32.pack(value))
    return int(bits)


def float64(bits: int) -> float:
    """The number that the bits stand for."""
    (value,) = _FLOAT64.unpack(_BITS64.pack(bits))
    return float(value)


def float64_bits(value: float) -> int:
    """The bits of the number."""
    (bits,) = _BITS64.unpack(_FLOAT64.pack(value))
    return int(bits)


def keep_nans(message: MessageFacts, data: _types.Buffer) -> None:
    """Sets the aligned 32-bit floats of ``message`` again, exactly as in ``data``."""
    frame = memoryview(data).tobytes()
    for name, byte in _aligned(message):
        bits = int.from_bytes(frame[byte : byte + 4], message.BYTE_ORDER)
        setattr(message, name, float32(bits))


def with_nans(message: MessageFacts, frame: bytes) -> bytes:
    """``frame`` with the exact bits of the aligned 32-bit floats of ``message``."""
    exact = bytearray(frame)
    for name, byte in _aligned(message):
        bits = float32_bits(getattr(message, name))
        exact[byte : byte + 4] = bits.to_bytes(4, message.BYTE_ORDER)
    return bytes(exact)


def _aligned(message: MessageFacts) -> _types.Iterator[tuple[str, int]]:
    for info in message.FIELDS:
        if info.type != "float" or info.bits != 32 or info.at % 8:
            continue
        if info.elements or info.when:
            continue  # elements, and what is not always there, are read as bits
        if info.byte_order in ("", message.BYTE_ORDER):
            yield info.attribute, info.at // 8
