"""A recording as a table.

A row is a message. A column is a field of one message, and is empty in rows of others.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import NamedTuple

from icdgen.logfile.columns import Column, columns_of, unique
from icdgen.logfile.recording import Came, Key, Recording, Tally, key
from icdgen.logfile.rows import Done, Value, reader
from icdgen.protocol.envelope import GIVEN

MESSAGE = "message"  # column with the name of the message


class Entry(NamedTuple):
    """A column of the table: its index and its field. ``is_cut``: the number of bytes varies."""

    place: int
    column: Column
    is_cut: bool


class Sheet:
    """The table of a recording. ``came``: messages that have columns."""

    def __init__(self, recording: Recording, came: Iterable[Key]) -> None:
        self.recording = recording
        messages = [message for name, message in recording.messages.items() if name in set(came)]
        roles = {field.role for field in recording.form.fields}
        self.roles = [role for role in GIVEN if role in roles]
        columns = unique(column for message in messages for column in columns_of(recording.icd, message))
        self.entries: dict[Key, list[Entry]] = {key(message): [] for message in messages}
        for place, column in enumerate(columns, 1 + len(self.roles)):
            assert column.message and column.field
            is_cut = column.field.scalar.length is not None and column.kind == "bytes"
            self.entries[key(column.message)].append(Entry(place, column, is_cut))

    @cached_property
    def columns(self) -> list[Column]:
        """Columns of fields, after the name of the message and the frame fields."""
        return [entry.column for entries in self.entries.values() for entry in entries]

    @cached_property
    def names(self) -> list[str]:
        """Names of all columns."""
        return [MESSAGE, *self.roles, *(column.name for column in self.columns)]

    def rows(self, head: int | None, done: Done) -> Iterator[list[Value]]:
        """Iterate over the rows, one for each message."""
        readers = {name: [(one, reader(one.column)) for one in entries] for name, entries in self.entries.items()}
        for came in self.recording.read(Tally(), head, done):
            row: list[Value] = [None] * len(self.names)
            row[0] = came.message.name
            row[1 : 1 + len(self.roles)] = [came.values.get(role) for role in self.roles]
            for entry, read in readers[key(came.message)]:
                if is_there(came, entry.column):
                    row[entry.place] = read(came.data[: end_of(came, entry.column)] if entry.is_cut else came.data)
            yield row


def end_of(came: Came, column: Column) -> int:
    """Return the first byte after a variable-length field."""
    assert column.field
    return came.ends[column.field.name]


def is_there(came: Came, column: Column) -> bool:
    """Return whether the message has the field."""
    return came.there is None or (column.field is not None and column.field.name in came.there)
