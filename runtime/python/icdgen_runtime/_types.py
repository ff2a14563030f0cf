"""Facts of fields, structs and messages, and types that annotations use.

Modules that the message classes import cannot import these classes. They use the types
of this module instead.
"""

from __future__ import annotations

from importlib import import_module

# The module, not its names: these are imported when an annotation is evaluated.
from . import _types  # noqa: PLW0406

__all__ = [
    "Any",
    "Buffer",
    "Callable",
    "Candidate",
    "Curve",
    "Derivation",
    "FieldInfo",
    "Frames",
    "Iterator",
    "Literal",
    "M",
    "Mapping",
    "MessageFacts",
    "OpenEnum",
    "Optional",
    "S",
    "StructFacts",
    "T",
    "Tail",
]

# Type checkers treat this name as true. Importing `typing` would slow down the start.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from typing import Any, ClassVar, Literal, Optional, TypeVar

    from ._enumeration import OpenEnum
    from ._hints import Buffer, Candidate, Curve, Derivation, Frames, T

    M = TypeVar("M", bound="MessageFacts")
    S = TypeVar("S", bound="StructFacts")
else:
    _HOMES = {
        "Buffer": "._hints",
        "Candidate": "._hints",
        "Curve": "._hints",
        "Derivation": "._hints",
        "Frames": "._hints",
        "OpenEnum": "._enumeration",
        "T": "._hints",
    }

    def __getattr__(name):
        if name.startswith("_"):  # import asks for `__path__`: typing stays unloaded
            raise AttributeError(name)
        if name in ("M", "S"):
            bound = MessageFacts if name == "M" else StructFacts
            value = import_module("typing").TypeVar(name, bound=bound)
            return globals().setdefault(name, value)
        return getattr(import_module(_HOMES.get(name, "typing"), __package__), name)


class FieldInfo:
    """Facts of a field in the ICD. Do not change them.

    Limits apply to the physical value, or to the raw value if there is no scale.
    """

    __slots__ = (
        "attribute", "name", "at", "bits", "type", "unit", "physical", "whole", "scale", "enum", "const",
        "special", "minimum", "maximum", "above", "below", "byte_order", "bit_order", "default",
        "elements", "is_open", "fewest", "struct", "curve", "ends", "leads_back", "when", "derived",
    )  # fmt: skip

    def __init__(
        self,
        attribute: str,
        name: str,
        at: int,
        bits: int,
        type: str,
        unit: str = "",
        physical: str = "",
        scale: tuple[int, int, int] = (1, 0, 1),
        enum: _types.Optional[type[_types.OpenEnum]] = None,
        const: _types.Optional[int] = None,
        special: tuple[tuple[float, str], ...] = (),
        minimum: _types.Optional[float] = None,
        maximum: _types.Optional[float] = None,
        above: _types.Optional[float] = None,
        below: _types.Optional[float] = None,
        byte_order: str = "",
        bit_order: str = "",
        whole: str = "",
        default: _types.Any = None,
        elements: int = 0,
        is_open: bool = False,
        fewest: int = 0,
        struct: _types.Optional[type[StructFacts]] = None,
        curve: _types.Curve = (),
        ends: tuple[int, ...] = (),
        leads_back: bool = True,
        when: tuple[tuple[str, tuple[int, ...]], ...] = (),
        derived: _types.Optional[_types.Derivation] = None,
    ) -> None:
        self.attribute = attribute
        """The attribute that holds the raw value."""
        self.name = name
        """The manual's name, verbatim."""
        self.at = at
        """Offset in bits from the start of the frame."""
        self.bits = bits
        """Width in bits."""
        self.type = type
        """``uint``, ``int``, ``bool``, ``enum``, ``float``, ``bytes``, ``text`` or ``struct``."""
        self.unit = unit
        """Unit of the physical value, or of the raw one if there is no scale."""
        self.physical = physical
        """The attribute that holds the physical value. For ``text``, it is a `str`.

        Empty if the field has neither a scale nor a text.
        """
        self.whole = whole
        """The attribute that holds the exact physical value, as an integer in parts of the unit."""
        self.scale = scale
        """``(p, c, q)``: the physical value is exactly ``(raw * p + c) / q``."""
        self.enum = enum
        """The enumeration of the values."""
        self.const = const
        """The only valid raw value."""
        self.special = special
        """Raw values with a special meaning."""
        self.minimum, self.maximum = minimum, maximum
        """The smallest and the largest value, or None."""
        self.above, self.below = above, below
        """Exclusive limits of the value, or None."""
        self.byte_order = byte_order
        """``little`` or ``big``; empty for the order of the message."""
        self.bit_order = bit_order
        """``lsb0`` or ``msb0``; empty for the order of the message."""
        self.default = default
        """The raw value in a new message."""
        self.elements = elements
        """Number of elements of an array, 0 if it is not one.

        `bits` is the width of an element. The attributes hold tuples.
        """
        self.is_open = is_open
        """Whether the length is variable, up to `elements` or bytes: see `Message.TAIL`."""
        self.fewest = fewest
        """Minimum number of elements or bytes."""
        self.struct = struct
        """The class of a struct. Offsets in it begin at 0."""
        self.curve = curve
        """Calibration instead of a scale, computed in doubles.

        It consists of pieces: the first raw value, and the coefficients of a polynomial
        in the distance from there, the constant first. A lookup table has several
        pieces. A piece without coefficients has no physical value.
        """
        self.ends = ends
        """The raw values between which the calibration has an inverse, if not all have one."""
        self.leads_back = leads_back
        """Whether the physical value can be set."""
        self.when = when
        """The field is present only if each of these attributes has one of these values.

        Otherwise its value is None after decoding, and is ignored when the message is encoded.
        """
        self.derived = derived
        """For a derived value: attributes, numbers, and steps on the row of their values."""

    @property
    def signed(self) -> bool:
        """Whether the raw value is in two's complement."""
        if self.enum is not None:
            from ._enumeration import is_signed

            return is_signed(self.enum)
        return self.type == "int"

    def allows(self, value: float) -> bool:
        """Return whether a physical value (raw, if there is no scale) is within the
        limits.

        NaN is within no limits.
        """
        return (
            (self.minimum is None or value >= self.minimum)
            and (self.above is None or value > self.above)
            and (self.maximum is None or value <= self.maximum)
            and (self.below is None or value < self.below)
        )

    @property
    def raw_range(self) -> tuple[int, int]:
        """The smallest and the largest raw value of an integer field."""
        if self.signed:
            return -(1 << (self.bits - 1)), (1 << (self.bits - 1)) - 1
        return 0, (1 << self.bits) - 1

    @property
    def parts(self) -> tuple[FieldInfo, ...]:
        """The elements of an array as fields with names like ``temperatures[3]``, or
        the field.
        """
        return tuple(map(self._part, range(self.elements))) or (self,)

    def _part(self, index: int) -> FieldInfo:
        facts = {name: getattr(self, name) for name in self.__slots__}
        for key in ("attribute", "name"):
            facts[key] += f"[{index}]"
        facts["at"] += index * self.bits
        if self.is_open or self.default is None:
            facts.update(default=None, is_open=False, fewest=0)
        else:
            facts["default"] = self.default[index]
        return FieldInfo(**{**facts, "elements": 0})

    @property
    def leaves(self) -> tuple[FieldInfo, ...]:
        """Fields without arrays and structs, with names like ``satellites[2].gnss``."""
        if self.struct is None:
            return self.parts
        return tuple(leaf for line in self.lines for leaf in line.parts)

    @property
    def lines(self) -> tuple[FieldInfo, ...]:
        """The field, or the fields of a struct, with names like ``satellites[2].gnss``.

        An array of values is one field.
        """
        if self.struct is None:
            return (self,)
        return tuple(
            line
            for part in self.parts
            for info in self.struct.FIELDS
            for line in info.within(part).lines
        )

    def within(self, part: FieldInfo) -> FieldInfo:
        """Return this field of a struct as a field of the message, whose struct is
        ``part``.
        """
        facts = {name: getattr(self, name) for name in self.__slots__}
        for key in ("attribute", "name", "physical", "whole"):
            if facts[key]:
                head = part.name if key == "name" else part.attribute
                facts[key] = f"{head}.{facts[key]}"
        facts["at"] += part.at
        facts["byte_order"] = self.byte_order or part.byte_order
        facts["bit_order"] = self.bit_order or part.bit_order
        return FieldInfo(**facts)

    @property
    def fresh(self) -> _types.Any:
        """Default raw value. A struct is a new object."""
        struct = self.struct
        if struct is None:
            return self.default
        count = self.fewest if self.is_open else self.elements
        return tuple(struct() for _ in range(count)) if self.elements else struct()

    def _values(self) -> tuple[_types.Any, ...]:
        return tuple(getattr(self, name) for name in self.__slots__)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, FieldInfo):
            return NotImplemented
        return self._values() == other._values()

    def __hash__(self) -> int:
        return hash((self.attribute, self.name, self.at, self.bits, self.type))

    def __repr__(self) -> str:
        values = (f"{name}={getattr(self, name)!r}" for name in self.__slots__)
        return f"FieldInfo({', '.join(values)})"


class Tail:
    """A variable-length field.

    A frame is the beginning of the longest frame, which has ``LENGTH`` bytes, and the
    last ``behind`` bytes of it.
    """

    __slots__ = ("part", "counter", "step", "most", "plus", "behind")

    def __init__(
        self,
        part: str,
        counter: str,
        step: int,
        most: int,
        plus: int = 0,
        behind: int = 0,
    ) -> None:
        self.part = part
        """The attribute that holds the elements: a tuple, or `bytes`."""
        self.counter = counter
        """The attribute that holds the number of elements.

        Empty if only the length of the frame gives it.
        """
        self.step = step
        """Bytes of an element."""
        self.most = most
        """Maximum number of elements."""
        self.plus = plus
        """Number of elements in addition to the counter."""
        self.behind = behind
        """Bytes of the fields of fixed size behind it."""


class StructFacts:
    """Facts of a struct or a message: attributes of its class."""

    __slots__ = ()

    if TYPE_CHECKING:
        NODE: ClassVar[str]
        """The node whose ICD declares it."""
        NAME: ClassVar[str]
        """The manual's name, verbatim."""
        LENGTH: ClassVar[int]
        """Length of a frame in bytes, without the id. If lengths differ, the longest."""
        FIELDS: ClassVar[tuple[FieldInfo, ...]]
        """The fields in the order of the manual."""
        VIEWS: ClassVar[tuple[FieldInfo, ...]]
        """Overlay fields and derived values. They are computed from the fields and cannot be set."""
        CONDITIONAL: ClassVar[bool]
        """Whether there are optional fields: see `FieldInfo.when`."""
    else:
        FIELDS = VIEWS = ()
        CONDITIONAL = False


class MessageFacts(StructFacts):
    """Facts of a message: attributes of its class."""

    __slots__ = ()

    if TYPE_CHECKING:
        KIND: ClassVar[str]
        """``telecommand``, ``telemetry`` or ``configuration`` (which is both)."""
        IDS: ClassVar[tuple[int, ...]]
        """Its ids: one, or the id to set it and the id to get it."""
        TABLE: ClassVar[int | None]
        """Number of the table in the manual."""
        ACKNOWLEDGED: ClassVar[bool]
        """Whether the node acknowledges the telecommand."""
        PARTS: ClassVar[tuple[tuple[str, str, int], ...]]
        """Parts of a composite message: node, class and first bit of each."""
        TAIL: ClassVar[Tail | None]
        """The last variable-length field of the frame."""
        INNER: ClassVar[
            tuple[tuple[Tail, int, tuple[tuple[int, int, int, int], ...]], ...]
        ]
        """Variable-length fields after which a frame differs from the longest one.

        Each has its first byte in the longest frame, and the pieces of its counter.
        These are the fields in front of `TAIL`, and `TAIL` itself if its elements have
        variable-length arrays.
        """
        NESTED: ClassVar[
            tuple[tuple[str, Tail, int, tuple[tuple[int, int, int, int], ...]], ...]
        ]
        """Variable-length arrays in the elements of such a field.

        Each has the name of the field, its first byte in the longest element, and the
        pieces of its counter.
        """
        ENDS_EARLY: ClassVar[bool]
        """Whether frames may lack the zeros at their end."""
        BYTE_ORDER: ClassVar[Literal["little", "big"]]
        BIT_ORDER: ClassVar[Literal["lsb0", "msb0"]]
    else:
        IDS = PARTS = INNER = NESTED = ()
        TABLE = TAIL = None
        ENDS_EARLY, ACKNOWLEDGED = False, True
        BYTE_ORDER, BIT_ORDER = "little", "lsb0"
