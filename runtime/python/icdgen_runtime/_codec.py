"""What generated messages decode and encode with."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from typing import Any, TypeVar

from ._base import Buffer, FieldInfo, Message
from ._enumeration import OpenEnum, is_signed
from ._errors import LengthError, RangeError

_E = TypeVar("_E", bound=OpenEnum)
_T = TypeVar("_T")
new = object.__new__

REFUSED = (
    struct.error,
    ArithmeticError,
    AttributeError,
    LookupError,
    TypeError,
    ValueError,
)
"""What a value that does not fit makes the encoders raise."""


def signed(value: int, bits: int) -> int:
    """The number that ``bits`` bits of two's complement stand for."""
    return value - (1 << bits) if value >> (bits - 1) else value


@cache
def bit_table(*parts: tuple[int, int, Any]) -> tuple[Any, ...]:
    """The values of the fields of a byte, for each of its 256 values.

    A part is shift, width and kind: `bool`, `int`, `signed` or an enumeration. One
    part gives a table of values, several a table of tuples.
    """
    columns = []
    for shift, bits, kind in parts:
        if kind is signed:
            values = [signed(value, bits) for value in range(1 << bits)]
        elif issubclass(kind, OpenEnum) and is_signed(kind):
            values = [kind(signed(value, bits)) for value in range(1 << bits)]
        else:
            values = [kind(value) for value in range(1 << bits)]
        mask = (1 << bits) - 1
        columns.append([values[byte >> shift & mask] for byte in range(256)])
    return tuple(columns[0]) if len(columns) == 1 else tuple(zip(*columns))


class Inverse(dict[Any, int]):
    """The byte that the values of a `bit_table` stand for, reserved bits 0.

    It is filled when it is first used.
    """

    def __init__(self, table: tuple[Any, ...]) -> None:
        super().__init__()
        self._table = table
        self._is_filled = False

    def __missing__(self, values: Any) -> int:
        if self._is_filled:
            raise KeyError(values)
        self.update({self._table[byte]: byte for byte in range(255, -1, -1)})
        self._is_filled = True
        return self[values]


class Members(dict[int, _E]):
    """The members of an enumeration by value."""

    def __init__(self, enum: type[_E]) -> None:
        super().__init__((member.value, member) for member in enum)
        self._enum = enum

    def __missing__(self, value: int) -> _E:
        return self._enum(value)


def unnamed(enum: type[_E], value: int) -> _E:
    """The member of a value that the manual does not name."""
    return enum(value)


def unsigned_bits(value: int, bits: int) -> int:
    """``value``, if it fits."""
    if value.__index__() >> bits:
        raise OverflowError
    return value


def signed_bits(value: int, bits: int) -> int:
    """``value`` in two's complement, if it fits."""
    if (value.__index__() + (1 << (bits - 1))) >> bits:
        raise OverflowError
    return value & ((1 << bits) - 1)


array = struct.Struct
"""Packs and unpacks the elements of an array."""


def counted(values: Sequence[_T], count: int) -> Sequence[_T]:
    """``values``, if there are so many."""
    if len(values) != count:
        raise ValueError
    return values


def sized(value: Buffer, size: int) -> bytes:
    """``value``, if it has that many bytes."""
    data = memoryview(value).tobytes()
    if len(data) != size:
        raise OverflowError
    return data


def text(value: Buffer) -> str:
    """What stands before the first NUL; U+FFFD for each byte that is not ASCII."""
    said = bytes(value).split(b"\0", 1)[0]
    return said.decode("ascii", "replace")


def text_bytes(value: str, field: str, size: int) -> bytes:
    """The bytes of a text, filled with NUL. Raises `RangeError`."""
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


def raw_value(
    value: float, field: str, scale: tuple[int, int, int], low: int, high: int
) -> int:
    """The raw value whose physical value is nearest; of two, the even one.

    The physical value is ``(raw * p + c) / q``. ``value`` is taken exactly: a float,
    an integer, or anything else that has ``as_integer_ratio``. Raises `RangeError`.
    """
    p, c, q = scale
    try:
        over, under = value.as_integer_ratio()
    except (ArithmeticError, AttributeError, TypeError, ValueError):
        raise RangeError(field, _limits(scale, low, high), value) from None
    over, under = over * q - c * under, under * p
    if under < 0:
        over, under = -over, -under
    raw, rest = divmod(over, under)
    if 2 * rest > under or (2 * rest == under and raw % 2):
        raw += 1
    if not low <= raw <= high:
        raise RangeError(field, _limits(scale, low, high), value)
    return raw


def raw_values(
    values: Sequence[float],
    field: str,
    scale: tuple[int, int, int],
    low: int,
    high: int,
    count: int,
) -> tuple[int, ...]:
    """`raw_value` of each of ``count`` elements. Raises `RangeError`."""
    if len(values) != count:
        raise RangeError(field, f"{count} values", values)
    return tuple(
        raw_value(value, f"{field}[{index}]", scale, low, high)
        for index, value in enumerate(values)
    )


def _limits(scale: tuple[int, int, int], low: int, high: int) -> str:
    p, c, q = scale
    least, most = sorted(((low * p + c) / q, (high * p + c) / q))
    return f"{least!r} to {most!r}"


def length_error(message: type[Message], data: Buffer) -> LengthError:
    """What to raise for a frame that does not have the length of the message."""
    return LengthError(message.NAME, message.LENGTH, memoryview(data).nbytes)


def range_error(message: Message) -> RangeError:
    """What to raise for a message that has a value that does not fit."""
    for info in message.FIELDS:
        value = getattr(message, info.attribute, None)
        for name, one in _elements(info, value):
            allowed, fits = _FITS[info.type](info, one)
            if not fits:
                return RangeError(name, allowed, one)
        if info.elements and not _has_elements(info, value):
            return RangeError(info.attribute, f"{info.elements} values", value)
    return RangeError("a field", "a value of its type", None)


def _has_elements(info: FieldInfo, value: Any) -> bool:
    return hasattr(value, "__getitem__") and len(value) == info.elements


def _elements(info: FieldInfo, value: Any) -> Iterator[tuple[str, Any]]:
    """What is to fit, and what it is called: the value, or each element of an array."""
    if not info.elements:
        yield info.attribute, value
    elif _has_elements(info, value):
        for index in range(info.elements):
            yield f"{info.attribute}[{index}]", value[index]


def raw_range(info: FieldInfo) -> tuple[int, int]:
    """Smallest and largest raw value of a field that holds integers."""
    if info.signed:
        return -(1 << (info.bits - 1)), (1 << (info.bits - 1)) - 1
    return 0, (1 << info.bits) - 1


def _fits_integer(info: FieldInfo, value: Any) -> tuple[str, bool]:
    low, high = raw_range(info)
    return f"integers from {low} to {high}", _is_within(value, low, high)


def _fits_bool(info: FieldInfo, value: Any) -> tuple[str, bool]:
    return "True or False", _is_within(value, 0, 1)


def _is_within(value: Any, low: int, high: int) -> bool:
    try:
        return bool(low <= value.__index__() <= high)
    except (AttributeError, TypeError):
        return False


def _fits_float(info: FieldInfo, value: Any) -> tuple[str, bool]:
    try:
        struct.pack("<f" if info.bits == 32 else "<d", value)
    except REFUSED:
        return f"{info.bits}-bit floats", False
    return "", True


def _fits_bytes(info: FieldInfo, value: Any) -> tuple[str, bool]:
    try:
        fits = memoryview(value).nbytes == info.bits // 8
    except TypeError:
        fits = False
    return f"{info.bits // 8} bytes", fits


_FITS: dict[str, Callable[[FieldInfo, Any], tuple[str, bool]]] = {
    "uint": _fits_integer,
    "int": _fits_integer,
    "enum": _fits_integer,
    "bool": _fits_bool,
    "float": _fits_float,
    "bytes": _fits_bytes,
    "text": _fits_bytes,
}
