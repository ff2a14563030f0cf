"""Messages of the model as the classes that the runtime's client and procedures ask for."""

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
    """A message whose frame the reference codec reads and writes. It has raw values, and no physical ones."""

    description: ClassVar[MessageDescription]

    def __init__(self) -> None:
        for one in self.description.fields:
            setattr(self, one.name, _value(one.model, one.model.initial_value))

    @classmethod
    def from_bytes(cls, data: Buffer) -> ModelMessage:
        """The message in a frame. Raises `LengthError`."""
        description, frame = cls.description, bytes(data)
        try:
            raw, made = codec.decode(description.node, description.model, frame), cls()
        except codec.LengthError:
            raise LengthError(cls.NAME, cls.LENGTH, len(frame)) from None
        for one in description.fields:
            known = one.model.name in raw  # a field that is not always there may be absent
            setattr(made, one.name, _value(one.model, raw[one.model.name]) if known else None)
        return made

    def to_bytes(self) -> bytes:
        """The frame, with reserved bits 0. Raises `RangeError`."""
        description = self.description
        held = ((one, getattr(self, one.name)) for one in description.fields)
        raw = {one.model.name: _raw(one, value) for one, value in held if value is not None}
        return codec.encode(description.node, description.model, raw)


class ModelMessages(Messages):
    """Messages of the model by id; a class is made when it is asked for."""

    def __init__(self, node: str, kind: str, known: Mapping[int, model.Message], description: Description) -> None:
        super().__init__({}, node, kind, {id: message.name for id, message in known.items()})
        self._known, self._description = known, description

    def _load(self, id: int) -> type[Message]:
        if id not in self:
            raise UnknownIdError(self._node, self._kind, id)
        self._loaded[id] = found = _class(self._description.message(self._known[id]))
        return found


def _class(description: MessageDescription) -> type[ModelMessage]:
    message = description.model
    members = {
        "description": description,
        "NODE": message.node,
        "NAME": message.name,
        "KIND": message.kind,
        "LENGTH": message.length,
        "IDS": message.ids,
        "ACKNOWLEDGED": message.acknowledge,
        "FIELDS": tuple(
            FieldInfo(
                one.name,
                one.model.name,
                one.model.at,
                one.model.bits,
                one.model.type,
                byte_order=one.model.byte_order,
                bit_order=one.model.bit_order,
            )
            for one in description.fields
        ),
        "BYTE_ORDER": description.node.byte_order,
        "BIT_ORDER": description.node.bit_order,
    }
    return type("ModelMessage", (ModelMessage,), members)


def _value(field: NodePlace, raw: int | bytes) -> object:
    """What an attribute holds: a float's number, and not its bits."""
    if isinstance(raw, bytes):
        return raw
    if field.type == "float":
        return codec.float_value(field, raw)
    return bool(raw) if field.type == "bool" else raw


def _raw(one: FieldDescription, value: object) -> int | bytes:
    """The reverse of `_value`. Raises `RangeError`."""
    field = one.model
    try:
        raw = codec.float_bits(field, value) if isinstance(value, float) else value
        assert isinstance(raw, int | bytes)
        codec.check_raw(field, raw)
    except codec.CodecError as error:
        raise RangeError(one.name, str(error), value) from None
    return raw
