"""Messages, enumerations and lists that rules read from tables, before they become
ICDs.

`rules/` fills a `Survey`, in the order of the tables. `assemble` distributes its
contents to a `NodeParts` for each node.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, TypeVar

from icdgen.frozen import NamedTuple
from icdgen.import_results.findings import ImportFinding, SourcePlace
from icdgen.importer.descriptions import Described
from icdgen.importer.document import SourceTable
from icdgen.importer.profile import NodeWords


@dataclass(slots=True)
class ReadField:
    """Field of a message.

    ``bits`` is the size of one element of an array; ``enum`` is set when references are
    resolved.
    """

    name: str
    at: int
    bits: int
    type: str
    described: Described
    spot: SourcePlace
    count: int = 0  # elements of an array
    enum: str = ""
    # Further keys of the field in the ICD.
    facts: dict[str, Any] = field(default_factory=dict)

    @property
    def end(self) -> int:
        """Bit after the field, or after its minimum length if that varies."""
        if "up_to" in self.facts:
            return self.at
        return self.at + self.bits * (self.facts.get("count") or self.count or 1)


class Extent(NamedTuple):
    """Run of bits of a message: the numbers of its first bit and of the bit behind it,
    in a bit order.
    """

    at: int
    end: int
    bit_order: str

    def numbers_in(self, bit_order: str) -> list[int]:
        """Return the numbers of the bits in a bit order.

        Within a byte, bit 0 of one order is bit 7 of the other.
        """
        numbers = range(self.at, self.end)
        return (
            list(numbers)
            if bit_order == self.bit_order
            else [number ^ 7 for number in numbers]
        )


@dataclass(slots=True)
class ReadStruct:
    """A struct that a message repeats; ``length`` in bytes."""

    name: str
    length: int
    fields: list[ReadField]


@dataclass(slots=True)
class ReadMessage:
    """A message as described by its own tables."""

    name: str
    kind: str
    table: SourceTable
    id: int | None = None
    set_id: int | None = None
    get_id: int | None = None
    length: int | None = None
    fields: list[ReadField] = field(default_factory=list)
    group: str = ""
    listed: dict[str, object] = field(default_factory=dict)
    summary: str = ""
    reserved: list[Extent] = field(default_factory=list)
    structs: list[ReadStruct] = field(default_factory=list)
    bit_order: str = "lsb0"

    def extents(self) -> list[Extent]:
        """Return the bits of each field and of each run of reserved bits."""
        orders = [field.facts.get("bit_order", self.bit_order) for field in self.fields]
        fields = [
            Extent(field.at, field.end, order)
            for field, order in zip(self.fields, orders, strict=True)
        ]
        return fields + self.reserved

    @property
    def all_fields(self) -> list[ReadField]:
        """Return the fields of the message and of its structs."""
        return [
            *self.fields,
            *(field for struct in self.structs for field in struct.fields),
        ]

    @property
    def gaps(self) -> list[tuple[int, int]]:
        """First and last bit of each run that neither a field nor reserved bits cover,
        in the bit order of the message.
        """
        covered = {
            number
            for extent in self.extents()
            for number in extent.numbers_in(self.bit_order)
        }
        free = [
            number for number in range(8 * (self.length or 0)) if number not in covered
        ]
        starts = [number for number in free if number - 1 in covered or number == 0]
        ends = [
            number
            for number in free
            if number + 1 in covered or number == 8 * (self.length or 0) - 1
        ]
        return list(zip(starts, ends, strict=True))

    @property
    def reserved_bytes(self) -> int:
        """Number of bytes at the end that contain only reserved bits; 0 if the length
        varies.
        """
        used = (max((field.end for field in self.fields), default=0) + 7) // 8
        is_variable = any("up_to" in field.facts for field in self.fields)
        if (
            self.length is None
            or is_variable
            or any(last >= 8 * used for _, last in self.gaps)
        ):
            return 0
        return max(0, self.length - used)

    @property
    def ids(self) -> tuple[int | None, int | None, int | None]:
        return self.id, self.set_id, self.get_id


@dataclass(slots=True)
class ReadMember:
    """A member of an enumeration."""

    value: int
    name: str
    summary: str = ""


@dataclass(slots=True)
class ReadEnum:
    """An enumeration; ``also`` are further tables that print it."""

    name: str
    members: list[ReadMember]
    table: SourceTable
    also: list[SourceTable] = field(default_factory=list)


@dataclass(slots=True)
class Listed:
    """A row of a list table."""

    kind: str
    name: str
    length: int | None
    id: int | None
    set_id: int | None
    get_id: int | None
    group: str
    spot: SourcePlace
    used: bool = False


@dataclass(slots=True)
class ReadList:
    """A list table: ``node`` is the node's name in its caption."""

    kind: str
    node: str
    rows: list[Listed]


@dataclass(slots=True)
class ReadLogBit:
    """Bit of a log mask, with the id and the name of the frame that it selects."""

    bit: int
    id: int
    name: str


@dataclass(slots=True)
class ReadLog:
    """A table of the frames that a device can log."""

    bits: list[ReadLogBit]


TableContent = ReadMessage | ReadEnum | ReadList | ReadLog
T = TypeVar("T", ReadEnum, ReadList, ReadLog, ReadMessage)
BACKGROUND, UNKNOWN = "background", "not understood"


@dataclass(slots=True)
class TableResult:
    """Result of one table, in the order of the document."""

    table: SourceTable
    # "message" | "enumeration" | "list" | "loggable frames" | BACKGROUND | UNKNOWN
    what: str
    content: TableContent | None


@dataclass(slots=True)
class Survey:
    """All tables of a document in order, and the findings about them."""

    results: list[TableResult] = field(default_factory=list)
    import_findings: list[ImportFinding] = field(default_factory=list)

    def results_of(self, kind: type[T]) -> list[tuple[TableResult, T]]:
        """Return the tables that gave an object of this class, each with the object."""
        return [
            (entry, entry.content)
            for entry in self.results
            if isinstance(entry.content, kind)
        ]


@dataclass
class NodeParts:
    """Messages, enumerations and lists of one node, before they become an ICD."""

    name: str
    title: str
    shared: bool = False
    words: NodeWords | None = None
    messages: list[ReadMessage] = field(default_factory=list)
    enums: list[ReadEnum] = field(default_factory=list)
    lists: list[ReadList] = field(default_factory=list)
    logs: list[ReadLog] = field(default_factory=list)
    include: list[str] = field(default_factory=list)
    missing: list[Listed] = field(default_factory=list)

    def add_content(self, content: TableContent) -> None:
        """Add an object to the list of its class."""
        by_kind: dict[type, list[Any]] = {
            ReadMessage: self.messages, ReadEnum: self.enums, ReadList: self.lists, ReadLog: self.logs,
        }  # fmt: skip
        by_kind[type(content)].append(content)

    @property
    def has_contents(self) -> bool:
        """Whether there are any contents for an ICD."""
        return bool(self.messages or self.enums or self.logs)
