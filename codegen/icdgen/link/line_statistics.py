"""Statistics of received telemetry: errors, missing and repeated messages, and
responses without a request.
"""

from __future__ import annotations

from collections import Counter

from icdgen_runtime.wire.events import Event, Gap, Late, LineError, Stray

from icdgen import codec
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.variants import ids_of

FAULTS = {
    "checksum": "wrong checksum", "unchecked": "no checksum", "length": "wrong length", "unknown_id": "unknown id",
    "overrun": "too long", "framing": "damaged",
}  # fmt: skip
"""Descriptions of decoder errors."""


class LineStatistics:
    """Counters of line errors, of missing and repeated messages, and of responses
    without a request.
    """

    def __init__(self, icd: Icd, node: Node) -> None:
        self.icd, self.ids = icd, ids_of(icd, node).telemetry
        self.faults: Counter[str] = Counter()
        self.missing = self.repeated = 0
        self.late = self.stray = 0  # responses without a request

    def event(self, event: Event) -> None:
        """Count an event."""
        if isinstance(event, LineError):
            self.faults[FAULTS.get(event.error, event.error.replace("_", " "))] += 1
        elif isinstance(event, Gap):
            self.missing += event.missing
            self.repeated += event.missing == 0
        elif isinstance(event, Late):
            self.late += 1
        elif isinstance(event, Stray):
            self.stray += 1

    def message_of(self, id: int, data: bytes) -> Message | None:
        """Return the message of this id that matches the data, or None."""
        return codec.message_of_frame_if_any(
            self.icd, [variant.message for variant in self.ids.get(id, ())], data
        )

    def text(self) -> str:
        """Return the errors as one line for a report; empty without errors."""
        counts = [f"{fault} ({times})" for fault, times in sorted(self.faults.items())]
        for what, times in (
            ("messages missing", self.missing),
            ("messages that came again", self.repeated),
            ("late responses", self.late),
            ("responses without a request", self.stray),
        ):
            if times:
                counts.append(f"{what} ({times})")
        return f"on the line: {', '.join(counts)}" if counts else ""
