"""Table of live telemetry."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from icdgen_runtime.wire.events import (
    Arrived,
    Busy,
    Done,
    LineError,
    Log,
    Malformed,
    Outcome,
    Refused,
)

from icdgen import tables
from icdgen.errors import UserError
from icdgen.icd.model import Icd, Message
from icdgen.link.line_statistics import FAULTS, LineStatistics
from icdgen.link.outcomes import failure_text
from icdgen.protocol import facts
from icdgen.tables import Column
from icdgen.values.find import find_message, find_node
from icdgen.values.frame import Frame, frame

if TYPE_CHECKING:
    from icdgen_runtime.wire.events import Event

OLD_SECONDS = 5.0  # the age of an older value is shown, also of an unsolicited message
COLUMNS = ("message", "field", "value", "unit", "remarks")


class Monitor:
    """The last frames of all monitored messages."""

    def __init__(self, icd: Icd, node: str, names: Sequence[str]) -> None:
        self.icd, self.node = icd, find_node(icd, node)
        self.facts = facts.of(icd, self.node)
        self.statistics = LineStatistics(icd, self.node)
        self.messages: list[Message] = []
        for name in names:
            message = find_message(icd, node, name, "telemetry")
            if message not in self.messages:
                self.messages.append(message)
        if not names and not self.listens:
            if self.facts.identification is None:
                raise UserError(
                    "it is not said what to show",
                    "name messages: icdgen monitor NODE MESSAGE ...",
                )
            self.messages.append(self.facts.identification.message)
        self.last: dict[str, bytes] = {}
        self.received_at: dict[str, float] = (
            {}
        )  # time of reception, by time.monotonic()
        self.awaited: set[str] = set()  # messages not yet received in this round
        self.silent: set[str] = set()  # messages not received in the last round
        self.faults: dict[int, str] = {}  # last error of a message, by id
        self.failures: dict[str, str] = {}  # refusal of the last request, by message

    @property
    def listens(self) -> bool:
        """Whether the node sends telemetry without requests, with header and trailer.

        A round then ends after its time.
        """
        return self.facts.stream is not None

    @property
    def failed(self) -> bool:
        """Whether a monitored message was missing in the last round."""
        return bool(self.silent) or (
            self.listens and not self.messages and not self.last
        )

    def requested(self) -> Iterator[Message]:
        """Return the messages that must be requested."""
        rows = self.facts.stream.telecommands if self.facts.stream else ()
        asking = {row.requests for row in rows}
        yield from (
            message
            for message in self.messages
            if not self.listens or message.telemetry_id in asking
        )

    def begin(self) -> None:
        """Begin a round."""
        if self.listens:
            self.awaited = {message.name for message in self.messages}

    def end(self) -> None:
        """End a round. Missing messages become silent."""
        if self.listens:
            self.silent = set(self.awaited)

    def record(self, message: Message, outcome: Outcome) -> None:
        """Record the outcome of a request."""
        self.failures.pop(message.name, None)
        if isinstance(outcome, Done):
            self._received(message, outcome.id, outcome.data)
            return
        self.silent.add(message.name)
        if isinstance(outcome, Refused | Busy):
            text = failure_text(self.icd, self.node, outcome)
            self.failures[message.name] = text

    def _received(self, message: Message, id: int, data: bytes) -> None:
        self.awaited.discard(message.name)
        self.silent.discard(message.name)
        self.faults.pop(id, None)
        self._keep(message, data)

    def _keep(self, message: Message, data: bytes) -> None:
        self.last[message.name] = data
        self.received_at[message.name] = time.monotonic()

    def disconnected(self) -> None:
        """Record that there is no connection: all messages are silent."""
        self.silent = self.awaited = {message.name for message in self.messages}
        self.faults.clear()
        self.failures.clear()

    def event(self, event: Event) -> None:
        """Record unsolicited telemetry and errors."""
        self.statistics.event(event)
        if isinstance(event, Malformed):
            self.faults[event.id] = "wrong length"
        elif (
            isinstance(event, LineError)
            and event.id is not None
            and event.error in FAULTS
        ):
            self.faults[event.id] = FAULTS[event.error]
        elif isinstance(event, Arrived):
            message = self.statistics.message_of(event.id, event.data)
            if message and (not self.messages or message in self.messages):
                self._received(message, event.id, event.data)
        elif isinstance(event, Log):
            for log_frame in event.log.frames:
                message = (
                    self.facts.telemetry.get(log_frame.id)
                    if log_frame.id is not None
                    else None
                )
                if message and message.length == len(log_frame.data):
                    self._keep(message, log_frame.data)

    def frames(self) -> Iterator[Frame]:
        """Return the received frames of messages that are not silent."""
        yield from (
            self._frame(name)
            for name in self._names()
            if name in self.last and name not in self.silent
        )

    def _frame(self, name: str) -> Frame:
        message = next(m for m in self.icd.messages_of(self.node) if m.name == name)
        return frame(self.icd, self.node, message, self.last[name])

    def rows(self) -> Iterator[tuple[str, str, str, str, str]]:
        """Return message, field, value, unit and remarks of each row.

        A silent message shows its last values with their age.
        """
        ids = {message.name: message.telemetry_id for message in self.messages}
        absence = "nothing came" if self.listens else "no answer"
        for name in self._names():
            remarks = []
            if name in self.silent:
                fault = self.faults.get(ids.get(name) or 0, absence)
                remarks.append(self.failures.get(name, fault))
            if name not in self.last:
                if remarks:
                    yield name, "", "", "", remarks[0]
                continue
            age = time.monotonic() - self.received_at[name]
            if name in self.silent or age >= OLD_SECONDS:
                remarks.append(f"last value, {_age_text(age)} old")
            for number, row in enumerate(self._frame(name).rows):
                of_row = "; ".join(
                    [*remarks, *row.remarks] if number == 0 else row.remarks
                )
                yield (
                    name if number == 0 else ""
                ), row.field.name, row.text, row.field.unit_symbol, of_row

    def _names(self) -> list[str]:
        names = [message.name for message in self.messages]
        return names + [name for name in list(self.last) if name not in names]

    def text(self) -> str:
        """Return the table for a pipe, or for a single round."""
        columns = [Column(title, right=title == "value") for title in COLUMNS]
        table = tables.render(
            columns, list(self.rows()), tables.width_of(sys.stdout)
        ).rstrip("\n")
        return "\n".join(filter(None, (table, self.statistics.text())))


def _age_text(seconds: float) -> str:
    """Return an age such as ``12 s``, ``3 min 20 s`` or ``2 h 5 min``."""
    minutes, hours = int(seconds // 60), int(seconds // 3600)
    if not minutes:
        return f"{int(seconds)} s"
    return (
        f"{hours} h {minutes % 60} min"
        if hours
        else f"{minutes} min {int(seconds) % 60} s"
    )
