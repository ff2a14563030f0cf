"""Fields of a container with their positions, and constants from fixed values,
constraints and lengths.

`eds_layout` creates the parts in the order of the frame. The functions here change the
type of a part when its value is fixed.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from xml.etree.ElementTree import Element

from icdgen.definitions import containers, eds_ranges
from icdgen.definitions.eds_sheets import Sheets
from icdgen.definitions.eds_types import EdsFieldType, EdsTypes
from icdgen.definitions.eds_values import encoded_value, evaluate
from icdgen.definitions.model import NotSupported, replace_keys
from icdgen.definitions.wording import line
from icdgen.frozen import NamedTuple
from icdgen.icd.fmt.emit import Spelled

_INTEGERS = ("uint", "int")
_MOST_FIXED = 64  # bits of a text that is a constant


@dataclass
class EdsPart(containers.ContainerPart):
    """Entry of a data sheet with its position."""

    entry: Element = field(kw_only=True)
    field_type: EdsFieldType | None = None  # of a scalar


class Constraint(NamedTuple):
    """Constraint of a data sheet, with the path of the constrained entry."""

    path: tuple[str, ...]
    constraint: Element


class LinearConversion(NamedTuple):
    """Linear conversion of a length field into bytes."""

    factor: Fraction
    offset: Fraction


def fix_raw_value(field_type: EdsFieldType, raw: int, name: str) -> None:
    """Make a raw value the constant of a field.

    Raises `NotSupported` if the field already has another constant.
    """
    item = field_type.item
    containers.check_only_value(item, raw, name)
    # The ICD has no constants of type `bool`.
    kind = {"type": "uint"} if item["type"] == "bool" else {}
    remaining = {
        key: value
        for key, value in item.items()
        if key not in ("min", "max", "special")
    }
    replace_keys(item, {**remaining, **kind, "const": raw})


def set_fixed_value(field_type: EdsFieldType, text: str, name: str) -> None:
    """Set the fixed value of a `FixedValueEntry`.

    A text of up to 64 bits becomes a number with its bytes.

    Raises `NotSupported` if the value does not fit the type. Longer texts, bytes and
    floats have no constant.
    """
    if field_type.item["type"] == "text" and field_type.bits:
        data = text.encode("utf-8", "replace").ljust(field_type.bits // 8, b"\0")
        if len(data) > field_type.bits // 8:
            raise NotSupported(f"`{name}` is longer than its type: `{line(text, 60)}`")
        if field_type.bits <= _MOST_FIXED:
            replace_keys(
                field_type.item,
                {"type": "uint", "const": Spelled(f"0x{data.hex().upper()}")},
            )
    elif field_type.item["type"] not in ("text", "bytes", "float"):
        fix_raw_value(field_type, field_type.raw(text, f"`{name}`"), name)


def apply_constraint(
    part: EdsPart | None, condition: Constraint, sheets: Sheets, types: EdsTypes
) -> int | None:
    """Apply a constraint to a part.

    Return the raw value that it requires, or None if it only narrows the range.

    Raises `NotSupported` for other constraints, and if the part is missing or an array.
    """
    element, name = condition.constraint, line(".".join(condition.path), 100)
    if part is None or part.field_type is None or part.bits != part.field_type.bits:
        raise NotSupported(f"it depends on `{name}`, but it has no such field")
    field_type, where = part.field_type, f"it depends on `{name}`, which"
    if element.tag == "ValueConstraint":
        raw = field_type.raw(sheets.attribute(element, "value"), where)
    elif element.tag in ("RangeConstraint", "TypeConstraint"):
        labels = [
            (label.text or "").strip()
            for label in element.iterfind("EnumeratedRange/Label")
        ]
        narrowed = _range_of_constraint(element, sheets, types)
        low, high = narrowed.of_integers()
        if len(labels) == 1:
            raw = field_type.raw(labels[0], where)
        elif (
            not labels
            and low is not None
            and low == high
            and field_type.item["type"] in _INTEGERS
        ):
            raw = field_type.raw(str(int(low)), where)
        elif (
            not labels
            and field_type.item["type"] in (*_INTEGERS, "float")
            and narrowed != eds_ranges.ALL
        ):
            field_type.range = field_type.range.within(narrowed)
            if not field_type.item.keys() & {"formula", "points", "const", "special"}:
                field_type.item.update(
                    eds_ranges.limited(
                        field_type.item, field_type.bits, field_type.range
                    )
                )
            return None
        else:
            raise NotSupported(f"{where} has one of several values")
    else:
        raise NotSupported(f"it is constrained by a `{line(element.tag, 60)}`")
    fix_raw_value(field_type, raw, name)
    return raw


def _range_of_constraint(
    constraint: Element, sheets: Sheets, types: EdsTypes
) -> eds_ranges.Range:
    """Return the range of a `RangeConstraint`, or of the type of a `TypeConstraint`."""
    if constraint.tag == "RangeConstraint":
        return eds_ranges.stated_range(sheets, constraint)
    type_ = sheets.find_element(
        "type", sheets.attribute(constraint, "type"), constraint
    )
    return types.field_type(type_, type_, f"`{type_.get('name', '')}`").range


def set_length(part: EdsPart, length: int, sheets: Sheets) -> None:
    """Make a length entry constant, from the ``length`` of its container in bytes.

    Nothing changes if the raw value is not an integer or does not fit. Raises
    `NotSupported` for a contradicting constant.
    """
    conversion = line_of(part.entry, sheets)
    if (
        conversion is None
        or part.field_type is None
        or part.item["type"] not in _INTEGERS
        or "const" in part.item
    ):
        return
    # length = factor * raw + offset
    raw = (length - conversion.offset) / conversion.factor
    if (
        raw.denominator == 1
        and (value := encoded_value(int(raw), part.field_type.code, part.bits))
        is not None
    ):
        fix_raw_value(part.field_type, value, part.path[-1])


def line_of(entry: Element, sheets: Sheets) -> LinearConversion | None:
    """Return the linear conversion of a length entry, or None if its calibrator is not
    linear.
    """
    if entry.find("SplineCalibrator") is not None:
        return None
    # Without terms, the raw value is the number of bytes (factor 1).
    terms = entry.findall("PolynomialCalibrator/Term")
    coefficients = {"0": Fraction(0), "1": Fraction(not terms)}
    for term in terms:
        power = sheets.attribute(term, "exponent")
        if power not in coefficients:
            return None
        try:
            coefficients[power] += evaluate(sheets.attribute(term, "coefficient"))
        except ValueError:
            return None
    return (
        LinearConversion(coefficients["1"], coefficients["0"])
        if coefficients["1"]
        else None
    )
