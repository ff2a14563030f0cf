"""Common result of all readers: ICDs as mappings with the keys of the YAML format, and
findings.

A reader returns `Definitions` with a `Network` for each node. `run` settles them
(`settle`) and makes trees of them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, Protocol

from icdgen.diagnostics import Finding, Findings, Place
from icdgen.frozen import NamedTuple
from icdgen.icd import units, wire_ids
from icdgen.icd.fmt.emit import Spelled
from icdgen.icd.model import KEYS_OF_IDS
from icdgen.import_results.findings import ImportFinding, SourcePlace
from icdgen.wording import count

UNREADABLE = "IMP005"
NOT_HELD = "IMP070"
WITHOUT_FIELD = "IMP091"
RAW_ONLY = "IMP078"
SAME_NAME = "IMP092"

# Message, field, enumeration, member or struct with the keys of the ICD.
Item = dict[str, Any]


class NotSupported(Exception):
    """Message that an ICD cannot represent.

    The text gives the reason, and ``help`` the remedy if any.
    """

    def __init__(self, text: str, help: str = "") -> None:
        super().__init__(text)
        self.help = help


@dataclass
class Network:
    """Content of one ICD: messages of a network, dialect or device.

    ``head`` is the section `node` without name and title.
    """

    name: str
    title: str
    head: Item
    messages: list[Item] = field(default_factory=list)
    enums: list[Item] = field(default_factory=list)
    structs: list[Item] = field(default_factory=list)
    protocol: Item | None = None
    # Checksum seeds of ``protocol`` by message name.
    seeds: dict[str, int] = field(default_factory=dict)

    @property
    def fields(self) -> Iterator[Item]:
        """Fields of all messages and structs."""
        return (
            field
            for owner in (*self.messages, *self.structs)
            for field in owner.get("fields", ())
        )

    def declare(self, enums: Iterable[Item]) -> None:
        """Set the enumerations to the subset that fields use."""
        used = {field.get("enum") for field in self.fields}
        self.enums = [enum for enum in enums if enum["name"] in used]

    def name_messages_apart(self, to: Definitions) -> None:
        """Make message names unique, with a note (IMP092).

        Duplicate names get the group or kind as prefix. If neither distinguishes the
        messages, they get the id as suffix.
        """
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
                ids = [
                    message[KEYS_OF_IDS[message["kind"]][0][0]] for message in messages
                ]
                names = [
                    f"{name} {id.spelling if isinstance(id, Spelled) else id}"
                    for id in ids
                ]
            for message, distinct in zip(messages, names, strict=True):
                message["name"] = distinct
            shown = ", ".join(f"`{distinct}`" for distinct in names)
            text = f"{len(messages)} messages have the name `{name}`: they are imported as {shown}"
            to.warn(
                SAME_NAME,
                text,
                "rename them in the ICD if you want other names",
                "note",
            )

    def tree(self) -> Item:
        """Return the ICD as plain mappings and lists."""
        self._mark_shared_ids()
        tree: Item = {
            "icdgen": 1,
            "node": {"name": self.name, "title": self.title, **self.head},
        }
        if declared := units.declared(
            field["unit"] for field in self.fields if "unit" in field
        ):
            tree["units"] = declared
        for key in ("protocol", "enums", "structs", "messages"):
            if value := getattr(self, key):
                tree[key] = value
        return tree

    def _mark_shared_ids(self) -> None:
        """Set `shares_id` for messages whose id occurs several times in a direction,
        and remove it elsewhere.
        """
        uses = [(message, use) for message in self.messages for use in _ids(message)]
        times = Counter(use for _, use in uses)
        for message in self.messages:
            message.pop("shares_id", None)
        for message, use in uses:
            if times[use] > 1:
                message["shares_id"] = True


@dataclass
class Definitions:
    """Definitions and findings of a file.

    ``total`` counts all messages, including messages that are not imported. ``more`` is
    the number of further files read together with the file.
    """

    file: str
    networks: list[Network] = field(default_factory=list)
    total: int = 0
    import_findings: list[ImportFinding] = field(default_factory=list)
    more: int = 0

    @property
    def files(self) -> str:
        """Name of the file and number of further files, for reports."""
        return (
            f"{self.file} and {count(self.more, 'more file')}"
            if self.more
            else self.file
        )

    def left_out(
        self, name: str, why: object, line: int | None = None, file: str = ""
    ) -> None:
        """Report a message that is not imported (IMP070).

        ``file`` is the file that contains it, if several files are read together.
        """
        spot = SourcePlace(line=line, file=file if file != self.file else "")
        help = why.help if isinstance(why, NotSupported) else ""
        self.import_findings.append(
            ImportFinding(
                NOT_HELD,
                f"message `{name}` is not imported: {why}",
                spot,
                help,
                "error",
            )
        )

    def without_field(
        self, message: str, field: str, why: object, line: int | None = None
    ) -> None:
        """Report a field that is left out of an imported message (IMP091)."""
        text = f"message `{message}`, `{field}` is left out: {why}"
        help = "the message is imported without it: its bits are reserved"
        self.import_findings.append(
            ImportFinding(
                WITHOUT_FIELD, text, SourcePlace(line=line), help, severity="error"
            )
        )

    def warn(
        self,
        code: str,
        message: str,
        help: str = "",
        severity: str = "warning",
        line: int | None = None,
        file: str = "",
    ) -> None:
        """Add a finding for the file, or for ``file`` if several files are read
        together.
        """
        spot = SourcePlace(line=line, file=file if file != self.file else "")
        self.import_findings.append(ImportFinding(code, message, spot, help, severity))

    def refuse(self, findings: Findings) -> None:
        """Report that the file cannot be read."""
        for finding in findings.findings:
            self.warn(
                finding.code,
                finding.message,
                finding.help,
                "error",
                finding.place.line if finding.place.line > 1 else None,
            )

    def take(self, part: Definitions) -> None:
        """Add the findings of a file that is read together with this one."""
        file = part.file if part.file != self.file else ""
        self.import_findings += [
            finding._replace(spot=finding.spot._replace(file=finding.spot.file or file))
            for finding in part.import_findings
        ]


class SourceFile(NamedTuple):
    """File with its contents."""

    file: str
    data: bytes


class DefinitionReader(Protocol):
    """Interface of a reader.

    Packages can register readers in the entry point group ``icdgen.definitions``.
    """

    name: str  # value of `--kind`
    title: str  # for reports
    needs: tuple[str, ...]  # required modules, from the extra `definitions`
    # Optional members: `most_bytes` is the size limit of a file. Kinds whose files
    # refer to each other have `read_set(sources: Sequence[Source]) ->
    # list[Definitions]`. Files that belong together share a result.

    def knows(self, start: str) -> bool:
        """Return whether a file with this beginning is of this kind."""

    def read(self, file: str, data: bytes) -> Definitions:
        """Read a file. Raises `Findings` if the file cannot be read at all."""


def _ids(message: Item) -> list[tuple[str, int]]:
    """Return direction and number of each id of a message."""
    return [
        (direction, wire_ids.number(message[key]))
        for key, direction in KEYS_OF_IDS[message["kind"]]
    ]


def unreadable(file: str, message: str, help: str = "", line: int = 1) -> Findings:
    """Return the exception for a file that cannot be read at all."""
    return Findings([Finding(UNREADABLE, message, Place(file, line), help)])


def replace_keys(item: Item, keys: Item) -> Item:
    """Replace the keys of a mapping and return it.

    Its identity matters: `Enumerations.declared` sets `enum` in it later.
    """
    item.clear()
    item |= keys
    return item
