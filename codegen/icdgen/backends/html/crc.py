"""A checksum from its parameters, as `protocol.crc8` and `protocol.crc16` of an ICD give them."""

from __future__ import annotations

from collections.abc import Mapping


def crc(facts: Mapping[str, object], data: bytes) -> int:
    """The checksum of ``data``, one bit at a time; ``empty`` overrides that of nothing."""
    if not data and isinstance(empty := facts.get("empty"), int):
        return empty
    width, polynomial, value = _int(facts, "width"), _int(facts, "polynomial"), _int(facts, "init")
    top, mask = 1 << (width - 1), (1 << width) - 1
    for byte in data:
        value ^= (_mirrored(byte, 8) if facts["reflect_in"] else byte) << (width - 8)
        for _ in range(8):
            value = (value << 1 ^ polynomial if value & top else value << 1) & mask
    return (_mirrored(value, width) if facts["reflect_out"] else value) ^ _int(facts, "xor_out")


def _int(facts: Mapping[str, object], key: str) -> int:
    value = facts[key]
    assert isinstance(value, int)
    return value


def _mirrored(value: int, width: int) -> int:
    return int(f"{value:0{width}b}"[::-1], 2)
