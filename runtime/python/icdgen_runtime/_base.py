"""Base classes of structs and messages.

Generated classes declare their fields with the functions of `_fields`; the metaclass
`MessageType` turns them into a dataclass with slots. `_compiled` makes ``from_bytes``
and ``to_bytes`` of a class at their first use.
"""

from __future__ import annotations

# The module, not its names: these are imported when an annotation is evaluated.
from . import _types
from ._fields import (
    Form,
    curve,
    curve_only,
    field,
    part,
    scaled,
    text,
    whole,
)
from ._types import FieldInfo, MessageFacts, StructFacts, Tail

__all__ = [
    "FieldInfo",
    "Message",
    "MessageType",
    "Struct",
    "Tail",
    "curve",
    "curve_only",
    "derived",
    "field",
    "on_curve",
    "part",
    "scaled",
    "text",
    "view",
    "whole",
]

# Type checkers treat this name as true. Importing `typing` would slow down the start.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from inspect import Signature
    from typing import Any, Callable, Generic

    from typing_extensions import ParamSpec, Self, TypeVar, dataclass_transform

    P = ParamSpec("P")
    N_contra = TypeVar("N_contra", contravariant=True, default=Any)

    class NodeMessageBase(Generic[N_contra]):
        """Base class that relates a message to its node, for type checkers only.

        It has no members at run time.
        """

        @classmethod
        def _instance(cls) -> Self: ...

        @staticmethod
        def _belongs_to(node: N_contra, /) -> None: ...

else:

    def dataclass_transform(**_):
        return lambda cls: cls

    N_contra = None

    class NodeMessageBase:
        """Nothing, when the program runs."""

        __slots__ = ()

        def __class_getitem__(cls, node):
            return cls


@dataclass_transform(
    kw_only_default=True,
    field_specifiers=(field, part, scaled, curve, curve_only, whole, text),
)
class MessageType(type):
    """Metaclass of messages and structs: a dataclass with slots, whose fields `field`
    declares.

    `Message.from_bytes` and `Message.to_bytes` are compiled from the fields at their
    first use. The attributes that `dataclasses` needs are created at their first use,
    too.
    """

    def __new__(
        mcls, name: str, bases: tuple[type, ...], namespace: dict[str, _types.Any]
    ) -> _types.Any:
        """Create the class.

        Slots hold the values of the fields and replace the declarations.
        """
        if "LENGTH" in namespace:  # the base classes declare no fields
            infos: list[FieldInfo] = []
            notes = namespace.get("__annotations__", {})
            for key, declared in list(namespace.items()):
                if isinstance(declared, FieldInfo):
                    declared.attribute = key
                    infos.append(namespace.pop(key))
                elif isinstance(declared, Form):
                    namespace[key] = declared.property_of(infos[-1], key)
                    del notes[key]  # it is a property, not a dataclass field
            names = tuple(info.attribute for info in infos)
            namespace["FIELDS"] = tuple(infos)
            namespace["__slots__"] = namespace["__match_args__"] = names
        return super().__new__(mcls, name, bases, namespace)

    @property
    def __signature__(cls) -> Signature:
        """Keyword arguments of the constructor, for `inspect.signature`."""
        from ._dataclass import signature

        return signature(cls, Struct.__init__)


class _DataclassFields:
    """``__dataclass_fields__``, which the functions of `dataclasses` read."""

    def __get__(self, message: object, owner: _types.Any) -> dict[str, _types.Any]:
        from ._dataclass import dataclass_fields

        return dataclass_fields(owner)


class _DataclassParams:
    """``__dataclass_params__``, with the value that `dataclasses.dataclass` would set."""

    def __get__(self, message: object, owner: object) -> _types.Any:
        from ._dataclass import PARAMS

        return PARAMS


class Struct(StructFacts, metaclass=MessageType):
    """Base class of messages and of the structs in them.

    The attributes hold raw values, as transmitted. The constructor takes keyword
    arguments of raw or of physical values. Values are checked by `Message.to_bytes`,
    not when they are assigned.
    """

    __slots__ = ()
    __dataclass_params__ = _DataclassParams()

    if not TYPE_CHECKING:
        __dataclass_fields__ = _DataclassFields()

        def __init__(self, /, **values):
            """Take raw or physical values.

            The physical value has precedence. Raise `RangeError`.
            """
            given = frozenset(values) if self.CONDITIONAL else ()
            for info in self.FIELDS:
                fresh = info.default if info.struct is None else info.fresh
                setattr(self, info.attribute, values.pop(info.attribute, fresh))
                if info.physical in values:
                    setattr(self, info.physical, values.pop(info.physical))
            for name in values:
                raise TypeError(f"{type(self).__name__} has no field {name!r}")
            if self.CONDITIONAL:
                from ._conditions import settle

                settle(self, given)

    if TYPE_CHECKING:

        @classmethod  # pyright: ignore[reportArgumentType]
        def from_physical(
            cls: Callable[P, _types.S], *args: P.args, **values: P.kwargs
        ) -> _types.S:
            """Create an object from physical values, or raw values if a field has no
            other.

            Values of overlay fields and derived values are ignored. Raise `RangeError`,
            and `TypeError` for the raw value of a field that has a physical value or a
            text.
            """
            ...

    else:

        @classmethod
        def from_physical(cls, /, **values):
            """Create an object from physical values, or raw values if a field has no
            other.

            Values of overlay fields and derived values are ignored. Raise `RangeError`,
            and `TypeError` for the raw value of a field that has a physical value or a
            text.
            """
            for info in cls.FIELDS:
                if info.physical and info.leads_back and info.attribute in values:
                    raise TypeError(
                        f"from_physical takes {info.physical}, not {info.attribute}"
                    )
            for info in cls.VIEWS:  # computed from the fields
                values.pop(info.attribute, None)
                values.pop(info.physical, None)
            return cls(**values)

    def as_dict(self, physical: bool = False) -> dict[str, _types.Any]:
        """Return all values by attribute, overlay fields and derived values last.

        With ``physical``, fields that have a physical value or a text are given by
        that, other fields by their raw value. A struct becomes a dictionary.
        """
        infos = (*self.FIELDS, *self.VIEWS)
        if physical:
            names = [info.physical or info.attribute for info in infos]
        else:
            names = [info.attribute for info in infos]
        values = {name: getattr(self, name) for name in names}
        for info in self.FIELDS:
            if info.struct is not None:
                value = values[info.attribute]
                values[info.attribute] = (
                    tuple(element.as_dict(physical) for element in value)
                    if info.elements
                    else value.as_dict(physical)
                )
        return values

    def _own(self) -> dict[str, _types.Any]:
        """Return the values of the fields by attribute, without overlay fields and
        derived values.
        """
        return {info.attribute: getattr(self, info.attribute) for info in self.FIELDS}

    @classmethod
    def from_dict(
        cls: type[_types.S], values: _types.Mapping[str, _types.Any]
    ) -> _types.S:
        """Create an object from raw or physical values: the reverse of `as_dict`.

        Missing fields have their default. Bytes may be given as hexadecimal digits.
        Raise `RangeError` for a value out of range, and `IcdError` for a name that is
        not a field.
        """
        from ._dicts import filled

        struct: _types.Any = filled(cls, values)
        checked: _types.S = struct._checked()
        return checked

    def _checked(self) -> _types.Any:
        """Return an equal object with values of the types that decoding returns.

        Raise `RangeError`.
        """
        return self

    def to_json(self, physical: bool = False) -> str:
        """Return `as_dict` as JSON. Bytes become hexadecimal digits."""
        from ._dicts import to_json

        return to_json(self.as_dict(physical))

    @classmethod
    def from_json(cls: type[_types.S], data: str) -> _types.S:
        """Create an object from JSON: the reverse of `to_json`.

        Raise the exceptions of `from_dict`, and `IcdError` if ``data`` is not valid
        JSON.
        """
        from ._dicts import values_of_json

        struct: _types.Any = cls
        result: _types.S = struct.from_dict(values_of_json(data))
        return result

    def __replace__(self: _types.S, **changes: _types.Any) -> _types.S:
        message: _types.Any = self
        result: _types.S = type(message)(**{**message._own(), **changes})
        return result

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return self._own() == other._own()

    def __repr__(self) -> str:
        values = (f"{name}={value!r}" for name, value in self._own().items())
        return f"{type(self).__name__}({', '.join(values)})"


class Message(NodeMessageBase[N_contra], MessageFacts, Struct):
    """A message: a frame of ``LENGTH`` bytes with an id."""

    __slots__ = ()

    @classmethod
    def from_bytes(cls: type[_types.M], data: _types.Buffer) -> _types.M:
        """Decode a frame. Raise `LengthError` if the message cannot have its length."""
        from ._compiled import compiled

        message: _types.M = compiled(cls, "from_bytes")(cls, data)
        return message

    @classmethod
    def from_part(cls: type[_types.M], message: Message, index: int = 0) -> _types.M:
        """Return the part of a composite message that has this class.

        ``index`` selects one of several. Raise `IcdError` if ``message`` has no such
        part.
        """
        from ._parts import part

        return part(cls, message, index)

    def _checked(self) -> _types.Any:
        return type(self).from_bytes(self.to_bytes())

    def iter_parts(self) -> _types.Iterator[Message]:
        """Iterate over the parts of a composite message. Each has its own class."""
        from ._parts import parts

        return parts(self)

    def to_bytes(self) -> bytes:
        """Encode the message.

        Reserved bits are 0. Raise `RangeError` if a value is out of range.
        """
        from ._compiled import compiled

        frame: bytes = compiled(type(self), "to_bytes")(self)
        return frame

    @classmethod
    def decode_many(
        cls, frames: _types.Frames, physical: bool = False
    ) -> dict[str, _types.Any]:
        """Decode consecutive frames into one numpy array per field.

        The keys are equal to the keys of `as_dict`. Byte-aligned fields are views of
        the frames, or of a copy if the frames are mutable. Raise `LengthError` if the
        data is not a multiple of the length of a frame.

        Frames of different lengths are given as a list. A variable-length field at the
        end of the frame becomes an array of arrays, or of bytes. An optional field
        becomes a masked array. Needs numpy.
        """
        from . import _columns

        return _columns.decode_many(cls, cls.from_bytes, frames, physical)

    @classmethod
    def decode_table(cls, frames: _types.Frames, physical: bool = True) -> _types.Any:
        """Decode consecutive frames into a `pyarrow.Table`.

        The metadata of its fields are ``unit``, ``name`` (the manual's name) and
        ``values`` (the names of an enumeration). Raise `LengthError` if the data is not
        a multiple of the length of a frame. Needs numpy and pyarrow.
        """
        from . import _columns

        return _columns.decode_table(cls, cls.from_bytes, frames, physical)


def view(message: Message, attribute: str, kind: type[_types.T]) -> _types.T:
    """Return the value of an overlay field, from the encoded message.

    Raise `RangeError`.
    """
    from ._codec import value_of_bits

    (info,) = (overlay for overlay in message.VIEWS if overlay.attribute == attribute)
    value: _types.T = value_of_bits(info, type(message), message.to_bytes(), kind)
    return value


def derived(message: Message, attribute: str) -> float:
    """Return a derived value, computed from the fields. Raise `RangeError`."""
    from ._derived import derived as result_of

    views = (entry for entry in message.VIEWS if entry.attribute == attribute)
    (derivation,) = (entry.derived for entry in views if entry.derived)
    return result_of(derivation, [getattr(message, name) for name in derivation[0]])


def on_curve(message: Message, attribute: str) -> float:
    """Return the physical value of an overlay field with a calibration.

    Raise `RangeError`.
    """
    from ._curves import on_curve as value_on

    (curve,) = (
        overlay.curve for overlay in message.VIEWS if overlay.attribute == attribute
    )
    return value_on(curve, getattr(message, attribute))
