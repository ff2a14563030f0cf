"""A recording as a table.

A row is a message. A column is a field of one message, and is empty in rows of others.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property

from icdgen.frozen import NamedTuple
from icdgen.logfile.columns import LogColumn, columns_of, unique
from icdgen.logfile.recording import Key, ReceivedMessage, Recording, Tally, key
from icdgen.logfile.rows import Done, Value, reader
from icdgen.protocol.packet_formats import GIVEN

MESSAGE = "message"  # column with the name of the message


class SheetColumn(NamedTuple):
    """A column of the table: its index and its field.

    ``is_cut``: the number of bytes varies.
    """

    place: int
    column: LogColumn
    is_cut: bool


class Sheet:
    """The table of a recording. ``received``: messages that have columns."""

    def __init__(self, recording: Recording, received: Iterable[Key]) -> None:
        self.recording = recording
        messages = [
            message
            for name, message in recording.messages.items()
            if name in set(received)
        ]
        # Other packets, such as refusals, are no rows.
        packets = [
            packet
            for packet in recording.form.packets_of(recording.direction)
            if packet.content == "message"
        ]
        self.roles = [
            role for role in GIVEN if any(packet.of(role) for packet in packets)
        ]
        columns = unique(
            column
            for message in messages
            for column in columns_of(recording.icd, message)
        )
        self.entries: dict[Key, list[SheetColumn]] = {
            key(message): [] for message in messages
        }
        for place, column in enumerate(columns, 1 + len(self.roles)):
            assert column.message and column.field
            # A text ends at its first NUL, so that the zeros behind it do no harm.
            is_cut = column.field.scalar.length is not None and column.kind == "bytes"
            self.entries[key(column.message)].append(SheetColumn(place, column, is_cut))

    @cached_property
    def columns(self) -> list[LogColumn]:
        """Columns of fields, after the name of the message and the frame fields."""
        return [entry.column for entries in self.entries.values() for entry in entries]

    @cached_property
    def names(self) -> list[str]:
        """Names of all columns."""
        return [MESSAGE, *self.roles, *(column.name for column in self.columns)]

    def rows(self, head: int | None, done: Done) -> Iterator[list[Value]]:
        """Iterate over the rows, one for each message."""
        # By message: its columns, each with the function that reads the value
        readers = {
            name: [(entry, reader(entry.column)) for entry in entries]
            for name, entries in self.entries.items()
        }
        for received in self.recording.received_messages(Tally(), head, done):
            row: list[Value] = [None] * len(self.names)
            row[0] = received.message.name
            row[1 : 1 + len(self.roles)] = [
                received.values.get(role) for role in self.roles
            ]
            for entry, read in readers[key(received.message)]:
                if not is_present(received, entry.column):
                    continue
                data = received.data
                if entry.is_cut:
                    data = data[: end_of_field(received, entry.column)]
                row[entry.place] = read(data)
            yield row


def end_of_field(received: ReceivedMessage, column: LogColumn) -> int:
    """Return the first byte after a variable-length field."""
    assert column.field
    return received.ends[column.field.name]


def is_present(received: ReceivedMessage, column: LogColumn) -> bool:
    """Return whether the message has the field."""
    return received.present is None or (
        column.field is not None and column.field.name in received.present
    )
