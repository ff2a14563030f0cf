"""A log file on the disk, read in pieces of whole entries."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from icdgen.errors import UserError, unreadable
from icdgen.icd.model import Icd, Node
from icdgen.logfile.columns import Plan, plan
from icdgen.protocol import facts
from icdgen.values.find import find_node

_SAMPLE = 64  # entries by which it is judged whether this is a log
_PIECE = 1 << 18  # bytes of them that are read at once, about


@dataclass(frozen=True, slots=True)
class Source:
    """``entries`` whole ones, after them ``truncated`` bytes of one that was cut off."""

    path: Path
    mask: bytes
    header_bytes: int
    size: int
    plan: Plan

    @property
    def entries(self) -> int:
        return (self.size - self.header_bytes) // self.plan.entry_bytes

    @property
    def truncated(self) -> int:
        return (self.size - self.header_bytes) % self.plan.entry_bytes

    def pieces(self, head: int | None, size: int = _PIECE) -> Iterator[bytes]:
        """The entries, about ``size`` bytes at once; ``head``: only so many. Raises `icdgen.errors.UserError`."""
        left = self.entries if head is None else min(head, self.entries)
        some, one = max(1, size // self.plan.entry_bytes), self.plan.entry_bytes
        try:
            with self.path.open("rb") as file:
                file.seek(self.header_bytes)
                while left:
                    data = file.read(min(some, left) * one)
                    whole = len(data) // one
                    if not whole:
                        return  # it has become shorter meanwhile
                    yield data[: whole * one]
                    left -= whole
        except OSError as error:
            raise unreadable(self.path, error) from None

    def time(self, entry: bytes) -> int:
        """Milliseconds since 1970."""
        order = self.plan.order
        (at, size), (after, rest) = self.plan.seconds, self.plan.milliseconds
        return int.from_bytes(entry[at : at + size], order) * 1000 + int.from_bytes(entry[after : after + rest], order)

    def entry(self, number: int) -> bytes:
        """One entry. Raises `icdgen.errors.UserError`."""
        try:
            with self.path.open("rb") as file:
                file.seek(self.header_bytes + number * self.plan.entry_bytes)
                return file.read(self.plan.entry_bytes)
        except OSError as error:
            raise unreadable(self.path, error) from None

    def notes(self) -> list[str]:
        """What is wrong with it. Raises `icdgen.errors.UserError`."""
        rest = [f"the last {self.truncated} bytes belong to no whole entry"] if self.truncated else []
        return self._doubts() + rest

    def _doubts(self) -> list[str]:
        """What a log of this node would not have: any file of some length can be read as one."""
        found = []
        unknown = sum(slot.id is None for slot in self.plan.slots)
        if unknown:
            found.append(f"the mask selects {unknown} bit{'s' * (unknown > 1)} that no frame has")
        if self.entries and not self.plan.slots:
            found.append("the mask selects no frame")
        if self.entries > 1 and self.time(self.entry(self.entries - 1)) < self.time(self.entry(0)):
            found.append("the last entry is older than the first")
        return [f"{doubt}; is this a log of {self.plan.node.name}?" for doubt in found]


def node_of(icd: Icd, name: str | None) -> Node:
    """The node that is meant; without a name the only one that has logs. Raises `icdgen.errors.UserError`."""
    if name is not None:
        return find_node(icd, name)
    able = [node for node in icd.nodes if (known := facts.of(icd, node)).log_file or known.stream]
    if len(able) == 1:
        return able[0]
    if not able:
        help = "`protocol.telemetry_log` describes files, and `protocol.stream` what can be recorded of a link"
        raise UserError("the ICDs describe no logs", help)
    names = ", ".join(node.name for node in able)
    raise UserError("it is not said whose log it is", f"name the node; nodes: {names}")


def open_source(icd: Icd, node: Node, path: Path) -> Source:
    """The log file. Raises `icdgen.errors.UserError`."""
    known = facts.of(icd, node)
    if known.log_file is None or known.mask is None:
        raise UserError(f"the ICD of {node.name} describes no logs", "name another node")
    header = known.log_file.header_bytes
    try:
        if path.is_dir():
            raise UserError(f"{path} is a folder", "name a log file")
        with path.open("rb") as file:
            head, size = file.read(header), file.seek(0, 2)
    except OSError as error:
        raise unreadable(path, error) from None
    if len(head) < header:
        raise UserError(f"{path} is no log: it has {size} bytes, the header alone has {header}", "is it whole?")
    mask = head[known.log_file.mask_at : known.log_file.mask_at + known.mask.size]
    found = Source(path, mask, header, size, plan(icd, known, mask))
    if why := _impossible(found):
        raise UserError(f"{path} is no log of {node.name}: {why}", "name a log file as it was downloaded, or --node")
    return found


def _impossible(source: Source) -> str:
    """Why the file can be no log, however damaged. Raises `icdgen.errors.UserError`."""
    at, size = source.plan.milliseconds
    order = source.plan.order
    some = b"".join(source.pieces(_SAMPLE))
    entries = range(0, len(some), source.plan.entry_bytes)
    wrong = sum(int.from_bytes(some[one + at : one + at + size], order) >= 1000 for one in entries)
    return "its entries have no times, their milliseconds are above 999" if wrong * 2 > len(entries) else ""
