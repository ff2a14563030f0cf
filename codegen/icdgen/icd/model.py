"""The model of an ICD: what every backend, the codec, the vectors and the diff are made from.

All objects are immutable. Positions are kept as ``source``, the mapping that the object was read from (an empty one
where a model was made in memory or came from the cache).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import field
from typing import Any

from icdgen.frozen import dataclass
from icdgen.icd.annex import Loggable, Missing
from icdgen.icd.display import Display as Display
from icdgen.icd.enumeration import Enum as Enum
from icdgen.icd.enumeration import Member as Member
from icdgen.icd.erratum import Erratum as Erratum
from icdgen.icd.frames import FrameField, frame_fields
from icdgen.icd.layout import Condition as Condition
from icdgen.icd.layout import Layout, Orders
from icdgen.icd.layout import Limits as Limits
from icdgen.icd.layout import Special as Special
from icdgen.icd.located import Map, unread
from icdgen.icd.places import NodePlace, scalars_in
from icdgen.icd.units import Unit

TELECOMMAND, TELEMETRY, CONFIGURATION = "telecommand", "telemetry", "configuration"

# kind -> the keys of its ids and the direction each belongs to
KEYS_OF_IDS = {
    TELECOMMAND: (("id", TELECOMMAND),),
    TELEMETRY: (("id", TELEMETRY),),
    CONFIGURATION: (("set_id", TELECOMMAND), ("get_id", TELEMETRY)),
}

# Where the ICD gives no other numbers.
CAN_DATA_BYTES = 8  # of a packet
CAN_PACKETS = 256  # of an extended message


@dataclass(frozen=True, slots=True)
class Struct:
    """Fields that stand together, in messages and in other structs; declared once."""

    name: str
    layout: Layout
    identifier: str | None = None
    summary: str = ""
    table: int | None = None
    node: str = ""  # name of the node that declares it
    aliases: tuple[str, ...] = ()  # other names by which people look for it
    errata: tuple[Erratum, ...] = ()
    source: Map = field(default_factory=unread, compare=False, repr=False)

    @property
    def length(self) -> int:
        """Its bytes."""
        return self.layout.length


@dataclass(frozen=True, slots=True)
class Part:
    """A frame that a composite frame repeats from bit ``at``."""

    message: str
    at: int


@dataclass(frozen=True, slots=True)
class Message:
    """A telecommand, a telemetry frame or a configuration message (one layout, two ids)."""

    name: str
    kind: str  # TELECOMMAND | TELEMETRY | CONFIGURATION
    layout: Layout
    id: int | None = None
    set_id: int | None = None
    get_id: int | None = None
    identifier: str | None = None
    group: str = ""
    table: int | None = None
    page: int | None = None
    summary: str = ""
    acknowledge: bool = True
    expects_reset: bool = False  # not acknowledged because the node restarts instead
    hazard: str = ""  # what is lost, or cannot be undone, once it is sent
    assumptions: tuple[tuple[str, str], ...] = ()  # key and reason of what is assumed
    contains: tuple[Part, ...] = ()
    reserved: int = 0  # bytes at the end that are said to be reserved
    may_end_early: str = ""  # "zeros": frames may be sent without the zeros that they end with; else empty
    node: str = ""  # name of the node that declares it
    aliases: tuple[str, ...] = ()  # other names by which people look for it
    errata: tuple[Erratum, ...] = ()
    source: Map = field(default_factory=unread, compare=False, repr=False)

    @property
    def length(self) -> int:
        """Bytes of a frame, without the id; where frames differ, of the longest."""
        return self.layout.longest

    @property
    def fields(self) -> tuple[NodePlace, ...]:
        """The fields of the longest frame, each element of an array and each field of a struct one: `scalars_in`."""
        return scalars_in(self.layout)

    @property
    def field_count(self) -> int:
        """How many fields there are, each element of an array one; a count that only the end of a frame tells is none."""
        return sum(not scalar.is_count for scalar in scalars_in(self.layout))

    @property
    def has_conditions(self) -> bool:
        """Whether a field of it is not always there."""
        return any(node.present_if for node in self.layout.fixed)

    @property
    def telecommand_id(self) -> int | None:
        """The id under which it is sent, if it can be sent."""
        return {TELECOMMAND: self.id, CONFIGURATION: self.set_id}.get(self.kind)

    @property
    def telemetry_id(self) -> int | None:
        """The id under which it is requested, if it can be requested."""
        return {TELEMETRY: self.id, CONFIGURATION: self.get_id}.get(self.kind)

    @property
    def ids(self) -> tuple[int, ...]:
        """All wire ids: one, or set id and get id."""
        return tuple(i for i in (self.id, self.set_id, self.get_id) if i is not None)


@dataclass(frozen=True, slots=True)
class Node:
    """One ICD file, errata applied. Messages of included nodes are not repeated here: see `Icd.messages_of`."""

    name: str
    title: str
    summary: str
    byte_order: str  # "little" | "big"
    bit_order: str  # "lsb0" | "msb0"
    messages: tuple[Message, ...]
    enums: tuple[Enum, ...]
    structs: tuple[Struct, ...] = ()  # each after those that it has in it
    node_type: int | None = None
    interface_version: int | None = None
    document: tuple[tuple[str, str], ...] = ()
    includes: tuple[str, ...] = ()  # names of the nodes it includes
    vocabulary: tuple[str, ...] = ()  # its own and what it includes
    units: tuple[Unit, ...] = ()  # units that this file declares
    protocol: dict[str, Any] = field(default_factory=dict, hash=False)
    loggable: tuple[Loggable, ...] = ()
    missing: tuple[Missing, ...] = ()
    errata: tuple[Erratum, ...] = ()  # all entries of its overlay, in order, then all notes
    digest: str = ""  # SHA-256 over the file, its overlay and what it includes
    file: str = ""
    id_bits: int = 8  # of every id that it speaks; sent as whole bytes, the most significant first
    source: Map = field(default_factory=unread, compare=False, repr=False)

    @property
    def orders(self) -> Orders:
        """Byte order and bit order that hold where a message, a struct or a field declares none."""
        return Orders(self.byte_order, self.bit_order)


@dataclass(frozen=True, slots=True)
class Icd:
    """A set of nodes; a node stands after those that it includes."""

    nodes: tuple[Node, ...]

    def node(self, name: str) -> Node:
        """The node called ``name``. Raises `KeyError`."""
        for node in self.nodes:
            if node.name == name:
                return node
        raise KeyError(name)

    def included(self, node: Node) -> tuple[Node, ...]:
        """All nodes that ``node`` includes, directly or not, each once, in the order of the set."""
        return closure(self.nodes, node.includes)

    def messages_of(self, node: Node) -> tuple[Message, ...]:
        """All messages that the node speaks: those of included nodes first, then its own."""
        return tuple(m for n in (*self.included(node), node) for m in n.messages)

    def longest_frame(self, message: Message) -> tuple[FrameField, ...]:
        """The scalars of the longest frame of a message. Outputs number fields by their index in it."""
        return frame_fields(message.layout, self.node(message.node).orders)

    def protocol_of(self, node: Node) -> dict[str, Any]:
        """The protocol facts that hold for the node: its own over those of what it includes."""
        merged: dict[str, Any] = {}
        for one in (*self.included(node), node):
            merged.update(one.protocol)
        return merged


def closure(nodes: Iterable[Node], names: Iterable[str]) -> tuple[Node, ...]:
    """The nodes of these names and all that they include, directly or not, each once, in the order of ``nodes``."""
    known = {node.name: node for node in reversed(tuple(nodes))}
    wanted: set[str] = set()
    queue = list(names)
    while queue:
        name = queue.pop()
        if name in known and name not in wanted:
            wanted.add(name)
            queue += known[name].includes
    return tuple(node for node in nodes if node.name in wanted)
