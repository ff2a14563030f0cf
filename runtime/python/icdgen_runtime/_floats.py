"""Floats whose NaNs keep sign and payload.

`struct` makes signalling 32-bit NaNs quiet. This module converts a 32-bit NaN to the
64-bit NaN with equal sign and payload, and back.
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
    """Return whether a number is the special value. Any NaN matches a special NaN."""
    return value == special or (isnan(value) and isnan(special))


def float32(bits: int) -> float:
    """Return the number of 32 bits. NaNs keep sign and payload."""
    # A NaN has all bits of the exponent and a payload other than 0. The payloads have
    # 23 and 52 bits, which begin at the same end.
    if bits & 0x7F800000 == 0x7F800000 and bits & 0x007FFFFF:
        wide = (bits >> 31) << 63 | 0x7FF << 52 | (bits & 0x007FFFFF) << 29
        return float64(wide)
    (value,) = _FLOAT32.unpack(_BITS32.pack(bits))
    return float(value)


def float32_bits(value: float) -> int:
    """Return the bits of the nearest 32-bit float. NaNs keep sign and payload."""
    if isnan(value):
        wide = float64_bits(value)
        # With payload 0, it would be infinity. Then use the quiet NaN.
        payload = wide >> 29 & 0x007FFFFF
        return wide >> 63 << 31 | 0x7F800000 | (payload or 0x00400000)
    (bits,) = _BITS32.unpack(_FLOAT32.pack(value))
    return int(bits)


def float64(bits: int) -> float:
    """Return the number of 64 bits."""
    (value,) = _FLOAT64.unpack(_BITS64.pack(bits))
    return float(value)


def float64_bits(value: float) -> int:
    """Return the bits of a 64-bit float."""
    (bits,) = _BITS64.unpack(_FLOAT64.pack(value))
    return int(bits)


def keep_nans(message: MessageFacts, data: _types.Buffer) -> None:
    """Set the byte-aligned 32-bit floats of ``message`` again, exactly as in ``data``."""
    frame = memoryview(data).tobytes()
    for name, byte in _aligned(message):
        bits = int.from_bytes(frame[byte : byte + 4], message.BYTE_ORDER)
        setattr(message, name, float32(bits))


def with_nans(message: MessageFacts, frame: bytes) -> bytes:
    """Return ``frame`` with the exact bits of the byte-aligned 32-bit floats of
    ``message``.
    """
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
            continue  # the decoder reads array elements and optional fields as bits
        if info.byte_order in ("", message.BYTE_ORDER):
            yield info.attribute, info.at // 8
