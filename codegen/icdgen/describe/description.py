"""A set of ICDs, its nodes, their messages and the fields of these, which know each other."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

from icdgen import layout, naming
from icdgen.describe import steps
from icdgen.describe.bounds import Bound, bounds
from icdgen.describe.comments import Comment, field_comment, message_comment, words
from icdgen.describe.constants import Constant, constants
from icdgen.describe.enums import EnumDescription, enum_widths
from icdgen.describe.errata import tellers, told_elsewhere
from icdgen.describe.named import Named
from icdgen.describe.storage import Storage, holding, storage_of
from icdgen.describe.wholes import part_of_unit
from icdgen.icd.curve import Curve
from icdgen.icd.identifiers import Identifier
from icdgen.icd.model import Enum, Field, Icd, Member, Message, Node


class FieldDescription(Named[Field]):
    """A field of ``message``; of an array, an element, or among `MessageDescription.members` all of it.

    Made by the ten thousand, and each asked for its names at once: what these need is worked out at the beginning.
    """

    storage: Storage
    """The integer that holds the raw value (the bits of a float); of an enumeration, that of its type. None of bytes."""
    steps: steps.Steps | None
    """How the physical value is computed in whole numbers; None where that is the raw value, or there is a curve."""
    curve: Curve | None
    """How it is computed in doubles."""
    physical_name: str
    """``estimated_roll_angle_deg``"""
    member: str
    """What an expression calls it, in any language: its name, of an element ``temperatures[3]``."""
    declared: str
    """The name that is declared for it: of an element, that of its array."""

    def __init__(self, field: Field, message: MessageDescription, enum: EnumDescription | None) -> None:
        super().__init__(field, message.node.vocabulary, f"field `{field.name}` of `{message.model.name}`")
        self.message, self.enum = message, enum
        self.storage = enum.storage if enum is not None else storage_of(field.bits, field.signed)
        self.steps, self.curve = steps.steps(field), field.curve
        self.member = self.declared = self.name
        if field.path:
            step = field.path[-1]
            self.declared = naming.snake(naming.words(step.identifier or step.name, message.node.vocabulary))
            self.name, self.member = f"{self.declared}_{step.index}", f"{self.declared}[{step.index}]"
        self.physical_name = f"{self.declared}_{self.unit_name}"

    @property
    def count(self) -> int:
        """How many elements an array has that stands as one; else 0."""
        return self.model.count

    @property
    def is_open(self) -> bool:
        """Whether it is the open end of its message, or an element of that."""
        tail, path = self.message.model.tail, self.model.path
        return tail is not None and tail.name == (path[0].name if path else self.model.name)

    @cached_property
    def elements(self) -> tuple[FieldDescription, ...]:
        """The elements of an array that stands as one; else none."""
        if not self.count:
            return ()
        return tuple(one for one in self.message.fields if one.model.path and one.model.path[0].name == self.model.name)

    @property
    def is_narrow(self) -> bool:
        """Whether `storage` holds raw values that the field can't."""
        return self.model.bits != self.storage.bits and self.model.type in ("uint", "int", "enum")

    @property
    def fresh(self) -> int:
        """The raw value in a new message, as a number."""
        return self.model.const or 0

    @property
    def byte_order(self) -> str:
        """``little`` or ``big``: its own, its message's or its node's."""
        return self.model.orders(self.message.node)[0]

    @property
    def pieces(self) -> tuple[layout.Piece, ...]:
        """The runs of bits of the frame that make up a number."""
        return layout.pieces(self.model, self.message.node)

    @property
    def is_text(self) -> bool:
        """Whether its bytes are characters: its physical value is a text, which every language gives and takes."""
        return self.model.type == "text"

    def whole_name(self, per: int) -> str:
        """``estimated_roll_angle_mdeg``: its physical value in whole parts of the unit."""
        return f"{self.declared}_{part_of_unit(self.model, per)[0]}"

    def whole_title(self, per: int) -> str:
        """``Estimated Roll Angle in thousandths of deg``"""
        return f"{words(self.model.name)} in {words(part_of_unit(self.model, per)[1])}"

    @property
    def size(self) -> int:
        """How many bytes or characters a field of these has."""
        return self.model.bits // 8

    @property
    def has_physical(self) -> bool:
        """Whether there are accessors of a physical value that is not the raw one."""
        return self.is_text or self.is_scaled

    @property
    def is_scaled(self) -> bool:
        """Whether the physical value is a number that is computed from the raw one."""
        return self.steps is not None or self.curve is not None

    @property
    def is_set(self) -> bool:
        """Whether a physical value sets it."""
        return not self.model.view and self.model.leads_back

    @property
    def unit_name(self) -> str:
        """What names of the physical value end in: the unit's identifier, ``physical`` or ``text``."""
        if self.is_text:
            return "text"
        return self.model.unit.identifier if self.model.unit else "physical"

    @cached_property
    def bounds(self) -> tuple[Bound, ...]:
        """The limits, one by one."""
        return bounds(self.model.limits)

    @property
    def constants(self) -> tuple[Constant, ...]:
        """The only valid value, values with a meaning, limits: all by name."""
        field = self.model
        return () if field.const is None and not field.special and field.limits is None else self._constants

    @cached_property
    def _constants(self) -> tuple[Constant, ...]:
        return tuple(constants(self.model, self.declared, self.physical_name, self.message.node.vocabulary))

    @cached_property
    def comment(self) -> Comment:
        told = told_elsewhere(self.model, self.message.tellers) if self.model.errata else {}
        return field_comment(self.model, told, self.message.model.tail)


class Id(NamedTuple):
    """An id of a message; ``name`` is ``id``, ``set_id`` or ``get_id``."""

    name: str
    value: int
    comment: str


class TailDescription(NamedTuple):
    """The open end of a message: see `icdgen.icd.model.Tail`."""

    part: FieldDescription  # the array as one, or the bytes or text
    counter: FieldDescription  # how many elements there are; implied, or a field of the frame
    least: int  # bytes of a frame without any element
    step: int  # bytes of an element
    most: int  # elements

    @property
    def is_bound(self) -> bool:
        """Whether the integer that holds the count holds larger ones than there can be."""
        return self.counter.storage.max > self.most


class MessageDescription(Named[Message]):
    """A message that ``node`` declares."""

    def __init__(self, description: Description, message: Message, node: Node) -> None:
        super().__init__(message, node.vocabulary, f"message `{message.name}`")
        self._description, self.node = description, node

    @cached_property
    def all_fields(self) -> tuple[FieldDescription, ...]:
        """Fields and views, in the order of the ICD; each element of an array."""
        return tuple(map(self._field, self.model.fields))

    @cached_property
    def all_members(self) -> tuple[FieldDescription, ...]:
        """Members and views, in the order of the ICD: what is declared in code."""
        declared = self.model.members
        return self.all_fields if declared is self.model.fields else tuple(map(self._field, declared))

    def _field(self, field: Field) -> FieldDescription:
        return FieldDescription(field, self, self._description.enum(field.enum) if field.enum else None)

    @cached_property
    def views(self) -> tuple[FieldDescription, ...]:
        """What reads bits of others: it is asked of a message, and never set."""
        return tuple(field for field in self.all_fields if field.model.view)

    @cached_property
    def members(self) -> tuple[FieldDescription, ...]:
        """What a message is made of, in the order of the ICD, an array as one."""
        return self._owners(self.all_members)

    @cached_property
    def fields(self) -> tuple[FieldDescription, ...]:
        """What has bits of its own, in the order of the ICD, each element of an array."""
        return self._owners(self.all_fields)

    def _owners(self, fields: tuple[FieldDescription, ...]) -> tuple[FieldDescription, ...]:
        return tuple(field for field in fields if not field.model.view) if self.views else fields

    @cached_property
    def tail(self) -> TailDescription | None:
        """Its open end, where frames differ in length."""
        tail = self.model.tail
        if tail is None:
            return None
        part, counter = (
            next(one for one in self.members if one.model.name == name) for name in (tail.name, tail.counter)
        )
        return TailDescription(part, counter, self.model.least, tail.step, tail.most)

    @property
    def sent(self) -> tuple[FieldDescription, ...]:
        """Members that have bits in the frame: without the count that only the length of the frame tells."""
        return self.members if self.tail is None else tuple(one for one in self.members if not one.model.implied)

    @property
    def sent_fields(self) -> tuple[FieldDescription, ...]:
        """Fields that have bits in the frame, each element of an array."""
        return self.fields if self.tail is None else tuple(one for one in self.fields if not one.model.implied)

    @cached_property
    def contained(self) -> tuple[tuple[MessageDescription, int], ...]:
        """The messages that it repeats, each with the bit at which it begins, in the order of the ICD."""
        if not self.model.contains:
            return ()
        known = {one.model.name: one for one in self._description.node(self.node).spoken}
        return tuple((known[one.message], one.at) for one in self.model.contains if one.message in known)

    @cached_property
    def ids(self) -> tuple[Id, ...]:
        """The id, or the set id and the get id."""
        message = self.model
        found = (
            ("id", message.id, f"Id of the {message.kind}."),
            ("set_id", message.set_id, "Id of the telecommand that sets it."),
            ("get_id", message.get_id, "Id of the telemetry that gets it."),
        )
        return tuple(Id(name, value, comment) for name, value, comment in found if value is not None)

    @property
    def telecommand_id_name(self) -> str:
        """Name of the id under which it is sent: ``id`` or ``set_id``."""
        return "id" if self.model.id is not None else "set_id"

    @property
    def telemetry_id_name(self) -> str:
        """Name of the id under which it is requested: ``id`` or ``get_id``."""
        return "id" if self.model.id is not None else "get_id"

    @property
    def is_narrow(self) -> bool:
        """Whether a field of it may be given a raw value that does not fit."""
        return any(field.is_narrow for field in self.fields) or (self.tail is not None and self.tail.is_bound)

    @property
    def has_floats(self) -> bool:
        return any(field.type == "float" for field in self.model.owners)

    @cached_property
    def has_wide_steps(self) -> bool:
        """Whether the formula of a field has numbers of many digits."""
        return any(field.steps is not None and field.steps.is_wide for field in self.all_fields)

    @cached_property
    def tellers(self) -> dict[str, Message | Field | Enum | Member]:
        """By the ids of errata: which part of the message tells of it."""
        return tellers((self.model, *self.model.members))

    @cached_property
    def comment(self) -> Comment:
        bits = self._description.node(self.node).log_bits
        telemetry_id = self.model.telemetry_id
        return message_comment(self.model, None if telemetry_id is None else bits.get(telemetry_id))


class Direction(NamedTuple):
    """What a node speaks in one direction: messages, each with the name of its id there (``id``, ``set_id`` or ``get_id``)."""

    kind: str  # "telecommand" | "telemetry"
    messages: tuple[tuple[MessageDescription, str], ...]


class NodeDescription:
    """A node (``model``) of the set."""

    def __init__(self, description: Description, node: Node) -> None:
        self._description, self.model, self.name = description, node, node.name

    def identifier(self, scope: str, name: str) -> Identifier:
        """A name that generated code declares for it."""
        return Identifier(scope, name, f"node `{self.name}`", self.model.source)

    @cached_property
    def messages(self) -> tuple[MessageDescription, ...]:
        """Those that it declares."""
        return tuple(map(self._description.message, self.model.messages))

    @cached_property
    def enums(self) -> tuple[EnumDescription, ...]:
        """Those that it declares."""
        return tuple(map(self._description.enum, self.model.enums))

    @cached_property
    def spoken(self) -> tuple[MessageDescription, ...]:
        """All messages that it speaks: those of included nodes first."""
        return tuple(map(self._description.message, self._description.icd.messages_of(self.model)))

    @property
    def telecommands(self) -> tuple[MessageDescription, ...]:
        """Those of `spoken` that can be sent to it."""
        return tuple(one for one in self.spoken if one.model.telecommand_id is not None)

    @property
    def telemetry(self) -> tuple[MessageDescription, ...]:
        """Those of `spoken` that can be requested from it."""
        return tuple(one for one in self.spoken if one.model.telemetry_id is not None)

    @property
    def directions(self) -> tuple[Direction, ...]:
        """Telecommands, then telemetry; without one of which it has none."""
        found = (
            Direction("telecommand", tuple((one, one.telecommand_id_name) for one in self.telecommands)),
            Direction("telemetry", tuple((one, one.telemetry_id_name) for one in self.telemetry)),
        )
        return tuple(direction for direction in found if direction.messages)

    @property
    def is_linked(self) -> bool:
        """Whether it is known how its messages travel."""
        return bool(self._description.icd.protocol_of(self.model))

    @property
    def has_client(self) -> bool:
        """Whether requests can be sent on its link, which is not so of an envelope."""
        return self.is_linked and "stream" not in self._description.icd.protocol_of(self.model)

    @property
    def id_bits(self) -> int:
        """Those of the set: see `Description.id_bits`."""
        return self._description.id_bits

    @cached_property
    def log_bits(self) -> dict[int, int]:
        """Telemetry id -> the bit of the log mask that selects it."""
        return {row.id: row.bit for row in self.model.loggable}


class Description:
    """A set of ICDs. ``nodes`` stand in the order of the set: each after those that it includes."""

    def __init__(self, icd: Icd) -> None:
        self.icd = icd
        self._enum_bits = enum_widths(icd)
        self._messages: dict[tuple[str, str], MessageDescription] = {}
        self._enums: dict[tuple[str, str], EnumDescription] = {}
        self._nodes = {node.name: NodeDescription(self, node) for node in icd.nodes}
        self.nodes = tuple(self._nodes.values())

    @cached_property
    def id_bits(self) -> int:
        """8, 16 or 32: bits of the integer that holds every id of the set."""
        used = (id.bit_length() for node in self.icd.nodes for message in node.messages for id in message.ids)
        return holding(max((*(node.id_bits for node in self.icd.nodes), *used), default=8))

    def node(self, node: str | Node) -> NodeDescription:
        """The description of a node, by its name or of the node itself. Raises `KeyError`."""
        return self._nodes[node if isinstance(node, str) else node.name]

    def message(self, message: Message) -> MessageDescription:
        """The description of a message, whoever speaks it."""
        key = message.node, message.name
        found = self._messages.get(key)
        if found is None or found.model is not message:
            found = self._messages[key] = MessageDescription(self, message, self.icd.node(message.node))
        return found

    def enum(self, enum: Enum) -> EnumDescription:
        """The description of an enumeration, whoever uses it."""
        key = enum.node, enum.name
        found = self._enums.get(key)
        if found is None or found.model is not enum:
            found = self._enums[key] = EnumDescription(enum, self.icd.node(enum.node), self._enum_bits[key])
        return found


_kept: list[Description] = []


def describe(icd: Icd) -> Description:
    """The description of a set of ICDs. The last ones are kept, so that the backends of one run share theirs."""
    for known in _kept:
        if known.icd is icd:
            return known
    _kept[:] = [*_kept[-1:], Description(icd)]
    return _kept[-1]
