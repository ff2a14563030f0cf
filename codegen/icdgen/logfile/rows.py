"""Entries as Python values, one at a time, with the standard library only.

`reader` returns, for each column, a function that reads its value from the bytes of an
entry. `icdgen.logfile.parquet` does the same for many entries at once with numpy.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Iterator
from functools import lru_cache

from icdgen import codec
from icdgen.icd import floats
from icdgen.logfile.columns import LogColumn
from icdgen.logfile.source import LogSource, time_text

Value = int | float | str | bool | None  # None: missing
Done = Callable[[int], None]  # called with the number of bytes read


def log_rows(source: LogSource, head: int | None, done: Done) -> Iterator[list[Value]]:
    """Iterate over time and values of each entry."""
    readers = [reader(column) for column in source.plan.columns]
    size = source.plan.entry_bytes
    for piece in source.pieces(head):
        for at in range(0, len(piece), size):
            entry = piece[at : at + size]
            yield [time_text(source.time(entry)), *(read(entry) for read in readers)]
        done(len(piece))


def reader(column: LogColumn) -> Callable[[bytes], Value]:
    """Return the function that reads the value of a column from an entry."""
    if column.operands:
        return _derived(column)
    return _READERS.get(column.kind, _integer)(column)


def _derived(column: LogColumn) -> Callable[[bytes], float]:
    """Return the function that computes a derived value from an entry."""
    assert column.field and column.field.derived
    formula = column.field.derived
    operands = [_number(operand) for operand in column.operands]
    return lambda entry: formula.double([operand(entry) for operand in operands])


def _number(column: LogColumn) -> Callable[[bytes], float]:
    """Return the function that reads a number from an entry as a double."""
    if column.operands:
        return _derived(column)
    assert column.field
    field, raw = column.field, _raw(column)
    return lambda entry: codec.value_double(field, raw(entry))


def _raw(column: LogColumn) -> Callable[[bytes], int]:
    """Return the function that reads a raw integer from an entry."""
    assert column.field
    field, first, last = column.field, column.at, column.at + column.size
    if field.at % 8 == 0 and field.bits % 8 == 0:
        order, signed = column.byte_order, field.is_signed
        return lambda entry: int.from_bytes(entry[first:last], order, signed=signed)  # type: ignore[arg-type]
    if len(column.pieces) == 1 and not field.is_signed:
        (piece,) = column.pieces
        byte, shift, mask = piece.byte, piece.shift, (1 << piece.bits) - 1
        return lambda entry: entry[byte] >> shift & mask
    pieces, sign = column.pieces, 1 << field.bits - 1 if field.is_signed else 0

    def read(entry: bytes) -> int:
        # Two's complement: the sign bit counts negative.
        value = sum((entry[p.byte] & p.mask) >> p.shift << p.at for p in pieces)
        return value - (value & sign) * 2

    return read


def _integer(column: LogColumn) -> Callable[[bytes], Value]:
    raw, steps, curve = _raw(column), column.steps, column.curve
    if curve is not None:
        return lambda entry: curve.double(raw(entry))
    if steps is None:
        return raw
    a, b, d = steps.terms
    return lambda entry: (raw(entry) * a + b) / d


def _bool(column: LogColumn) -> Callable[[bytes], Value]:
    raw = _raw(column)
    return lambda entry: bool(raw(entry))


def _enum(column: LogColumn) -> Callable[[bytes], Value]:
    assert column.field and column.field.enum
    raw, enum = _raw(column), column.field.enum

    @lru_cache(maxsize=1024)
    def name(value: int) -> str:
        member = enum.member_of(value)
        return member.name if member else f"unknown {value}"

    return lambda entry: name(raw(entry))


def _float(column: LogColumn) -> Callable[[bytes], Value]:
    assert column.field
    raw, bits, curve = _raw(column), column.field.bits, column.curve
    form, integer_form = ("<f", "<I") if bits == 32 else ("<d", "<Q")

    def read(entry: bytes) -> Value:
        # `raw` gives a number, so any byte order will do if both calls use the same.
        value = struct.unpack(form, struct.pack(integer_form, raw(entry)))[0]
        if curve is not None:
            return curve.double(value)
        # 0.1, not 0.10000000149011612.
        return float(floats.text_of(value, bits)) if math.isfinite(value) else value

    return read


def _octets(
    column: LogColumn, shown: Callable[[bytes], str]
) -> Callable[[bytes], Value]:
    first, last = column.at, column.at + column.size
    return lambda entry: shown(entry[first:last])


_READERS: dict[str, Callable[[LogColumn], Callable[[bytes], Value]]] = {
    "text": lambda column: _octets(column, codec.text), "bool": _bool, "enum": _enum, "float": _float,
    "bytes": lambda column: _octets(column, bytes.hex),
}  # fmt: skip
