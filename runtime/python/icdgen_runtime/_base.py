"""Base classes of structs and messages."""

from __future__ import annotations

# The module: its names in annotations are loaded when they are evaluated.
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

TYPE_CHECKING = False
if TYPE_CHECKING:
    from inspect import Signature
    from typing import Any, Callable, Generic

    from typing_extensions import ParamSpec, Self, TypeVar, dataclass_transform

    P = ParamSpec("P")
    N_contra = TypeVar("N_contra", contravariant=True, default=Any)

    class Spoken(Generic[N_contra]):
        """What type checkers are told of which node speaks a message."""

        @classmethod
        def _made(cls) -> Self: ...

        @staticmethod
        def _spoken_by(node: N_contra, /) -> None: ...

else:

    def dataclass_transform(**_):
        return lambda cls: cls

    N_contra = None

    class Spoken:
        """Nothing, when the program runs."""

        __slots__ = ()

        def __class_getitem__(cls, node):
            return cls


@dataclass_transform(
    kw_only_default=True,
    field_specifiers=(field, part, scaled, curve, curve_only, whole, text),
)
class MessageType(type):
    """Makes the class of a message or a struct: a dataclass with slots, of fields that `field` declares.

    `Message.from_bytes` and `Message.to_bytes` are compiled from these when they are
    first used, and what `dataclasses` wants is made when it is asked for.
    """

    def __new__(
        mcls, name: str, bases: tuple[type, ...], namespace: dict[str, _types.Any]
    ) -> _types.Any:
        """The class. Values of fields stand in slots, so their declarations go."""
        if "LENGTH" in namespace:
            infos: list[FieldInfo] = []
            notes = namespace.get("__annotations__", {})
            for key, declared in list(namespace.items()):
                if isinstance(declared, FieldInfo):
                    declared.attribute = key
                    infos.append(namespace.pop(key))
                elif isinstance(declared, Form):
                    namespace[key] = declared.property_of(infos[-1], key)
                    del notes[key]
            names = tuple(info.attribute for info in infos)
            namespace["FIELDS"] = tuple(infos)
            namespace["__slots__"] = namespace["__match_args__"] = names
        return super().__new__(mcls, name, bases, namespace)

    @property
    def __signature__(cls) -> Signature:
        """The keywords that it is made with, for `inspect.signature`."""
        from ._dataclass import signature

        return signature(cls, Struct.__init__)


class _DataclassFields:
    """``__dataclass_fields__``, which the functions of `dataclasses` look at."""

    def __get__(self, message: object, owner: _types.Any) -> dict[str, _types.Any]:
        from ._dataclass import dataclass_fields

        return dataclass_fields(owner)


class _DataclassParams:
    """``__dataclass_params__``, as `dataclasses.dataclass` leaves it."""

    def __get__(self, message: object, owner: object) -> _types.Any:
        from ._dataclass import PARAMS

        return PARAMS


class Struct(StructFacts, metaclass=MessageType):
    """Fields that stand together: a message, or what stands in messages once or several times.

    Its attributes hold raw values, just as they are on the wire. It is made with
    keywords, of raw or of physical values. Values are not checked when they are
    assigned, but by `Message.to_bytes`.
    """

    __slots__ = ()
    __dataclass_params__ = _DataclassParams()

    if not TYPE_CHECKING:
        __dataclass_fields__ = _DataclassFields()

        def __init__(self, /, **values):
            """Of raw values, or physical ones, which go before. Raises `RangeError`."""
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
            """From physical values, raw ones where there is no scale or text; those of views are not looked at.

            Raises `RangeError`, and `TypeError` for a raw value that has a physical one.
            """
            ...

    else:

        @classmethod
        def from_physical(cls, /, **values):
            """From physical values, raw ones where there is no scale or text; those of views are not looked at.

            Raises `RangeError`, and `TypeError` for a raw value that has a physical one.
            """
            for info in cls.FIELDS:
                if info.physical and info.leads_back and info.attribute in values:
                    raise TypeError(
                        f"from_physical takes {info.physical}, not {info.attribute}"
                    )
            for info in cls.VIEWS:  # they follow from the fields
                values.pop(info.attribute, None)
                values.pop(info.physical, None)
            return cls(**values)

    def as_dict(self, physical: bool = False) -> dict[str, _types.Any]:
        """All values by attribute: raw, or physical where there is such a value; then those of views.

        What is a struct is a dictionary itself.
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
                    tuple(one.as_dict(physical) for one in value)
                    if info.elements
                    else value.as_dict(physical)
                )
        return values

    def _own(self) -> dict[str, _types.Any]:
        """What it is made of: views follow from that."""
        return {info.attribute: getattr(self, info.attribute) for info in self.FIELDS}

    @classmethod
    def from_dict(
        cls: type[_types.S], values: _types.Mapping[str, _types.Any]
    ) -> _types.S:
        """The reverse of `as_dict`, of raw or physical values; what is not there is as in a new message.

        Bytes may be hexadecimal digits. Raises `RangeError` for a value that does not
        fit, and `IcdError` for a name that is none.
        """
        from ._dicts import filled

        made: _types.Any = filled(cls, values)
        checked: _types.S = made._checked()
        return checked

    def _checked(self) -> _types.Any:
        """Return an equal object that holds values of the types that decoding gives. Raises `RangeError`."""
        return self

    def to_json(self, physical: bool = False) -> str:
        """`as_dict` as JSON; bytes are hexadecimal digits."""
        from ._dicts import to_json

        return to_json(self.as_dict(physical))

    @classmethod
    def from_json(cls: type[_types.S], data: str) -> _types.S:
        """The reverse of `to_json`. Raises like `from_dict`, and `IcdError` for what is no JSON."""
        from ._dicts import values_of_json

        struct: _types.Any = cls
        made: _types.S = struct.from_dict(values_of_json(data))
        return made

    def __replace__(self: _types.S, **changes: _types.Any) -> _types.S:
        message: _types.Any = self
        made: _types.S = type(message)(**{**message._own(), **changes})
        return made

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return self._own() == other._own()

    def __repr__(self) -> str:
        values = (f"{name}={value!r}" for name, value in self._own().items())
        return f"{type(self).__name__}({', '.join(values)})"


class Message(Spoken[N_contra], MessageFacts, Struct):
    """A message that travels: a frame of ``LENGTH`` bytes, under an id."""

    __slots__ = ()

    @classmethod
    def from_bytes(cls: type[_types.M], data: _types.Buffer) -> _types.M:
        """The message in a frame of a length that it has. Raises `LengthError`."""
        from ._compiled import compiled

        made: _types.M = compiled(cls, "from_bytes")(cls, data)
        return made

    @classmethod
    def from_part(cls: type[_types.M], message: Message, index: int = 0) -> _types.M:
        """The message as another one repeats it, of several times the one with this index.

        Raises `IcdError` if it does not.
        """
        from ._parts import part

        return part(cls, message, index)

    def _checked(self) -> _types.Any:
        return type(self).from_bytes(self.to_bytes())

    def iter_parts(self) -> _types.Iterator[Message]:
        """The messages that it repeats, one after the other, each of its own class."""
        from ._parts import parts

        return parts(self)

    def to_bytes(self) -> bytes:
        """The frame, reserved bits 0. Raises `RangeError` if a value does not fit."""
        from ._compiled import compiled

        frame: bytes = compiled(type(self), "to_bytes")(self)
        return frame

    @classmethod
    def decode_many(
        cls, frames: _types.Frames, physical: bool = False
    ) -> dict[str, _types.Any]:
        """Frames that follow each other, as one numpy array a field.

        The names are those of `as_dict`. What stands on whole bytes is a view of the
        frames, or of a copy of them if they can change. Raises `LengthError` if they
        are not whole frames. Frames that differ in length, or end early, are given one by one, as a
        list; what ends them is an array of arrays, or of bytes. What is not always there is
        a masked array. Needs numpy.
        """
        from . import _columns

        return _columns.decode_many(cls, cls.from_bytes, frames, physical)

    @classmethod
    def decode_table(cls, frames: _types.Frames, physical: bool = True) -> _types.Any:
        """Frames that follow each other, as a `pyarrow.Table`.

        Units, the manual's names and those of enumerations are metadata of its fields:
        ``unit``, ``name`` and ``values``. Raises
        `LengthError` if they are not whole frames. Needs numpy and pyarrow.
        """
        from . import _columns

        return _columns.decode_table(cls, cls.from_bytes, frames, physical)


def view(message: Message, attribute: str, kind: type[_types.T]) -> _types.T:
    """The value of a view, of the frame that the message makes. Raises `RangeError`."""
    from ._codec import value_of_bits

    (info,) = (one for one in message.VIEWS if one.attribute == attribute)
    value: _types.T = value_of_bits(info, type(message), message.to_bytes(), kind)
    return value


def derived(message: Message, attribute: str) -> float:
    """What is derived from fields. Raises `RangeError`."""
    from ._derived import derived as result_of

    views = (one for one in message.VIEWS if one.attribute == attribute)
    (derivation,) = (one.derived for one in views if one.derived)
    return result_of(derivation, [getattr(message, name) for name in derivation[0]])


def on_curve(message: Message, attribute: str) -> float:
    """The physical value of a view that has a curve. Raises `RangeError`."""
    from ._curves import on_curve as value_on

    (curve,) = (one.curve for one in message.VIEWS if one.attribute == attribute)
    return value_on(curve, getattr(message, attribute))
