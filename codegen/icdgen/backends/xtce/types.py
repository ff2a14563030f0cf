"""What fields are made of in XTCE: types, each once, with a name."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import chain, count
from math import ceil, floor
from typing import Any

from icdgen import naming
from icdgen.describe import FieldDescription
from icdgen.describe.bounds import bounds
from icdgen.describe.description import VariablePartDescription
from icdgen.describe.numbers import exact_text, point_text
from icdgen.icd.curve import CLAMP, EXTRAPOLATE
from icdgen.icd.model import Member
from icdgen.icd.places import NodePlace

_LONG = range(-(1 << 63), 1 << 63)  # what XTCE has as a value of an integer
_KEYS = {"min": "minInclusive", "above": "minExclusive", "max": "maxInclusive", "below": "maxExclusive"}
_KINDS = {
    "uint": "Integer", "int": "Integer", "bool": "Boolean", "enum": "Enumerated", "float": "Float", "bytes": "Binary",
    "text": "String",
}  # fmt: skip


@dataclass(frozen=True)
class Type:
    """A type of parameters or arguments. All of it is text for the template, but for numbers of bits and elements."""

    kind: str  # as in the name of its element
    bits: int = 0
    encoding: str = ""  # of an integer on the wire; of a float none
    byte_order: str = ""  # of more than one byte
    unit: str = ""
    terms: tuple[tuple[int, str], ...] = ()  # exponents and coefficients
    points: tuple[tuple[str, str], ...] = ()  # raw and calibrated
    extrapolates: bool = False
    limits: tuple[tuple[str, str], ...] = ()  # names of attributes and values
    labels: tuple[Member, ...] = ()
    enum: str = ""  # what an enumeration is called
    of: str = ""  # of an array the type of its elements
    count: int = 0  # of an array its elements; of what something counts the most that there are
    counter: str = ""  # the parameter or argument that counts elements, or bytes
    plus: int = 0  # there are so many more than it says

    @property
    def size(self) -> int:
        """Bits of a value of it, as programs hold it."""
        is_double = self.terms or self.points
        return 64 if is_double or self.bits > 32 else 32

    @property
    def is_signed(self) -> bool:
        return self.encoding == "twosComplement"


def unique(wanted: str, taken: set[str]) -> str:
    """A name that nothing else has, from now on taken: as ``wanted``, or with a number behind it."""
    tried = chain([wanted], (f"{wanted}_{number}" for number in count(2)))
    name = next(name for name in tried if name not in taken)
    taken.add(name)
    return name


@dataclass
class Types:
    """Those of one of the sets of a file."""

    names: dict[Type, str] = field(default_factory=dict)
    taken: set[str] = field(default_factory=set)

    def name(self, of: Type, wanted: str) -> str:
        """What a type is called: as ``wanted`` if that is free."""
        if of not in self.names:
            self.names[of] = unique(wanted, self.taken)
        return self.names[of]

    def of(self, field: FieldDescription, wanted: str, is_little: bool) -> str:
        """The name of the type of a field, of an array of all its elements."""
        name = self._element(field, wanted, is_little)
        return name if not field.count else self.name(Type("Array", of=name, count=field.count), f"{wanted}_Array")

    def of_open(self, tail: VariablePartDescription, counter: str, wanted: str, is_little: bool) -> str:
        """The name of the type of an open end, of which ``counter`` says how much there is."""
        if tail.field.model.is_bytes and not tail.field.count:
            made = replace(type_of(tail.field.model), bits=0)
        else:
            made, wanted = Type("Array", of=self._element(tail.field, wanted, is_little)), f"{wanted}_Array"
        return self.name(replace(made, count=tail.model.most, counter=counter, plus=tail.model.plus), wanted)

    def _element(self, field: FieldDescription, wanted: str, is_little: bool) -> str:
        element = type_of(field.model, is_little)
        return self.name(element, _usual_name(field, element) or wanted)


def type_of(field: NodePlace, is_little: bool = False) -> Type:
    """The type of a field, of an array that of an element."""
    order = "" if field.is_bytes else "leastSignificantByteFirst" if is_little else most_first(field.bits)
    encoding = "" if field.type == "float" or field.is_bytes else "twosComplement" if field.is_signed else "unsigned"
    made = Type(_KINDS[field.type], field.bits, encoding, order, field.unit_symbol)
    if field.enum is not None:
        labels = tuple(one for one in field.enum.members if one.value in _LONG and one.last in _LONG)
        return replace(made, labels=labels, enum=field.enum.name)
    if field.has_formula:
        made = replace(made, kind="Float", **_calibration(field))
    return replace(made, limits=_limits(field))


def most_first(bits: int) -> str:
    """The order of the bytes of a number that begins with the most significant one; of a single byte none."""
    return "mostSignificantByteFirst" if bits > 8 else ""


def _usual_name(field: FieldDescription, of: Type) -> str:
    """What a type is called that has no more than an encoding, or that is an enumeration; else nothing."""
    if field.enum is not None:
        return naming.camel(field.enum.words)
    if of.unit or of.terms or of.points or of.limits:
        return ""
    little = "_le" if of.byte_order.startswith("least") else ""
    names = {"Boolean": "flag", "Binary": f"bytes{of.bits // 8}", "String": f"text{of.bits // 8}"}
    return names.get(of.kind, f"{field.model.type}{of.bits}{little}")


def _calibration(field: NodePlace) -> dict[str, Any]:
    """The polynomial, or the table, of a formula."""
    if field.scale is not None:
        return {"terms": _terms([field.scale.offset, field.scale.factor])}
    curve = field.curve
    assert curve is not None
    if not curve.points:
        return {"terms": _terms(list(map(Fraction, curve.coefficients)))}
    points = list(map(_point, curve.points))
    if curve.outside == CLAMP and field.type != "float":  # XTCE has no word for it, but lines that are level
        if curve.points[0][0] > field.raw_min:
            points.insert(0, (str(field.raw_min), points[0][1]))
        if curve.points[-1][0] < field.raw_max:
            points.append((str(field.raw_max), points[-1][1]))
    return {"points": tuple(points), "extrapolates": curve.outside == EXTRAPOLATE}


def _terms(coefficients: list[Fraction]) -> tuple[tuple[int, str], ...]:
    return tuple((power, exact_text(value)) for power, value in enumerate(coefficients) if value or power == 1)


def _point(point: tuple[float, float]) -> tuple[str, str]:
    raw, _, value = point_text(point).partition(": ")
    return raw, value


def _limits(field: NodePlace) -> tuple[tuple[str, str], ...]:
    """Attributes of the valid range; of integers XTCE has inclusive ones only."""
    said = {one.key: one.value for one in bounds(field.limits)}
    if field.type == "float" or field.has_formula:
        return tuple((_KEYS[key], exact_text(value)) for key, value in said.items())
    least = [ceil(said[key]) if key == "min" else floor(said[key]) + 1 for key in ("min", "above") if key in said]
    most = [floor(said[key]) if key == "max" else ceil(said[key]) - 1 for key in ("max", "below") if key in said]
    found = (*((_KEYS["min"], one) for one in least[-1:]), *((_KEYS["max"], one) for one in most[-1:]))
    return tuple((key, str(value)) for key, value in found if value in _LONG)


def is_said(field: NodePlace) -> bool:
    """Whether the calibration says all that the formula does."""
    return field.type != "float" or field.curve is None or field.curve.outside != CLAMP
