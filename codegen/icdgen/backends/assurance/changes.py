"""Every single change of what the lines of an ICD say: numbers one more and one less, types, formulas, references."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from itertools import product
from operator import is_
from typing import Any, NamedTuple, TypeVar

from icdgen import layout
from icdgen.icd import floats
from icdgen.icd.build import calibration, special
from icdgen.icd.curve import OUTSIDE, Curve, doubles, table
from icdgen.icd.derived import Derivation, parse
from icdgen.icd.formula import FormulaError
from icdgen.icd.located import Map, plain
from icdgen.icd.model import Enum, Field, Limits, Member, Message, Node, Struct
from icdgen.icd.paths import members_of

OTHER_TYPES = {
    "uint": ("int", "float", "bytes", "bool"),
    "int": ("uint", "float", "bytes"),
    "enum": ("uint", "int"),
    "bool": ("uint", "int"),
    "float": ("uint", "int", "bytes"),
    "bytes": ("uint", "int"),
    "text": ("uint", "int", "bytes"),
}
"""Types that a field of the same width could be instead."""

T = TypeVar("T", Field, Message, Node, Member)
_OTHER_ORDER = {"little": "big", "big": "little", "lsb0": "msb0", "msb0": "lsb0"}
_WIDER = {**dict.fromkeys(("uint", "int", "enum"), (-1, 1)), **dict.fromkeys(("bytes", "text"), (-8, 8))}
_LIMITS = ("min", "max", "above", "below")
_OF_SCALED = ("formula", "const", "special", *_LIMITS)  # what only numbers have


class Change(NamedTuple):
    """The value of ``key`` of ``source`` (what was read of a line) would be ``now`` instead of ``old``."""

    kind: str  # "offset", "width", "type" ...
    source: Map
    key: str
    old: object
    now: object


def of_field(field: Field, message: Message | Struct, node: Node) -> Iterator[tuple[Change, Field]]:
    """The changes of a member, and what it would be; none that no field of such a type or no frame of such a length can have."""
    size, count = 8 * message.length, field.count or 1
    source = field.source
    parts = message.open_parts
    if any(part.name == field.name for part in parts):
        # how many elements there are, and where, is no change of a field
        if not field.is_bytes and field.struct is None:
            yield from (*_types(field), *_formulas(field), *_values(field))
        return
    if parts and isinstance(message, Message):
        size = 8 * message.fixed
        if any(part.counter == field.name for part in parts):
            return  # it counts the elements: as another field it may count none
    if field.derived is not None:
        yield from _derived(field, field.derived)
        return
    if isinstance(message, Message) and any(one.field == field.name for other in message.fields for one in other.when):
        return  # others depend on it: as another field it may decide nothing
    yield from _of_conditions(field, message)
    for step in (-8, 8) if field.is_bytes or field.struct is not None else (-8, -1, 1, 8):
        if 0 <= field.at + step <= size - field.width:
            yield _step("offset", source, "at", field.at, step), replace(field, at=field.at + step)
    for step in _WIDER.get(field.type, ()):
        if 0 < (field.bits + step) * count <= size - field.at:
            yield _step("width", source, "bits", field.bits, step), replace(field, bits=field.bits + step)
    for step in (-1, 1) if field.count else ():
        if 0 < field.count + step <= (size - field.at) // field.bits:
            yield _step("count", source, "count", field.count, step), replace(field, count=field.count + step)
    yield from _readings(field, node)


def _derived(field: Field, old: Derivation) -> Iterator[tuple[Change, Field]]:
    """The changes of the formula by which it is derived."""
    for text in formulas(field.formula):
        with suppress(FormulaError):  # it would be none, or the number is one of a name
            new = parse(text, old.fields)
            if new.sense({}) != old.sense({}):
                change = Change("formula", field.source, "formula", field.formula, text)
                yield change, replace(field, formula=text, derived=new)


def _of_conditions(field: Field, message: Message | Struct) -> Iterator[tuple[Change, Field]]:
    """The changes of a value that another field must have, where one is said, by its number, to others that it can have."""
    known = {one.name: one for one in message.fields}
    for place, one in enumerate(field.when):
        said, other = field.source["when"].get(one.field), known[one.field]
        for step in (-1, 1) if type(said) is int else ():
            if not other.raw_min <= said + step <= other.raw_max:
                continue
            now = replace(one, values=(said + step,))
            changed = (*field.when[:place], now, *field.when[place + 1 :])
            yield _step("condition", field.source["when"], one.field, said, step), replace(field, when=changed)


def _readings(field: Field, node: Node) -> Iterator[tuple[Change, Field]]:
    """Changes of how its bits are read."""
    yield from _types(field)
    for key, order in zip(("byte_order", "bit_order"), field.orders(node), strict=True):
        other = _with(field, key, _OTHER_ORDER[order])
        if key in field.source and not field.is_bytes and layout.pieces(other, node) != layout.pieces(field, node):
            yield Change(key.replace("_", " "), field.source, key, order, _OTHER_ORDER[order]), other
    yield from _formulas(field)
    yield from _values(field)


def _types(field: Field) -> Iterator[tuple[Change, Field]]:
    source = field.source
    for kind in OTHER_TYPES[field.type] if "type" in source and "enum" not in source else ():
        if _can_be(field, kind):
            scale, curve = calibration(field.formula, kind)
            if "points" in source and kind in ("uint", "int", "float"):
                curve = field.curve
            yield Change("type", source, "type", field.type, kind), replace(field, type=kind, scale=scale, curve=curve)


def _formulas(field: Field) -> Iterator[tuple[Change, Field]]:
    """The changes of what the physical value is computed by."""
    if field.curve is not None and field.curve.points:
        yield from _tables(field, field.curve)
        return
    for text in formulas(field.formula) if field.has_formula else ():
        scale, curve = calibration(text, field.type)
        if scale is not None or curve is not None:  # else its factor would be 0
            change = Change("formula", field.source, "formula", field.formula, text)
            yield change, replace(field, scale=scale, curve=curve)


def _tables(field: Field, old: Curve) -> Iterator[tuple[Change, Field]]:
    source, said, outside = field.source, plain(field.source["points"]), field.source.get("outside", "")
    others = [(Change("points", source, "points", said, points), points, outside) for points in tables(said)]
    if outside and (field.type == "float" or not old.holds(field.raw_min, field.raw_max)):
        others += [(Change("outside", source, "outside", outside, now), said, now) for now in OUTSIDE if now != outside]
    for change, points, around in others:
        with suppress(FormulaError):  # it would be none
            new = table(doubles(points), around)
            if new != old:
                yield change, replace(field, curve=new)


def tables(points: list[list[Any]]) -> Iterator[list[list[Any]]]:
    """Each number of a table one more and one less."""
    for index, (place, step) in product(range(len(points)), product((0, 1), (-1, 1))):
        number = points[index][place]
        point = list(points[index])
        point[place] = (float(number) if isinstance(number, str) else number) + step
        yield [*points[:index], point, *points[index + 1 :]]


def with_struct(fields: tuple[Field, ...], old: Struct, new: Struct) -> tuple[Field, ...]:
    """The fields of a message, or of a struct, in which a struct is another; the same if it does not stand there."""
    members, found = members_of(fields), []
    for one in members:
        if one.struct is not None:
            inner = new.fields if one.struct is old else with_struct(one.struct.fields, old, new)
            one = one if inner is one.struct.fields else replace(one, struct=replace(one.struct, fields=inner))
        found.append(one)
    if all(map(is_, members, found)):
        return fields
    return tuple(element for one in found for element in one.elements)


def _values(field: Field) -> Iterator[tuple[Change, Field]]:
    """Changes of the values that have a meaning."""
    if field.const is not None:
        for step in (-1, 1):
            yield _step("const", field.source, "const", field.const, step), replace(field, const=field.const + step)
    for index, old in enumerate(field.special):
        source = field.source["special"][index]
        named = [name for name in floats.NAMED if old.number in floats.NAMED and name != old.number]
        for now in named or [source["value"] + step for step in (-1, 1)]:
            new = special(field.type, field.bits, now, old.meaning)
            if new is not None and new != old:
                change = Change("special", source, "value", source["value"], now)
                yield change, replace(field, special=(*field.special[:index], new, *field.special[index + 1 :]))
    held = field.limits or Limits()
    for key in _LIMITS:
        value: Fraction | None = getattr(held, key)
        for step in (-1, 1):
            if value is None:
                break
            limits = replace(held, **{key: value + step})
            yield _step("limit", field.source, key, field.source[key], step), replace(field, limits=limits)


def of_message(message: Message, node: Node) -> Iterator[tuple[Change, Message]]:
    """The changes of what a message says of itself."""
    source = message.source
    for key in ("id", "set_id", "get_id", "length"):
        value = getattr(message, key)
        if key == "length" and message.tail is not None:
            continue  # what is open begins where it ends
        for step in (-1, 1) if value is not None else ():
            if value + step >= 0:
                kind = "length" if key == "length" else "id"
                yield _step(kind, source, key, value, step), _with(message, key, value + step)
    for key in ("byte_order", "bit_order"):
        if key in source:
            now = _OTHER_ORDER[source[key]]
            fields = tuple(one if key in one.source else _with(one, key, now) for one in message.fields)
            if not _same_places(message.fields, node, fields, node):
                yield Change(key.replace("_", " "), source, key, source[key], now), replace(message, fields=fields)


def of_node(node: Node) -> Iterator[tuple[Change, Node]]:
    """The changes of what a node says of itself."""
    source = node.source.get("node", node.source)
    for key in ("node_type", "interface_version"):
        value = getattr(node, key)
        for step in (-1, 1) if value is not None else ():
            yield _step("node", source, key, value, step), _with(node, key, value + step)
    every = tuple(field for message in node.messages for field in message.fields)
    for key in ("byte_order", "bit_order"):
        now = _OTHER_ORDER[getattr(node, key)]
        other = _with(node, key, now)
        if not _same_places(every, node, every, other):
            yield Change(key.replace("_", " "), source, key, getattr(node, key), now), other


def of_enum(enum: Enum) -> Iterator[tuple[Change, Enum]]:
    """The changes of the members of an enumeration."""
    for index, member in enumerate(enum.members):
        for key, step in product(("value", "to"), (-1, 1)):
            value = getattr(member, key)
            if value is not None and not _is_taken(value + step, member, enum):
                members = (*enum.members[:index], _with(member, key, value + step), *enum.members[index + 1 :])
                yield _step("enum value", member.source, key, value, step), replace(enum, members=members)


def _is_taken(value: int, member: Member, enum: Enum) -> bool:
    """Whether another member has what a range would get too: no ICD says so, and which name holds is not defined."""
    return member.to is not None and any(one.value <= value <= one.last for one in enum.members if one is not member)


def formulas(text: str) -> Iterator[str]:
    """Each number of the formula one more and one less in its last digit, ten times and a tenth; the sign turned."""
    for match in re.finditer(r"[0-9]+(?:\.[0-9]+)?", text):
        number = Decimal(match.group())
        last = Decimal(1).scaleb(int(number.as_tuple().exponent))
        for other in (number - last, number + last, number * 10, number / 10):
            yield f"{text[: match.start()]}{other:f}{text[match.end() :]}"
    yield text.replace("raw", "-raw", 1) if "=" not in text else text.replace("value", "-value", 1)
    yield f"{text} + 1"


def _with(thing: T, key: str, value: Any) -> T:
    return replace(thing, **{key: value})


def _step(kind: str, source: Map, key: str, value: float, step: int) -> Change:
    """``value`` is that of the model; where the line gives another, as a part of a field does its place, that is changed."""
    printed = source.get(key, value)
    old = printed if type(printed) in (int, float) else value
    return Change(kind, source, key, old, old + step)


def _can_be(field: Field, kind: str) -> bool:
    """Whether a field of this width and with what else its line says may be of that type."""
    if field.type == "float" and field.special:
        return False
    if kind in ("uint", "int"):
        return field.bits <= 64
    if any(key in field.source for key in _OF_SCALED):
        return False
    if kind == "bool":
        return field.bits == 1
    if kind == "float":
        return field.bits in (32, 64)
    return not field.count and field.bits % 8 == field.at % 8 == 0


def _same_places(fields: tuple[Field, ...], node: Node, others: tuple[Field, ...], other: Node) -> bool:
    """Whether every bit lies where it lay."""
    pairs = zip(fields, others, strict=True)
    return all(a.is_bytes or layout.pieces(a, node) == layout.pieces(b, other) for a, b in pairs)
