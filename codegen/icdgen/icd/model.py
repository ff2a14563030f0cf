"""Model of an ICD: the input of all backends, the codec, the vectors and the diff.

All objects are immutable. ``source`` is the mapping that an object was read from, with
its position in the file. It is empty in a model that was made in memory or came from
the cache.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
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
from icdgen.icd.located import Map, unread
from icdgen.icd.meanings import Limits as Limits
from icdgen.icd.meanings import Special as Special
from icdgen.icd.places import NodePlace, places_in, scalars_in
from icdgen.icd.units import Unit

TELECOMMAND, TELEMETRY, CONFIGURATION = "telecommand", "telemetry", "configuration"

# Keys of the ids of each kind of message, with the direction of each id.
KEYS_OF_IDS = {
    TELECOMMAND: (("id", TELECOMMAND),),
    TELEMETRY: (("id", TELEMETRY),),
    CONFIGURATION: (("set_id", TELECOMMAND), ("get_id", TELEMETRY)),
}

# Limits of CAN if the ICD declares no others.
CAN_DATA_BYTES = 8  # of a packet
CAN_PACKETS = 256  # of an extended message


@dataclass(frozen=True, slots=True)
class Struct:
    """A group of fields that messages and other structs use; declared once."""

    name: str
    layout: Layout
    identifier: str | None = None
    summary: str = ""
    table: int | None = None
    node: str = ""  # name of the node that declares it
    aliases: tuple[str, ...] = ()  # other names that a search matches
    errata: tuple[Erratum, ...] = ()
    source: Map = field(default_factory=unread, compare=False, repr=False)

    @property
    def length(self) -> int:
        """Length in bytes."""
        return self.layout.length


@dataclass(frozen=True, slots=True)
class ContainedMessage:
    """A message whose frame a composite message contains, from bit ``at`` on."""

    message: str
    at: int


@dataclass(frozen=True, slots=True)
class Message:
    """A telecommand, a telemetry frame or a configuration message (one layout, two
    ids).
    """

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
    # Responses on a framed link that differ from those of other telecommands: a mapping,
    # "none", or None if there is no difference
    response: object = None
    # Whether a client may send it again although it may have been executed
    repeat: bool = False
    hazard: str = ""  # irreversible effect of sending the message
    assumptions: tuple[tuple[str, str], ...] = ()  # key and reason of each assumption
    contains: tuple[ContainedMessage, ...] = ()
    requested: bool = True  # telemetry: whether a packet with its id requests it
    period_ms: int | None = None  # nominal, of telemetry that is sent unasked
    reserved: int = 0  # reserved bytes at the end
    # "zeros": frames may be sent without their trailing zeros; else empty
    may_end_early: str = ""
    node: str = ""  # name of the node that declares it
    aliases: tuple[str, ...] = ()  # other names that a search matches
    errata: tuple[Erratum, ...] = ()
    source: Map = field(default_factory=unread, compare=False, repr=False)

    @property
    def length(self) -> int:
        """Length of the longest frame in bytes, without the id."""
        return self.layout.longest

    @property
    def fields(self) -> tuple[NodePlace, ...]:
        """Scalars of the longest frame, each array element and each field of a struct
        separately: `scalars_in`.
        """
        return scalars_in(self.layout)

    @property
    def field_count(self) -> int:
        """Number of scalars of the longest frame, without counts that have no bits."""
        return sum(
            place.scalar_count for place in places_in(self.layout) if not place.is_count
        )

    @property
    def has_conditions(self) -> bool:
        """Whether the message has optional fields."""
        return any(node.present_if for node in self.layout.fixed)

    @property
    def telecommand_id(self) -> int | None:
        """Id for sending the message; None if it cannot be sent."""
        return {TELECOMMAND: self.id, CONFIGURATION: self.set_id}.get(self.kind)

    @property
    def telemetry_id(self) -> int | None:
        """Id for requesting the message; None if it cannot be requested."""
        return {TELEMETRY: self.id, CONFIGURATION: self.get_id}.get(self.kind)

    @property
    def ids(self) -> tuple[int, ...]:
        """All wire ids: one, or set id and get id."""
        return tuple(id for id in (self.id, self.set_id, self.get_id) if id is not None)


@dataclass(frozen=True, slots=True)
class Node:
    """One ICD file with its errata applied.

    `Icd.messages_of` also returns the messages of included nodes.
    """

    name: str
    title: str
    summary: str
    byte_order: str  # "little" | "big"
    bit_order: str  # "lsb0" | "msb0"
    messages: tuple[Message, ...]
    enums: tuple[Enum, ...]
    structs: tuple[Struct, ...] = ()  # each after the structs that it contains
    node_type: int | None = None
    interface_version: int | None = None
    document: tuple[tuple[str, str], ...] = ()
    includes: tuple[str, ...] = ()  # names of the nodes it includes
    vocabulary: tuple[str, ...] = ()  # of included nodes and its own
    units: tuple[Unit, ...] = ()  # units that this file declares
    protocol: dict[str, Any] = field(default_factory=dict, hash=False)
    loggable: tuple[Loggable, ...] = ()
    missing: tuple[Missing, ...] = ()
    # All entries of its overlay, in order, then all notes.
    errata: tuple[Erratum, ...] = ()
    digest: str = ""  # SHA-256 over the file, its overlay and its included files
    file: str = ""
    # Of each message id; sent as whole bytes, the most significant first.
    id_bits: int = 8
    source: Map = field(default_factory=unread, compare=False, repr=False)

    @property
    def orders(self) -> Orders:
        """Default byte order and bit order of messages, structs and fields."""
        return Orders(self.byte_order, self.bit_order)


@dataclass(frozen=True, slots=True)
class Icd:
    """A set of nodes, ordered so that a node follows the nodes that it includes."""

    nodes: tuple[Node, ...]

    def node(self, name: str) -> Node:
        """Return the node called ``name``. Raises `KeyError`."""
        for node in self.nodes:
            if node.name == name:
                return node
        raise KeyError(name)

    def included(self, node: Node) -> tuple[Node, ...]:
        """Return all nodes that ``node`` includes, directly or indirectly, each once,
        in the order of the set.
        """
        return closure(self.nodes, node.includes)

    def messages_of(self, node: Node) -> tuple[Message, ...]:
        """Return all messages of the node: first the messages of included nodes, then
        its own.
        """
        return tuple(
            message
            for owner in (*self.included(node), node)
            for message in owner.messages
        )

    def longest_frame(self, message: Message) -> tuple[FrameField, ...]:
        """Return the scalars of the longest frame of a message.

        Outputs number fields by their index in it.
        """
        return frame_fields(message.layout, self.node(message.node).orders)

    def protocol_of(self, node: Node) -> dict[str, Any]:
        """Return the protocol facts of the node: `protocol_of_all`."""
        return protocol_of_all((*self.included(node), node))

    def procedures_of(self, node: Node) -> dict[str, dict[str, Any]]:
        """Return the sections of the procedures that the node has, by name.

        An included node can have some that are only for others.
        """
        procedures = self.protocol_of(node).get("procedures")
        if not isinstance(procedures, dict):
            return {}
        return {
            name: section
            for name, section in procedures.items()
            if _has_names(section) and node.name in section.get("nodes", (node.name,))
        }


def _has_names(procedure: Any) -> bool:
    """Return whether the parts of a procedure with names have the right form.

    Names are checked before the sections are known to have the right form.
    """
    if not isinstance(procedure, dict):
        return False
    steps, nodes = procedure.get("steps"), procedure.get("nodes", [])
    inputs, outputs = procedure.get("inputs", {}), procedure.get("outputs", {})
    if not isinstance(inputs, dict) or not isinstance(outputs, dict):
        return False
    if not isinstance(steps, list) or not isinstance(nodes, list):
        return False
    return all(isinstance(row, dict) for row in (*inputs.values(), *steps))


def protocol_of_all(owners: Iterable[Node]) -> dict[str, Any]:
    """Return the protocol facts of a node.

    ``owners``: the included nodes, then the node itself; see `merged_protocols`.
    """
    return merged_protocols(owner.protocol for owner in owners)


def merged_protocols(protocols: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """Return one protocol section for several.

    A part of a later section replaces that of an earlier one. Procedures, checksums,
    buses, packets on buses and the other parts of a link are parts of their own; but
    the packets and responses of a framed link belong to its framing, which is replaced
    with them. A framed link replaces buses, and buses replace a framed link.
    """
    merged: dict[str, Any] = {}
    for protocol in protocols:
        combined = {
            key: merge(merged[key], protocol[key])
            for key, merge in (("link", _merged_links), ("procedures", _merged_by_name))
            if key in merged and key in protocol
        }
        merged |= {**protocol, **combined}
    return merged


def _merged_links(earlier: Any, later: Any) -> Any:
    """Return the section `link` of two protocol sections: see `merged_protocols`."""
    if not isinstance(earlier, dict) or not isinstance(later, dict):
        return later
    if "framing" in later or ("buses" in later and "framing" in earlier):
        earlier = {
            key: earlier[key] for key in ("client", "checksums") if key in earlier
        }
    combined = {
        key: _merged_by_name(earlier[key], later[key])
        for key in ("checksums", "buses", "packets")
        if key in earlier and key in later
    }
    return {**earlier, **later, **combined}


def _merged_by_name(earlier: Any, later: Any) -> Any:
    """Return the entries of two mappings; those of the later one take precedence."""
    is_mapping = isinstance(earlier, dict) and isinstance(later, dict)
    return {**earlier, **later} if is_mapping else later


def replaced_part(path: tuple[str, ...]) -> tuple[str, ...]:
    """Return the beginning of a path in the protocol section that a later section
    replaces as a whole: a bus, another part of the link, or a section.
    """
    if path[:2] == ("link", "buses"):
        return path[:3]
    return path[:2] if path[0] == "link" else path[:1]


def buses_of(protocol: Mapping[str, Any]) -> dict[str, Any]:
    """Return the sections of UART, I2C and CAN of a protocol section, by name."""
    link = protocol.get("link")
    buses = link.get("buses") if isinstance(link, dict) else None
    return buses if isinstance(buses, dict) else {}


def framed_link(protocol: Mapping[str, Any]) -> dict[str, Any]:
    """Return the section `link` of a protocol section that describes a link of packets;
    empty if it describes none, or another kind of link.
    """
    link = protocol.get("link")
    return link if isinstance(link, dict) and "framing" in link else {}


def closure(nodes: Iterable[Node], names: Iterable[str]) -> tuple[Node, ...]:
    """Return the nodes of these names and all that they include, each once, in the
    order of ``nodes``.
    """
    by_name = {node.name: node for node in reversed(tuple(nodes))}
    selected: set[str] = set()
    queue = list(names)
    while queue:
        name = queue.pop()
        if name in by_name and name not in selected:
            selected.add(name)
            queue += by_name[name].includes
    return tuple(node for node in nodes if node.name in selected)
