"""Description of a set of ICDs: its nodes, and the messages that they declare and use.

Each is described once.

A node has the messages of each direction by their ids. A message has its fields, its
variable parts and its ids.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from icdgen import frame_bits
from icdgen.describe.comments import Comment, message_comment
from icdgen.describe.description import (
    Composite,
    Declarations,
    FieldDescription,
    StructDescription,
    VariablePartDescription,
)
from icdgen.describe.enums import EnumDescription
from icdgen.describe.lengths import (
    LengthTest,
    length_tests,
    length_tests_of_frame,
)
from icdgen.describe.shared_ids import sharing_sentence
from icdgen.describe.storage import storage_bits
from icdgen.frozen import NamedTuple
from icdgen.icd.identifiers import Identifier
from icdgen.icd.model import (
    Enum,
    Icd,
    Message,
    Node,
    Struct,
    framed_link,
)
from icdgen.icd.trees import at_path
from icdgen.icd.variants import Ids, Variant, common_length, ids_of
from icdgen.once import cached_property


class MessageId(NamedTuple):
    """Id of a message; ``name`` is ``id``, ``set_id`` or ``get_id``."""

    name: str
    value: int
    comment: str


class MessageDescription(Composite[Message]):
    """Message of a node."""

    def __init__(self, description: Description, message: Message, node: Node) -> None:
        super().__init__(description.declared, message, node, "message")
        self._description = description

    @property
    def has_reserved_bits(self) -> bool:
        """Whether some bits of its frame belong to no field."""
        return bool(frame_bits.reserved_bits(self.model, self.node))

    @cached_property
    def optional_members(self) -> tuple[FieldDescription, ...]:
        """Members that are present only if other fields have certain values."""
        return tuple(member for member in self.members if member.model.conditions)

    @property
    def last_part(self) -> VariablePartDescription | None:
        """Last part of variable length; None if all frames have the same length or may
        end early.
        """
        return self.variable_parts[-1] if self.variable_parts else None

    @property
    def earlier_parts(self) -> tuple[VariablePartDescription, ...]:
        """Parts of variable length in front of the last one."""
        return self.variable_parts[:-1]

    @cached_property
    def variable_parts(self) -> tuple[VariablePartDescription, ...]:
        """Parts of variable length, in the order of the frame."""
        by_name = {member.model.name: member for member in self.members}
        parts = []
        for part in self.model.layout.parts:
            field = by_name[part.name]
            inner: list[VariablePartDescription] = []
            if field.struct is not None:
                for model in part.inner:
                    member = field.struct.member_for[id(model.node)]
                    counter = by_name[model.counter]
                    inner.append(VariablePartDescription(model, member, counter))
            parts.append(
                VariablePartDescription(
                    part, field, by_name[part.counter], tuple(inner)
                )
            )
        return tuple(parts)

    @property
    def has_inner_gaps(self) -> bool:
        """Whether a frame can differ from the beginning of the longest frame."""
        return self.model.layout.has_inner_gaps

    @property
    def fixed_length(self) -> int:
        """Number of bytes that every frame has outside its parts of variable length."""
        return self.model.layout.fixed_length

    @property
    def counted_parts(self) -> tuple[VariablePartDescription, ...]:
        """Variable-length parts of the message, then the variable-length arrays in the
        elements of these parts.
        """
        inner = (inner for part in self.variable_parts for inner in part.inner)
        return (*self.variable_parts, *inner)

    @property
    def spread_parts(self) -> tuple[VariablePartDescription, ...]:
        """Parts after which a frame differs from the longest one: all but the last, and
        all with arrays in elements.
        """
        return tuple(
            part
            for part in self.variable_parts
            if part is not self.last_part or part.inner
        )

    @property
    def length_tests(self) -> tuple[LengthTest, ...]:
        """Tests of the length of a frame of variable length, with all parts in front of
        the last one in full.
        """
        assert self.last_part is not None
        last = self.last_part.model
        # Before these tests, a decoder of frames with gaps has put all that is in front
        # of the last part before it.
        return length_tests(
            last.possible_ends, last.begin if self.has_inner_gaps else 0
        )

    @cached_property
    def contained(self) -> tuple[tuple[MessageDescription, int], ...]:
        """Messages that a composite message contains, each with the bit at which it
        starts, in the order of the ICD.
        """
        if not self.model.contains:
            return ()
        messages = {
            message.model.name: message
            for message in self._description.node(self.node).all_messages
        }
        return tuple(
            (messages[part.message], part.at)
            for part in self.model.contains
            # In an ICD with errors, a message can contain one that no node declares.
            if part.message in messages
        )

    @cached_property
    def ids(self) -> tuple[MessageId, ...]:
        """Id of the message, or set id and get id of a configuration."""
        about = {
            "id": f"Id of the {self.model.kind}.",
            "set_id": "Id of the telecommand that sets it.",
            "get_id": "Id of the telemetry that gets it.",
        }
        ids = []
        for name, comment in about.items():
            value = getattr(self.model, name)
            if value is not None:
                ids.append(MessageId(name, value, comment))
        return tuple(ids)

    @property
    def directions(self) -> tuple[str, ...]:
        """Directions in which it is sent: ``telecommand``, ``telemetry``, or both for a
        configuration.
        """
        ids = {
            "telecommand": self.model.telecommand_id,
            "telemetry": self.model.telemetry_id,
        }
        return tuple(direction for direction, id in ids.items() if id is not None)

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
        """Whether the type of a field can store raw values or counts that the message
        cannot have.
        """
        return super().is_narrow or any(
            part.needs_count_check for part in self.counted_parts
        )

    @cached_property
    def comment(self) -> Comment:
        node, telemetry_id = self._description.node(self.node), self.model.telemetry_id
        bit = None if telemetry_id is None else node.log_bits.get(telemetry_id)
        return message_comment(
            self.model, bit, sharing_sentence(node.messages_by_id, self.model)
        )


class DirectionMessages(NamedTuple):
    """Messages of a node in one direction, each with the name of its id there: ``id``,
    ``set_id`` or ``get_id``.
    """

    kind: str  # "telecommand" | "telemetry"
    messages: tuple[tuple[MessageDescription, str], ...]


class MessageOfId(NamedTuple):
    """Message under an id, the name of that id, and the bytes by which a frame of its
    length is recognised.
    """

    message: MessageDescription
    id_name: str
    constant_bytes: tuple[frame_bits.ConstantByte, ...]

    @property
    def length_tests(self) -> tuple[LengthTest, ...]:
        """Tests that the lengths of its frames pass."""
        return length_tests_of_frame(self.message.model.layout.lengths)

    def can_lack(self, constant: frame_bits.ConstantByte) -> bool:
        """Return whether a frame can end in front of a byte, which then counts as 0."""
        return constant.byte >= self.message.model.layout.shortest


class MessagesOfId(NamedTuple):
    """Messages of one id, in the order in which a frame is compared with them."""

    id: int
    messages: tuple[MessageOfId, ...]
    length: int | None  # of all of them; None if lengths differ

    @property
    def first(self) -> MessageOfId:
        """First of them; code takes the id from its constant."""
        return self.messages[0]

    @property
    def is_shared(self) -> bool:
        """Whether several messages have the id, so that a decoder has to look at the
        frame.
        """
        return len(self.messages) > 1

    @property
    def fallback(self) -> MessageOfId | None:
        """Message of a frame that matches no message of `tested`: only its length can
        be wrong.

        None without such a message.
        """
        # Messages with more constants are tried first. If all have the same length, the
        # last one needs no test of it.
        last = self.messages[-1]
        if not self.is_shared:
            return last
        needs_no_test = self.length is not None and not last.constant_bytes
        return last if needs_no_test else None

    @property
    def tested(self) -> tuple[MessageOfId, ...]:
        """Messages that a decoder has to test a frame for."""
        return self.messages if self.fallback is None else self.messages[:-1]


class NodeDescription:
    """Node of the set."""

    def __init__(self, description: Description, node: Node) -> None:
        self._description, self.model, self.name = description, node, node.name

    def identifier(self, scope: str, name: str, role: str = "") -> Identifier:
        """Return a name that generated code declares for the node."""
        return Identifier(
            scope, name, f"node `{self.name}`", self.model.source, role, self.model
        )

    @cached_property
    def messages(self) -> tuple[MessageDescription, ...]:
        """Messages that the node declares."""
        return tuple(map(self._description.message, self.model.messages))

    @cached_property
    def enums(self) -> tuple[EnumDescription, ...]:
        """Enumerations that the node declares.

        In an ICD with errors, fields refer to the last one of a name.
        """
        enums = {enum.name: enum for enum in self.model.enums}.values()
        return tuple(map(self._description.enum, enums))

    @cached_property
    def structs(self) -> tuple[StructDescription, ...]:
        """Structs that the node declares, each after the structs of its members."""
        return tuple(map(self._description.struct, self.model.structs))

    @property
    def composites(self) -> tuple[Composite[Any], ...]:
        """Structs and messages that the node declares, each after the structs of its
        members.
        """
        return (*self.structs, *self.messages)

    @property
    def declared(self) -> tuple[Composite[Any] | EnumDescription, ...]:
        """All messages, enumerations and structs that the node declares."""
        return (*self.messages, *self.enums, *self.structs)

    @property
    def included(self) -> tuple[str, ...]:
        """Names of included nodes."""
        included = self._description.icd.included(self.model)
        return tuple(node.name for node in included)

    @property
    def usable(self) -> Iterator[Composite[Any] | EnumDescription]:
        """All messages, enumerations and structs of included nodes, then its own."""
        for name in dict.fromkeys((*self.included, self.name)):
            yield from self._description.node(name).declared

    @cached_property
    def all_messages(self) -> tuple[MessageDescription, ...]:
        """Messages of included nodes, then messages that the node declares."""
        return tuple(
            map(
                self._description.message, self._description.icd.messages_of(self.model)
            )
        )

    @property
    def telecommands(self) -> tuple[MessageDescription, ...]:
        """Messages of `all_messages` that can be sent to the node."""
        return tuple(
            message
            for message in self.all_messages
            if message.model.telecommand_id is not None
        )

    @property
    def telemetry(self) -> tuple[MessageDescription, ...]:
        """Messages of `all_messages` that can be requested from the node."""
        return tuple(
            message
            for message in self.all_messages
            if message.model.telemetry_id is not None
        )

    @property
    def directions(self) -> tuple[DirectionMessages, ...]:
        """Telecommands, then telemetry; without a direction that has no messages."""
        telecommands = (
            (message, message.telecommand_id_name) for message in self.telecommands
        )
        telemetry = ((message, message.telemetry_id_name) for message in self.telemetry)
        directions = (
            DirectionMessages("telecommand", tuple(telecommands)),
            DirectionMessages("telemetry", tuple(telemetry)),
        )
        return tuple(direction for direction in directions if direction.messages)

    def ids(self, direction: str) -> tuple[MessagesOfId, ...]:
        """Return the messages of a direction by their ids, in the order of the ICD."""
        return self._ids[direction]

    def shares_ids(self, direction: str) -> bool:
        """Return whether messages of the direction share an id."""
        return bool(self._sharing[direction])

    def shares_id(self, direction: str, message: MessageDescription) -> bool:
        """Return whether a message shares its id with another one of the direction."""
        return message in self._sharing[direction]

    @cached_property
    def _sharing(self) -> dict[str, frozenset[MessageDescription]]:
        """Messages of each direction that share their id with another one."""
        return {
            direction: frozenset(_messages_with_shared_id(ids))
            for direction, ids in self._ids.items()
        }

    @cached_property
    def messages_by_id(self) -> Ids:
        """Messages of the node by their ids, per direction."""
        return ids_of(self._description.icd, self.model)

    @cached_property
    def _ids(self) -> dict[str, tuple[MessagesOfId, ...]]:
        by_id = self.messages_by_id
        telecommands, telemetry = by_id.telecommand.items(), by_id.telemetry.items()
        return {
            "telecommand": tuple(
                self._messages_of_id("set_id", id, variants)
                for id, variants in telecommands
            ),
            "telemetry": tuple(
                self._messages_of_id("get_id", id, variants)
                for id, variants in telemetry
            ),
        }

    def _messages_of_id(
        self, other_name: str, id: int, variants: tuple[Variant, ...]
    ) -> MessagesOfId:
        """Return the messages of an id; ``other_name`` is its name in a configuration."""
        candidates = []
        for variant in variants:
            name = "id" if variant.message.id is not None else other_name
            message = self._description.message(variant.message)
            candidates.append(
                MessageOfId(message, name, frame_bits.constant_bytes(variant))
            )
        return MessagesOfId(id, tuple(candidates), common_length(variants))

    @cached_property
    def is_linked(self) -> bool:
        """Whether the ICD describes the link of the node."""
        return bool(self._description.icd.protocol_of(self.model))

    @cached_property
    def procedures(self) -> dict[str, dict[str, Any]]:
        """Procedures of the node in the ICD, by name."""
        return self._description.icd.procedures_of(self.model)

    @cached_property
    def checksums(self) -> tuple[str, ...]:
        """Names of the checksums of the node."""
        protocol = self._description.icd.protocol_of(self.model)
        # Names are checked before the link is known to have the right form.
        declared = at_path(protocol, ("link", "checksums"))
        return tuple(declared) if isinstance(declared, Mapping) else ()

    @cached_property
    def has_client(self) -> bool:
        """Whether its link has messages with an id of one byte: only these have a
        client, procedures and logs.
        """
        return self.is_linked and not framed_link(
            self._description.icd.protocol_of(self.model)
        )

    @property
    def id_bits(self) -> int:
        """Bits of ids in the set: see `Description.id_bits`."""
        return self._description.id_bits

    @cached_property
    def log_bits(self) -> dict[int, int]:
        """Telemetry id -> the bit of the log mask that selects it."""
        return {row.id: row.bit for row in self.model.loggable}


def _messages_with_shared_id(
    ids: Iterable[MessagesOfId],
) -> Iterator[MessageDescription]:
    for messages_of_id in ids:
        if messages_of_id.is_shared:
            yield from (row.message for row in messages_of_id.messages)


class Description:
    """Set of ICDs. Each of ``nodes`` comes after the nodes that it includes."""

    def __init__(self, icd: Icd) -> None:
        self.icd = icd
        self.declared = Declarations(icd)
        self._messages: dict[tuple[str, str], MessageDescription] = {}
        # In an ICD with errors, includes refer to the first node of a name.
        self._nodes = {
            node.name: NodeDescription(self, node) for node in reversed(icd.nodes)
        }
        self.nodes = tuple(dict.fromkeys(map(self.node, icd.nodes)))

    @cached_property
    def id_bits(self) -> int:
        """Bits of the integer for all ids of the set: 8, 16 or 32."""
        widths = [8]
        for node in self.icd.nodes:
            widths.append(node.id_bits)
            for message in node.messages:
                widths += (id.bit_length() for id in message.ids)
        return storage_bits(max(widths))

    def node(self, node: str | Node) -> NodeDescription:
        """Return the description of a node, by its name or by the node itself.

        Raises `KeyError`.
        """
        return self._nodes[node if isinstance(node, str) else node.name]

    def users_of(self, node: Node) -> tuple[NodeDescription, ...]:
        """Return the nodes that can use the declarations of a node: the node itself and
        all nodes that include it.
        """
        return self._users.get(node.name, ())

    @cached_property
    def _users(self) -> dict[str, tuple[NodeDescription, ...]]:
        users: dict[str, tuple[NodeDescription, ...]] = {}
        for user in self.nodes:
            for name in dict.fromkeys(
                (*(node.name for node in self.icd.included(user.model)), user.name)
            ):
                users[name] = (*users.get(name, ()), user)
        return users

    def message(self, message: Message) -> MessageDescription:
        """Return the description of a message, whichever node uses it."""
        key = message.node, message.name
        description = self._messages.get(key)
        # In an ICD with errors, two messages of a node can have the same name.
        if description is None or description.model is not message:
            description = self._messages[key] = MessageDescription(
                self, message, self.icd.node(message.node)
            )
        return description

    def struct(self, struct: Struct) -> StructDescription:
        """Return the description of a struct, whichever node uses it."""
        return self.declared.struct_of(struct.layout)

    def enum(self, enum: Enum) -> EnumDescription:
        """Return the description of an enumeration, whichever node uses it."""
        return self.declared.enum(enum)


_recent: list[Description] = []
"""Descriptions of the last two sets, the older first: one run generates several
languages from the same set.
"""


def describe(icd: Icd) -> Description:
    """Return the description of a set of ICDs.

    Calls with the same set share the result.
    """
    for description in _recent:
        if description.icd is icd:
            return description
    _recent[:] = [*_recent[-1:], Description(icd)]
    return _recent[-1]
