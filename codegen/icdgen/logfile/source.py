"""A log file, read in pieces of complete entries.

`open_source` reads the header of a file; `LogSource` gives the entries to the
converters, and notes about damage to the user.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from functools import cached_property
from pathlib import Path

from icdgen.errors import UserError, unreadable
from icdgen.icd.model import Icd, Node
from icdgen.logfile.columns import EntryLayout, plan
from icdgen.logfile.integrity import Damage, Integrity, LogSurvey, TimeJump
from icdgen.protocol import facts
from icdgen.values.find import find_node
from icdgen.wording import count

_MOST_NOTES = 8  # damaged ranges or time jumps that are listed
_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
_PIECE = 1 << 18  # approximate bytes of a read


@dataclass(frozen=True)
class LogSource:
    """A log file and its header.

    `icdgen.logfile.integrity` finds its complete entries.
    """

    path: Path
    mask: bytes
    header_bytes: int
    size: int
    plan: EntryLayout

    @cached_property
    def integrity(self) -> Integrity:
        """Entries, damage and clock jumps of the complete file.

        Raises `icdgen.errors.UserError`.
        """
        return self.survey(None)

    def survey(self, head: int | None) -> Integrity:
        """Entries, damage and clock jumps up to the first ``head`` entries.

        Raises `icdgen.errors.UserError`.
        """
        try:
            with self.path.open("rb") as file:
                return LogSurvey(file, self.size, self.header_bytes, self.plan).run(
                    head
                )
        except OSError as error:
            raise unreadable(self.path, error) from None

    @property
    def entries(self) -> int:
        """Number of complete entries."""
        return self.integrity.entries

    def pieces(self, head: int | None, size: int = _PIECE) -> Iterator[bytes]:
        """Iterate over up to ``head`` entries, about ``size`` bytes at a time.

        Raise `icdgen.errors.UserError`.
        """
        integrity = self.integrity if head is None else self.survey(head)
        entry_bytes = self.plan.entry_bytes
        chunk_entries = max(1, size // entry_bytes)
        try:
            with self.path.open("rb") as file:
                for span in integrity.spans:
                    file.seek(span.start)
                    remaining = span.entries
                    while remaining:
                        data = file.read(min(chunk_entries, remaining) * entry_bytes)
                        complete = len(data) // entry_bytes
                        if not complete:
                            return  # the file was truncated meanwhile
                        yield data[: complete * entry_bytes]
                        remaining -= complete
        except OSError as error:
            raise unreadable(self.path, error) from None

    def time(self, entry: bytes) -> int:
        """Return the time of an entry in milliseconds since 1970."""
        at, size = self.plan.seconds
        seconds = int.from_bytes(entry[at : at + size], self.plan.order)
        at, size = self.plan.milliseconds
        milliseconds = int.from_bytes(entry[at : at + size], self.plan.order)
        return seconds * 1000 + milliseconds

    def first_and_last(self) -> tuple[int, int] | None:
        """Times of the first and the last entry; None without entries.

        Raises `icdgen.errors.UserError`.
        """
        spans = [span for span in self.integrity.spans if span.entries]
        if not spans:
            return None
        last = spans[-1].start + (spans[-1].entries - 1) * self.plan.entry_bytes
        try:
            with self.path.open("rb") as file:
                times = []
                for start in (spans[0].start, last):
                    file.seek(start)
                    times.append(self.time(file.read(self.plan.entry_bytes)))
        except OSError as error:
            raise unreadable(self.path, error) from None
        return times[0], times[1]

    def notes(self, integrity: Integrity) -> list[str]:
        """Return notes about damage, clock jumps, an incomplete last entry, and doubts
        about the node.
        """
        notes = [
            f"{doubt}; is this a log of {self.plan.node.name}?"
            for doubt in self._doubts(integrity)
        ]
        notes += _summary(
            [_damage_text(damage) for damage in integrity.damages], "damaged range"
        )
        notes += _summary([_jump_text(jump) for jump in integrity.jumps], "time jump")
        if integrity.truncated:
            notes.append(
                f"the last {integrity.truncated} bytes belong to no whole entry"
            )
        return notes

    def _doubts(self, integrity: Integrity) -> Iterator[str]:
        """Return reasons to doubt that the file is a log.

        Nearly any file can be read as one.
        """
        unknown = sum(slot.id is None for slot in self.plan.slots)
        if unknown:
            yield f"the mask selects {count(unknown, 'bit')} that no frame has"
        if integrity.entries and not self.plan.slots:
            yield "the mask selects no frame"


def _damage_text(damage: Damage) -> str:
    rows = "about 1 row is" if damage.rows == 1 else f"about {damage.rows:,} rows are"
    size = count(damage.end - damage.start, "byte")
    return f"damaged: bytes {damage.start:,} to {damage.end - 1:,} ({size}); {rows} left out"


def _jump_text(jump: TimeJump) -> str:
    times = f"{time_text(jump.before)} to {time_text(jump.after)}"
    return f"time jump at byte {jump.at:,}: {times}; its rows are converted"


def _summary(texts: list[str], what: str) -> list[str]:
    """Return the first texts and the number of the remaining ones."""
    remaining = len(texts) - _MOST_NOTES
    if remaining <= 0:
        return texts
    return [*texts[:_MOST_NOTES], f"and {count(remaining, f'more {what}')}"]


def time_text(milliseconds: int) -> str:
    """Return a time as ISO 8601 text in UTC."""
    time = _EPOCH + timedelta(milliseconds=milliseconds)
    # RFC 3339 with Z instead of +00:00
    return time.isoformat(timespec="milliseconds").removesuffix("+00:00") + "Z"


def node_of(icd: Icd, name: str | None) -> Node:
    """Return the node of this name, or the only node with logs.

    Raise `icdgen.errors.UserError`.
    """
    if name is not None:
        return find_node(icd, name)
    candidates = []
    for node in icd.nodes:
        node_facts = facts.of(icd, node)
        if node_facts.log_file or node_facts.stream:
            candidates.append(node)
    if len(candidates) == 1:
        return candidates[0]
    if not candidates:
        help = "`protocol.telemetry_log` describes files, and `protocol.link` what can be recorded of a link"
        raise UserError("the ICDs describe no logs", help)
    names = ", ".join(node.name for node in candidates)
    raise UserError("it is not said whose log it is", f"name the node; nodes: {names}")


def open_source(icd: Icd, node: Node, path: Path) -> LogSource:
    """Open a log file. Raise `icdgen.errors.UserError`."""
    node_facts = facts.of(icd, node)
    if node_facts.log_file is None or node_facts.mask is None:
        raise UserError(
            f"the ICD of {node.name} describes no logs", "name another node"
        )
    header = node_facts.log_file.header_bytes
    try:
        if path.is_dir():
            raise UserError(f"{path} is a folder", "name a log file")
        with path.open("rb") as file:
            head, size = file.read(header), file.seek(0, 2)
    except OSError as error:
        raise unreadable(path, error) from None
    if len(head) < header:
        raise UserError(
            f"{path} is no log: it has {size} bytes, the header alone has {header}",
            "is it whole?",
        )
    mask = head[
        node_facts.log_file.mask_at : node_facts.log_file.mask_at + node_facts.mask.size
    ]
    source = LogSource(path, mask, header, size, plan(icd, node_facts, mask))
    # The header has no magic number: the times of the entries are the only evidence
    # that this is a log.
    # A log without a complete entry has no such evidence, and is accepted.
    if size >= header + source.plan.entry_bytes and not source.survey(1).spans:
        why = "its entries have no times, their milliseconds are above 999"
        raise UserError(
            f"{path} is no log of {node.name}: {why}",
            "name a log file as it was downloaded, or --node",
        )
    return source
