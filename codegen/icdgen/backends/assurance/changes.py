"""Single changes (mutations) of the content of an ICD: numbers plus and minus one,
types, formulas and references.

Each function takes an object of the model and yields pairs: the `SingleChange`, and a
copy of the object with it. Changes that `icdgen check` would report, or that have no
effect on a frame, are left out.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from itertools import product
from typing import Any, TypeVar

from icdgen.frozen import NamedTuple
from icdgen.icd import floats
from icdgen.icd.build import calibration
from icdgen.icd.curve import OUTSIDE, Curve, doubles, table
from icdgen.icd.derived import parse
from icdgen.icd.formula import FormulaError
from icdgen.icd.frames import frame_fields
from icdgen.icd.layout import (
    Array,
    Derived,
    Layout,
    LayoutNode,
    Orders,
    Scalar,
    scalar_of,
    stride,
)
from icdgen.icd.layout_copies import with_attributes
from icdgen.icd.located import Map, plain
from icdgen.icd.meanings import Limits, special
from icdgen.icd.model import Enum, Member, Message, Node
from icdgen.icd.pieces import Piece, pieces_at

OTHER_TYPES = {
    "uint": ("int", "float", "bytes", "bool"),
    "int": ("uint", "float", "bytes"),
    "enum": ("uint", "int"),
    "bool": ("uint", "int"),
    "float": ("uint", "int", "bytes"),
    "bytes": ("uint", "int"),
    "text": ("uint", "int", "bytes"),
}
"""Other types that a field of the same width can have."""

T = TypeVar("T", Message, Node, Member)
_OTHER_ORDER = {"little": "big", "big": "little", "lsb0": "msb0", "msb0": "lsb0"}
_WIDER = {
    **dict.fromkeys(("uint", "int", "enum"), (-1, 1)),
    **dict.fromkeys(("bytes", "text"), (-8, 8)),
}
_LIMITS = ("min", "max", "above", "below")
_OF_SCALED = ("formula", "const", "special", *_LIMITS)  # keys of numbers only


class SingleChange(NamedTuple):
    """Change of one value in a line of an ICD: ``key`` of ``source`` has the value
    ``now`` instead of ``old``.
    """

    kind: str  # "offset", "width", "type" ...
    source: Map
    key: str
    old: object
    now: object


def of_line(
    node: LayoutNode, layout: Layout, orders: Orders
) -> Iterator[tuple[SingleChange, LayoutNode]]:
    """Yield the changes of a line of a message or struct, each with the resulting node.

    Changes that are impossible for the type of the field or the length of the frame are
    omitted. ``orders``: orders of the ICD node.
    """
    scalar = scalar_of(node)
    if isinstance(node, Derived):
        yield from _derived_changes(node)
        return
    behind = layout.inner_parts and node.at >= 8 * layout.inner_parts[0].begin
    if behind or any(node is part for part in layout.sequence):
        # Size and position of a variable-length part, and of fields behind it, are no
        # attributes of a field.
        if scalar is not None and not scalar.is_bytes:
            yield from (
                *_type_changes(node, scalar),
                *_formula_changes(node, scalar),
                *_value_changes(node, scalar),
            )
        return
    counters = {part.counter for part in layout.counted_parts}
    conditions = {
        condition.field for other in layout.nodes for condition in other.present_if
    }
    if node.name in counters | conditions:
        return  # other parts of the frame depend on its value
    yield from _condition_changes(node, layout)
    size, bits, source = 8 * layout.length, stride(node), node.source
    count = node.size if isinstance(node, Array) and isinstance(node.size, int) else 1
    # One bit is an error within a byte, eight bits an error in counting bytes. Structs
    # and byte strings begin at a byte.
    for step in (-8, 8) if scalar is None or scalar.is_bytes else (-8, -1, 1, 8):
        # A field outside of the frame would be reported by `icdgen check`.
        if 0 <= node.at + step <= size - bits * count:
            yield (
                _change_by("offset", source, "at", node.at, step),
                with_attributes(node, at=node.at + step),
            )
    for step in _WIDER.get(scalar.type, ()) if scalar else ():
        if 0 < (bits + step) * count <= size - node.at:
            yield (
                _change_by("width", source, "bits", bits, step),
                with_attributes(node, bits=bits + step),
            )
    for step in (-1, 1) if isinstance(node, Array) else ():
        if 0 < count + step <= (size - node.at) // bits:
            yield (
                _change_by("count", source, "count", count, step),
                with_attributes(node, size=count + step),
            )
    if scalar is not None:
        yield from _type_changes(node, scalar)
    yield from _order_changes(node, layout.orders.within(orders))
    if scalar is not None:
        yield from (*_formula_changes(node, scalar), *_value_changes(node, scalar))


def _derived_changes(node: Derived) -> Iterator[tuple[SingleChange, LayoutNode]]:
    """Yield the changes of the formula of a derived value."""
    old, formula = node.derivation, node.scalar.formula
    for text in formulas(formula):
        # No formula after the change, or the number is part of a name
        with suppress(FormulaError):
            new = parse(text, old.fields)
            if new.sense({}) != old.sense({}):
                change = SingleChange("formula", node.source, "formula", formula, text)
                yield change, with_attributes(node, formula=text, derivation=new)


def _condition_changes(
    node: LayoutNode, layout: Layout
) -> Iterator[tuple[SingleChange, LayoutNode]]:
    """Yield the changes of a required value of another field, if the ICD states it as a
    number.
    """
    scalars = {
        other.name: scalar
        for other in layout.nodes
        if (scalar := scalar_of(other)) is not None
    }
    for place, condition in enumerate(node.present_if):
        value = node.source["when"].get(condition.field)
        other = scalars[condition.field]
        for step in (-1, 1) if type(value) is int else ():
            if not other.raw_min <= value + step <= other.raw_max:
                continue
            now = replace(condition, values=(value + step,))
            present_if = (*node.present_if[:place], now, *node.present_if[place + 1 :])
            change = _change_by(
                "condition", node.source["when"], condition.field, value, step
            )
            yield change, with_attributes(node, present_if=present_if)


def _order_changes(
    node: LayoutNode, around: Orders
) -> Iterator[tuple[SingleChange, LayoutNode]]:
    """Yield the changes of the orders of a line.

    ``around``: orders in effect outside of the line.
    """
    own, scalar = node.orders.within(around), scalar_of(node)
    if scalar is not None and scalar.is_bytes:
        return
    for key, name in (("byte_order", "byte"), ("bit_order", "bit")):
        # An order that a line inherits is changed in the line that declares it.
        if key not in node.source:
            continue
        order = getattr(own, name)
        other = replace(own, **{name: _OTHER_ORDER[order]})
        own_bits, other_bits = (
            pieces_at(node.at, stride(node), orders.byte, orders.bit)
            for orders in (own, other)
        )
        # Different orders can result in the same bits, for example of a single byte.
        if own_bits != other_bits:
            change = SingleChange(
                key.replace("_", " "), node.source, key, order, _OTHER_ORDER[order]
            )
            yield (
                change,
                with_attributes(
                    node, orders=replace(node.orders, **{name: _OTHER_ORDER[order]})
                ),
            )


def _type_changes(
    node: LayoutNode, scalar: Scalar
) -> Iterator[tuple[SingleChange, LayoutNode]]:
    source = node.source
    for kind in (
        OTHER_TYPES[scalar.type] if "type" in source and "enum" not in source else ()
    ):
        if _can_have_type(node, scalar, kind):
            # Formulas of integers are exact scales, formulas of floats are not.
            scale, curve = calibration(scalar.formula, kind)
            if "points" in source and kind in ("uint", "int", "float"):
                curve = scalar.curve
            change = SingleChange("type", source, "type", scalar.type, kind)
            yield change, with_attributes(node, type=kind, scale=scale, curve=curve)


def _formula_changes(
    node: LayoutNode, scalar: Scalar
) -> Iterator[tuple[SingleChange, LayoutNode]]:
    """Yield the changes of the calibration."""
    if scalar.curve is not None and scalar.curve.points:
        yield from _table_changes(node, scalar, scalar.curve)
        return
    for text in formulas(scalar.formula) if scalar.has_formula else ():
        scale, curve = calibration(text, scalar.type)
        if scale is not None or curve is not None:  # None for a factor of 0
            change = SingleChange(
                "formula", node.source, "formula", scalar.formula, text
            )
            yield change, with_attributes(node, scale=scale, curve=curve)


def _table_changes(
    node: LayoutNode, scalar: Scalar, old: Curve
) -> Iterator[tuple[SingleChange, LayoutNode]]:
    source = node.source
    printed = plain(node.source["points"])
    outside = node.source.get("outside", "")
    variants = [
        (SingleChange("points", source, "points", printed, points), points, outside)
        for points in tables(printed)
    ]
    if outside and (
        scalar.type == "float" or not old.covers(scalar.raw_min, scalar.raw_max)
    ):
        # Without raw values outside of the points, the key has no effect.
        words = (word for word in OUTSIDE if word != outside)
        variants += [
            (SingleChange("outside", source, "outside", outside, word), printed, word)
            for word in words
        ]
    for change, points, beyond in variants:
        with suppress(FormulaError):  # no lookup table after the change
            new = table(doubles(points), beyond)
            if new != old:
                yield change, with_attributes(node, curve=new)


def tables(points: list[list[Any]]) -> Iterator[list[list[Any]]]:
    """Yield the table with each of its numbers increased and decreased by one."""
    for index, (place, step) in product(range(len(points)), product((0, 1), (-1, 1))):
        number = points[index][place]
        point = list(points[index])
        # `1e-3` is text in an ICD; only `1.0e-3` is a number.
        point[place] = (float(number) if isinstance(number, str) else number) + step
        yield [*points[:index], point, *points[index + 1 :]]


def _value_changes(
    node: LayoutNode, scalar: Scalar
) -> Iterator[tuple[SingleChange, LayoutNode]]:
    """Yield the changes of constants, special values and limits."""
    if scalar.const is not None:
        for step in (-1, 1):
            change = _change_by("const", node.source, "const", scalar.const, step)
            yield change, with_attributes(node, const=scalar.const + step)
    for index, old in enumerate(scalar.special):
        source = node.source["special"][index]
        # NaN and infinities are exchanged for each other instead of counted up.
        named = [
            name
            for name in floats.NAMED
            if old.number in floats.NAMED and name != old.number
        ]
        for now in named or [source["value"] + step for step in (-1, 1)]:
            new = special(scalar.type, scalar.bits, now, old.meaning)
            if new is not None and new != old:
                change = SingleChange("special", source, "value", source["value"], now)
                specials = (*scalar.special[:index], new, *scalar.special[index + 1 :])
                yield change, with_attributes(node, special=specials)
    limits = scalar.limits or Limits()
    for key in _LIMITS:
        value: Fraction | None = getattr(limits, key)
        if value is None:
            continue
        for step in (-1, 1):
            change = _change_by("limit", node.source, key, node.source[key], step)
            yield (
                change,
                with_attributes(node, limits=replace(limits, **{key: value + step})),
            )


def of_message(message: Message, node: Node) -> Iterator[tuple[SingleChange, Message]]:
    """Yield the changes of the attributes of a message."""
    source = message.source
    for key in ("id", "set_id", "get_id", "length"):
        value = getattr(message, key)
        if key == "length" and message.layout.sequence:
            continue  # the variable-length part begins where the fixed part ends
        for step in (-1, 1) if value is not None else ():
            if value + step >= 0:
                if key == "length":
                    layout = replace(message.layout, length=value + step)
                    yield (
                        _change_by("length", source, key, value, step),
                        replace(message, layout=layout),
                    )
                else:
                    yield (
                        _change_by("id", source, key, value, step),
                        _with_value(message, key, value + step),
                    )
    for key, name in (("byte_order", "byte"), ("bit_order", "bit")):
        if key in source:
            now = _OTHER_ORDER[source[key]]
            orders = replace(message.layout.orders, **{name: now})
            layout = replace(message.layout, orders=orders)
            if _bits_of_numbers(message.layout, node.orders) != _bits_of_numbers(
                layout, node.orders
            ):
                yield (
                    SingleChange(key.replace("_", " "), source, key, source[key], now),
                    replace(message, layout=layout),
                )


def of_node(node: Node) -> Iterator[tuple[SingleChange, Node]]:
    """Yield the changes of the attributes of a node."""
    source = node.source.get("node", node.source)
    for key in ("node_type", "interface_version"):
        value = getattr(node, key)
        for step in (-1, 1) if value is not None else ():
            yield (
                _change_by("node", source, key, value, step),
                _with_value(node, key, value + step),
            )
    for key in ("byte_order", "bit_order"):
        now = _OTHER_ORDER[getattr(node, key)]
        other = _with_value(node, key, now)
        layouts = [message.layout for message in node.messages]
        if any(
            _bits_of_numbers(layout, node.orders)
            != _bits_of_numbers(layout, other.orders)
            for layout in layouts
        ):
            yield (
                SingleChange(
                    key.replace("_", " "), source, key, getattr(node, key), now
                ),
                other,
            )


def of_enum(enum: Enum) -> Iterator[tuple[SingleChange, Enum]]:
    """Yield the changes of the members of an enumeration."""
    for index, member in enumerate(enum.members):
        for key, step in product(("value", "to"), (-1, 1)):
            value = getattr(member, key)
            if value is not None and not _is_taken(value + step, member, enum):
                members = (
                    *enum.members[:index],
                    _with_value(member, key, value + step),
                    *enum.members[index + 1 :],
                )
                yield (
                    _change_by("enum value", member.source, key, value, step),
                    replace(enum, members=members),
                )


def _is_taken(value: int, member: Member, enum: Enum) -> bool:
    """Return whether a changed range would overlap another member.

    The ICD format excludes overlaps, so the resulting name is undefined.
    """
    return member.to is not None and any(
        other.value <= value <= other.last
        for other in enum.members
        if other is not member
    )


def formulas(text: str) -> Iterator[str]:
    """Yield the formula with each number changed in its last digit, multiplied and
    divided by ten; with inverted sign; and with an added offset.
    """
    for match in re.finditer(r"[0-9]+(?:\.[0-9]+)?", text):
        number = Decimal(match.group())
        # One in the last printed digit: 0.01 for 1.25. A Decimal keeps trailing zeros,
        # which a float does not.
        last = Decimal(1).scaleb(int(number.as_tuple().exponent))
        for other in (number - last, number + last, number * 10, number / 10):
            yield f"{text[: match.start()]}{other:f}{text[match.end() :]}"
    # A formula may be solved for the raw value: `raw = value / 0.5`.
    yield (
        text.replace("raw", "-raw", 1)
        if "=" not in text
        else text.replace("value", "-value", 1)
    )
    yield f"{text} + 1"


def _with_value(thing: T, key: str, value: Any) -> T:
    return replace(thing, **{key: value})


def _change_by(
    kind: str, source: Map, key: str, value: float, step: int
) -> SingleChange:
    """Return the change of a value by ``step``.

    ``value``: value of the model. If the line has another value, such as a position
    within a struct, that value is changed.
    """
    printed = source.get(key, value)
    old = printed if type(printed) in (int, float) else value
    return SingleChange(kind, source, key, old, old + step)


def _can_have_type(node: LayoutNode, scalar: Scalar, kind: str) -> bool:
    """Return whether a scalar of this width, with the other keys of its line, can have
    a type.
    """
    # Special values of a float can be NaN or fractions, which integers lack.
    if scalar.type == "float" and scalar.special:
        return False
    if kind in ("uint", "int"):
        return scalar.bits <= 64
    if any(key in node.source for key in _OF_SCALED):
        return False
    if kind == "bool":
        return scalar.bits == 1
    if kind == "float":
        return scalar.bits in (32, 64)
    # Byte strings begin and end at a byte.
    return not isinstance(node, Array) and scalar.bits % 8 == node.at % 8 == 0


def _bits_of_numbers(layout: Layout, orders: Orders) -> list[tuple[Piece, ...]]:
    """Return the bits of each number in the longest frame."""
    fields = frame_fields(layout, orders)
    numbers = (
        field
        for field in fields
        if field.role in ("field", "overlay") and not field.scalar.is_bytes
    )
    return [
        pieces_at(field.at, field.bits, field.byte_order, field.bit_order)
        for field in numbers
    ]
