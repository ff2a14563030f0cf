"""What a reader makes of a file: ICDs to be, in one form for all kinds. What stands in them is written as in an ICD."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol

from icdgen.diagnostics import Finding, Findings, Place
from icdgen.icd import units, wire_ids
from icdgen.icd.fmt.emit import Spelled
from icdgen.icd.model import KEYS_OF_IDS
from icdgen.import_results.findings import Spot, Trouble

UNREADABLE = "IMP005"
NOT_HELD = "IMP070"
WITHOUT_FIELD = "IMP091"
RAW_ONLY = "IMP078"
SAME_NAME = "IMP092"

Item = dict[str, Any]  # a message, field, enumeration, member or struct as it stands in an ICD


class NotHeld(Exception):
    """A message that an ICD cannot hold; the text says why, and ``help`` what to do if there is something."""

    def __init__(self, text: str, help: str = "") -> None:
        super().__init__(text)
        self.help = help


@dataclass
class Network:
    """One ICD: the messages of a network, a dialect, a device. ``head`` is the section `node` but for name and title."""

    name: str
    title: str
    head: Item
    messages: list[Item] = field(default_factory=list)
    enums: list[Item] = field(default_factory=list)
    structs: list[Item] = field(default_factory=list)
    protocol: Item | None = None
    seeds: dict[str, int] = field(default_factory=dict)  # those of ``protocol``: of each message one

    @property
    def fields(self) -> Iterator[Item]:
        """Those of all messages and structs."""
        return (one for owner in (*self.messages, *self.structs) for one in owner.get("fields", ()))

    def declare(self, enums: Iterable[Item]) -> None:
        """Takes those enumerations that a field has."""
        used = {one.get("enum") for one in self.fields}
        self.enums = [enum for enum in enums if enum["name"] in used]

    def name_messages_apart(self, to: Definitions) -> None:
        """Put group or kind in front of the names of messages with the same name, or else the id behind, with a note (IMP092)."""
        by_name: dict[str, list[Item]] = {}
        for message in self.messages:
            by_name.setdefault(message["name"], []).append(message)
        for name, messages in by_name.items():
            if len(messages) == 1:
                continue
            for key in ("group", "kind"):
                values = [message.get(key) for message in messages]
                if len(set(values)) == len(messages):
                    names = [f"{value} {name}" if value else name for value in values]
                    break
            else:
                ids = [message[KEYS_OF_IDS[message["kind"]][0][0]] for message in messages]
                names = [f"{name} {id.spelling if isinstance(id, Spelled) else id}" for id in ids]
            for message, distinct in zip(messages, names, strict=True):
                message["name"] = distinct
            shown = ", ".join(f"`{distinct}`" for distinct in names)
            text = f"{len(messages)} messages have the name `{name}`: they are imported as {shown}"
            to.warn(SAME_NAME, text, "rename them in the ICD if you want other names", "note")

    def tree(self) -> Item:
        """The ICD as plain mappings and lists."""
        self._mark_shared_ids()
        tree: Item = {"icdgen": 1, "node": {"name": self.name, "title": self.title, **self.head}}
        if declared := units.declared(one["unit"] for one in self.fields if "unit" in one):
            tree["units"] = declared
        for key in ("protocol", "enums", "structs", "messages"):
            if value := getattr(self, key):
                tree[key] = value
        return tree

    def _mark_shared_ids(self) -> None:
        """Set `shares_id` where the source itself gives one id to several messages of a direction, and nowhere else."""
        uses = [(message, use) for message in self.messages for use in _ids(message)]
        times = Counter(use for _, use in uses)
        for message in self.messages:
            message.pop("shares_id", None)
        for message, use in uses:
            if times[use] > 1:
                message["shares_id"] = True


@dataclass
class Definitions:
    """Everything that a file defines, with ``more`` files that are read as one with it.

    ``total`` counts its messages, those that are not imported among them.
    """

    file: str
    networks: list[Network] = field(default_factory=list)
    total: int = 0
    troubles: list[Trouble] = field(default_factory=list)
    more: int = 0

    @property
    def files(self) -> str:
        """The file, and how many others, for people."""
        others = "1 more file" if self.more == 1 else f"{self.more} more files"
        return f"{self.file} and {others}" if self.more else self.file

    def left_out(self, name: str, why: object, line: int | None = None, file: str = "") -> None:
        """Notes that a message is not imported. ``file`` is where it stands, if several are read as one."""
        spot = Spot(line=line, file=file if file != self.file else "")
        help = why.help if isinstance(why, NotHeld) else ""
        self.troubles.append(Trouble(NOT_HELD, f"message `{name}` is not imported: {why}", spot, help, "error"))

    def without_field(self, message: str, field: str, why: object, line: int | None = None) -> None:
        """Report that a field is left out of a message, which is imported without it."""
        text = f"message `{message}`, `{field}` is left out: {why}"
        help = "the message is imported without it: its bits are reserved"
        self.troubles.append(Trouble(WITHOUT_FIELD, text, Spot(line=line), help, severity="error"))

    def warn(
        self,
        code: str,
        message: str,
        help: str = "",
        severity: str = "warning",
        line: int | None = None,
        file: str = "",
    ) -> None:
        """Notes a fault of the file, or of ``file`` if several are read as one."""
        spot = Spot(line=line, file=file if file != self.file else "")
        self.troubles.append(Trouble(code, message, spot, help, severity))

    def refuse(self, findings: Findings) -> None:
        """Notes that the file cannot be read."""
        for finding in findings.findings:
            self.warn(
                finding.code,
                finding.message,
                finding.help,
                "error",
                finding.place.line if finding.place.line > 1 else None,
            )

    def take(self, part: Definitions) -> None:
        """Takes the findings of a file that is read as one with others."""
        file = part.file if part.file != self.file else ""
        self.troubles += [
            finding._replace(spot=finding.spot._replace(file=finding.spot.file or file)) for finding in part.troubles
        ]


class Source(NamedTuple):
    """A file with what stands in it."""

    file: str
    data: bytes


class Reader(Protocol):
    """A kind of definition. A package of its own brings one by the entry point group ``icdgen.definitions``."""

    name: str  # as in `--kind`
    title: str  # for people
    needs: tuple[str, ...]  # modules that reading takes, of the extra `definitions`
    # `most_bytes`, if it is there, is how large a file may be. A kind whose files refer to each other has
    # `read_set(sources: Sequence[Source]) -> list[Definitions]`; files that belong together are one of them.

    def knows(self, start: str) -> bool:
        """Whether a file that begins so is of this kind."""

    def read(self, file: str, data: bytes) -> Definitions:
        """What the file defines. Raises `Findings` for one that cannot be read at all."""


def _ids(message: Item) -> list[tuple[str, int]]:
    """Direction and number of each id of a message."""
    return [(direction, wire_ids.number(message[key])) for key, direction in KEYS_OF_IDS[message["kind"]]]


def unreadable(file: str, message: str, help: str = "", line: int = 1) -> Findings:
    """That a file cannot be read at all, to be raised."""
    return Findings([Finding(UNREADABLE, message, Place(file, line), help)])


def raws(bits: int, is_signed: bool) -> tuple[int, int]:
    """The least and the largest raw value of an integer."""
    return (-(1 << bits - 1), (1 << bits - 1) - 1) if is_signed else (0, (1 << bits) - 1)


def again(item: Item, said: Item) -> Item:
    """The same mapping with other keys: an enumeration is named in it later."""
    item.clear()
    item |= said
    return item
