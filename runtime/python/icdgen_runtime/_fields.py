"""Declarations of fields in a message class, and the properties that they create.

`field` declares an attribute for the raw value; `scaled`, `whole`, `curve` and `text`
declare further attributes of the same bits, such as the physical value.
"""

from __future__ import annotations

# The module, not its names: these are imported when an annotation is evaluated.
from . import _types
from ._errors import RangeError, span_of
from ._types import FieldInfo

# Type checkers treat this name as true. Importing `typing` would slow down the start.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class Form:
    """Declaration of another attribute of the preceding field, such as its physical
    value.
    """

    __slots__ = ("kind", "terms", "curve", "ends")

    def __init__(
        self,
        kind: str,
        terms: tuple[int, int, int] = (1, 0, 1),
        curve: _types.Curve = (),
        ends: tuple[int, ...] = (),
    ) -> None:
        self.kind, self.terms, self.curve, self.ends = kind, terms, curve, ends

    def property_of(self, info: FieldInfo, name: str) -> property:
        """Return the property ``name``, and enter its name into the facts of the field."""
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
    """Return the property of an optional field: None if the field is not present."""

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
        raw_values = (
            from_curve(element, info, f"{name}[{place}]") for place, element in each
        )
        setattr(self, attribute, tuple(raw_values))

    if info.when:
        return _optional(attribute, get, set)
    return property(get_all, set_all) if info.elements else property(get, set)


def _counted(info: FieldInfo, name: str, values: Any) -> None:
    """Raise `RangeError` that names the attribute unless there is a value for each
    element.
    """
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
        raw_values = (
            nearest_raw(value, info, f"{name}[{index}]", terms)
            for index, value in enumerate(values)
        )
        setattr(self, attribute, tuple(raw_values))

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
    name: str,
    at: int,
    bits: int,
    type: str,
    *,
    default: _types.Any,
    **facts: _types.Any,
) -> _types.Any:
    """Declare a field: the manual's name, offset and width in bits, type and default.

    Further facts are keywords with the names of `FieldInfo`. The enumeration is the
    type of the default, unless ``enum`` is given.
    """
    if type == "enum" and "enum" not in facts:
        member = default[0] if facts.get("elements") else default
        facts["enum"] = member.__class__
    return FieldInfo("", name, at, bits, type, default=default, **facts)


def part(
    name: str,
    at: int,
    bits: int,
    *,
    factory: _types.Any,
    **facts: _types.Any,
) -> _types.Any:
    """Declare a struct of class ``factory``, or an array of such structs."""
    facts.update(default=() if facts.get("is_open") else None, struct=factory)
    return FieldInfo("", name, at, bits, "struct", **facts)


def scaled(p: int, c: int, q: int, *, default: _types.Any) -> _types.Any:
    """Declare the physical value ``(raw * p + c) / q`` of the field above, correctly
    rounded.

    Setting it sets the nearest raw value, the even one of two. Raise `RangeError`.
    """
    return Form("scaled", (p, c, q))


def curve(
    *pieces: tuple[float, tuple[float, ...]],
    default: _types.Any,
    ends: tuple[int, ...] = (),
) -> _types.Any:
    """Declare the physical value of the field above by a calibration: see
    `FieldInfo.curve`.

    Setting it sets the nearest raw value, the even one of two. Raise `RangeError`. If
    ``ends`` are given, the raw value is between these.
    """
    return Form("curve", curve=pieces, ends=ends)


def curve_only(
    *pieces: tuple[float, tuple[float, ...]],
    default: _types.Any,
    init: _types.Literal[False] = False,
) -> _types.Any:
    """Declare a read-only physical value by a calibration that has no inverse."""
    return Form("curve_only", curve=pieces)


def whole(p: int, c: int, *, init: _types.Literal[False] = False) -> _types.Any:
    """Declare the exact integer ``raw * p + c`` of the field above, in parts of its
    unit.

    Setting it sets the nearest raw value, the even one of two. Raise `RangeError`.
    """
    return Form("whole", (p, c, 1))


def text(*, default: _types.Any) -> _types.Any:
    """Declare the text of the field above, or the texts of an array, up to the first
    NUL.

    A byte that is not ASCII reads as U+FFFD. Setting it may raise `RangeError`.
    """
    return Form("text")


def nearest_raw(
    value: float, info: FieldInfo, field: str, terms: tuple[int, int, int]
) -> int:
    """Return the raw value whose physical value is nearest, the even one of two.

    The physical value is ``(raw * p + c) / q``. ``value`` is used exactly: a float, an
    integer, or any object that has ``as_integer_ratio``. Raise `RangeError` that names
    ``field``, the attribute that is set.
    """
    (p, c, q), (low, high) = terms, info.raw_range
    try:
        over, under = value.as_integer_ratio()
    except (ArithmeticError, AttributeError, TypeError, ValueError):
        raise RangeError(field, _allowed(info, terms), value) from None
    over, under = over * q - c * under, under * p
    if under < 0:
        over, under = -over, -under
    raw, remainder = divmod(over, under)
    if 2 * remainder > under or (2 * remainder == under and raw % 2):
        raw += 1
    if not low <= raw <= high:
        raise RangeError(field, _allowed(info, terms), value)
    return raw


def _allowed(info: FieldInfo, terms: tuple[int, int, int]) -> str:
    """Return the valid values, such as ``0 to 6553.5 m/s``.

    An integer in parts of the unit has its own range, followed by the physical range.
    """
    least, most = _ends(info, info.scale)
    span = span_of(least, most, info.unit)
    if terms == info.scale:
        return span
    least, most = _ends(info, terms)
    return f"{span_of(least, most)} ({span})"


def _ends(info: FieldInfo, terms: tuple[int, int, int]) -> list[float]:
    """Return the physical values of the smallest and the largest raw value, in order."""
    p, c, q = terms
    return sorted(
        (raw * p + c) / q if q != 1 else raw * p + c for raw in info.raw_range
    )
