"""Types of XTCE, each with a unique name.

`type_of` translates the type of a field; `TypeBuilder` gives equal types one name, such
as ``uint16`` or the name of an enumeration.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import chain, count
from math import ceil, floor
from typing import Any

from icdgen.describe import FieldDescription
from icdgen.describe.bounds import bounds_of_limits
from icdgen.describe.description import VariablePartDescription
from icdgen.describe.numbers import exact_text, point_text
from icdgen.icd.curve import CLAMP, EXTRAPOLATE
from icdgen.icd.model import Member
from icdgen.icd.places import NodePlace

_LONG = range(-(1 << 63), 1 << 63)  # range of integer values in XTCE
_KEYS = {
    "min": "minInclusive",
    "above": "minExclusive",
    "max": "maxInclusive",
    "below": "maxExclusive",
}
_KINDS = {
    "uint": "Integer", "int": "Integer", "bool": "Boolean", "enum": "Enumerated", "float": "Float", "bytes": "Binary",
    "text": "String",
}  # fmt: skip


@dataclass(frozen=True)
class GeneratedType:
    """Type of parameters or arguments.

    All attributes are text for the template, except numbers of bits and elements.
    """

    kind: str  # part of the name of its XML element
    bits: int = 0
    encoding: str = ""  # encoding of an integer; empty for a float
    byte_order: str = ""  # empty for a single byte
    unit: str = ""
    terms: tuple[tuple[int, str], ...] = ()  # exponents and coefficients
    points: tuple[tuple[str, str], ...] = ()  # raw and calibrated
    extrapolates: bool = False
    limits: tuple[tuple[str, str], ...] = ()  # names of attributes and values
    labels: tuple[Member, ...] = ()
    enum: str = ""  # name of the enumeration
    of: str = ""  # element type of an array
    count: int = 0  # number of elements; the maximum if there is a counter
    counter: str = ""  # parameter or argument that counts elements or bytes
    plus: int = 0  # offset added to the counter

    @property
    def size(self) -> int:
        """Bits of a value in programs."""
        is_double = self.terms or self.points
        return 64 if is_double or self.bits > 32 else 32

    @property
    def is_signed(self) -> bool:
        return self.encoding == "twosComplement"


def unique(wanted: str, taken: set[str]) -> str:
    """Return an unused name and reserve it: ``wanted``, or ``wanted`` with a number."""
    tried = chain([wanted], (f"{wanted}_{number}" for number in count(2)))
    name = next(name for name in tried if name not in taken)
    taken.add(name)
    return name


@dataclass
class TypeBuilder:
    """Types of one set of a file."""

    names: dict[GeneratedType, str] = field(default_factory=dict)
    taken: set[str] = field(default_factory=set)

    def name_of_type(self, of: GeneratedType, wanted: str) -> str:
        """Return the name of a type: the existing one, otherwise ``wanted`` if it is
        free.
        """
        if of not in self.names:
            self.names[of] = unique(wanted, self.taken)
        return self.names[of]

    def type_of_field(
        self, field: FieldDescription, wanted: str, is_little: bool
    ) -> str:
        """Return the name of the type of a field; for an array, of the array."""
        name = self._element_type(field, wanted, is_little)
        return (
            name
            if not field.count
            else self.name_of_type(
                GeneratedType("Array", of=name, count=field.count), f"{wanted}_Array"
            )
        )

    def type_of_variable_part(
        self, part: VariablePartDescription, counter: str, wanted: str, is_little: bool
    ) -> str:
        """Return the name of the type of a variable-length field with a counter."""
        if part.field.model.is_bytes and not part.field.count:
            variable_type = replace(type_of(part.field.model), bits=0)
        else:
            variable_type = GeneratedType(
                "Array", of=self._element_type(part.field, wanted, is_little)
            )
            wanted = f"{wanted}_Array"
        return self.name_of_type(
            replace(
                variable_type,
                count=part.model.most,
                counter=counter,
                plus=part.model.plus,
            ),
            wanted,
        )

    def _element_type(
        self, field: FieldDescription, wanted: str, is_little: bool
    ) -> str:
        element = type_of(field.model, is_little)
        return self.name_of_type(element, _usual_name(field, element) or wanted)


def type_of(field: NodePlace, is_little: bool = False) -> GeneratedType:
    """Return the type of a field; for an array, of an element."""
    order = encoding = ""
    if not field.is_bytes:
        order = "leastSignificantByteFirst" if is_little else most_first(field.bits)
        if field.type != "float":
            encoding = "twosComplement" if field.is_signed else "unsigned"
    field_type = GeneratedType(
        _KINDS[field.type], field.bits, encoding, order, field.unit_symbol
    )
    if field.enum is not None:
        # XTCE 1.2 defines enumeration values as xs:long.
        labels = tuple(
            member
            for member in field.enum.members
            if member.value in _LONG and member.last in _LONG
        )
        return replace(field_type, labels=labels, enum=field.enum.name)
    if field.has_formula:
        field_type = replace(field_type, kind="Float", **_calibration(field))
    return replace(field_type, limits=_range_attributes(field))


def most_first(bits: int) -> str:
    """Return the byte order of a number with the most significant byte first; empty for
    a single byte.
    """
    return "mostSignificantByteFirst" if bits > 8 else ""


def _usual_name(field: FieldDescription, of: GeneratedType) -> str:
    """Return the name of an enumeration or of a type with only an encoding; empty for
    other types.
    """
    if field.enum is not None:
        return field.enum.camel_name
    if of.unit or of.terms or of.points or of.limits:
        return ""
    little = "_le" if of.byte_order.startswith("least") else ""
    names = {
        "Boolean": "flag",
        "Binary": f"bytes{of.bits // 8}",
        "String": f"text{of.bits // 8}",
    }
    return names.get(of.kind, f"{field.model.type}{of.bits}{little}")


def _calibration(field: NodePlace) -> dict[str, Any]:
    """Return the polynomial or lookup table of a formula."""
    if field.scale is not None:
        return {"terms": _polynomial_terms([field.scale.offset, field.scale.factor])}
    curve = field.curve
    assert curve is not None
    if not curve.points:
        return {"terms": _polynomial_terms(list(map(Fraction, curve.coefficients)))}
    points = list(map(_point, curve.points))
    # XTCE cannot clamp; horizontal segments have the same effect
    if curve.outside == CLAMP and field.type != "float":
        if curve.points[0][0] > field.raw_min:
            points.insert(0, (str(field.raw_min), points[0][1]))
        if curve.points[-1][0] < field.raw_max:
            points.append((str(field.raw_max), points[-1][1]))
    return {"points": tuple(points), "extrapolates": curve.outside == EXTRAPOLATE}


def _polynomial_terms(coefficients: list[Fraction]) -> tuple[tuple[int, str], ...]:
    return tuple(
        (power, exact_text(value))
        for power, value in enumerate(coefficients)
        if value or power == 1
    )


def _point(point: tuple[float, float]) -> tuple[str, str]:
    raw, _, value = point_text(point).partition(": ")
    return raw, value


def _range_attributes(field: NodePlace) -> tuple[tuple[str, str], ...]:
    """Return the attributes of the valid range.

    XTCE permits only inclusive limits for integers.
    """
    limits = {bound.key: bound.value for bound in bounds_of_limits(field.limits)}
    if field.type == "float" or field.has_formula:
        return tuple((_KEYS[key], exact_text(value)) for key, value in limits.items())
    least = [
        ceil(limits[key]) if key == "min" else floor(limits[key]) + 1
        for key in ("min", "above")
        if key in limits
    ]
    most = [
        floor(limits[key]) if key == "max" else ceil(limits[key]) - 1
        for key in ("max", "below")
        if key in limits
    ]
    attributes = (
        *((_KEYS["min"], limit) for limit in least[-1:]),
        *((_KEYS["max"], limit) for limit in most[-1:]),
    )
    return tuple((key, str(value)) for key, value in attributes if value in _LONG)


def is_complete(field: NodePlace) -> bool:
    """Return whether the calibration of XTCE represents the formula completely."""
    return field.type != "float" or field.curve is None or field.curve.outside != CLAMP
