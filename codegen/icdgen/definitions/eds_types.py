"""Scalar types of electronic data sheets as fields: encoding, labels, calibration and
limits.

`EdsTypes.field_type` is the entry point. It returns the field without its position,
which `eds_layout` adds.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from xml.etree.ElementTree import Element

from icdgen.definitions import containers, eds_ranges
from icdgen.definitions.eds_ranges import ALL, Range
from icdgen.definitions.eds_sheets import Sheets
from icdgen.definitions.eds_values import (
    CODES,
    TWOS,
    UNSIGNED,
    encoded_value,
    integer_value,
)
from icdgen.definitions.frames import BIG, LITTLE
from icdgen.definitions.model import Item, NotSupported
from icdgen.definitions.reading import ReadingState
from icdgen.definitions.wording import line, summary, unit, without_type
from icdgen.definitions.xtce_calibration import calibrated
from icdgen.icd.variable_length import MOST_BYTES

# Help text of findings.
_BITS_ONLY = "its raw bits are imported as a number, without unit and limits"
CONTAINER, ARRAY, SUBRANGE = "ContainerDataType", "ArrayDataType", "SubRangeDataType"
_DEEPEST = 20  # levels of subranges
_WORD = 64  # bits of the largest number
_FLOATS = {"ieee754_2008_single": 32, "ieee754_2008_double": 64}
_SI = {
    "second": "s", "metre": "m", "meter": "m", "kilogram": "kg", "gram": "g", "ampere": "A", "kelvin": "K", "volt": "V",
    "watt": "W", "newton": "N", "pascal": "Pa", "joule": "J", "hertz": "Hz", "ohm": "ohm", "tesla": "T",
    "radian": "rad", "degree": "deg", "degreescelsius": "C", "degreecelsius": "C", "percent": "%", "bit": "bit",
}  # fmt: skip
_MARKUP = re.compile(r"(?<!\S)[\\@][A-Za-z]\w*\s*")  # of Doxygen


@dataclass
class EdsFieldType(containers.FieldType):
    """Field of a type, with integer encoding, labels and range of raw values."""

    code: str = UNSIGNED  # integer encoding; empty for other types
    values: dict[str, int] = field(default_factory=dict)  # raw values by label
    range: Range = ALL

    def raw(self, text: str, where: str) -> int:
        """Return the raw value of a literal or label.

        Raises `NotSupported` if the field cannot have this value.
        """
        if self.item["type"] not in ("uint", "int", "enum", "bool"):
            raise NotSupported(
                f"{where} has a value and is of the type {self.item['type']}"
            )
        if (
            label := text if self.code else text.lower()
        ) in self.values:  # labels of flags ignore case
            return self.values[label]
        try:
            raw = (
                encoded_value(integer_value(text, "a value"), self.code, self.bits)
                if self.code
                else None
            )
        except NotSupported:
            raw = None
        if raw is None:
            raise NotSupported(f"{where} is never `{line(text, 60)}`")
        return raw


@dataclass
class EdsTypes(ReadingState):
    """Factory of fields and enumerations from types."""

    most_steps = 500_000  # types and labels of all messages

    sheets: Sheets

    def chain(self, type_: Element) -> list[Element]:
        """Return a type, followed by its base types if it is a subrange.

        Raises `NotSupported` for circular or too deep references.
        """
        chain = [type_]
        while chain[-1].tag == SUBRANGE:
            base = self.sheets.find_element(
                "type", self.sheets.attribute(chain[-1], "baseType"), chain[-1]
            )
            if base in chain or len(chain) >= _DEEPEST:
                raise NotSupported(
                    f"the type `{type_.get('name', '')}` is based on itself, or on too many others"
                )
            chain.append(base)
        return chain

    def field_type(self, type_: Element, entry: Element, where: str) -> EdsFieldType:
        """Return the field of a scalar type.

        The encoding of the entry takes precedence over that of the type.

        ``where`` names the field in messages. Raises `NotSupported` with the reason if
        the type is not supported.
        """
        self.step()
        chain = self.chain(type_)
        kind = chain[-1].tag.removesuffix("DataType")
        encoding = next(
            (
                inner
                for element in (entry, *chain)
                for inner in element
                if inner.tag.endswith("DataEncoding")
            ),
            None,
        )
        if kind in ("Integer", "Enumerated"):
            field_type = self._integer(encoding, where, kind == "Enumerated")
        elif kind == "Boolean":
            field_type = self._flag(encoding, chain[-1])
        elif kind == "Float":
            field_type = self._float(encoding, where)
        elif kind == "String":
            field_type = self._text(encoding, chain[-1])
        elif kind == "Binary":
            field_type = self._binary(chain[-1])
        else:
            raise NotSupported(f"{where} is a `{line(chain[-1].tag, 60)}`")
        if kind == "Enumerated":
            self._labels(field_type, chain[-1], where)
        field_type.range = self._range(chain, entry)
        if field_type.item["type"] in ("uint", "int", "float") and field_type.code in (
            UNSIGNED,
            TWOS,
        ):
            field_type.item |= self._meaning(chain, entry, field_type, where)
        return field_type

    def _integer(
        self, encoding: Element | None, where: str, has_names: bool
    ) -> EdsFieldType:
        if encoding is None or encoding.tag != "IntegerDataEncoding":
            raise NotSupported(f"{where} has a type without an encoding")
        code = self._keyword(encoding, "encoding", UNSIGNED, CODES)
        bits = self._size(encoding, where)
        order = self._order(encoding, bits, where)
        # Labels are assigned to the transmitted bits, so enumerations support all
        # encodings.
        if code not in (UNSIGNED, TWOS) and not has_names:
            self.raw_only(where, f"it is encoded as {code}", _BITS_ONLY)
        if bits > _WORD:
            return _bytes(bits, where)
        return EdsFieldType(
            {"type": "int" if code == TWOS else "uint"}, bits, order, code
        )

    def _float(self, encoding: Element | None, where: str) -> EdsFieldType:
        if encoding is None or encoding.tag != "FloatDataEncoding":
            raise NotSupported(f"{where} has a type without an encoding")
        precision = self.sheets.attribute(
            encoding, "encodingAndPrecision", "IEEE754_2008_single"
        )
        bits = self._size(encoding, where, _FLOATS.get(precision.lower()))
        order = self._order(encoding, bits, where)
        if _FLOATS.get(precision.lower()) == bits:
            return EdsFieldType({"type": "float"}, bits, order)
        self.raw_only(
            where, f"it is encoded as {line(precision, 60)} of {bits} bits", _BITS_ONLY
        )
        return (
            _bytes(bits, where)
            if bits > _WORD
            else EdsFieldType({"type": "uint"}, bits, order, "")
        )

    def _flag(self, encoding: Element | None, type_: Element) -> EdsFieldType:
        bits = (
            1
            if encoding is None
            else self._size(encoding, f"`{type_.get('name', '')}`")
        )
        is_inverse = (
            encoding is not None
            and self.sheets.attribute(encoding, "falseValue").lower()
            == "nonzeroisfalse"
        )
        if bits > _WORD:
            raise NotSupported(f"the flag `{type_.get('name', '')}` has {bits} bits")
        names = ("True", "False") if is_inverse else ("False", "True")
        values = {name.lower(): value for value, name in enumerate(names)}
        field_type = EdsFieldType({"type": "bool"}, bits, code="", values=values)
        # The type `bool` has one bit, and 1 means true.
        if bits > 1 or is_inverse:
            members: list[Item] = [
                {"value": value, "name": name} for value, name in enumerate(names)
            ]
            field_type.item = {"type": "enum"}
            self.enums.assign_enumeration(
                field_type.item, _enumeration_name(type_), self._owner(type_), members
            )
        return field_type

    def _text(self, encoding: Element | None, type_: Element) -> EdsFieldType:
        length = integer_value(
            self.sheets.attribute(type_, "length"),
            "the length of a text",
            1,
            MOST_BYTES,
        )
        ends = (
            ""
            if encoding is None
            else self.sheets.attribute(encoding, "terminationCharacter")
        )
        if self.sheets.attribute(type_, "fixedLength", "true").lower() not in (
            "false",
            "0",
        ):
            return EdsFieldType({"type": "text"}, 8 * length)
        if ends:
            raise NotSupported(
                f"`{type_.get('name', '')}` ends at the character `{line(ends, 20)}`"
            )
        return EdsFieldType({"type": "text", "up_to": length}, 0)

    def _binary(self, type_: Element) -> EdsFieldType:
        bits = self._size(type_, f"`{type_.get('name', '')}`")
        if self.sheets.attribute(type_, "fixedSize", "true").lower() in ("false", "0"):
            if bits % 8:
                raise NotSupported(f"`{type_.get('name', '')}` has up to {bits} bits")
            return EdsFieldType({"type": "bytes", "up_to": bits // 8}, 0)
        if bits % 8 and bits <= _WORD:
            return EdsFieldType({"type": "uint"}, bits)
        return _bytes(bits, f"`{type_.get('name', '')}`")

    def _size(self, encoding: Element, where: str, default: int | None = None) -> int:
        text = self.sheets.attribute(
            encoding, "sizeInBits", "" if default is None else str(default)
        )
        return integer_value(text, f"the size of {where}", 1, 8 * MOST_BYTES)

    def _order(self, encoding: Element, bits: int, where: str) -> str:
        is_little = (
            self._keyword(
                encoding, "byteOrder", "bigEndian", ("bigEndian", "littleEndian")
            )
            == "littleEndian"
        )
        if is_little and bits % 8:
            raise NotSupported(
                f"the least significant byte of {where}, of {bits} bits, is sent first"
            )
        return LITTLE if is_little else BIG

    def _keyword(
        self, element: Element, key: str, default: str, keywords: tuple[str, ...]
    ) -> str:
        """Return the keyword in ``keywords`` that an attribute matches, ignoring case.

        Raises `NotSupported` if none matches.
        """
        text = self.sheets.attribute(element, key, default)
        keyword = next(
            (candidate for candidate in keywords if candidate.lower() == text.lower()),
            None,
        )
        if keyword is None:
            raise NotSupported(f"its `{key}` is `{line(text, 60)}`")
        return keyword

    def _labels(self, field_type: EdsFieldType, type_: Element, where: str) -> None:
        choices: dict[int, str] = {}
        for label, value in self.sheets.labels(type_):
            self.step()
            raw = (
                encoded_value(value, field_type.code, field_type.bits)
                if field_type.item["type"] != "bytes"
                else None
            )
            if raw is None:
                raise NotSupported(
                    f"{where} never has the value `{value}` of `{line(label, 60)}`"
                )
            choices.setdefault(raw, label)
            field_type.values.setdefault(label, raw)
        if not choices:
            return
        notes = self.heard(f"labels of {id(type_)}")  # report faults of a type once
        name = _enumeration_name(type_)
        self.enums.assign_value_names(
            field_type.item,
            field_type.bits,
            choices,
            name,
            self._owner(type_),
            f"`{name}`",
            notes,
        )

    def _owner(self, type_: Element) -> str:
        return self.sheets.package(type_).rsplit("/", 1)[-1]

    def _range(self, chain: list[Element], entry: Element) -> Range:
        result = ALL
        for element in (*chain, entry):
            for bounds in (
                inner for inner in element if inner.tag in ("Range", "ValidRange")
            ):
                result = result.within(eds_ranges.stated_range(self.sheets, bounds))
        return result

    def _meaning(
        self, chain: list[Element], entry: Element, field_type: EdsFieldType, where: str
    ) -> Item:
        """Return calibration and unit of the entry, and the limits of its type.

        A calibrated field gets no limits, because the calibration converts them.
        """
        item: Item = {}
        try:
            # The calibration of a length entry converts to the bytes of the container.
            if entry.tag != "LengthEntry":
                item |= calibrated(entry) or {}
        except ValueError as error:
            self.raw_only(where, str(error), _BITS_ONLY)
            return item
        if not item and "special" not in field_type.item and field_type.range != ALL:
            item |= eds_ranges.limited(
                field_type.item, field_type.bits, field_type.range
            )
        return {**self._unit((entry, *chain)), **item}

    def _unit(self, chain: tuple[Element, ...]) -> Item:
        for type_ in chain:
            for element in (type_.find("Semantics"), type_):
                for key in ("unit", "units") if element is not None else ():
                    if element is not None and (
                        text := self.sheets.attribute(element, key)
                    ):
                        return {**unit(_SI.get(text.lower(), text))}
        return {}


def described(element: Element) -> dict[str, str]:
    """Return the `summary` key from the short description, or else from the first
    paragraph of the long description.
    """
    paragraphs = re.split(
        r"\n[ \t\r]*\n", (element.findtext("LongDescription") or "")[:20_000]
    )
    texts = (
        _MARKUP.sub("", text)
        for text in (element.get("shortDescription") or "", *paragraphs)
    )
    return next((item for item in map(summary, texts) if item), {})


def _enumeration_name(type_: Element) -> str:
    """Return the name of an enumeration, without a suffix for `type`."""
    return without_type(line(type_.get("name"), 60))


def _bytes(bits: int, where: str) -> EdsFieldType:
    """Return a field of bytes, for numbers that exceed 64 bits.

    Raises `NotSupported` for a partial byte.
    """
    if bits % 8:
        raise NotSupported(f"{where} has {bits} bits")
    return EdsFieldType({"type": "bytes"}, bits, code="")
