"""A set of ICDs as a whole, its nodes and their messages: each is described once.

Nodes: what they declare, and what they speak in each direction under which ids. Messages: their fields, the end that may be open,
and their ids.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from icdgen import layout
from icdgen.describe.comments import Comment, message_comment
from icdgen.describe.description import (
    Composite,
    Declarations,
    FieldDescription,
    StructDescription,
    VariablePartDescription,
)
from icdgen.describe.enums import EnumDescription
from icdgen.describe.shared_ids import sharing
from icdgen.describe.storage import holding
from icdgen.icd.identifiers import Identifier
from icdgen.icd.model import Enum, Icd, Message, Node, Struct
from icdgen.icd.variants import Ids, Variant, common_length, ids_of
from icdgen.once import cached_property


class Id(NamedTuple):
    """An id of a message; ``name`` is ``id``, ``set_id`` or ``get_id``."""

    name: str
    value: int
    comment: str


class MessageDescription(Composite[Message]):
    """A message."""

    def __init__(self, description: Description, message: Message, node: Node) -> None:
        super().__init__(description.declared, message, node, "message")
        self._whole = description

    @property
    def has_reserved_bits(self) -> bool:
        """Whether some bits of its frame are those of no field."""
        return bool(layout.gaps(self.model, self.node))

    @cached_property
    def optional_members(self) -> tuple[FieldDescription, ...]:
        """The members that are not always there."""
        return tuple(member for member in self.members if member.model.when)

    @property
    def last_part(self) -> VariablePartDescription | None:
        """Its open end, where frames differ in length."""
        return self.variable_parts[-1] if self.variable_parts else None

    @property
    def earlier_parts(self) -> tuple[VariablePartDescription, ...]:
        """What is open in front of the tail."""
        return self.variable_parts[:-1]

    @cached_property
    def variable_parts(self) -> tuple[VariablePartDescription, ...]:
        """All parts of variable length, in the order of the frame."""
        by_name = {member.model.name: member for member in self.members}
        return tuple(
            VariablePartDescription(part, by_name[part.name], by_name[part.counter]) for part in self.model.layout.parts
        )

    @cached_property
    def contained(self) -> tuple[tuple[MessageDescription, int], ...]:
        """The messages that it repeats, each with the bit at which it begins, in the order of the ICD."""
        if not self.model.contains:
            return ()
        known = {one.model.name: one for one in self._whole.node(self.node).all_messages}
        return tuple((known[one.message], one.at) for one in self.model.contains if one.message in known)

    @cached_property
    def ids(self) -> tuple[Id, ...]:
        """The id, or the set id and the get id."""
        about = {
            "id": f"Id of the {self.model.kind}.",
            "set_id": "Id of the telecommand that sets it.",
            "get_id": "Id of the telemetry that gets it.",
        }
        found = ((name, getattr(self.model, name), comment) for name, comment in about.items())
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
        """Whether a field of it may be given a raw value that does not fit, or a count."""
        return super().is_narrow or any(one.needs_count_check for one in self.variable_parts)

    @cached_property
    def comment(self) -> Comment:
        node, telemetry_id = self._whole.node(self.node), self.model.telemetry_id
        bit = None if telemetry_id is None else node.log_bits.get(telemetry_id)
        return message_comment(self.model, bit, sharing(node.messages_by_id, self.model))


class Direction(NamedTuple):
    """What a node speaks in one direction: messages, each with the name of its id there (``id``, ``set_id`` or ``get_id``)."""

    kind: str  # "telecommand" | "telemetry"
    messages: tuple[tuple[MessageDescription, str], ...]


class MessageOfId(NamedTuple):
    """A message under an id, the name of its id there, and what bytes show that a frame of its length is it."""

    message: MessageDescription
    id_name: str
    signs: tuple[layout.ConstantByte, ...]


class MessagesOfId(NamedTuple):
    """The messages of one id, in the order in which a frame is tried with them."""

    id: int
    messages: tuple[MessageOfId, ...]
    length: int | None  # that all of them have; None if they have several

    @property
    def first(self) -> MessageOfId:
        """One of them, whose constant says the id."""
        return self.messages[0]

    @property
    def is_shared(self) -> bool:
        """Whether it takes more than the id to know the message."""
        return len(self.messages) > 1

    @property
    def fallback(self) -> MessageOfId | None:
        """The candidate that is left when the frame is none of the others: nothing but its length may be wrong."""
        last = self.messages[-1]
        return last if not self.is_shared or (self.length is not None and not last.signs) else None

    @property
    def tested(self) -> tuple[MessageOfId, ...]:
        """Those that a frame has to be looked at for."""
        return self.messages if self.fallback is None else self.messages[:-1]


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
    def structs(self) -> tuple[StructDescription, ...]:
        """Those that it declares, each after those that it has in it."""
        return tuple(map(self._description.struct, self.model.structs))

    @property
    def composites(self) -> tuple[Composite[Any], ...]:
        """Structs and messages that it declares, each after those that it has in it."""
        return (*self.structs, *self.messages)

    @property
    def declared(self) -> tuple[Composite[Any] | EnumDescription, ...]:
        """All that it declares by a name: messages, enumerations and structs."""
        return (*self.messages, *self.enums, *self.structs)

    @cached_property
    def all_messages(self) -> tuple[MessageDescription, ...]:
        """All messages that it speaks: those of included nodes first."""
        return tuple(map(self._description.message, self._description.icd.messages_of(self.model)))

    @property
    def telecommands(self) -> tuple[MessageDescription, ...]:
        """Those of `all_messages` that can be sent to it."""
        return tuple(one for one in self.all_messages if one.model.telecommand_id is not None)

    @property
    def telemetry(self) -> tuple[MessageDescription, ...]:
        """Those of `all_messages` that can be requested from it."""
        return tuple(one for one in self.all_messages if one.model.telemetry_id is not None)

    @property
    def directions(self) -> tuple[Direction, ...]:
        """Telecommands, then telemetry; without one of which it has none."""
        found = (
            Direction("telecommand", tuple((one, one.telecommand_id_name) for one in self.telecommands)),
            Direction("telemetry", tuple((one, one.telemetry_id_name) for one in self.telemetry)),
        )
        return tuple(direction for direction in found if direction.messages)

    def ids(self, direction: str) -> tuple[MessagesOfId, ...]:
        """The messages of a direction by their ids, in the order of the ICD."""
        return self._ids[direction]

    def shares_ids(self, direction: str) -> bool:
        """Whether messages of the direction have an id in common."""
        return any(one.is_shared for one in self._ids[direction])

    def shares_id(self, direction: str, message: MessageDescription) -> bool:
        """Whether it takes more than the id to know the message."""
        shared = (one.messages for one in self._ids[direction] if one.is_shared)
        return any(one.message is message for among in shared for one in among)

    @cached_property
    def messages_by_id(self) -> Ids:
        """All messages that it speaks, by their ids."""
        return ids_of(self._description.icd, self.model)

    @cached_property
    def _ids(self) -> dict[str, tuple[MessagesOfId, ...]]:
        known = self.messages_by_id
        return {
            "telecommand": tuple(self._under("set_id", id, those) for id, those in known.telecommand.items()),
            "telemetry": tuple(self._under("get_id", id, those) for id, those in known.telemetry.items()),
        }

    def _under(self, other_name: str, id: int, variants: tuple[Variant, ...]) -> MessagesOfId:
        message = self._description.message
        found = (
            MessageOfId(
                message(one.message), "id" if one.message.id is not None else other_name, layout.constant_bytes(one)
            )
            for one in variants
        )
        return MessagesOfId(id, tuple(found), common_length(variants))

    @property
    def is_linked(self) -> bool:
        """Whether it is known how its messages travel."""
        return bool(self._description.icd.protocol_of(self.model))

    @property
    def has_client(self) -> bool:
        """Whether its link has messages with an id of one byte: the client, procedures and logs are for such."""
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
        self.declared = Declarations(icd)
        self._messages: dict[tuple[str, str], MessageDescription] = {}
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

    def struct(self, struct: Struct) -> StructDescription:
        """The description of a struct, whoever uses it."""
        return self.declared.struct_of(struct.layout)

    def enum(self, enum: Enum) -> EnumDescription:
        """The description of an enumeration, whoever uses it."""
        return self.declared.enum(enum)


_kept: list[Description] = []


def describe(icd: Icd) -> Description:
    """The description of a set of ICDs. The last ones are kept, so that the backends of one run share theirs."""
    for known in _kept:
        if known.icd is icd:
            return known
    _kept[:] = [*_kept[-1:], Description(icd)]
    return _kept[-1]
