"""What of an ICD is layout and meaning, as plain values that two models can be compared
by.
"""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from math import ceil, floor

from icdgen import frame_bits
from icdgen.icd.curve import CLAMP, EXTRAPOLATE
from icdgen.icd.enumeration import Enum
from icdgen.icd.layout import VariablePart
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.places import NodePlace, places_in, raw_fields_in

# What XTCE has no word for, so that it cannot come back. What is no layout and no
# meaning is not compared: protocol (but for the header of space packets), what can be
# logged, sources, errata, identifiers, acknowledges, and what is said of enumerations.
NOT_SAID = {
    "open": "open ends of structs or constants, those that nothing counts or that stand beside conditions",
    "early": "that zeros may be cut off",
    "constant": "of a constant of a telecommand all but its bits: name, type, unit",
    "order": "fields whose bits lie in no order that XTCE has, and the views of such a message",
    "rounded": "factors that are no decimal of 24 digits: they are rounded to doubles",
    "between": "limits of integers that are exclusive or no integers: the nearest inclusive ones",
    "line": "tables of two points that go on: they are lines",
    "clamp": "`clamp` of a table on a float",
    "same": "members that share a name: each has its value behind it",
    "long": "values of enumerations and limits beyond 63 bits",
}


def messages(icd: Icd, node: Node) -> dict[tuple[str, str], dict]:
    """Everything that a node speaks, by direction and name."""
    found = {}
    for one in icd.messages_of(node):
        for direction, id in (
            ("telecommand", one.telecommand_id),
            ("telemetry", one.telemetry_id),
        ):
            if id is not None and not (
                direction == "telecommand" and _lacks(one, icd.node(one.node))
            ):
                found[direction, line(one.name)] = _message(
                    one, icd.node(one.node), direction, id
                )
    return found


def _message(one: Message, node: Node, direction: str, id: int) -> dict:
    is_sent = direction == "telecommand"
    has_views = not is_sent and all(
        is_ordered(field, node) for field in raw_fields_in(one.layout)
    )
    fields = [
        field
        for field in one.fields
        if not (field.is_count or field.derived)
        and (has_views or not field.is_read_only)
    ]
    own, parts = one.layout, one.layout.parts
    open_ = bool(parts) and not has_open_end(one)
    fields = [
        field
        for field in fields
        if not (open_ and field.at >= own.length * 8) and is_ordered(field, node)
    ]
    runs = [(field, _bits(field, node)) for field in fields]
    told = [
        (field.const, bits)
        for field, bits in runs
        if field.const is not None and is_sent
    ]
    constants = {
        bit: value >> at & 1 for value, bits in told for at, bit in enumerate(bits)
    }
    return {
        "id": id, "is both": one.kind == "configuration" and not _lacks(one, node), "bytes": own.length,
        "open": _open_end(parts[-1]) if parts and not open_ else None,
        "summary": line(one.summary), "group": line(one.group),
        "hazard": line(one.hazard) if is_sent else "", "constants": constants,
        "fields": {line(field.name): _field(field, bits) for field, bits in runs if not (told and field.const is not None)},
    }  # fmt: skip


def _lacks(one: Message, node: Node) -> bool:
    """Whether a telecommand is left out, as XTCE has no word for a part of it."""
    return (bool(one.layout.parts) and not has_open_end(one)) or not all(
        is_ordered(field, node) for field in raw_fields_in(one.layout)
    )


def has_open_end(one: Message) -> bool:
    """Whether a message has an open end for which XTCE has a word."""
    parts = one.layout.parts
    if len(parts) != 1 or parts[0].is_rest or parts[0].behind or one.has_conditions:
        return False
    place = next(
        place for place in places_in(one.layout) if place.node is parts[0].node
    )
    return place.struct is None and place.const is None


def _open_end(part: VariablePart) -> tuple[str, str, int, int]:
    return line(part.name), line(part.counter), part.most, part.plus


def is_ordered(field: NodePlace, node: Node) -> bool:
    """Whether the bits of a field follow each other, from the most significant one on
    or from the least significant one.
    """
    bits = _bits(field, node)
    falling = [bit // 8 * 8 + 7 - bit % 8 for bit in reversed(bits)]
    return field.is_bytes or any(
        list(range(one[0], one[0] + len(one))) == one for one in (bits, falling)
    )


def line(text: str) -> str:
    """What can be printed of a text, in one line."""
    return " ".join(
        "".join(
            one if one.isprintable() or one == "\xa0" else " " for one in text
        ).split()
    )


def _bits(field: NodePlace, node: Node) -> list[int]:
    """The bits of the frame that a value has, the least significant first; bit w of
    byte b is 8 * b + w.
    """
    if field.is_bytes:
        return list(range(field.at, field.at + field.bits))
    pieces = sorted(frame_bits.pieces(field, node), key=lambda one: one.at)
    return [8 * one.byte + one.shift + bit for one in pieces for bit in range(one.bits)]


def _field(field: NodePlace, bits: list[int]) -> dict:
    is_number = field.type in ("uint", "int", "bool", "enum")
    return {
        "bits": bits,
        "type": field.type,
        "signed": is_number and field.is_signed,
        "enum": field.enum and _enum(field.enum),
        "unit": field.unit and field.unit.symbol,
        "scale": _scale(field),
        "curve": field.curve and _curve(field),
        "constant": field.const,
        "special": {
            (one.value, one.number): line(one.meaning) for one in field.special
        },
        "limits": _limits(field),
        "summary": line(field.summary),
        "view": field.is_read_only,
        "when": {(one.field, tuple(sorted(one.values))) for one in field.conditions},
    }


def _enum(enum: Enum) -> tuple[str, dict]:
    times = Counter(one.name for one in enum.members)
    held = [
        one for one in enum.members if one.value >= -(1 << 63) and one.last < 1 << 63
    ]
    names = {
        one: line(one.name if times[one.name] == 1 else f"{one.name} {one.value}")
        for one in held
    }
    return line(enum.name), {(one.value, one.last): name for one, name in names.items()}


def _scale(field: NodePlace) -> tuple[float, float] | None:
    """Factor and offset as doubles; a table of two points that goes on is a line, too."""
    if field.scale is not None:
        return float(field.scale.factor), float(field.scale.offset)
    if field.curve is None or not _is_line(field):
        return None
    (x0, y0), (x1, y1) = (
        map(Fraction, map(repr, point)) for point in field.curve.points
    )
    slope = (y1 - y0) / (x1 - x0)
    return float(slope), float(y0 - x0 * slope)


def _is_line(field: NodePlace) -> bool:
    return (
        field.curve is not None
        and len(field.curve.points) == 2
        and field.curve.outside == EXTRAPOLATE
    )


def _curve(field: NodePlace) -> dict | None:
    assert field.curve is not None
    plain = field.curve.plain
    if field.type == "float" and field.curve.outside == CLAMP:
        return {**plain, "outside": "refuse"}
    if field.type != "float" and field.curve.covers(field.raw_min, field.raw_max):
        plain = (
            {"points": plain["points"]} if "points" in plain else plain
        )  # nothing is outside
    return None if _is_line(field) else plain


def _limits(field: NodePlace) -> dict:
    if field.limits is None:
        return {}
    said = {
        key: value
        for key in ("min", "above", "max", "below")
        if (value := getattr(field.limits, key)) is not None
    }
    if field.type == "float" or field.has_formula:
        return {key: float(value) for key, value in said.items()}
    least = [
        ceil(said[key]) if key == "min" else floor(said[key]) + 1
        for key in ("min", "above")
        if key in said
    ]
    most = [
        floor(said[key]) if key == "max" else ceil(said[key]) - 1
        for key in ("max", "below")
        if key in said
    ]
    found = {"min": least[-1] if least else None, "max": most[-1] if most else None}
    return {
        key: value
        for key, value in found.items()
        if value is not None and abs(value) < 1 << 63
    }
