"""How the class of a message declares its fields, and what is told of them."""

from __future__ import annotations

# Itself: what annotations name is loaded when they are evaluated.
from . import _lazy
from ._errors import RangeError
from ._scales import nearest_raw

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class FieldInfo:
    """What the ICD says of a field. Not to be changed.

    Limits are those of the physical value, or of the raw one if there is no scale.
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
        enum: _lazy.Optional[type[_lazy.OpenEnum]] = None,
        const: _lazy.Optional[int] = None,
        special: tuple[tuple[float, str], ...] = (),
        minimum: _lazy.Optional[float] = None,
        maximum: _lazy.Optional[float] = None,
        above: _lazy.Optional[float] = None,
        below: _lazy.Optional[float] = None,
        byte_order: str = "",
        bit_order: str = "",
        whole: str = "",
        default: _lazy.Any = None,
        elements: int = 0,
        is_open: bool = False,
        fewest: int = 0,
        struct: _lazy.Optional[type[_lazy.Struct]] = None,
        curve: _lazy.Curve = (),
        ends: tuple[int, ...] = (),
        leads_back: bool = True,
        when: tuple[tuple[str, tuple[int, ...]], ...] = (),
        derived: _lazy.Optional[_lazy.Derivation] = None,
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
        """The attribute that holds the physical value, of ``text`` a `str`.

        Empty if the field has neither a scale nor a text.
        """
        self.whole = whole
        """The attribute that holds it exactly, as a whole number of parts of the unit."""
        self.scale = scale
        """``(p, c, q)``: the physical value is exactly ``(raw * p + c) / q``."""
        self.enum = enum
        """The enumeration of the values."""
        self.const = const
        """The only valid raw value."""
        self.special = special
        """Raw values with a meaning of their own."""
        self.minimum, self.maximum = minimum, maximum
        """The smallest and the largest value, or None."""
        self.above, self.below = above, below
        """Exclusive limits of the value, or None."""
        self.byte_order = byte_order
        """``little`` or ``big``; empty where it is the message's."""
        self.bit_order = bit_order
        """``lsb0`` or ``msb0``; empty where it is the message's."""
        self.default = default
        """The raw value in a new message."""
        self.elements = elements
        """Elements of an array, of so many bits each: its attributes hold tuples; else 0."""
        self.is_open = is_open
        """Whether frames hold up to so many elements, or bytes: see `Message.TAIL`."""
        self.fewest = fewest
        """How many of them every frame holds."""
        self.struct = struct
        """The class of what stands here, where that is a struct; the offsets in it begin at 0."""
        self.curve = curve
        """How it is computed in doubles, and no scale: from a raw value on, the terms of
        a polynomial in what is above that, the constant first.

        A table of points has several such pieces; without terms there is no number.
        """
        self.ends = ends
        """The raw values between which a physical one leads back, where not all do."""
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
        """Whether a physical value (a raw one if there is no scale) keeps the limits; NaN keeps none."""
        return (
            (self.minimum is None or value >= self.minimum)
            and (self.above is None or value > self.above)
            and (self.maximum is None or value <= self.maximum)
            and (self.below is None or value < self.below)
        )

    @property
    def raw_range(self) -> tuple[int, int]:
        """The smallest and the largest raw value of a field that holds integers."""
        if self.signed:
            return -(1 << (self.bits - 1)), (1 << (self.bits - 1)) - 1
        return 0, (1 << self.bits) - 1

    @property
    def parts(self) -> tuple[FieldInfo, ...]:
        """The elements of an array as fields, called ``temperatures[3]``; else the field."""
        return tuple(map(self._part, range(self.elements))) or (self,)

    def _part(self, index: int) -> FieldInfo:
        told = {name: getattr(self, name) for name in self.__slots__}
        for key in ("attribute", "name"):
            told[key] += f"[{index}]"
        told["at"] += index * self.bits
        if self.is_open or self.default is None:
            told.update(default=None, is_open=False, fewest=0)
        else:
            told["default"] = self.default[index]
        return FieldInfo(**{**told, "elements": 0})

    @property
    def leaves(self) -> tuple[FieldInfo, ...]:
        """The same, and of a struct the fields in it, called ``satellites[2].gnss``: no arrays, no structs."""
        if self.struct is None:
            return self.parts
        return tuple(leaf for line in self.lines for leaf in line.parts)

    @property
    def lines(self) -> tuple[FieldInfo, ...]:
        """The field; of a struct the fields in it, called ``satellites[2].gnss``, arrays as one."""
        if self.struct is None:
            return (self,)
        return tuple(
            line
            for part in self.parts
            for info in self.struct.FIELDS
            for line in info.within(part).lines
        )

    def within(self, part: FieldInfo) -> FieldInfo:
        """This field of a struct, where the struct stands as ``part`` of a message."""
        told = {name: getattr(self, name) for name in self.__slots__}
        for key in ("attribute", "name", "physical", "whole"):
            if told[key]:
                head = part.name if key == "name" else part.attribute
                told[key] = f"{head}.{told[key]}"
        told["at"] += part.at
        told["byte_order"] = self.byte_order or part.byte_order
        told["bit_order"] = self.bit_order or part.bit_order
        return FieldInfo(**told)

    @property
    def fresh(self) -> _lazy.Any:
        """The raw value in a new message: of a struct a new one."""
        made = self.struct
        if made is None:
            return self.default
        count = self.fewest if self.is_open else self.elements
        return tuple(made() for _ in range(count)) if self.elements else made()

    def _values(self) -> tuple[_lazy.Any, ...]:
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
    """The end of a message whose frames differ in length.

    A frame is the beginning of the longest one, which has ``LENGTH`` bytes.
    """

    __slots__ = ("part", "counter", "step", "most", "plus")

    def __init__(
        self, part: str, counter: str, step: int, most: int, plus: int = 0
    ) -> None:
        self.part = part
        """The attribute that holds it: a tuple, or `bytes`."""
        self.counter = counter
        """The attribute that says how many elements it has.

        Empty if only the length of the frame does.
        """
        self.step = step
        """Bytes of an element."""
        self.most = most
        """The most elements."""
        self.plus = plus
        """There are so many more elements than the counter says."""


class Form:
    """Another attribute of the field that is declared before it: its value in another form."""

    __slots__ = ("kind", "terms", "curve", "ends")

    def __init__(
        self,
        kind: str,
        terms: tuple[int, int, int] = (1, 0, 1),
        curve: _lazy.Curve = (),
        ends: tuple[int, ...] = (),
    ) -> None:
        self.kind, self.terms, self.curve, self.ends = kind, terms, curve, ends

    def property_of(self, info: FieldInfo, name: str) -> property:
        """What the class has as ``name``, which the field is told of."""
        if self.kind == "text":
            info.physical = name
            return _text_property(info)
        if self.curve:
            info.physical, info.curve, info.ends = name, self.curve, self.ends
            info.leads_back = self.kind == "curve"
            return _curve_property(info)
        if self.kind == "whole":
            info.whole = name
        else:
            info.physical, info.scale = name, self.terms
        return _number_property(info, self, name)


def _number_property(info: FieldInfo, form: Form, name: str) -> property:
    if info.elements:
        return _array_property(info, form, name)
    attribute, terms = info.attribute, form.terms
    p, c, q = terms
    is_whole = form.kind == "whole"

    def get_whole(self: Any) -> int:
        value: int = getattr(self, attribute) * p + c
        return value

    def get_physical(self: Any) -> float:
        value: float = (getattr(self, attribute) * p + c) / q
        return value

    def set_nearest(self: Any, value: float) -> None:
        setattr(self, attribute, nearest_raw(value, info, name, terms))

    if info.when:
        return _optional(
            attribute, get_whole if is_whole else get_physical, set_nearest
        )
    return property(get_whole if is_whole else get_physical, set_nearest)


def _optional(attribute: str, get: Any, set: Any) -> property:
    """The property of a field that is not always there: None then, in both directions."""

    def get_there(self: Any) -> Any:
        return None if getattr(self, attribute) is None else get(self)

    def set_there(self: Any, value: Any) -> None:
        setattr(self, attribute, None) if value is None else set(self, value)

    return property(get_there, set_there)


def _curve_property(info: FieldInfo) -> property:
    from ._curves import from_curve, on_curve

    attribute, curve, name = info.attribute, info.curve, info.physical

    def get(self: Any) -> float:
        return on_curve(curve, getattr(self, attribute))

    def set(self: Any, value: float) -> None:
        setattr(self, attribute, from_curve(value, info, name))

    def get_all(self: Any) -> tuple[float, ...]:
        return tuple(on_curve(curve, raw) for raw in getattr(self, attribute))

    def set_all(self: Any, values: Any) -> None:
        _counted(info, name, values)
        each = enumerate(values)
        found = (from_curve(one, info, f"{name}[{place}]") for place, one in each)
        setattr(self, attribute, tuple(found))

    if info.when:
        return _optional(attribute, get, set)
    return property(get_all, set_all) if info.elements else property(get, set)


def _counted(info: FieldInfo, name: str, values: Any) -> None:
    """Raises `RangeError` that names the attribute unless there is a value for each element."""
    from ._codec import elements_of, has_elements

    if not has_elements(info, values):
        raise RangeError(name, elements_of(info), values)


def _array_property(info: FieldInfo, form: Form, name: str) -> property:
    attribute, terms = info.attribute, form.terms
    p, c, q = terms
    is_whole = form.kind == "whole"

    def get_whole(self: Any) -> tuple[int, ...]:
        return tuple(raw * p + c for raw in getattr(self, attribute))

    def get_physical(self: Any) -> tuple[float, ...]:
        return tuple((raw * p + c) / q for raw in getattr(self, attribute))

    def set_nearest(self: Any, values: Any) -> None:
        _counted(info, name, values)
        found = (
            nearest_raw(value, info, f"{name}[{index}]", terms)
            for index, value in enumerate(values)
        )
        setattr(self, attribute, tuple(found))

    return property(get_whole if is_whole else get_physical, set_nearest)


def _text_property(info: FieldInfo) -> property:
    attribute = info.attribute

    def get(self: Any) -> Any:
        from ._codec import texts_of

        return texts_of(info, getattr(self, attribute))

    def set(self: Any, value: Any) -> None:
        from ._codec import bytes_of_texts

        setattr(self, attribute, bytes_of_texts(info, value))

    return property(get, set)


def field(
    name: str, at: int, bits: int, type: str, *, default: _lazy.Any, **told: _lazy.Any
) -> _lazy.Any:
    """A field: the manual's name, offset and width in bits, type, and its first value.

    What else is told of it goes by the names of `FieldInfo`; the enumeration is that of
    the default, unless it is told, too.
    """
    if type == "enum" and "enum" not in told:
        one = default[0] if told.get("elements") else default
        told["enum"] = one.__class__
    return FieldInfo("", name, at, bits, type, default=default, **told)


def part(
    name: str,
    at: int,
    bits: int,
    *,
    factory: _lazy.Any,
    **told: _lazy.Any,
) -> _lazy.Any:
    """A struct, or as many of them as there are elements: the class of one is ``factory``."""
    told.update(default=() if told.get("is_open") else None, struct=factory)
    return FieldInfo("", name, at, bits, "struct", **told)


def scaled(p: int, c: int, q: int, *, default: _lazy.Any) -> _lazy.Any:
    """The physical value ``(raw * p + c) / q`` of the field above, correctly rounded.

    Setting it takes the nearest raw value, of two the even one. Raises `RangeError`.
    """
    return Form("scaled", (p, c, q))


def curve(
    *pieces: tuple[float, tuple[float, ...]],
    default: _lazy.Any,
    ends: tuple[int, ...] = (),
) -> _lazy.Any:
    """The physical value of the field above by a curve: see `FieldInfo.curve`.

    Setting it takes the nearest raw value, of two the even one, between ``ends`` where
    these are told. Raises `RangeError`.
    """
    return Form("curve", curve=pieces, ends=ends)


def curve_only(
    *pieces: tuple[float, tuple[float, ...]],
    default: _lazy.Any,
    init: _lazy.Literal[False] = False,
) -> _lazy.Any:
    """The same where it does not lead back to a raw value: it is only read."""
    return Form("curve_only", curve=pieces)


def whole(p: int, c: int, *, init: _lazy.Literal[False] = False) -> _lazy.Any:
    """The exact ``raw * p + c`` of the field above, in parts of its unit, set likewise."""
    return Form("whole", (p, c, 1))


def text(*, default: _lazy.Any) -> _lazy.Any:
    """The field above as a text, or texts: what stands before the first NUL.

    A byte that is not ASCII reads as U+FFFD. Setting it raises `RangeError`.
    """
    return Form("text")
