"""What rules look at: the model, flattened once so that sixty rules need not each walk it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from icdgen.diagnostics import Lines
from icdgen.icd.errata import Applied
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map
from icdgen.icd.model import Enum, Field, Icd, Message, Node, Struct
from icdgen.icd.trees import at_path, mappings

if TYPE_CHECKING:
    from icdgen.icd.identifiers import Language

# Keys of a field that only few fields have.
RARE = ("enum", "unit", "formula", "formula_for", "points", "outside", "const", "special", "bitfields", "byte_order",
    "bit_order", "view", "when", "display",
)  # fmt: skip

Owner = Message | Struct
Row = tuple[Field, Owner, Node]


def said(node: Node, *path: str) -> Any:
    """What the node's own protocol says at a path; None if nothing."""
    return at_path(node.source.get("protocol"), path)


def section_of(node: Node, *path: str) -> Map | None:
    """A section of the node's own protocol."""
    found = said(node, *path)
    return found if isinstance(found, Map) else None


class Context:
    """The model and what was found so far. The model must have been read from files: rules look at ``source``."""

    def __init__(
        self,
        icd: Icd,
        applied: Iterable[Applied] = (),
        complete: bool = True,
        languages: Sequence[Language] = (),
        texts: Mapping[str, str] | None = None,
    ) -> None:
        self.icd = icd
        self._lines = {file: Lines(text) for file, text in (texts or {}).items()}
        self.languages = languages  # that names must do for
        self.applied = tuple(applied)
        self._accepted = {(code, id(owner)) for one in self.applied for code, _, owner in one.accepts}
        self.complete = complete
        self.raised: list[tuple[str, Fault]] = []  # code and fault, of the rules that ran already
        self.messages: list[tuple[Message, Node]] = [(m, n) for n in icd.nodes for m in n.messages]
        self.structs: list[tuple[Struct, Node]] = [(one, n) for n in icd.nodes for one in n.structs]
        self.enums: list[Enum] = [one for n in icd.nodes for one in n.enums]
        self.owners: list[tuple[Owner, Node]] = [*self.messages, *self.structs]  # of fields
        self.members: list[Row] = [
            (f, m, n) for m, n in self.owners for f in m.members if not f.implied and f.derived is None
        ]  # an array once
        self.fields: list[Row] = [row for row in self.members if row[0].struct is None]
        self.having: dict[str, list[Row]] = {key: [] for key in RARE}  # fields that have the key
        having = self.having
        for row in self.fields:
            for key in row[0].source:
                if key in having:
                    having[key].append(row)
        derived = [(f, m, n) for m, n in self.messages for f in m.views if f.derived is not None]
        for key in ("unit", "display"):
            having[key] += (row for row in derived if key in row[0].source)
        self.declared: list[Any] | None = None  # what backends declare; see `declarations`
        self._scopes: dict[int, tuple[Node, ...]] = {}

    def scope(self, node: Node) -> tuple[Node, ...]:
        """What the node includes, then the node itself; each name once."""
        found = self._scopes.get(id(node))
        if found is None:
            by_name = {n.name: n for n in reversed(self.icd.included(node)) if n.name != node.name}
            found = (*(n for n in self.icd.nodes if by_name.get(n.name) is n), node)
            self._scopes[id(node)] = found
        return found

    def written(self, owner: Map, key: str) -> str:
        """Return a number as its file writes it, such as ``0x82``, and a list of bytes as ``0x01 0x05``."""
        value, place = owner[key], owner.at(key)
        if isinstance(value, list):
            return " ".join(f"0x{byte:02X}" for byte in value)
        lines = self._lines.get(place.file)
        return lines.marked(place) if lines is not None else str(value)

    def accepts(self, code: str, fault: Fault) -> bool:
        """Whether an erratum says that the fault is to be."""
        return (code, id(fault.owner)) in self._accepted

    def sections(self, *path: str) -> Iterator[Map]:
        """The sections of that path, of each node that has one of its own."""
        found = (section_of(node, *path) for node in self.icd.nodes)
        return (section for section in found if section is not None)

    def messages_of(self, node: Node) -> list[Message]:
        """All messages that the node speaks."""
        return [m for n in self.scope(node) for m in n.messages]

    def broken_messages(self, node: Node) -> set[str]:
        """The names of those that stand in the files of what the node speaks, and could not be read. Findings tell of them."""
        entries = (item for one in self.scope(node) for item in mappings(one.source.get("messages")))
        written = {name for item in entries if isinstance(name := item.get("name"), str)}
        return written - {message.name for message in self.messages_of(node)}

    def protocol_of(self, node: Node) -> dict[str, Any]:
        """The protocol facts that hold for the node: its own over those of what it includes."""
        merged: dict[str, Any] = {}
        for one in self.scope(node):
            merged.update(one.protocol)
        return merged

    def fact(self, node: Node, *path: str) -> Any:
        """The protocol fact at a path that holds for the node; None if there is none."""
        return at_path(self.protocol_of(node), path)

    def is_linked(self, node: Node) -> bool:
        """Whether its protocol describes links that know a message by its id, and in one length: an envelope does without."""
        protocol = self.protocol_of(node)
        return bool(protocol) and "stream" not in protocol
