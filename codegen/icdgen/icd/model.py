"""The model of an ICD: what every backend, the codec, the vectors and the diff are made from.

All objects are immutable. Positions are kept as ``source``, the mapping that the object was read from (an empty one
where a model was made in memory or came from the cache).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import field, replace
from math import gcd
from typing import Any

from icdgen.frozen import dataclass
from icdgen.icd.annex import Loggable, Missing
from icdgen.icd.curve import Curve, leads_back
from icdgen.icd.derived import Derivation
from icdgen.icd.display import Display as Display
from icdgen.icd.enumeration import Enum as Enum
from icdgen.icd.enumeration import Member as Member
from icdgen.icd.erratum import Erratum as Erratum
from icdgen.icd.formula import Scale
from icdgen.icd.layout import Condition as Condition
from icdgen.icd.layout import FrameField, Layout, Orders
from icdgen.icd.layout import Limits as Limits
from icdgen.icd.layout import Special as Special
from icdgen.icd.located import Map, unread
from icdgen.icd.paths import Step, members_of, name_of, placed
from icdgen.icd.tail import Tail as Tail
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

NO_LAYOUT = Layout("", 0, ())
"""Layout of a message or struct that was made from a list of fields and not from an ICD."""


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a message, or of a struct: ``bits`` bits at bit ``at`` of it.

    Each element of an array is one, and each field of a struct, wherever the struct stands: `Message.members`.
    """

    name: str
    at: int
    bits: int
    type: str  # "uint" | "int" | "bool" | "enum" | "float" | "bytes" | "text"; of a member also "struct"
    identifier: str | None = None
    enum: Enum | None = None
    unit: Unit | None = None
    formula: str = ""  # as held, for documentation; empty of a table of points
    scale: Scale | None = None  # of a number, where the formula is a line
    curve: Curve | None = None  # of other formulas, those of floats, and points; without either it is the raw value
    const: int | None = None
    special: tuple[Special, ...] = ()
    limits: Limits | None = None
    display: Display | None = None
    summary: str = ""
    byte_order: str = ""  # its own or its message's; empty: the node's
    bit_order: str = ""  # likewise; `at` is counted by it
    view: bool = False  # it has no bits, but reads those of other fields, or is derived: see `Message.owners`
    derived: Derivation | None = None  # of a view whose raw value is a double, derived from the values of fields
    when: tuple[Condition, ...] = ()  # it is there only if all of them hold
    path: tuple[Step, ...] = ()  # of an element, or a field of a struct: the steps to it, itself the last; else empty
    count: int = 0  # of an array that stands as one: its elements, of which this is the first but for its name
    struct: Struct | None = None  # what a member of type "struct" is made of
    implied: bool = False  # it has no bits: the length of a frame tells its value; see `Tail`
    counts_from: int = 0  # the smallest value of one that counts an open end, and something before it
    aliases: tuple[str, ...] = ()  # other names by which people look for it
    errata: tuple[Erratum, ...] = ()
    source: Map = field(default_factory=unread, compare=False, repr=False)

    def orders(self, node: Node) -> tuple[str, str]:
        """Byte order and bit order; ``node`` is the one that declares its message."""
        return self.byte_order or node.byte_order, self.bit_order or node.bit_order

    @property
    def unit_symbol(self) -> str:
        """The unit as it is written; empty without one."""
        return self.unit.symbol if self.unit else ""

    @property
    def width(self) -> int:
        """Its bits; of an array that stands as one, those of all elements."""
        return self.bits * (self.count or 1)

    @property
    def elements(self) -> tuple[Field, ...]:
        """The fields that an array or a struct which stands as one is made of; else the field itself."""
        if self.struct is not None:
            return tuple(one for place in self.places for one in placed(self, place, self.struct.fields))
        return self.places

    @property
    def places(self) -> tuple[Field, ...]:
        """All elements of what stands as one, structs whole; else the field itself."""
        if not self.count:
            return (self,)
        found: list[tuple[int, tuple[Step, ...]]] = [(self.at, ())]
        for step in self.path or (Step(self.name, None, self.count, self.bits, self.identifier),):
            indexes = range(step.count) if step.is_open else (None,)
            found = [
                (at + (index or 0) * step.stride, (*before, step if index is None else replace(step, index=index)))
                for at, before in found
                for index in indexes
            ]
        return tuple(replace(self, name=name_of(steps), at=at, path=steps, count=0) for at, steps in found)

    @property
    def index(self) -> int | None:
        """Which element of its array it is; None of what is no element."""
        return self.path[-1].index if self.path else None

    @property
    def alias(self) -> str | None:
        """Its name where its identifier, or one on its path, takes the place of a name; None if there is none."""
        if not self.path:
            return self.identifier
        return ".".join(step.alias for step in self.path) if any(step.identifier for step in self.path) else None

    @property
    def has_formula(self) -> bool:
        """Whether its physical value is computed from the raw one."""
        return self.scale is not None or self.curve is not None

    @property
    def leads_back(self) -> bool:
        """Whether a physical value gives the nearest raw one: always, but with some curves."""
        return self.curve is None or leads_back(self.curve, self.type == "float", self.raw_min, self.raw_max)

    @property
    def ends(self) -> tuple[int, int]:
        """The least and the largest raw value of a number that setting a physical one may give."""
        every = self.raw_min, self.raw_max
        return every if self.curve is None or self.type == "float" else self.curve.ends(*every)

    @property
    def is_bytes(self) -> bool:
        """Whether the raw value is whole bytes in order, and no number."""
        return self.type in ("bytes", "text")

    @property
    def signed(self) -> bool:
        """Whether it is in two's complement."""
        return self.type == "int" or (self.enum is not None and self.enum.signed)

    is_signed, is_invertible, settable_raws = signed, leads_back, ends  # as `Scalar` calls them

    @property
    def fresh(self) -> int | bytes:
        """The raw value in a new message: the only valid one, or the smallest; of a float its bits, of bytes all of them."""
        return bytes(self.bits // 8) if self.is_bytes else self.const or self.counts_from

    @property
    def raw_min(self) -> int:
        """Smallest raw value of an integer, enum or bool field."""
        return -(1 << (self.bits - 1)) if self.signed else 0

    @property
    def raw_max(self) -> int:
        """Largest raw value of an integer, enum or bool field."""
        return (1 << (self.bits - self.signed)) - 1


@dataclass(frozen=True, slots=True)
class Struct:
    """Fields that stand together, in messages and in other structs; declared once."""

    name: str
    length: int  # bytes
    fields: tuple[Field, ...]  # where they lie in it, with orders of their own only
    identifier: str | None = None
    summary: str = ""
    table: int | None = None
    node: str = ""  # name of the node that declares it
    aliases: tuple[str, ...] = ()  # other names by which people look for it
    errata: tuple[Erratum, ...] = ()
    layout: Layout = NO_LAYOUT
    source: Map = field(default_factory=unread, compare=False, repr=False)

    @property
    def owners(self) -> tuple[Field, ...]:
        """All fields: a struct has no views."""
        return self.fields

    @property
    def members(self) -> tuple[Field, ...]:
        """The fields as the ICD declares them: an array stands as one, and so does a struct."""
        return members_of(self.fields)

    @property
    def tail(self) -> None:
        """It has no open end."""

    @property
    def open_parts(self) -> tuple[Tail, ...]:
        """Nothing in it is open."""
        return ()


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
    length: int  # bytes of a frame, without the id; where frames differ, of the longest
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
    hazard: str = ""  # what is lost, or cannot be undone, once it is sent
    assumptions: tuple[tuple[str, str], ...] = ()  # key and reason of what is assumed
    contains: tuple[Part, ...] = ()
    reserved: int = 0  # bytes at the end that are said to be reserved
    tail: Tail | None = None  # where frames differ in length
    inner: tuple[Tail, ...] = ()  # what is open in front of the tail: elements that a frame lacks are not at its end
    may_end_early: str = ""  # "zeros": frames may be sent without the zeros that they end with; else empty
    node: str = ""  # name of the node that declares it
    aliases: tuple[str, ...] = ()  # other names by which people look for it
    errata: tuple[Erratum, ...] = ()
    layout: Layout = NO_LAYOUT
    source: Map = field(default_factory=unread, compare=False, repr=False)

    @property
    def least(self) -> int:
        """Bytes of the shortest frame."""
        if self.may_end_early:
            return min(1, self.length)  # of zeros alone, one is sent
        lacking = sum((one.most - one.fewest) * one.step for one in self.inner)
        return self.begin + (self.tail.fewest * self.tail.step if self.tail else 0) - lacking

    @property
    def begin(self) -> int:
        """Bytes of the longest frame before the open end, where there is one; else of a frame."""
        return self.length - (self.tail.most * self.tail.step if self.tail else 0)

    @property
    def fixed(self) -> int:
        """Bytes before all that is open; without that, of a frame."""
        return self.inner[0].begin if self.inner else self.begin

    @property
    def lengths(self) -> range:
        """The lengths that frames have, with some more where several parts are open: what these count decides."""
        return range(self.least, self.length + 1, gcd(*(one.step for one in self.open_parts)) or 1)

    @property
    def open_parts(self) -> tuple[Tail, ...]:
        """All that is open, the end last."""
        return (*self.inner, self.tail) if self.tail else ()

    @property
    def counter(self) -> Field | None:
        """Where frames differ in length: the field that says how many elements the end has."""
        return next((one for one in self.fields if self.tail and one.name == self.tail.counter), None)

    @property
    def field_count(self) -> int:
        """How many fields there are, each element of an array one; a count that only the end of a frame tells is none."""
        return sum(not one.implied for one in self.fields)

    @property
    def owners(self) -> tuple[Field, ...]:
        """The fields that have bits of their own: what a message is made of. The others are views of these."""
        if not any(field.view for field in self.fields):
            return self.fields
        return tuple(field for field in self.fields if not field.view)

    @property
    def views(self) -> tuple[Field, ...]:
        """The fields that read bits of others, or are derived from others."""
        return tuple(field for field in self.fields if field.view)

    @property
    def members(self) -> tuple[Field, ...]:
        """The fields as the ICD declares them: an array stands as one, and so does a struct."""
        return members_of(self.fields)

    @property
    def fresh(self) -> dict[str, int | bytes]:
        """The raw values of a new message by the names of its fields, but for views and what is not there."""
        found = {field.name: field.fresh for field in self.owners}
        return {one.name: one.fresh for one in self.owners if all(found.get(c.field) in c.values for c in one.when)}

    @property
    def has_conditions(self) -> bool:
        """Whether a field of it is not always there."""
        return any(field.when for field in self.fields)

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
        return message.layout.frame(self.node(message.node).orders)

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
