"""Helpers of the compiled decoders and encoders, and the search for a value out of
range.

`_compiled` refers to these functions in the code that it makes.
"""

from __future__ import annotations

import struct

from . import _types
from ._errors import LengthError, RangeError
from ._types import FieldInfo, MessageFacts

ENCODING_ERRORS = (
    struct.error,
    ArithmeticError,
    AttributeError,
    LookupError,
    TypeError,
    ValueError,
)
"""Exceptions of the encoders for a value out of range."""


def is_present(info: FieldInfo, message: _types.Any) -> bool:
    """Return whether the message has an optional field, by the fields in its condition."""
    return all(getattr(message, name) in values for name, values in info.when)


def has_elements(info: FieldInfo, values: _types.Any) -> bool:
    """Return whether the number of values is valid for an array."""
    if not hasattr(values, "__getitem__") or not hasattr(values, "__len__"):
        return False
    least = info.fewest if info.is_open else info.elements
    return least <= len(values) <= info.elements


def elements_of(info: FieldInfo) -> str:
    """Return the valid number of elements of an array, such as ``6 values``."""
    return f"{_at_least(info)}{info.elements} values"


def _at_least(info: FieldInfo) -> str:
    if not info.is_open:
        return ""
    return f"{info.fewest} to " if info.fewest else "up to "


def signed(value: int, bits: int) -> int:
    """Return the number that ``bits`` bits of two's complement represent.

    >>> signed(0b1111, 4)
    -1
    """
    return value - (1 << bits) if value >> (bits - 1) else value


def bit_table(
    parts: tuple[tuple[int, FieldInfo], ...],
) -> tuple[_types.Any, ...]:
    """Return the values of the fields within a byte for each of its 256 values.

    Each field begins at bit ``shift``. One field gives a table of values, several
    fields give a table of tuples.
    """
    columns = []
    for shift, info in parts:
        mask = (1 << info.bits) - 1
        values: list[_types.Any] = [_value(info, bits) for bits in range(mask + 1)]
        columns.append([values[byte >> shift & mask] for byte in range(256)])
    return tuple(columns[0]) if len(columns) == 1 else tuple(zip(*columns))


def _value(info: FieldInfo, bits: int) -> _types.Any:
    number = signed(bits, info.bits) if info.signed else bits
    if info.enum is not None:
        return info.enum(number)
    return bool(bits) if info.type == "bool" else number


class Inverse(dict[object, int]):
    """Byte by the values of a `bit_table`, with reserved bits 0.

    Filled at the first use.
    """

    def __init__(self, table: tuple[_types.Any, ...]) -> None:
        super().__init__()
        self._table = table
        self._is_filled = False

    def __missing__(self, values: _types.Any) -> int:
        if self._is_filled:
            raise KeyError(values)
        # Bytes that differ in reserved bits have equal values. The smallest is entered
        # last and remains: its reserved bits are 0.
        self.update({self._table[byte]: byte for byte in range(255, -1, -1)})
        self._is_filled = True
        return self[values]


class Members(dict[int, "_types.OpenEnum"]):
    """Members of an enumeration by value.

    Unknown values are added by the enumeration.
    """

    def __init__(self, enum: type[_types.OpenEnum]) -> None:
        super().__init__((member.value, member) for member in enum)
        self._enum = enum

    def __missing__(self, value: int) -> _types.OpenEnum:
        return self._enum(value)


def unsigned_bits(value: int, bits: int) -> int:
    """Return ``value``. Raise `OverflowError` if it needs more than ``bits`` bits."""
    # `__index__` rejects floats. A negative number shifts to -1, which is true.
    if value.__index__() >> bits:
        raise OverflowError
    return value


def signed_bits(value: int, bits: int) -> int:
    """Return ``value`` in two's complement.

    Raise `OverflowError` if it needs more bits.
    """
    if (value.__index__() + (1 << (bits - 1))) >> bits:
        raise OverflowError
    return value & ((1 << bits) - 1)


def check_count(values: _types.Any, count: int) -> None:
    """Raise `ValueError` unless there are exactly ``count`` values."""
    if len(values) != count:
        raise ValueError


def checked_bytes(value: _types.Buffer, size: int) -> bytes:
    """Return ``value`` as bytes. Raise `OverflowError` unless it has ``size`` bytes."""
    data = memoryview(value).tobytes()
    if len(data) != size:
        raise OverflowError
    return data


def text(value: _types.Buffer) -> str:
    """Return the characters before the first NUL.

    A byte that is not ASCII becomes U+FFFD.

    >>> text(bytes([0x31, 0x2E, 0x32, 0, 0]))
    '1.2'
    """
    characters = bytes(value).split(b"\0", 1)[0]
    return characters.decode("ascii", "replace")


def text_bytes(value: str, field: str, size: int) -> bytes:
    """Return a text as bytes, padded with NUL. Raise `RangeError`."""
    if (
        not isinstance(value, str)
        or not value.isascii()
        or "\0" in value
        or len(value) > size
    ):
        raise RangeError(
            field, f"up to {size} ASCII characters, none of them NUL", value
        )
    return value.encode("ascii").ljust(size, b"\0")


def texts_of(info: FieldInfo, value: _types.Any) -> _types.Any:
    """Return the text of a field of characters, or the texts of an array."""
    return tuple(map(text, value)) if info.elements else text(value)


def bytes_of_texts(info: FieldInfo, value: _types.Any) -> _types.Any:
    """Return the raw value of a text, or of the texts of an array.

    Raise `RangeError`.
    """
    size = info.bits // 8
    if not info.elements:
        raw = text_bytes(value, info.physical, size)
        return raw[: max(len(value), info.fewest)] if info.is_open else raw
    if not has_elements(info, value):
        raise RangeError(info.physical, elements_of(info), value)
    return tuple(
        text_bytes(element, f"{info.physical}[{index}]", size)
        for index, element in enumerate(value)
    )


def length_error(message: type[MessageFacts], data: _types.Buffer) -> LengthError:
    """Return the exception for a frame whose length does not match."""
    return LengthError(message.NAME, message.LENGTH, memoryview(data).nbytes)


def range_error(message: MessageFacts) -> RangeError:
    """Return the exception for the first field whose value is out of range."""
    for info in message.FIELDS:
        if info.when and not is_present(info, message):
            continue
        error = _field_error(info, getattr(message, info.attribute, None))
        if error is not None:
            return error
    return RangeError("a field", "a value of its type", None)


def _field_error(info: FieldInfo, value: _types.Any) -> _types.Optional[RangeError]:
    """Return the exception for a field if its value, or an element, is out of range."""
    if info.elements and not has_elements(info, value):
        return RangeError(info.attribute, elements_of(info), value)
    for part, element in zip(info.parts, value if info.elements else (value,)):
        if part.struct is not None:
            for inner in part.struct.FIELDS:
                inner_value = getattr(element, inner.attribute, None)
                error = _field_error(inner.within(part), inner_value)
                if error is not None:
                    return error
            continue
        allowed, fits = _FITS[info.type](part, element)
        if not fits:
            return RangeError(part.attribute, allowed, element)
    return None


def value_of_bits(
    info: FieldInfo,
    message: type[MessageFacts],
    frame: bytes,
    kind: _types.Any,
) -> _types.Any:
    """Return the value of an overlay field in a frame, as an object of type ``kind``."""
    from ._floats import float32, float64
    from ._layout import pieces

    value = 0
    for piece in pieces(info, message):
        value |= (frame[piece.byte] >> piece.shift & (1 << piece.bits) - 1) << piece.at
    if kind is float:
        return float32(value) if info.bits == 32 else float64(value)
    return kind(signed(value, info.bits) if info.signed else value)


def _fits_integer(info: FieldInfo, value: _types.Any) -> tuple[str, bool]:
    low, high = info.raw_range
    named = "" if info.enum is None else f"members of {info.enum.__name__} or "
    meant = info.physical if isinstance(value, float) and info.leads_back else ""
    hint = f" ({meant} takes physical values)" if meant else ""
    return f"{named}integers from {low} to {high}{hint}", _is_within(value, low, high)


def _fits_bool(info: FieldInfo, value: _types.Any) -> tuple[str, bool]:
    return "True or False", _is_within(value, 0, 1)


def _is_within(value: _types.Any, low: int, high: int) -> bool:
    try:
        return bool(low <= value.__index__() <= high)
    except (AttributeError, TypeError):
        return False


def _fits_float(info: FieldInfo, value: _types.Any) -> tuple[str, bool]:
    try:
        struct.pack("<f" if info.bits == 32 else "<d", value)
    except ENCODING_ERRORS:
        return f"{info.bits}-bit floats", False
    return "", True


def _fits_bytes(info: FieldInfo, value: _types.Any) -> tuple[str, bool]:
    try:
        size, most = memoryview(value).nbytes, info.bits // 8
        fits = (info.fewest if info.is_open else most) <= size <= most
    except TypeError:
        fits = False
    return f"{_at_least(info)}{info.bits // 8} bytes", fits


_FITS: dict[str, _types.Callable[[FieldInfo, _types.Any], tuple[str, bool]]] = {
    "uint": _fits_integer,
    "int": _fits_integer,
    "enum": _fits_integer,
    "bool": _fits_bool,
    "float": _fits_float,
    "bytes": _fits_bytes,
    "text": _fits_bytes,
}
