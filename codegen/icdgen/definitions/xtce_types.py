"""Types of XTCE parameters and arguments as fields: encodings, calibrations, labels and
limits.

`XtceTypes.field_type` is the entry point. It returns the field without its position,
which `xtce_layout` adds. A calibration that is not supported leaves the raw value
(IMP078).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any
from xml.etree.ElementTree import Element

from icdgen.definitions import containers
from icdgen.definitions.accounting import settle
from icdgen.definitions.frames import BIG, LITTLE
from icdgen.definitions.model import Item, NotSupported
from icdgen.definitions.reading import ReadingState
from icdgen.definitions.wording import line, summary, unit, without_type
from icdgen.definitions.xtce_calibration import (
    NUMBER,
    calibration,
    decimal,
    fixed,
    formula,
    number,
    simplified_table,
)
from icdgen.definitions.xtce_names import XtceNames, alias, ancillary_data
from icdgen.icd.variable_length import MOST_BYTES, MOST_ELEMENTS

_MOST_NAMED = 1024  # values that one label can cover
_DEEPEST = 20  # types that inherit each other (`baseType`)
_WORD = 64  # bits of the largest integer
_ENCODINGS = (
    "IntegerDataEncoding",
    "FloatDataEncoding",
    "StringDataEncoding",
    "BinaryDataEncoding",
)
_LINE = (("slope", "1"), ("intercept", "0"))
_RANGES = ("ValidRange", "ValidRangeSet/ValidRange")
_LIMITS = {
    "minInclusive": "min",
    "maxInclusive": "max",
    "minExclusive": "above",
    "maxExclusive": "below",
}


@dataclass
class XtceFieldType(containers.FieldType):
    """Field that a type describes, with its counter and the labels of its raw values."""

    size: str = ""  # parameter that gives the size; empty if the size is fixed
    # added to that parameter; None if it does not count bytes or elements
    plus: int | None = None
    values: dict[str, int] = field(default_factory=dict)  # by label
    # Names and types of the members of an aggregate, which has no field of its own.
    members: list[tuple[str, Element]] = field(default_factory=list)
    # whether only the raw bits are imported, without their meaning
    is_raw: bool = False


@dataclass
class XtceTypes(ReadingState):
    """Types of a database as fields, and their enumerations."""

    most_steps = 1_000_000  # entries, members and labels of all messages

    names: XtceNames

    def field_type(self, element: Element, where: str) -> XtceFieldType:
        """Return the field of a type.

        ``where`` names the parameter in messages. Raises `NotSupported` if it is not
        supported.
        """
        self.step()
        chain = self._chain(element)
        kind = re.sub("(Parameter|Argument)Type$", "", element.tag)
        if kind == "Aggregate":
            type_of = self.names.type_of
            members = [
                (member.get("name", ""), type_of(member.get("typeRef", ""), element))
                for member in _inside(chain, "MemberList/Member")
            ]
            return XtceFieldType({}, 0, members=members)
        if kind == "Array":
            return self.array(element, element.find("DimensionList"), where)
        encoding = next(
            (child for child in _below(chain) if child.tag in _ENCODINGS), None
        )
        try:
            field_type = self._encoded(chain, kind, encoding)
        except NotSupported as why:
            return self._raw(chain, encoding, where, why)
        if kind == "Enumerated":
            self._labels(field_type, chain, element, where)
        elif kind == "Boolean":
            self._flag(field_type, chain, element)
        elif field_type.item["type"] in ("uint", "int", "float"):
            is_supported = self._calibrated(field_type, chain, encoding, kind, where)
            field_type.item |= _unit(chain) if is_supported else {}
            field_type.item |= (
                self._limits(field_type.item, chain) if is_supported else {}
            )
        return field_type

    def member(self, element: Element, name: str, where: str) -> Element:
        """Return the type of a member of an aggregate.

        Raises `NotSupported` if it does not exist.
        """
        for member, type_ in self.field_type(element, where).members:
            if member == name:
                return type_
        raise NotSupported(
            f"{where}: `{element.get('name', '')}` has no member `{line(name, 60)}`"
        )

    def array(
        self, element: Element, dimensions: Element | None, where: str
    ) -> XtceFieldType:
        """Return an array of one dimension with a fixed or counted number of elements.

        Raises `NotSupported` for other arrays.
        """
        of = self.names.type_of(element.get("arrayTypeRef", ""), element)
        listed = [] if dimensions is None else dimensions.findall("Dimension")
        if len(listed) != 1:
            raise NotSupported(
                f"{where} is an array of {len(listed) or 'no'} dimensions"
            )
        first, last = (
            fixed(listed[0].find("StartingIndex"), 0),
            fixed(listed[0].find("EndingIndex")),
        )
        if (
            first == 0
            and last is None
            and (dynamic := listed[0].find("EndingIndex/DynamicValue")) is not None
        ):
            return _counted(self._element(of, where), dynamic, where)
        if first is None or last is None:
            raise NotSupported(
                f"{where} is an array of as many elements as another parameter says"
            )
        # The last index is part of the array.
        return _array(self._element(of, where), last - first + 1, where)

    def _element(self, of: Element, where: str) -> XtceFieldType:
        """Return the element of an array.

        Raises `NotSupported` for an array of arrays.
        """
        if of.tag.startswith("Array"):
            raise NotSupported(f"{where} is an array of arrays")
        return self.field_type(of, where)

    def _chain(self, element: Element) -> list[Element]:
        """Return a type and its base types, the derived one first.

        Raises `NotSupported` for circular or too deep inheritance.
        """
        chain = [element]
        while (base := chain[-1].get("baseType")) is not None:
            base_type = self.names.type_of(base, chain[-1])
            if any(base_type is type_ for type_ in chain):
                raise NotSupported(
                    f"the type `{element.get('name', '')}` is based on itself"
                )
            if len(chain) >= _DEEPEST:
                raise NotSupported(
                    f"the type `{element.get('name', '')}` is based on more than {_DEEPEST} others"
                )
            chain.append(base_type)
        return chain

    def _encoded(
        self, chain: list[Element], kind: str, encoding: Element | None
    ) -> XtceFieldType:
        """Return the field of an encoding, or of an integer or float type without one.

        Raises `NotSupported`.
        """
        if encoding is None:
            if kind not in ("Integer", "Float"):
                raise NotSupported(
                    f"the type `{chain[0].get('name', '')}` has no encoding"
                )
            # Defaults of the XTCE schema for types: 32 bits, signed. Those of an
            # encoding differ: 8 bits, unsigned.
            bits = number(_attribute(chain, "sizeInBits", "32"), "a size")
            is_signed = _attribute(chain, "signed", "true") == "true"
            if kind == "Float":
                return _numbers("float", bits, BIG)
            return _numbers("int" if is_signed else "uint", bits, BIG)
        if (
            encoding.get("bitOrder", "mostSignificantBitFirst")
            != "mostSignificantBitFirst"
        ):
            raise NotSupported("its least significant bit is sent first")
        if encoding.tag == "IntegerDataEncoding":
            encoding_name = encoding.get("encoding", "unsigned")
            # XTCE 1.1 spells the value `twosCompliment`, 1.2 `twosComplement`.
            type_ = {
                "unsigned": "uint",
                "twosComplement": "int",
                "twosCompliment": "int",
            }.get(encoding_name)
            if type_ is None:
                raise NotSupported(
                    f"an integer is encoded as `{line(encoding_name, 60)}`"
                )
            return _numbers(
                type_,
                number(encoding.get("sizeInBits", "8"), "a size"),
                _order(encoding),
            )
        if encoding.tag == "FloatDataEncoding":
            encoding_name = encoding.get("encoding", "IEEE754_1985")
            if not encoding_name.startswith("IEEE754"):
                raise NotSupported(f"a float is encoded as `{line(encoding_name, 60)}`")
            return _numbers(
                "float",
                number(encoding.get("sizeInBits", "32"), "a size"),
                _order(encoding),
            )
        return _bytes(
            encoding, "text" if encoding.tag == "StringDataEncoding" else "bytes"
        )

    def _raw(
        self,
        chain: list[Element],
        encoding: Element | None,
        where: str,
        why: NotSupported,
    ) -> XtceFieldType:
        """Return the raw bits of a type that is not supported, and note it.

        Raises ``why`` if its size is not fixed.
        """
        if encoding is None:
            raise why
        default = {"IntegerDataEncoding": "8", "FloatDataEncoding": "32"}.get(
            encoding.tag
        )
        size = encoding.find("SizeInBits/Fixed")
        size = encoding.find("SizeInBits") if size is None else size
        bits = (
            fixed(size)
            if default is None
            else number(encoding.get("sizeInBits", default), "a size")
        )
        if bits is None or not (
            1 <= bits <= _WORD or (bits % 8 == 0 and 0 < bits <= 8 * MOST_BYTES)
        ):
            raise why
        self.raw_only(
            where, str(why), "its raw bits are imported, without their meaning"
        )
        for type_ in chain:
            settle(type_)
        return XtceFieldType(
            {"type": "uint" if bits <= _WORD else "bytes"}, bits, is_raw=True
        )

    def _labels(
        self,
        field_type: XtceFieldType,
        chain: list[Element],
        element: Element,
        where: str,
    ) -> None:
        """Add the enumeration of a type with labels.

        Raises `NotSupported` if it is not an integer, or a label covers too much.
        """
        if field_type.item["type"] not in ("uint", "int"):
            raise NotSupported(
                f"{where} has labels, and is encoded as {field_type.item['type']}"
            )
        choices: dict[int, str] = {}
        for enumeration in _inside(chain, "EnumerationList/Enumeration"):
            first = number(enumeration.get("value", ""), "the value of a label")
            last = number(
                enumeration.get("maxValue") or str(first), "the value of a label"
            )
            if not 0 <= last - first < _MOST_NAMED:
                raise NotSupported(
                    f"{where} has a label for the values {first} to {last}"
                )
            self.step(last - first + 1)
            for value in range(first, last + 1):
                choices.setdefault(value, enumeration.get("label", ""))
        # Reversed: of equal labels, the first value counts.
        field_type.values = {label: value for value, label in reversed(choices.items())}
        notes = self.heard(f"labels of {id(element)}")  # report once per type
        called = _enumeration_name(element)
        self.enums.assign_value_names(
            field_type.item,
            field_type.bits,
            choices,
            called,
            self._owner(element),
            f"`{called}`",
            notes,
        )

    def _owner(self, element: Element) -> str:
        """Return the name of the system that contains a type."""
        return self.names.system(element).rsplit("/", 1)[-1]

    def _flag(
        self, field_type: XtceFieldType, chain: list[Element], element: Element
    ) -> None:
        """Make a field a flag, or an enumeration of two members if it has several bits.

        Raises `NotSupported`.
        """
        if field_type.item["type"] not in ("uint", "int"):
            raise NotSupported(f"a flag is encoded as {field_type.item['type']}")
        label_of_0 = _attribute(chain, "zeroStringValue", "False")
        label_of_1 = _attribute(chain, "oneStringValue", "True")
        # Comparisons may use the words of XML instead of the labels.
        field_type.values = {label_of_0: 0, label_of_1: 1, "false": 0, "true": 1}
        if field_type.bits == 1:
            field_type.item["type"] = "bool"
            return
        choices, called = (
            {
                0: line(label_of_0, 60),
                1: line(label_of_1, 60),
            },
            _enumeration_name(element),
        )
        self.enums.assign_value_names(
            field_type.item,
            field_type.bits,
            choices,
            called,
            self._owner(element),
            f"`{called}`",
            self.to,
        )

    def _calibrated(
        self,
        field_type: XtceFieldType,
        chain: list[Element],
        encoding: Element | None,
        kind: str,
        where: str,
    ) -> bool:
        """Add the calibration of a number, and return whether it is supported.

        If not, the raw value is imported.
        """
        try:
            is_time = kind in ("AbsoluteTime", "RelativeTime")
            if is_time:
                keys = _time(field_type.item, chain)
            else:
                keys = {} if encoding is None else calibration(encoding)
        except ValueError as error:
            self.raw_only(
                where, str(error), "its raw values are imported, without the unit"
            )
            for type_ in chain:
                settle(type_)
            return False
        if "points" in keys and field_type.item["type"] != "float":
            keys = simplified_table(
                keys, field_type.bits, field_type.item["type"] == "int"
            )
        field_type.item |= keys
        return True

    def _limits(self, item: Item, chain: list[Element]) -> Item:
        """Return the limits of the valid range.

        Empty if there are several, or it applies to raw values of a calibrated number.
        """
        ranges = list(_inside(chain, *_RANGES))
        owners = [
            owner
            for type_ in chain
            if (owner := type_.find("ValidRangeSet")) is not None
        ]
        of_raw = any(
            owner.get("validRangeAppliesToCalibrated") == "false"
            for owner in (*ranges, *owners)
        )
        if len(ranges) != 1 or (of_raw and item.keys() & {"formula", "points"}):
            return {}
        result: Item = {}
        for attribute, key in _LIMITS.items():
            if match := NUMBER.match(ranges[0].get(attribute, "")):
                value = Fraction(match[1])
                exact = value.numerator if value.denominator == 1 else float(value)
                if "e" not in str(exact):
                    result[key] = exact
        return result


def repeated(field_type: XtceFieldType, count: int, where: str) -> XtceFieldType:
    """Return an array of a field, or the field itself if ``count`` is 1.

    Raises `NotSupported`.
    """
    return field_type if count == 1 else _array(field_type, count, where)


def _array(field_type: XtceFieldType, count: int, where: str) -> XtceFieldType:
    """Return an array of ``count`` elements of a fixed size. Raises `NotSupported`."""
    if field_type.members or "count" in field_type.item or not field_type.bits:
        raise NotSupported(f"{where} is an array of elements of variable size")
    if not 1 <= count <= MOST_ELEMENTS:
        raise NotSupported(f"{where} is an array of {count} elements")
    field_type.item |= {"bits": field_type.bits, "count": count}
    return XtceFieldType(
        field_type.item,
        field_type.bits * count,
        field_type.order,
        values=field_type.values,
    )


def _counted(field_type: XtceFieldType, dynamic: Element, where: str) -> XtceFieldType:
    """Return an array with a last index that a parameter or argument gives.

    Raises `NotSupported` if it is not supported.
    """
    name, slope, intercept = _adjusted(dynamic)
    if (
        field_type.members
        or "count" in field_type.item
        or not field_type.bits
        or field_type.bits % 8
    ):
        raise NotSupported(
            f"{where} is an array of elements without a fixed size in bytes"
        )
    if not name or slope != 1 or intercept is None:
        raise NotSupported(
            f"{where} is an array of a number of elements that no parameter counts"
        )
    most = min(MOST_ELEMENTS, MOST_BYTES * 8 // field_type.bits)
    field_type.item |= {"bits": field_type.bits, "count": "rest", "up_to": most}
    return XtceFieldType(
        field_type.item, 0, field_type.order, size=name, plus=intercept + 1
    )


def special_values(element: Element) -> Item:
    """Return the special values of a parameter or argument, which icdgen writes as
    ancillary data.
    """
    result = []
    for name, text in ancillary_data(element).items():
        kind, _, value = name.partition(" ")
        if (
            kind == "special"
            and text
            and (value in ("nan", "inf", "-inf") or NUMBER.match(value))
        ):
            number: float | str = value
            if value[-1] not in "nf":  # neither `nan` nor `inf`
                number = float(value) if set(value) & set(".e") else int(value)
            result.append({"value": number, "meaning": text})
    return {"special": result[:_MOST_NAMED]} if result else {}


def _description(element: Element) -> str:
    """Return the short and the long description of an element, without repetition."""
    parts = (
        element.get("shortDescription"),
        next((child.text for child in element.iterfind("LongDescription")), None),
    )
    texts = [text for text in map(line, parts) if text]
    if len(texts) == 2 and (texts[0] in texts[1] or texts[1] in texts[0]):
        texts = [max(texts, key=len)]
    return " ".join(
        text if text.endswith((".", "!", "?")) or len(texts) == 1 else f"{text}."
        for text in texts
    )


def _time(item: Item, chain: list[Element]) -> dict[str, Any]:
    """Return the formula of a time from its scale and offset, and add the unit to
    ``item``.

    Raises `ValueError` if scale or offset is not a number.
    """
    of = next(
        (element for type_ in chain for element in type_.iterfind("Encoding")), None
    )
    if of is None:
        return {}
    text = formula(
        {1: decimal(of.get("scale", "1")), 0: decimal(of.get("offset", "0"))}
    )
    item |= unit({"seconds": "s"}.get(of.get("units", "seconds"), of.get("units", "")))
    return {"formula": text} if text else {}


def described(*elements: Element) -> dict[str, str]:
    """Return the summary of the first element that has a description."""
    return summary(next((text for text in map(_description, elements) if text), ""))


def _inside(chain: list[Element], *paths: str) -> Iterator[Element]:
    """Yield the elements of types at each of the paths."""
    for type_ in chain:
        for path in paths:
            yield from type_.iterfind(path)


def _below(chain: list[Element]) -> Iterator[Element]:
    """Yield the children of types.

    The encoding of a time is within another element, `Encoding`.
    """
    for type_ in chain:
        yield from type_
        yield from type_.iterfind("Encoding/*")


def _numbers(type_: str, bits: int, order: str) -> XtceFieldType:
    """Return an integer of 1 to 64 bits, or a float of 32 or 64 bits.

    Raises `NotSupported` for other widths.
    """
    if type_ == "float" and bits not in (32, 64):
        raise NotSupported(f"a float has {bits} bits")
    if not 1 <= bits <= 64:
        raise NotSupported(f"an integer has {bits} bits")
    return XtceFieldType({"type": type_}, bits, order)


def _order(encoding: Element) -> str:
    """Return the byte order of an encoding: an attribute in XTCE 1.2, a list of bytes
    in 1.1.

    Raises `NotSupported`.
    """
    order = encoding.get("byteOrder", "mostSignificantByteFirst")
    bytes_ = [
        number(element.get("byteSignificance", ""), "a byte")
        for element in encoding.iterfind("ByteOrderList/Byte")
    ]
    if order == "leastSignificantByteFirst" or (
        len(bytes_) > 1 and bytes_ == sorted(bytes_)
    ):
        return LITTLE
    if order != "mostSignificantByteFirst" or bytes_ != sorted(bytes_, reverse=True):
        raise NotSupported(
            f"its bytes are sent in the order {bytes_ or line(order, 60)}"
        )
    return BIG


def _bytes(encoding: Element, type_: str) -> XtceFieldType:
    """Return text or bytes of a fixed or variable length.

    Raises `NotSupported` for length prefixes and terminators.
    """
    size = encoding.find("SizeInBits")
    if size is None:
        variable = encoding.find("Variable")
        return _open(type_, encoding if variable is None else variable)
    if size.find("LeadingSize") is not None:
        raise NotSupported("it has a length prefix")
    # A text of an ICD ends at the first NUL anyway; other terminators have no key.
    if (end := size.find("TerminationChar")) is not None and (end.text or "00").strip(
        "0"
    ):
        raise NotSupported(f"it ends at the byte `{line(end.text, 20)}`")
    bits = fixed(size.find("Fixed")) if size.find("Fixed") is not None else fixed(size)
    if bits is None:
        return _open(type_, size)
    if type_ == "text" and encoding.get("encoding", "UTF-8") not in (
        "UTF-8",
        "US-ASCII",
        "ISO-8859-1",
    ):
        type_ = "bytes"
    if bits % 8 and type_ == "bytes":
        return _numbers("uint", bits, BIG)
    if bits < 8 or bits % 8:
        raise NotSupported(f"text or bytes have {bits} bits")
    return XtceFieldType({"type": type_}, bits)


def _open(type_: str, of: Element) -> XtceFieldType:
    """Return text or bytes of a length that another parameter gives.

    Raises `NotSupported` if there is no parameter.
    """
    dynamic = of.find("DynamicValue")
    name, slope, intercept = ("", 0, None) if dynamic is None else _adjusted(dynamic)
    if not name:
        raise NotSupported("its size is neither a number nor that of a parameter")
    plus = (
        intercept // 8
        if slope == 8 and intercept is not None and intercept % 8 == 0
        else None
    )
    return XtceFieldType(
        {"type": type_, "size": "rest", "up_to": MOST_BYTES}, 0, size=name, plus=plus
    )


def _adjusted(dynamic: Element) -> tuple[str, int, int | None]:
    """Return the parameter or argument of a `DynamicValue`, its factor and its offset.

    The factor is 0 and the offset None if one of them is not an integer. The name is
    empty without a reference.
    """
    reference = next(
        (child for child in dynamic if child.tag.endswith("InstanceRef")), None
    )
    if reference is None:
        return "", 0, None
    name = reference.get("parameterRef") or reference.get("argumentRef") or ""
    adjustment, terms = dynamic.find("LinearAdjustment"), []
    for key, default in _LINE:
        match = NUMBER.match(
            default if adjustment is None else adjustment.get(key, default)
        )
        if match is None or (value := Fraction(match[1])).denominator != 1:
            return name, 0, None
        terms.append(value.numerator)
    return name, terms[0], terms[1]


def _unit(chain: list[Element]) -> dict[str, str]:
    """Return the unit of the first type that has one: `m` and `s` to the power of -2
    are `m/s^2`.
    """
    # Many are empty.
    sets = [element for type_ in chain for element in type_.iterfind("UnitSet")]
    units = next(
        (matches for unit_set in sets if (matches := unit_set.findall("Unit"))), []
    )
    parts = ""
    for element in units:
        power, text = element.get("power", "1"), line("".join(element.itertext()), 60)
        try:
            exponent = float(power)
        except ValueError:
            exponent = 1.0
        if text:
            if parts:
                parts += "/" if exponent < 0 else "."
                exponent = abs(exponent)
            parts += text if exponent == 1 else f"{text}^{exponent:g}"
    return unit(parts)


def _attribute(chain: list[Element], name: str, default: str) -> str:
    """Return an attribute of a type or the nearest base type that has it."""
    return next(
        (type_.attrib[name] for type_ in chain if name in type_.attrib), default
    )


def _enumeration_name(element: Element) -> str:
    """Return the name of the enumeration of a type."""
    return alias(element) or without_type(element.get("name", ""))
