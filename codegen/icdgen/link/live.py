"""Table of live telemetry, for `icdgen monitor`.

`Monitor` stores the last frame of each message. The command gives it the outcomes of
requests and unsolicited events, and prints its rows, frames or reports.
"""

from __future__ import annotations

import shlex
import sys
import time
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from icdgen_runtime.wire.events import (
    Arrived,
    Busy,
    Done,
    Late,
    LineError,
    Log,
    Outcome,
    Refused,
    Stray,
)

from icdgen import tables
from icdgen.errors import UserError
from icdgen.icd.model import Icd, Message
from icdgen.link.line_statistics import FAULTS, LineStatistics
from icdgen.link.outcomes import failure_text, outcome_report
from icdgen.protocol import facts
from icdgen.tables import Column
from icdgen.values.find import find_message, find_node
from icdgen.values.frame import DecodedFrame, decoded_frame

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
        # Time of reception, by time.monotonic().
        self.received_at: dict[str, float] = {}
        self.awaited: set[str] = set()  # messages not yet received in this round
        self.silent: set[str] = set()  # messages not received in the last round
        self.faults: dict[int, str] = {}  # last error of a message, by id
        self.failures: dict[str, str] = {}  # refusal of the last request, by message
        self._reports: list[dict[str, Any]] = []  # see `take_reports`

    @property
    def listens(self) -> bool:
        """Whether the node sends telemetry without requests, with header and trailer.

        A round then ends after its time.
        """
        return self.facts.stream is not None

    @property
    def hint(self) -> str:
        """Advice to name messages of a node without unsolicited telemetry.

        Empty if messages are named, or if the node has unsolicited telemetry.
        """
        form = self.facts.stream
        if form is None or self.messages:
            return ""
        responses = [row for exchange in form.exchanges for row in exchange.responses]
        responding = {response.telemetry for response in responses}
        if any(
            row.id not in responding and not row.is_requested for row in form.telemetry
        ):
            return ""
        requested_ids = form.requested_ids
        names = [
            message.name
            for message in self.icd.messages_of(self.node)
            if message.telemetry_id in requested_ids
        ]
        why = "on request" if form.request else "in response to telecommands"
        what = f"{self.node.name} sends telemetry only {why}"
        if not names:
            return f"{what}, and none can be requested; `icdgen send` shows responses"
        words = shlex.join(["icdgen", "monitor", self.node.name, names[0]])
        return (
            f"{what}; name messages to request them, such as `{words}`; they can be: "
            f"{', '.join(names)}"
        )

    @property
    def failed(self) -> bool:
        """Whether a monitored message was missing in the last round."""
        return bool(self.silent) or (
            self.listens and not self.messages and not self.last
        )

    def requested(self) -> Iterator[Message]:
        """Return the messages that must be requested."""
        requested_ids = self.facts.stream.requested_ids if self.facts.stream else ()
        yield from (
            message
            for message in self.messages
            if not self.listens or message.telemetry_id in requested_ids
        )

    def begin(self) -> None:
        """Begin a round."""
        if self.listens:
            self.awaited = {message.name for message in self.messages}

    def end(self) -> None:
        """End a round. Missing messages become silent."""
        if self.listens:
            self.silent = {name for name in self.awaited if self._is_overdue(name)}

    def _is_overdue(self, name: str) -> bool:
        """Return whether a message that did not arrive in a round is overdue.

        A periodic message is overdue when it has not arrived for two periods.
        """
        if name not in self.received_at:
            return True
        age = time.monotonic() - self.received_at[name]
        return age > 2 * self._period_seconds(name)

    def _period_seconds(self, name: str) -> float:
        """Return the period of a message; 0 for a message without a period."""
        messages = self.icd.messages_of(self.node)
        period = next(each.period_ms for each in messages if each.name == name)
        return (period or 0) / 1000

    def record(self, message: Message, outcome: Outcome) -> None:
        """Record the outcome of a request."""
        self.failures.pop(message.name, None)
        if isinstance(outcome, Done):
            self._received(message, outcome.id, outcome.data)
            return
        self.silent.add(message.name)
        if isinstance(outcome, Refused | Busy):
            text = failure_text(outcome)
            self.failures[message.name] = text
            refusal = None
            if isinstance(outcome, Refused) and outcome.type:
                refusal = self._frame(outcome.type.NAME, outcome.data)
            self._reports.append(outcome_report(message.name, outcome, refusal))

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
        if isinstance(event, Late | Stray):
            self._reports.append(self._response_report(event))
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
                if log_frame.id is None:
                    continue  # of an unassigned bit of the mask
                message = self.facts.telemetry.get(log_frame.id)
                if message and message.length == len(log_frame.data):
                    self._keep(message, log_frame.data)

    def _response_report(self, event: Late | Stray) -> dict[str, Any]:
        """Return a response without a request as JSON."""
        kind = type(event).__name__.lower()
        if event.type is None:
            ids = {} if event.id is None else {"id": event.id}
            return {"event": kind, **ids, "bytes": event.data.hex()}
        name = event.type.NAME
        response = self._frame(name, event.data).to_json()
        return {"message": name, "event": kind, "response": response}

    def take_reports(self) -> list[dict[str, Any]]:
        """Return refusals and busy devices, and responses without a request, since the
        previous call, as JSON.
        """
        reports, self._reports = self._reports, []
        return reports

    def frames(self) -> Iterator[DecodedFrame]:
        """Return the received frames of messages that are not silent."""
        yield from (
            self._frame(name, self.last[name])
            for name in self._names()
            if name in self.last and name not in self.silent
        )

    def _frame(self, name: str, data: bytes) -> DecodedFrame:
        message = next(m for m in self.icd.messages_of(self.node) if m.name == name)
        return decoded_frame(self.icd, self.node, message, data)

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
            if name in self.silent or age >= max(
                OLD_SECONDS, 2 * self._period_seconds(name)
            ):
                remarks.append(f"last value, {_age_text(age)} old")
            # The first row has the name of the message and the remarks about it.
            first_cell = name
            for row in self._frame(name, self.last[name]).rows:
                text = "; ".join([*remarks, *row.remarks])
                yield first_cell, row.field.name, row.text, row.field.unit_symbol, text
                first_cell, remarks = "", []

    def _names(self) -> list[str]:
        names = [message.name for message in self.messages]
        return names + [name for name in list(self.last) if name not in names]

    def text(self) -> str:
        """Return the table for a pipe, or for a single round."""
        columns = [Column(title, right=title == "value") for title in COLUMNS]
        rows = list(self.rows())
        table = tables.render_table(columns, rows, tables.width_of(sys.stdout)).rstrip(
            "\n"
        )
        if not rows:
            table = "nothing came"
        return "\n".join(filter(None, (table, self.statistics.text())))


def _age_text(seconds: float) -> str:
    """Return an age such as ``12 s``, ``3 min 20 s`` or ``2 h 5 min``."""
    minutes, hours = int(seconds // 60), int(seconds // 3600)
    if not minutes:
        return f"{int(seconds)} s"
    if not hours:
        return f"{minutes} min {int(seconds) % 60} s"
    return f"{hours} h {minutes % 60} min"
