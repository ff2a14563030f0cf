"""Conversion to Parquet with numpy and pyarrow.

One thread decodes while another writes. `ColumnReader` reads one column of many entries
at once; `icdgen.logfile.rows` is the same for single entries without these libraries.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING

from icdgen_runtime._curves import columns_on_curve
from icdgen_runtime._derived import column as derived_column

from icdgen import codec
from icdgen.errors import UserError
from icdgen.icd.model import Node
from icdgen.logfile.columns import TIME, EntryLayout, LogColumn
from icdgen.logfile.source import LogSource
from icdgen.logfile.strided import numbers_at

if TYPE_CHECKING:
    import numpy as np
    import pyarrow as pa

PIECE = 6 << 20  # bytes decoded at a time: fits the cache of the processor
GROUP = 24 << 20  # approximate bytes of the log in a row group


def to_parquet(
    source: LogSource, path: Path, head: int | None, done: Callable[[int], None]
) -> None:
    """Write the file.

    Units and names are metadata of the columns. Raise `icdgen.errors.UserError`.
    """
    check_installed()
    decoder = Decoder(source.plan)
    write(path, decoder.schema, _ahead(_groups(source, decoder, head, done)))


def write(path: Path, schema: pa.Schema, tables: Iterable[pa.Table]) -> None:
    """Write a file with these row groups."""
    import pyarrow.parquet as pq

    with pq.ParquetWriter(
        path, schema, compression="lz4", write_page_index=True
    ) as writer:
        for table in tables:
            # pyarrow would divide tables of more than 2**20 rows.
            writer.write_table(table, row_group_size=table.num_rows)


def schema_of(fields: Iterable[pa.Field], node: Node) -> pa.Schema:
    """Return the schema of the columns, with the node as metadata."""
    import pyarrow as pa

    return pa.schema(
        fields, {"icdgen.node": node.name, "icdgen.icd_sha256": node.digest}
    )


def check_installed() -> None:
    """Raise `icdgen.errors.UserError` if numpy or pyarrow is not installed."""
    try:
        import numpy  # noqa: F401
        import pyarrow.parquet  # noqa: F401
    except ImportError:
        raise UserError(
            "pyarrow and numpy are not installed", "pip install 'icdgen[arrow]'"
        ) from None


def _groups(
    source: LogSource, decoder: Decoder, head: int | None, done: Callable[[int], None]
) -> Iterator[pa.Table]:
    """Decode row groups of about `GROUP` bytes."""
    import pyarrow as pa

    batches, size = [], 0
    for piece in source.pieces(head, PIECE):
        batches.append(decoder.batch(piece))
        size += len(piece)
        if size >= GROUP:
            yield pa.Table.from_batches(batches)
            batches, size = [], 0
        done(len(piece))
    if batches:
        yield pa.Table.from_batches(batches)


def _ahead(items: Iterator[pa.Table]) -> Iterator[pa.Table]:
    """Return the items. A thread creates each item while the previous one is used."""
    # One thread only: two threads must not run a generator at the same time.
    with ThreadPoolExecutor(1) as thread:
        coming = thread.submit(next, items, None)
        while (item := coming.result()) is not None:
            coming = thread.submit(next, items, None)
            yield item


class Decoder:
    """Converter of entries to Arrow record batches."""

    def __init__(self, plan: EntryLayout) -> None:
        import pyarrow as pa

        self.plan = plan
        self.columns = [
            ColumnReader(column, plan.entry_bytes) for column in plan.columns
        ]
        time = pa.field(TIME, pa.timestamp("ms", tz="UTC"), nullable=False)
        self.schema = schema_of(
            [time, *(reader.field for reader in self.columns)], plan.node
        )

    def batch(self, data: bytes) -> pa.RecordBatch:
        """Return the entries in ``data`` as a record batch."""
        import numpy as np
        import pyarrow as pa

        plan, count = self.plan, len(data) // self.plan.entry_bytes
        seconds = numbers_at(
            data, plan.entry_bytes, *plan.seconds, plan.order == "little"
        )
        milliseconds = numbers_at(
            data, plan.entry_bytes, *plan.milliseconds, plan.order == "little"
        )
        time = pa.array(
            seconds.astype(np.int64) * 1000 + milliseconds, pa.int64()
        ).cast(self.schema.field(0).type)
        arrays = [time, *(reader.read(data, count) for reader in self.columns)]
        return pa.RecordBatch.from_arrays(arrays, schema=self.schema)


class ColumnReader:
    """Converter of one column of entries to an Arrow array."""

    def __init__(self, column: LogColumn, entry_bytes: int) -> None:
        import pyarrow as pa

        self.column, self.stride = column, entry_bytes
        self.operands = [
            ColumnReader(operand, entry_bytes) for operand in column.operands
        ]
        self.names: pa.Array | None = None  # names of all values of a small enumeration
        metadata = {
            "frame": column.frame,
            "field": column.field.name if column.field else "",
            "unit": column.unit,
        }
        if column.field and column.field.enum:
            metadata["members"] = json.dumps(
                {m.values: m.name for m in column.field.enum.members}
            )
        self.field = pa.field(
            column.name, self._type(), nullable=False, metadata=metadata
        )

    def _type(self) -> pa.DataType:
        import pyarrow as pa

        column = self.column
        if column.kind == "bytes" or column.field is None:
            return pa.binary(column.size)
        if column.kind == "text":
            return pa.string()
        if column.kind == "bool":
            return pa.bool_()
        if column.curve:
            return pa.float64()
        if column.kind == "float":
            return pa.float32() if column.field.bits == 32 else pa.float64()
        if column.kind == "enum":
            # Up to 256 values share one dictionary of all names. Larger enumerations
            # get the names that occur in a batch, so their indices differ from batch to
            # batch.
            # The raw value is the index of its name, so it must not be negative.
            if column.field.bits > 8 or column.field.is_signed:
                return pa.dictionary(pa.int32(), pa.string())
            self.names = pa.array(self._named(range(1 << column.field.bits)))
            return pa.dictionary(pa.uint8(), pa.string())
        if column.steps:
            return pa.float64()
        size = next(size for size in (8, 16, 32, 64) if column.field.bits <= size)
        return pa.type_for_alias(f"{'int' if column.field.is_signed else 'uint'}{size}")

    def read(self, data: bytes, count: int) -> pa.Array:
        """Return the column of ``count`` entries."""
        import numpy as np
        import pyarrow as pa

        column, type_ = self.column, self.field.type
        if pa.types.is_fixed_size_binary(type_):
            table = np.frombuffer(data, np.uint8).reshape(count, self.stride)
            part = np.ascontiguousarray(table[:, column.at : column.at + column.size])
            return pa.FixedSizeBinaryArray.from_buffers(
                type_, count, [None, pa.py_buffer(part)]
            )
        if column.kind == "text":
            places = range(column.at, count * self.stride, self.stride)
            return pa.array(
                [codec.text(data[at : at + column.size]) for at in places], type_
            )
        if self.operands or column.steps or column.curve or column.kind == "float":
            return pa.array(self._numbers(data))
        raw = self._raw(data)
        if self.names is not None:
            return pa.DictionaryArray.from_arrays(
                pa.array(raw.astype(np.uint8)), self.names
            )
        if column.kind == "enum":
            different, where = np.unique(raw, return_inverse=True)
            names = pa.array(
                self._named(int(value) for value in different), pa.string()
            )
            return pa.DictionaryArray.from_arrays(
                pa.array(where.astype(np.int32)), names
            )
        if column.kind == "bool":
            return pa.array(raw != 0)
        return pa.array(raw.astype(type_.to_pandas_dtype()))

    def _numbers(self, data: bytes) -> np.ndarray:
        """Return physical values, or raw values without a scale."""
        import numpy as np

        column = self.column
        result: np.ndarray
        if column.field is not None and column.field.derived is not None:
            result = derived_column(
                np,
                column.field.derived,
                [operand._numbers(data) for operand in self.operands],
            )
            return result
        raw = self._raw(data)
        if column.steps:
            return self._physical(raw)
        if column.kind == "float":
            is_single = column.field is not None and column.field.bits == 32
            bits = raw.astype(np.uint32 if is_single else np.uint64)
            raw = bits.view(np.float32 if is_single else np.float64)
        return columns_on_curve(np, column.curve.pieces, raw) if column.curve else raw

    def _named(self, values: Iterable[int]) -> list[str]:
        """Return the names of raw values of an enumeration."""
        enum = self.column.field.enum if self.column.field else None
        names = []
        for value in values:
            member = enum.member_of(value) if enum else None
            names.append(member.name if member else f"unknown {value}")
        return names

    def _raw(self, data: bytes) -> np.ndarray:
        """Return the raw integers of a field."""
        import numpy as np

        column, field = self.column, self.column.field
        assert field
        if field.at % 8 == 0 and field.bits in (8, 16, 32, 64):
            little = column.byte_order == "little"
            return numbers_at(
                data,
                self.stride,
                column.at,
                field.bits // 8,
                little,
                "i" if field.is_signed else "u",
            )
        if len(column.pieces) == 1:
            (piece,) = column.pieces
            value = numbers_at(data, self.stride, piece.byte, 1, True) & piece.mask
            # A bit counts as true at any place, so that it need not be shifted.
            if column.kind == "bool":
                return value
            value = value >> piece.shift
        else:
            value = np.zeros(len(data) // self.stride, np.uint64)
            for piece in column.pieces:
                octets = numbers_at(data, self.stride, piece.byte, 1, True)
                part = (octets & piece.mask) >> piece.shift
                value |= part.astype(np.uint64) << np.uint64(piece.at)
        if field.is_signed:
            # Shift to the top of a word and back, which copies the sign to the upper
            # bits.
            up = np.int64(64 - field.bits)
            return value.astype(np.uint64).view(np.int64) << up >> up
        return value

    def _physical(self, raw: np.ndarray) -> np.ndarray:
        """Return the physical values, as correctly rounded doubles."""
        import numpy as np

        steps = self.column.steps
        assert steps
        a, b, d = steps.terms
        if steps.exact_in_doubles:
            result = raw.astype(np.float64)
            if a != 1:
                result *= a
            if b:
                result += b
            if d != 1:
                result /= d
            return result
        # Numbers this large need Python's integers. Compute each different value only
        # once.
        different, where = np.unique(raw, return_inverse=True)
        physical = [(int(raw_value) * a + b) / d for raw_value in different]
        return np.array(physical, np.float64)[where]
