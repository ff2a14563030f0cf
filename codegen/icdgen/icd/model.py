"""The model of an ICD: what every backend, the codec, the vectors and the diff are made from.

All objects are immutable. Positions are kept as ``source``, the mapping that the object was read from (None where a
model was made in memory or came from the cache).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from icdgen.icd.formula import Scale
from icdgen.icd.tree import Map
from icdgen.icd.units import Unit

TELECOMMAND, TELEMETRY, CONFIGURATION = "telecommand", "telemetry", "configuration"

# Where the ICD gives no other numbers.
CAN_DATA_BYTES = 8  # of a packet
CAN_PACKETS = 256  # of an extended message


class _Value:
    """Pickles as a call of its class: several times faster than what ``slots=True`` comes with."""

    __slots__ = ()

    def __reduce__(self) -> tuple:
        return type(self), tuple(getattr(self, name) for name in self.__slots__)


@dataclass(frozen=True, slots=True)
class Erratum(_Value):
    """One decision about a fault of the manual. ``changes`` is False for a note."""

    id: str
    title: str
    why: str
    evidence: str
    confidence: str  # "certain" | "likely" | "open"
    tables: tuple[int, ...] = ()
    printed: tuple[tuple[str, object], ...] = ()
    held: tuple[tuple[str, object], ...] = ()
    changes: bool = False


@dataclass(frozen=True, slots=True)
class Member(_Value):
    """One value of an enumeration."""

    value: int
    name: str
    identifier: str | None = None  # words to build identifiers from, if not the name's
    summary: str = ""
    errata: tuple[Erratum, ...] = ()
    source: Map | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Enum(_Value):
    """An enumeration; members in the order of the manual."""

    name: str
    members: tuple[Member, ...]
    identifier: str | None = None
    summary: str = ""
    table: int | None = None
    node: str = ""  # name of the node that declares it
    errata: tuple[Erratum, ...] = ()
    source: Map | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Special(_Value):
    """A raw value with a meaning of its own, such as 0xFFFF for 'no time-out'."""

    value: int
    meaning: str


@dataclass(frozen=True, slots=True)
class Limits(_Value):
    """Bounds of the physical value (of the raw value where there is no scale); None where there is none."""

    min: Fraction | None = None
    max: Fraction | None = None
    above: Fraction | None = None
    below: Fraction | None = None


@dataclass(frozen=True, slots=True)
class BitField(_Value):
    """A part of a field that the manual describes only in words; ``at`` counts within the field's value."""

    at: int
    bits: int
    name: str
    summary: str = ""
    unit: Unit | None = None


@dataclass(frozen=True, slots=True)
class Field(_Value):
    """A field of a message: ``bits`` bits at bit ``at`` of the frame."""

    name: str
    at: int
    bits: int
    type: str  # "uint" | "int" | "bool" | "enum" | "float" | "bytes"
    identifier: str | None = None
    enum: Enum | None = None
    unit: Unit | None = None
    formula: str = ""  # as held, for documentation
    scale: Scale | None = None  # None: the physical value is the raw value
    const: int | None = None
    special: tuple[Special, ...] = ()
    limits: Limits | None = None
    bitfields: tuple[BitField, ...] = ()
    summary: str = ""
    errata: tuple[Erratum, ...] = ()
    source: Map | None = field(default=None, compare=False, repr=False)

    @property
    def signed(self) -> bool:
        return self.type == "int"

    @property
    def raw_min(self) -> int:
        """Smallest raw value of an integer, enum or bool field."""
        return -(1 << (self.bits - 1)) if self.type == "int" else 0

    @property
    def raw_max(self) -> int:
        """Largest raw value of an integer, enum or bool field."""
        return (1 << (self.bits - (self.type == "int"))) - 1


@dataclass(frozen=True, slots=True)
class Part(_Value):
    """A frame that a composite frame repeats from bit ``at``."""

    message: str
    at: int


@dataclass(frozen=True, slots=True)
class Message(_Value):
    """A telecommand, a telemetry frame or a configuration message (one layout, two ids)."""

    name: str
    kind: str  # TELECOMMAND | TELEMETRY | CONFIGURATION
    length: int  # bytes, without the id
    fields: tuple[Field, ...]
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
    assumptions: tuple[tuple[str, str], ...] = ()  # key and reason of what is assumed
    contains: tuple[Part, ...] = ()
    node: str = ""  # name of the node that declares it
    errata: tuple[Erratum, ...] = ()
    source: Map | None = field(default=None, compare=False, repr=False)

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
class Loggable(_Value):
    """One bit of the log mask (bit 0: least significant bit of the first byte) and the frame it selects."""

    bit: int
    id: int
    name: str = ""
    errata: tuple[Erratum, ...] = ()
    source: Map | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Missing(_Value):
    """A message that the manual mentions and does not describe."""

    kind: str
    id: int
    name: str
    why: str


@dataclass(frozen=True, slots=True)
class Node(_Value):
    """One ICD file, errata applied. Messages of included nodes are not repeated here: see `Icd.messages_of`."""

    name: str
    title: str
    summary: str
    byte_order: str  # "little" | "big"
    bit_order: str  # "lsb0" | "msb0"
    messages: tuple[Message, ...]
    enums: tuple[Enum, ...]
    node_type: int | None = None
    interface_version: int | None = None
    document: tuple[tuple[str, str], ...] = ()
    includes: tuple[str, ...] = ()  # names of the nodes it includes
    vocabulary: tuple[str, ...] = ()  # its own and what it includes
    units: tuple[Unit, ...] = ()  # units that this file declares
    protocol: dict = field(default_factory=dict, hash=False)
    loggable: tuple[Loggable, ...] = ()
    missing: tuple[Missing, ...] = ()
    errata: tuple[Erratum, ...] = ()  # all entries of its overlay, in order
    digest: str = ""  # SHA-256 over the file, its overlay and what it includes
    file: str = ""
    source: Map | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Icd(_Value):
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
        names, queue = set(), list(node.includes)
        while queue:
            name = queue.pop()
            if name not in names:
                names.add(name)
                queue += self.node(name).includes
        return tuple(n for n in self.nodes if n.name in names)

    def messages_of(self, node: Node) -> tuple[Message, ...]:
        """All messages that the node speaks: those of included nodes first, then its own."""
        return tuple(m for n in (*self.included(node), node) for m in n.messages)

    def protocol_of(self, node: Node) -> dict:
        """The protocol facts that hold for the node: its own over those of what it includes."""
        merged: dict = {}
        for one in (*self.included(node), node):
            merged.update(one.protocol)
        return merged
