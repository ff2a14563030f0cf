"""The reference codec: slow, obvious, exact. The judge of all generated code, so it shares nothing with ``layout``.

Raw values are int (uint, int, enum, bool as 0 or 1), bytes (bytes fields) and, for floats, the int of their IEEE 754 bits, so
that every NaN survives. Physical values are exact `fractions.Fraction`s.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from fractions import Fraction

from icdgen.icd.model import Field, Message, Node


class CodecError(ValueError):
    """The value or the frame does not fit the message; the message says what was expected and what was given."""


class LengthError(CodecError):
    def __init__(self, message: Message, actual: int) -> None:
        super().__init__(f"{message.name} has {message.length} bytes, {actual} given")
        self.expected, self.actual = message.length, actual


def decode(node: Node, message: Message, frame: bytes) -> dict[str, int | bytes]:
    """Raw value of every field by name. Raises `LengthError`."""
    if len(frame) != message.length:
        raise LengthError(message, len(frame))
    return {field.name: _read(node, field, frame) for field in message.fields}


def encode(node: Node, message: Message, raw: Mapping[str, int | bytes]) -> bytes:
    """The frame, reserved bits 0. Raises `CodecError` for a missing, unknown or unfit value."""
    known = {field.name for field in message.fields}
    for name in raw:
        if name not in known:
            raise CodecError(f"{message.name} has no field {name!r}")
    frame = bytearray(message.length)
    for field in message.fields:
        if field.name not in raw:
            raise CodecError(f"no value for {field.name!r}")
        _write(node, field, frame, raw[field.name])
    return bytes(frame)


def check_raw(field: Field, value: int | bytes) -> None:
    """Raises `CodecError` unless the field can hold the raw value."""
    if field.type == "bytes":
        if not isinstance(value, (bytes, bytearray)) or len(value) != field.bits // 8:
            raise CodecError(f"{field.name!r} takes {field.bits // 8} bytes")
        return
    if isinstance(value, (bytes, bytearray, str)) or value != int(value):
        raise CodecError(f"{field.name!r} takes an integer")
    if not field.raw_min <= value <= field.raw_max:
        raise CodecError(f"{field.name!r} takes {field.raw_min} to {field.raw_max}, not {value}")


def physical(field: Field, raw: int) -> Fraction | None:
    """Exact physical value of an integer field with a scale, else None."""
    return field.scale.physical(raw) if field.scale else None


def physical_double(field: Field, raw: int) -> float | None:
    """The correctly rounded double of the physical value."""
    exact = physical(field, raw)
    return None if exact is None else _to_double(exact)


def raw_from_physical(field: Field, value: Fraction | int | float) -> int:
    """Nearest raw value, ties to even. Raises `CodecError` if it is not finite or does not fit."""
    if isinstance(value, float):
        if value != value or value in (float("inf"), float("-inf")):
            raise CodecError(f"{field.name!r} takes a finite number, not {value}")
    exact = Fraction(value)
    raw = round(field.scale.raw(exact) if field.scale else exact)  # Fraction rounds ties to even
    if not field.raw_min <= raw <= field.raw_max:
        low, high = sorted(float(field.scale.physical(r)) if field.scale else r for r in (field.raw_min, field.raw_max))
        raise CodecError(f"{field.name!r} takes {low:g} to {high:g}, not {float(exact):g}")
    return raw


def float_value(field: Field, bits: int) -> float:
    """The number that the bits of a float field stand for."""
    return struct.unpack("<f" if field.bits == 32 else "<d", bits.to_bytes(field.bits // 8, "little"))[0]


def float_bits(field: Field, value: float) -> int:
    """The bits of the nearest float of the field's width. Raises `CodecError` on overflow."""
    try:
        packed = struct.pack("<f" if field.bits == 32 else "<d", value)
    except OverflowError:
        raise CodecError(f"{field.name!r} is a {field.bits}-bit float and cannot hold {value:g}") from None
    return int.from_bytes(packed, "little")


def _to_double(exact: Fraction) -> float:
    return exact.numerator / exact.denominator  # int / int rounds correctly, once


def _bit_positions(node: Node, field: Field) -> list[tuple[int, int]]:
    """(byte, weight in the byte) of each bit of the value, least significant first."""
    runs: list[list[tuple[int, int]]] = []
    for number in range(field.at, field.at + field.bits):
        byte = number // 8
        weight = number % 8 if node.bit_order == "lsb0" else 7 - number % 8
        if not runs or runs[-1][0][0] != byte:
            runs.append([])
        runs[-1].append((byte, weight))
    if node.byte_order == "big":
        runs.reverse()
    return [position for run in runs for position in sorted(run, key=lambda p: p[1])]


def _read(node: Node, field: Field, frame: bytes) -> int | bytes:
    if field.type == "bytes":
        first = field.at // 8
        return bytes(frame[first : first + field.bits // 8])
    value = 0
    for index, (byte, weight) in enumerate(_bit_positions(node, field)):
        value += ((frame[byte] >> weight) & 1) << index
    if field.type == "int" and value >> (field.bits - 1):
        value -= 1 << field.bits
    return value


def _write(node: Node, field: Field, frame: bytearray, value: int | bytes) -> None:
    check_raw(field, value)
    if field.type == "bytes":
        first = field.at // 8
        frame[first : first + field.bits // 8] = value
        return
    for index, (byte, weight) in enumerate(_bit_positions(node, field)):
        if (int(value) >> index) & 1:
            frame[byte] |= 1 << weight
