"""What all messages have in common."""

from __future__ import annotations

from typing import (
    TYPE_CHECKING,
    Any,
    ClassVar,
    Literal,
    NamedTuple,
    Optional,
    TypeVar,
    Union,
)

from ._enumeration import OpenEnum, is_signed

Buffer = Union[bytes, bytearray, memoryview]
EnumClass = type[OpenEnum]
# Annotations of what users see can be evaluated with Python 3.9, which knows neither `int | None` nor `Self`.
_MaybeEnum = Optional[EnumClass]
_MaybeInt = Optional[int]
_MaybeFloat = Optional[float]
_M = TypeVar("_M", bound="Message")


class FieldInfo(NamedTuple):
    """What the ICD says of a field.

    Limits are those of the physical value, or of the raw one if there is no scale.
    """

    attribute: str
    """The attribute that holds the raw value."""
    name: str
    """The manual's name, verbatim."""
    at: int
    """Offset in bits from the start of the frame."""
    bits: int
    """Width in bits."""
    type: str
    """``uint``, ``int``, ``bool``, ``enum``, ``float``, ``bytes`` or ``text``."""
    unit: str = ""
    """Unit of the physical value, or of the raw one if there is no scale."""
    physical: str = ""
    """The property that holds the physical value, of ``text`` a `str`.

    Empty if the field has neither a scale nor a text.
    """
    scale: tuple[int, int, int] = (1, 0, 1)
    """``(p, c, q)``: the physical value is exactly ``(raw * p + c) / q``."""
    enum: _MaybeEnum = None
    """The enumeration of the values."""
    const: _MaybeInt = None
    """The only valid raw value."""
    special: tuple[tuple[int, str], ...] = ()
    """Raw values with a meaning of their own."""
    minimum: _MaybeFloat = None
    maximum: _MaybeFloat = None
    above: _MaybeFloat = None
    below: _MaybeFloat = None
    byte_order: str = ""
    """``little`` or ``big``; empty where it is the message's."""
    bit_order: str = ""
    """``lsb0`` or ``msb0``; empty where it is the message's."""
    elements: int = 0
    """Elements of an array, of so many bits each; its attributes hold tuples.

    0 if it is no array.
    """

    @property
    def signed(self) -> bool:
        """Whether the raw value is in two's complement."""
        if self.enum is not None:
            return is_signed(self.enum)
        return self.type == "int"


class Message:
    """A message: its attributes hold raw values, just as they are on the wire.

    Values are not checked when they are assigned, but by `to_bytes`.
    """

    __slots__ = ()

    if TYPE_CHECKING:
        NODE: ClassVar[str]
        """The node whose ICD declares it."""
        NAME: ClassVar[str]
        """The manual's name, verbatim."""
        KIND: ClassVar[str]
        """``telecommand``, ``telemetry`` or ``configuration`` (which is both)."""
        LENGTH: ClassVar[int]
        """Bytes of a frame, without the id."""
    IDS: ClassVar[tuple[int, ...]] = ()
    """Its ids: one, or the id to set it and the id to get it."""
    TABLE: ClassVar[_MaybeInt] = None
    """The manual's table."""
    ACKNOWLEDGED: ClassVar[bool] = True
    """Whether the node acknowledges it, where it is a telecommand."""
    FIELDS: ClassVar[tuple[FieldInfo, ...]] = ()
    """The fields in the order of the manual."""
    BYTE_ORDER: ClassVar[Literal["little", "big"]] = "little"
    BIT_ORDER: ClassVar[Literal["lsb0", "msb0"]] = "lsb0"

    @classmethod
    def from_bytes(cls: type[_M], data: Buffer) -> _M:  # noqa: PYI019
        """The message in a frame. Raises `LengthError`."""
        raise NotImplementedError

    def to_bytes(self) -> bytes:
        """The frame, with reserved bits 0. Raises `RangeError`."""
        raise NotImplementedError

    def as_dict(self, physical: bool = False) -> dict[str, Any]:
        """All values by attribute: raw, or physical where a field has such a value."""
        if physical:
            names = [info.physical or info.attribute for info in self.FIELDS]
        else:
            names = [info.attribute for info in self.FIELDS]
        return {name: getattr(self, name) for name in names}

    @classmethod
    def decode_many(cls, frames: Buffer, physical: bool = False) -> dict[str, Any]:
        """Frames that follow each other, as one numpy array a field.

        The names are those of `as_dict`. What stands on whole bytes is a view of the
        frames, or of a copy of them if they can change. Raises `LengthError` if they
        are not whole frames. Needs numpy.
        """
        from . import _columns

        return _columns.decode_many(cls, frames, physical)

    @classmethod
    def decode_table(cls, frames: Buffer, physical: bool = True) -> Any:
        """Frames that follow each other, as a `pyarrow.Table`.

        Units, the manual's names and those of enumerations are metadata of its fields:
        ``unit``, ``name`` and ``values``. Raises
        `LengthError` if they are not whole frames. Needs numpy and pyarrow.
        """
        from . import _columns

        return _columns.decode_table(cls, frames, physical)

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return self.as_dict() == other.as_dict()

    def __repr__(self) -> str:
        values = (f"{name}={value!r}" for name, value in self.as_dict().items())
        return f"{type(self).__name__}({', '.join(values)})"
