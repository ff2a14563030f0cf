"""Traceability from a line of the ICD to the golden vectors that detect a change of it.

`Trace.elements` yields each line of a node with its changes (`changes`), and for each
change the lines of the vector files that detect it (`detection`, `shared_ids`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from icdgen.backends.assurance import changes
from icdgen.backends.assurance.changes import SingleChange
from icdgen.backends.assurance.detection import MessageWatch
from icdgen.backends.assurance.shared_ids import SharedIds
from icdgen.icd.erratum import Erratum
from icdgen.icd.layout import LayoutNode
from icdgen.icd.layout_copies import with_node, with_struct_layout
from icdgen.icd.located import Map
from icdgen.icd.model import Enum, Icd, Member, Message, Node, Struct
from icdgen.vectors.lines import NodeLines, line_numbers
from icdgen.vectors.make import NodeVectors, make_vectors
from icdgen.vectors.write import vector_file_text

DetectedLines = dict[str, list[int]]
"""Node -> lines of its vector file."""


@dataclass(frozen=True, slots=True)
class Traced:
    """Change with the vectors that detect it."""

    change: SingleChange
    detected: DetectedLines


@dataclass(frozen=True, slots=True)
class Element:
    """Object that a line of the ICD describes.

    ``row``: number of its line within the message or enumeration, from 1.
    """

    kind: str  # "node" | "message" | "struct" | "field" | "enumeration" | "member"
    node: Node
    owner: Message | Struct | Enum | None  # message of a field, enumeration of a member
    model: Node | Message | Struct | LayoutNode | Enum | Member
    row: int | None
    changes: tuple[Traced, ...]

    @property
    def name(self) -> str:
        return self.model.name

    @property
    def part_of(self) -> str:
        """Name of its owner."""
        return self.owner.name if self.owner else ""

    @property
    def source(self) -> Map:
        """YAML content of its line."""
        source = self.model.source
        return source.get("node", source) if self.kind == "node" else source

    @property
    def errata(self) -> tuple[Erratum, ...]:
        """Errata and notes that concern it."""
        return () if self.kind == "node" else self.model.errata

    @property
    def table(self) -> int | None:
        """Number of its table in the manual."""
        thing = self.owner or self.model
        return thing.table if isinstance(thing, Message | Struct | Enum) else None

    @property
    def page(self) -> int | None:
        """Page of a message and its fields in the manual, if the ICD states it."""
        thing = self.owner or self.model
        return thing.page if isinstance(thing, Message) else None

    @property
    def detected(self) -> DetectedLines:
        """Vectors that detect any of the changes."""
        return merged(traced.detected for traced in self.changes)


class Trace:
    """Traceability of a set of ICDs, by node, in the order of the ICDs."""

    def __init__(self, icd: Icd) -> None:
        self.icd = icd
        self._vectors: dict[str, NodeVectors] = {}
        self._lines: dict[str, NodeLines] = {}
        self._watches: dict[tuple[str, str], MessageWatch] = {}
        for node in icd.nodes:
            vectors = self._vectors[node.name] = make_vectors(icd, node)
            node_lines = self._lines[node.name] = line_numbers(
                vectors, vector_file_text(vectors)
            )
            for message_vectors in vectors.messages:
                name = message_vectors.message.name
                self._watches[node.name, name] = MessageWatch(
                    node, message_vectors, node_lines.messages[name]
                )
        self._shared = SharedIds(icd, self._vectors, self._lines)

    def elements(self, node: Node) -> Iterator[Element]:
        """Yield the elements of a node that have a line in the ICD: the node,
        enumerations with members, structs and messages with fields.
        """
        yield Element("node", node, None, node, None, tuple(self._trace_node(node)))
        for enum in node.enums:
            traced = list(self._trace_enum(enum))
            # An enumeration has no numbers of its own; its members do.
            yield Element("enumeration", node, None, enum, None, ())
            for row, member in enumerate(enum.members, 1):
                # Changes of an enumeration are computed for all members at once.
                own = tuple(
                    change for change in traced if change.change.source is member.source
                )
                yield Element("member", node, enum, member, row, own)
        for struct in node.structs:
            yield Element("struct", node, None, struct, None, ())
            for row, line in enumerate(struct.layout.nodes, 1):
                yield Element(
                    "field",
                    node,
                    struct,
                    line,
                    row,
                    tuple(self._trace_struct(struct, line, node)),
                )
        for message in node.messages:
            yield Element(
                "message",
                node,
                None,
                message,
                None,
                tuple(self._trace_message(message, node)),
            )
            for row, line in enumerate(message.layout.nodes, 1):
                yield Element(
                    "field",
                    node,
                    message,
                    line,
                    row,
                    tuple(self._trace_line(message, line, node)),
                )

    def _trace_line(
        self, message: Message, line: LayoutNode, node: Node
    ) -> Iterator[Traced]:
        """Yield the changes of a line of a message."""
        watch = self._watches[node.name, message.name]
        for change, new in changes.of_line(line, message.layout, node.orders):
            now = replace(message, layout=with_node(message.layout, line, new))
            shared = self._shared.detect_message(message, now)
            yield Traced(
                change, merged([_lines_of_node(node, watch.detect_layout(now)), shared])
            )

    def _trace_struct(
        self, struct: Struct, line: LayoutNode, node: Node
    ) -> Iterator[Traced]:
        """Yield the changes of a line of a struct, with the vectors of all messages
        that use the struct.
        """
        for change, new in changes.of_line(line, struct.layout, node.orders):
            changed = with_node(struct.layout, line, new)
            results: list[DetectedLines] = []
            for watch in self._watches.values():
                layout = with_struct_layout(
                    watch.message.layout, struct.layout, changed
                )
                # The layout object is unchanged if the message does not use the struct.
                if layout is not watch.message.layout:
                    now = replace(watch.message, layout=layout)
                    results += (
                        _lines_of_node(watch.node, watch.detect_layout(now)),
                        self._shared.detect_message(watch.message, now),
                    )
            yield Traced(change, merged(results))

    def _trace_node(self, node: Node) -> Iterator[Traced]:
        for change, now in changes.of_node(node):
            if change.kind == "node":
                yield Traced(
                    change,
                    _lines_of_node(node, [self._lines[node.name].head[change.key]]),
                )
            else:
                watches = (
                    self._watches[node.name, message.name] for message in node.messages
                )
                rows = [
                    line
                    for watch in watches
                    for line in watch.detect_places(watch.message, now)
                ]
                yield Traced(
                    change,
                    merged(
                        [
                            _lines_of_node(node, rows),
                            self._shared.detect_node(node, now),
                        ]
                    ),
                )

    def _trace_enum(self, enum: Enum) -> Iterator[Traced]:
        for change, now in changes.of_enum(enum):
            # The line of the enumeration lists values and names, so each change of a
            # member fails there.
            results = [{enum.node: [self._lines[enum.node].enums[enum.name]]}]
            results += (
                _lines_of_node(watch.node, watch.detect_enum(enum, now))
                for watch in self._watches.values()
            )
            yield Traced(change, merged(results))

    def _trace_message(self, message: Message, node: Node) -> Iterator[Traced]:
        watch = self._watches[node.name, message.name]
        for change, now in changes.of_message(message, node):
            if change.kind == "id":
                detected = merged(
                    [
                        self._lines_of_ids(message, now),
                        _lines_of_node(node, watch.detect_id(change.key)),
                    ]
                )
            elif change.kind == "length":
                detected = _lines_of_node(node, watch.detect_length())
            else:
                detected = _lines_of_node(node, watch.detect_places(now, node))
            yield Traced(
                change, merged([detected, self._shared.detect_message(message, now)])
            )

    def _lines_of_ids(self, message: Message, now: Message) -> DetectedLines:
        """Return the lines with lists of ids that detect a lost id, for each node that
        uses the message.
        """
        detected: DetectedLines = {}
        for node in self.icd.nodes:
            # Only vector files of nodes that use the message list its id.
            if all(message is not other for other in self.icd.messages_of(node)):
                continue
            for direction, names_by_id in self._vectors[node.name].ids.items():
                own_ids = {
                    id for id, names in names_by_id.items() if message.name in names
                }
                if own_ids & (set(message.ids) - set(now.ids)):
                    detected.setdefault(node.name, []).append(
                        self._lines[node.name].ids[direction]
                    )
        return detected


def merged(results: Iterator[DetectedLines] | list[DetectedLines]) -> DetectedLines:
    """Return the union of lines by node, in ascending order."""
    lines_by_node: dict[str, set[int]] = {}
    for detected in results:
        for node, numbers in detected.items():
            lines_by_node.setdefault(node, set()).update(numbers)
    return {node: sorted(numbers) for node, numbers in lines_by_node.items() if numbers}


def _lines_of_node(node: Node, numbers: list[int]) -> DetectedLines:
    return {node.name: sorted(set(numbers))} if numbers else {}
