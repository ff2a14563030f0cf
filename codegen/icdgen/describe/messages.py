"""Messages: names in words, ids by what they are for, fields, comments."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

from icdgen import naming
from icdgen.describe.comments import Comment, message_comment
from icdgen.describe.fields import FieldDescription
from icdgen.icd.model import Message, Node

if TYPE_CHECKING:
    from icdgen.describe import Description


class Id(NamedTuple):
    """An id of a message; ``name`` is ``id``, ``set_id`` or ``get_id``."""

    name: str
    value: int
    comment: str


class MessageDescription:
    """A message (``model``) that ``node`` declares."""

    def __init__(self, description: Description, message: Message, node: Node) -> None:
        self._description, self.model, self.node = description, message, node
        self.words = naming.words(message.identifier or message.name, node.vocabulary)
        self.name = naming.snake(self.words)

    @cached_property
    def fields(self) -> tuple[FieldDescription, ...]:
        """In the order of the ICD."""
        enum = self._description.enum
        return tuple(FieldDescription(f, self, enum(f.enum) if f.enum else None) for f in self.model.fields)

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
        return any(field.is_narrow for field in self.fields)

    @property
    def has_floats(self) -> bool:
        return any(field.type == "float" for field in self.model.fields)

    @cached_property
    def comment(self) -> Comment:
        bits = self._description.node(self.node).log_bits
        telemetry_id = self.model.telemetry_id
        return message_comment(self.model, None if telemetry_id is None else bits.get(telemetry_id))
