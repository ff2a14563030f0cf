"""Optional fields: present only if other fields have certain values, otherwise None.

`decoder` and `encoder` wrap the compiled functions of a class that has such fields.
"""

from __future__ import annotations

from . import _types
from ._codec import (
    ENCODING_ERRORS,
    is_present,
    range_error,
    signed,
    signed_bits,
    unsigned_bits,
)
from ._floats import float32, float32_bits, float64, float64_bits
from ._layout import pieces
from ._types import FieldInfo, MessageFacts


def settle(message: MessageFacts, given: _types.Any) -> None:
    """Set optional fields that are not present to None, except for ``given``
    attributes.
    """
    for info in message.FIELDS:
        is_given = info.attribute in given or info.physical in given
        if info.when and not is_given and not is_present(info, message):
            setattr(message, info.attribute, None)


def decoder(owner: _types.Any, unconditional: _types.Any) -> _types.Any:
    """Return ``from_bytes`` of a class with optional fields.

    ``unconditional`` decodes the other fields.
    """
    optional = [(info, pieces(info, owner)) for info in owner.FIELDS if info.when]

    def from_bytes(cls: _types.Any, data: _types.Buffer) -> _types.Any:
        self = unconditional(cls, data)
        frame = memoryview(data).tobytes()
        for info, runs in optional:
            value = None
            if is_present(info, self):
                bits = 0
                for piece in runs:
                    part = frame[piece.byte] >> piece.shift & (1 << piece.bits) - 1
                    bits |= part << piece.at
                value = _value(info, bits)
            setattr(self, info.attribute, value)
        return self

    return from_bytes


def encoder(owner: _types.Any, unconditional: _types.Any) -> _types.Any:
    """Return ``to_bytes`` of a class with optional fields.

    ``unconditional`` encodes the other fields.
    """
    optional = [(info, pieces(info, owner)) for info in owner.FIELDS if info.when]

    def to_bytes(self: _types.Any) -> bytes:
        frame = bytearray(unconditional(self))
        for info, runs in optional:
            if is_present(info, self):
                try:
                    bits = _bits(info, getattr(self, info.attribute))
                except ENCODING_ERRORS:
                    raise range_error(self) from None
                for piece in runs:
                    part = bits >> piece.at & (1 << piece.bits) - 1
                    frame[piece.byte] |= part << piece.shift
        return bytes(frame)

    return to_bytes


def _value(info: FieldInfo, bits: int) -> _types.Any:
    if info.type == "float":
        return float32(bits) if info.bits == 32 else float64(bits)
    if info.type == "bool":
        return bool(bits)
    number = signed(bits, info.bits) if info.signed else bits
    return number if info.enum is None else info.enum(number)


def _bits(info: FieldInfo, value: _types.Any) -> int:
    """Return the bits of a value in the frame. Raise one of `ENCODING_ERRORS`."""
    if info.type == "float":
        return float32_bits(value) if info.bits == 32 else float64_bits(value)
    return (signed_bits if info.signed else unsigned_bits)(value, info.bits)


def absent(numpy: _types.Any, info: FieldInfo, columns: _types.Any) -> _types.Any:
    """Return whether an optional field is missing in each frame.

    ``columns`` are the raw values of the fields in its condition.
    """
    present = numpy.ones((), bool)
    for name, values in info.when:
        present = present & numpy.isin(columns[name], values)
    return ~present
