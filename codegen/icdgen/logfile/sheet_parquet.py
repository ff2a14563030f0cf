"""Conversion of a recording to Parquet.

Equal messages of a batch are decoded together, and then put into their rows.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

from icdgen.logfile.parquet import ColumnReader, check_installed, schema_of, write
from icdgen.logfile.recording import Key, ReceivedMessage, Tally, key
from icdgen.logfile.rows import Done
from icdgen.logfile.sheet import MESSAGE, Sheet, SheetColumn, end_of_field, is_present

if TYPE_CHECKING:
    import pyarrow as pa

# Approximate cells of a row group: limits the memory for wide, sparse tables.
_CELLS = 4_000_000


def to_parquet(sheet: Sheet, path: Path, head: int | None, done: Done) -> None:
    """Write the file. Missing values are null. Raise `icdgen.errors.UserError`."""
    check_installed()
    builder = _TableBuilder(sheet)
    messages = sheet.recording.received_messages(Tally(), head, done)
    size = max(256, _CELLS // len(sheet.names))  # rows of a row group

    def tables() -> Iterator[pa.Table]:
        while batch := list(islice(messages, size)):
            yield builder.table(batch)

    write(path, builder.schema, tables())


class _TableBuilder:
    """Converter of messages to Arrow tables."""

    def __init__(self, sheet: Sheet) -> None:
        import pyarrow as pa

        self.sheet = sheet
        # By message: its columns, each with the reader for many messages at once
        self.readers: dict[Key, list[tuple[SheetColumn, ColumnReader]]] = {}
        for name, entries in sheet.entries.items():
            length = sheet.recording.messages[name].length
            self.readers[name] = [
                (entry, ColumnReader(entry.column, length)) for entry in entries
            ]
        fields = [
            pa.field(MESSAGE, pa.dictionary(pa.int32(), pa.string()), nullable=False)
        ]
        # A message can be in a packet that lacks a role which others have.
        fields += [pa.field(role, pa.uint32()) for role in sheet.roles]
        for entry, reader in (
            pair for pairs in self.readers.values() for pair in pairs
        ):
            field = reader.field.with_nullable(True)
            # The type for a fixed number of bytes has the same number in all rows.
            fields.append(field.with_type(pa.binary()) if entry.is_cut else field)
        self.schema = schema_of(fields, sheet.recording.node)

    def table(self, batch: list[ReceivedMessage]) -> pa.Table:
        """Return the messages of a batch as rows."""
        import pyarrow as pa

        places: dict[Key, list[int]] = {}
        for place, received in enumerate(batch):
            places.setdefault(key(received.message), []).append(place)
        arrays = [
            pa.array([received.message.name for received in batch]).dictionary_encode()
        ]
        arrays += [
            pa.array([received.values.get(role) for received in batch], pa.uint32())
            for role in self.sheet.roles
        ]
        for name, readers in self.readers.items():
            here = places.get(name, [])
            data = b"".join(batch[place].data for place in here)
            for entry, reader in readers:
                type_ = self.schema.field(entry.place).type
                arrays.append(
                    self._column_of_batch(batch, here, entry, reader, data)
                    if here
                    else pa.nulls(len(batch), type_)
                )
        return pa.Table.from_arrays(arrays, schema=self.schema)

    def _column_of_batch(
        self,
        batch: list[ReceivedMessage],
        here: list[int],
        entry: SheetColumn,
        reader: ColumnReader,
        data: bytes,
    ) -> pa.Array:
        """Return a column with its values in the rows of its message, and null in the
        others.
        """
        import numpy as np
        import pyarrow as pa

        if entry.is_cut:
            values: list[bytes | None] = [None] * len(batch)
            for place in here:
                received = batch[place]
                if is_present(received, entry.column):
                    values[place] = received.data[
                        entry.column.at : end_of_field(received, entry.column)
                    ]
            return pa.array(values, pa.binary())
        indices, is_null = np.zeros(len(batch), np.int64), np.ones(len(batch), bool)
        # Row number -> index of its message among the decoded ones; the other rows are
        # null.
        indices[here] = np.arange(len(here))
        is_null[here] = [not is_present(batch[place], entry.column) for place in here]
        return reader.read(data, len(here)).take(pa.array(indices, mask=is_null))
