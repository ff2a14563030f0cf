"""Fields of a container with their positions, and constants from fixed values,
constraints and lengths.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from xml.etree.ElementTree import Element

from icdgen.definitions import containers, eds_ranges
from icdgen.definitions.eds_sheets import Sheets
from icdgen.definitions.eds_types import Piece, Types
from icdgen.definitions.eds_values import coded, evaluate
from icdgen.definitions.model import NotSupported, replace_keys
from icdgen.definitions.wording import line
from icdgen.frozen import NamedTuple
from icdgen.icd.fmt.emit import Spelled

_INTEGERS = ("uint", "int")
_MOST_FIXED = 64  # bits of a text that is a constant


@dataclass
class Part(containers.Part):
    """Entry of a data sheet with its position."""

    entry: Element = field(kw_only=True)
    piece: Piece | None = None  # of a scalar


class Told(NamedTuple):
    """Constraint of a data sheet, with the path of the constrained entry."""

    path: tuple[str, ...]
    constraint: Element


class Line(NamedTuple):
    """Linear conversion of a length field into bytes."""

    factor: Fraction
    offset: Fraction


def only(piece: Piece, raw: int, name: str) -> None:
    """Make a raw value the constant of a field.

    Raises `NotSupported` if the field already has another constant.
    """
    item = piece.item
    containers.check_only_value(item, raw, name)
    # The ICD has no constants of type `bool`.
    kind = {"type": "uint"} if item["type"] == "bool" else {}
    remaining = {
        key: value
        for key, value in item.items()
        if key not in ("min", "max", "special")
    }
    replace_keys(item, {**remaining, **kind, "const": raw})


def fix(piece: Piece, text: str, name: str) -> None:
    """Set the fixed value of a `FixedValueEntry`.

    A text of up to 64 bits becomes a number with its bytes.

    Raises `NotSupported` if the value does not fit the type. Longer texts, bytes and
    floats have no constant.
    """
    if piece.item["type"] == "text" and piece.bits:
        data = text.encode("utf-8", "replace").ljust(piece.bits // 8, b"\0")
        if len(data) > piece.bits // 8:
            raise NotSupported(f"`{name}` is longer than its type: `{line(text, 60)}`")
        if piece.bits <= _MOST_FIXED:
            replace_keys(
                piece.item,
                {"type": "uint", "const": Spelled(f"0x{data.hex().upper()}")},
            )
    elif piece.item["type"] not in ("text", "bytes", "float"):
        only(piece, piece.raw(text, f"`{name}`"), name)


def constrain(
    part: Part | None, condition: Told, sheets: Sheets, types: Types
) -> int | None:
    """Apply a constraint to a part.

    Return the raw value that it requires, or None if it only narrows the range.

    Raises `NotSupported` for other constraints, and if the part is missing or an array.
    """
    element, name = condition.constraint, line(".".join(condition.path), 100)
    if part is None or part.piece is None or part.bits != part.piece.bits:
        raise NotSupported(f"it depends on `{name}`, but it has no such field")
    piece, where = part.piece, f"it depends on `{name}`, which"
    if element.tag == "ValueConstraint":
        raw = piece.raw(sheets.attribute(element, "value"), where)
    elif element.tag in ("RangeConstraint", "TypeConstraint"):
        labels = [
            (label.text or "").strip()
            for label in element.iterfind("EnumeratedRange/Label")
        ]
        narrowed = _range_of_constraint(element, sheets, types)
        low, high = narrowed.of_integers()
        if len(labels) == 1:
            raw = piece.raw(labels[0], where)
        elif (
            not labels
            and low is not None
            and low == high
            and piece.item["type"] in _INTEGERS
        ):
            raw = piece.raw(str(int(low)), where)
        elif (
            not labels
            and piece.item["type"] in (*_INTEGERS, "float")
            and narrowed != eds_ranges.ALL
        ):
            piece.range = piece.range.within(narrowed)
            if not piece.item.keys() & {"formula", "points", "const", "special"}:
                piece.item.update(
                    eds_ranges.limited(piece.item, piece.bits, piece.range)
                )
            return None
        else:
            raise NotSupported(f"{where} has one of several values")
    else:
        raise NotSupported(f"it is constrained by a `{line(element.tag, 60)}`")
    only(piece, raw, name)
    return raw


def _range_of_constraint(
    constraint: Element, sheets: Sheets, types: Types
) -> eds_ranges.Range:
    """Return the range of a `RangeConstraint`, or of the type of a `TypeConstraint`."""
    if constraint.tag == "RangeConstraint":
        return eds_ranges.said(sheets, constraint)
    type_ = sheets.find("type", sheets.attribute(constraint, "type"), constraint)
    return types.piece(type_, type_, f"`{type_.get('name', '')}`").range


def measure(part: Part, length: int, sheets: Sheets) -> None:
    """Make a length entry constant, from the ``length`` of its container in bytes.

    Nothing changes if the raw value is not an integer or does not fit. Raises
    `NotSupported` for a contradicting constant.
    """
    conversion = line_of(part.entry, sheets)
    if (
        conversion is None
        or part.piece is None
        or part.item["type"] not in _INTEGERS
        or "const" in part.item
    ):
        return
    # length = factor * raw + offset
    raw = (length - conversion.offset) / conversion.factor
    if (
        raw.denominator == 1
        and (value := coded(int(raw), part.piece.code, part.bits)) is not None
    ):
        only(part.piece, value, part.path[-1])


def line_of(entry: Element, sheets: Sheets) -> Line | None:
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
    return Line(coefficients["1"], coefficients["0"]) if coefficients["1"] else None
