"""Layout and meaning of an ICD, as plain values by which two models are compared."""

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

# Parts of an ICD that XTCE cannot represent, and that an import can therefore not restore.
# The comparison is limited to layout and meaning. It does not include the protocol (except
# for the header of space packets), logs, sources, errata, identifiers, acknowledges, and
# texts of enumerations.
NOT_COMPARED = {
    "open": "variable-length arrays of structs or constants, without a counter, or with optional fields",
    "early": "messages that may omit zeros at the end",
    "constant": "name, type and unit of a constant of a telecommand; its bits are compared",
    "order": "fields whose bits have an order that XTCE does not support, and overlay fields of such a message",
    "rounded": "factors that are no decimal of 24 digits: they are rounded to doubles",
    "between": "exclusive or fractional limits of integers: they become the nearest inclusive ones",
    "line": "lookup tables of two points that are extrapolated: they become linear scales",
    "clamp": "`clamp` of a lookup table on a float",
    "same": "members that share a name: the value is appended to the name",
    "long": "values of enumerations and limits beyond 63 bits",
}


def messages(icd: Icd, node: Node) -> dict[tuple[str, str], dict]:
    """Return the messages of a node that XTCE can represent, by direction and name."""
    result = {}
    for message in icd.messages_of(node):
        for direction, id in (
            ("telecommand", message.telecommand_id),
            ("telemetry", message.telemetry_id),
        ):
            if id is not None and not (
                direction == "telecommand"
                and _is_left_out(message, icd.node(message.node))
            ):
                result[direction, line(message.name)] = _message(
                    message, icd.node(message.node), direction, id
                )
    return result


def _message(message: Message, node: Node, direction: str, id: int) -> dict:
    is_sent = direction == "telecommand"
    has_views = not is_sent and all(
        is_ordered(field, node) for field in raw_fields_in(message.layout)
    )
    fields = [
        field
        for field in message.fields
        if not (field.is_count or field.derived)
        and (has_views or not field.is_read_only)
    ]
    own, parts = message.layout, message.layout.parts
    open_ = bool(parts) and not has_variable_length(message)
    fields = [
        field
        for field in fields
        if not (open_ and field.at >= own.length * 8) and is_ordered(field, node)
    ]
    runs = [(field, _bits(field, node)) for field in fields]
    fixed = [
        (field.const, bits)
        for field, bits in runs
        if field.const is not None and is_sent
    ]
    constants = {
        bit: value >> at & 1 for value, bits in fixed for at, bit in enumerate(bits)
    }
    return {
        "id": id, "is both": message.kind == "configuration" and not _is_left_out(message, node), "bytes": own.length,
        "open": _variable_part(parts[-1]) if parts and not open_ else None,
        "summary": line(message.summary), "group": line(message.group),
        "hazard": line(message.hazard) if is_sent else "", "constants": constants,
        "fields": {line(field.name): _field(field, bits) for field, bits in runs if not (fixed and field.const is not None)},
    }  # fmt: skip


def _is_left_out(message: Message, node: Node) -> bool:
    """Return whether a telecommand is left out, because XTCE cannot represent a part of
    it.
    """
    return (bool(message.layout.parts) and not has_variable_length(message)) or not all(
        is_ordered(field, node) for field in raw_fields_in(message.layout)
    )


def has_variable_length(message: Message) -> bool:
    """Return whether a message has a variable-length array that XTCE can represent."""
    parts = message.layout.parts
    if len(parts) != 1 or parts[0].is_rest or parts[0].behind or message.has_conditions:
        return False
    place = next(
        place for place in places_in(message.layout) if place.node is parts[0].node
    )
    return place.struct is None and place.const is None


def _variable_part(part: VariablePart) -> tuple[str, str, int, int]:
    return line(part.name), line(part.counter), part.most, part.plus


def is_ordered(field: NodePlace, node: Node) -> bool:
    """Return whether the bits of a field are consecutive, from the most or from the
    least significant one.
    """
    bits = _bits(field, node)
    falling = [bit // 8 * 8 + 7 - bit % 8 for bit in reversed(bits)]
    return field.is_bytes or any(
        list(range(run[0], run[0] + len(run))) == run for run in (bits, falling)
    )


def line(text: str) -> str:
    """Return the printable characters of a text in one line."""
    printable = (
        character if character.isprintable() or character == "\xa0" else " "
        for character in text
    )
    return " ".join("".join(printable).split())


def _bits(field: NodePlace, node: Node) -> list[int]:
    """Return the bits of the frame that a value has, the least significant first.

    Bit w of byte b is 8 * b + w.
    """
    if field.is_bytes:
        return list(range(field.at, field.at + field.bits))
    pieces = sorted(frame_bits.pieces(field, node), key=lambda piece: piece.at)
    return [
        8 * piece.byte + piece.shift + bit
        for piece in pieces
        for bit in range(piece.bits)
    ]


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
            (special.value, special.number): line(special.meaning)
            for special in field.special
        },
        "limits": _limits(field),
        "summary": line(field.summary),
        "view": field.is_read_only,
        "when": {
            (condition.field, tuple(sorted(condition.values)))
            for condition in field.conditions
        },
    }


def _enum(enum: Enum) -> tuple[str, dict]:
    times = Counter(member.name for member in enum.members)
    representable = [
        member
        for member in enum.members
        if member.value >= -(1 << 63) and member.last < 1 << 63
    ]
    names = {
        member: line(
            member.name if times[member.name] == 1 else f"{member.name} {member.value}"
        )
        for member in representable
    }
    return line(enum.name), {
        (member.value, member.last): name for member, name in names.items()
    }


def _scale(field: NodePlace) -> tuple[float, float] | None:
    """Return factor and offset as doubles.

    A lookup table of two points that is extrapolated is a linear scale, too.
    """
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
    # XTCE cannot represent `clamp` of a float: see `NOT_COMPARED`.
    if field.type == "float" and field.curve.outside == CLAMP:
        return {**plain, "outside": "refuse"}
    if field.type != "float" and field.curve.covers(field.raw_min, field.raw_max):
        # No raw value is outside the table: its behaviour there has no meaning.
        plain = {"points": plain["points"]} if "points" in plain else plain
    return None if _is_line(field) else plain


def _limits(field: NodePlace) -> dict:
    if field.limits is None:
        return {}
    limits = {
        key: value
        for key in ("min", "above", "max", "below")
        if (value := getattr(field.limits, key)) is not None
    }
    if field.type == "float" or field.has_formula:
        return {key: float(value) for key, value in limits.items()}
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
    inclusive = {"min": least[-1] if least else None, "max": most[-1] if most else None}
    return {
        key: value
        for key, value in inclusive.items()
        if value is not None and abs(value) < 1 << 63
    }
