"""Common interface of log files of devices and of recordings of links, for `icdgen
log`.

`open_log` takes an ICD, a node and a path and returns a `Log`, which gives a listing,
rows, or a Parquet file. The file is a recording if the link of the node has a packet
format, otherwise a log of the device. A recording is read twice, and errors in it are
notes but no damage.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Protocol

from icdgen_runtime.wire.packet_formats import Direction

from icdgen.errors import UserError
from icdgen.icd.model import Icd, Message, Node
from icdgen.logfile import listing, parquet, sheet_parquet
from icdgen.logfile.columns import TIME
from icdgen.logfile.integrity import Integrity
from icdgen.logfile.recording import Recording, key
from icdgen.logfile.rows import Done, Value, log_rows
from icdgen.logfile.sheet import Sheet
from icdgen.logfile.source import LogSource, open_source
from icdgen.protocol import facts


class Log(Protocol):
    """A log as a table.

    Call `prepare` before `names`, `rows` and `to_parquet`, with the same ``head``: the
    maximum number of rows, or None. These methods raise `UserError`.
    """

    @property
    def names(self) -> list[str]:
        """Names of the columns."""

    def listing(self, width: int | None, done: Done) -> str:
        """Return a description of the contents."""

    def steps(self, head: int | None) -> int:
        """Return the approximate number of bytes that will be reported to ``done``."""

    def prepare(self, head: int | None, done: Done) -> list[str]:
        """Return notes about errors in the log."""

    def is_damaged(self, head: int | None) -> bool:
        """Return whether entries are left out because the file is damaged."""

    def rows(self, head: int | None, done: Done) -> Iterator[list[Value]]:
        """Iterate over the rows."""

    def to_parquet(self, path: Path, head: int | None, done: Done) -> None:
        """Write a Parquet file."""


def open_log(
    icd: Icd, node: Node, path: Path, direction: Direction, messages: Sequence[Message]
) -> Log:
    """Open a log.

    ``messages`` selects messages; empty for all. Raise `icdgen.errors.UserError`.
    """
    if facts.of(icd, node).stream is not None:
        return _Recorded(Recording(icd, node, path, direction, messages))
    return _Entries(_only(open_source(icd, node, path), messages))


def _only(source: LogSource, messages: Sequence[Message]) -> LogSource:
    """Return the log with the columns of these messages.

    Raise `icdgen.errors.UserError`.
    """
    if not messages:
        return source
    keys = {key(message) for message in messages}
    columns = tuple(
        column
        for column in source.plan.columns
        if column.message is not None and key(column.message) in keys
    )
    # The ICD has these messages, but the log has no column of them, for instance
    # because its mask does not select them.
    if missing := keys - {
        key(column.message) for column in columns if column.message is not None
    }:
        names = ", ".join(sorted(name for _, name in missing))
        raise UserError(
            f"{source.path} has no {names}",
            f"`icdgen log {source.path}` lists what it holds",
        )
    return replace(source, plan=replace(source.plan, columns=columns))


class _Entries:
    """A log file of a device."""

    def __init__(self, source: LogSource) -> None:
        self.source = source

    @property
    def names(self) -> list[str]:
        return [TIME, *(column.name for column in self.source.plan.columns)]

    def listing(self, width: int | None, done: Done) -> str:
        return listing.to_text(self.source, width)

    def steps(self, head: int | None) -> int:
        return self._integrity(head).entries * self.source.plan.entry_bytes

    def prepare(self, head: int | None, done: Done) -> list[str]:
        return self.source.notes(self._integrity(head))

    def is_damaged(self, head: int | None) -> bool:
        return bool(self._integrity(head).damages)

    def _integrity(self, head: int | None) -> Integrity:
        # The survey of the complete file is cached. With `head`, only its beginning is
        # read.
        return self.source.integrity if head is None else self.source.survey(head)

    def rows(self, head: int | None, done: Done) -> Iterator[list[Value]]:
        return log_rows(self.source, head, done)

    def to_parquet(self, path: Path, head: int | None, done: Done) -> None:
        parquet.to_parquet(self.source, path, head, done)


class _Recorded:
    """A recording of a link.

    It is read twice, as only received messages have columns.
    """

    def __init__(self, recording: Recording) -> None:
        self.recording = recording
        self.sheet = Sheet(recording, ())

    @property
    def names(self) -> list[str]:
        return self.sheet.names

    def listing(self, width: int | None, done: Done) -> str:
        return listing.recording_text(
            self.recording, self.recording.survey(None, done), width
        )

    def steps(self, head: int | None) -> int:
        return 2 * self.recording.size

    def prepare(self, head: int | None, done: Done) -> list[str]:
        tally = self.recording.survey(head, done)
        self.sheet = Sheet(
            self.recording, self.recording.chosen & tally.messages.keys()
        )
        return tally.notes()

    def is_damaged(self, head: int | None) -> bool:
        # Noise on a line is normal; it is counted and does not affect decoded messages.
        return False

    def rows(self, head: int | None, done: Done) -> Iterator[list[Value]]:
        return self.sheet.rows(head, done)

    def to_parquet(self, path: Path, head: int | None, done: Done) -> None:
        sheet_parquet.to_parquet(self.sheet, path, head, done)
