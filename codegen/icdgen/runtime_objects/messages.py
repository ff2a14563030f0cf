"""Message classes for the client and the procedures of the runtime, made from the
model.

`ModelMessages` maps ids to classes with the attributes of generated classes, and makes
each on its first access. `ModelMessage` decodes and encodes frames with the reference
codec, so no generated code is needed. It has no physical values. ``links`` uses the
classes for the `Link` of a node.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from icdgen_runtime._base import FieldInfo, Message
from icdgen_runtime._errors import LengthError, RangeError, UnknownIdError
from icdgen_runtime._hints import Buffer
from icdgen_runtime._lazy import Messages

from icdgen import codec
from icdgen.describe import Description, FieldDescription, MessageDescription
from icdgen.icd import model
from icdgen.icd.places import NodePlace


class ModelMessage(Message):
    """A message that the reference codec encodes and decodes.

    Its attributes are raw values only.
    """

    description: ClassVar[MessageDescription]

    def __init__(self) -> None:
        for field in self.description.fields:
            setattr(self, field.name, _value(field.model, field.model.initial_value))

    @classmethod
    def from_bytes(cls, data: Buffer) -> ModelMessage:
        """Return the message of a frame. Raises `LengthError`."""
        description, frame = cls.description, bytes(data)
        try:
            raw = codec.decode(description.node, description.model, frame)
        except codec.LengthError:
            raise LengthError(cls.NAME, cls.LENGTH, len(frame)) from None
        message = cls()
        for field in description.fields:
            # An absent optional field has no raw value.
            is_present = field.model.name in raw
            setattr(
                message,
                field.name,
                _value(field.model, raw[field.model.name]) if is_present else None,
            )
        return message

    def to_bytes(self) -> bytes:
        """Return the frame; reserved bits are 0. Raises `RangeError`."""
        description = self.description
        values = ((field, getattr(self, field.name)) for field in description.fields)
        raw = {
            field.model.name: _raw(field, value)
            for field, value in values
            if value is not None
        }
        return codec.encode(description.node, description.model, raw)


class ModelMessages(Messages):
    """Message classes of a node by id; each is made on the first access."""

    def __init__(
        self,
        node: str,
        kind: str,
        messages: Mapping[int, model.Message],
        description: Description,
    ) -> None:
        super().__init__(
            {}, node, kind, {id: message.name for id, message in messages.items()}
        )
        self._messages, self._description = messages, description

    def _load(self, id: int) -> type[Message]:
        """Return the class of an id. Raises `UnknownIdError`."""
        if id not in self:
            raise UnknownIdError(self._node, self._kind, id)
        message_class = _class(self._description.message(self._messages[id]))
        self._loaded[id] = message_class
        return message_class


def _class(description: MessageDescription) -> type[ModelMessage]:
    """Return the class of a message, with the class attributes of generated code."""
    message = description.model
    members = {
        "description": description,
        "NODE": message.node,
        "NAME": message.name,
        "KIND": message.kind,
        "LENGTH": message.length,
        "IDS": message.ids,
        "ACKNOWLEDGED": message.acknowledge,
        "FIELDS": tuple(map(_field_info, description.fields)),
        "BYTE_ORDER": description.node.byte_order,
        "BIT_ORDER": description.node.bit_order,
    }
    # A subclass per message, because the runtime reads these facts from the class.
    return type("ModelMessage", (ModelMessage,), members)


def _field_info(field: FieldDescription) -> FieldInfo:
    """Return the facts of a field that the runtime uses."""
    return FieldInfo(
        field.name,
        field.model.name,
        field.model.at,
        field.model.bits,
        field.model.type,
        byte_order=field.model.byte_order,
        bit_order=field.model.bit_order,
    )


def _value(field: NodePlace, raw: int | bytes) -> object:
    """Return the value of an attribute for a raw value: of a float the number, of a
    flag a truth value.
    """
    if isinstance(raw, bytes):
        return raw
    if field.type == "float":
        return codec.float_value(field, raw)
    return bool(raw) if field.type == "bool" else raw


def _raw(field: FieldDescription, value: object) -> int | bytes:
    """Return the raw value of the value of an attribute. Raises `RangeError`."""
    place = field.model
    try:
        raw = codec.float_bits(place, value) if isinstance(value, float) else value
        assert isinstance(raw, int | bytes)
        codec.check_raw(place, raw)
    except codec.CodecError as error:
        raise RangeError(field.name, str(error), value) from None
    return raw
