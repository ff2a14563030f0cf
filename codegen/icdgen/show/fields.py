"""Table of the fields of a message, with the columns of tables in manuals.

`field_table` returns the table as text; `remarks` are its last column, which HTML pages
show as well.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction

from icdgen import frame_bits
from icdgen.describe.bounds import allowed_ends, bounds_of_limits
from icdgen.describe.comments import condition_text, orders_text
from icdgen.describe.numbers import (
    byte_count,
    count_text,
    exact_text,
    factor_text,
    points_text,
    special_text,
    value_text,
)
from icdgen.icd.layout import Array, Counted, VariablePart
from icdgen.icd.lines import Line, lines
from icdgen.icd.model import Message, Node, Struct
from icdgen.icd.places import NodePlace
from icdgen.tables import Column, render_table

_COLUMNS = [
    *(Column(title, right=True, fixed=True) for title in ("offset", "bits")),
    *(Column(title) for title in ("type", "name", "unit")),
    *(Column(title, right=True) for title in ("resolution", "from", "to")),
    Column("notes"),
]


def field_table(message: Message | Struct, node: Node, width: int | None = None) -> str:
    """Return a table of fields and reserved bits in the order of the frame; empty for a
    message without fields.
    """
    rows = [
        (field.at, _row(field, message))
        for field in lines(message.layout)
        if not field.is_count
    ]
    reserved = ("reserved", "", "", "", "", "", "")
    rows += [
        (gap.at, (str(gap.at), str(gap.bits), *reserved))
        for gap in frame_bits.reserved_bits(message, node)
    ]
    return render_table(
        _COLUMNS, [row for _, row in sorted(rows, key=lambda r: r[0])], width
    )


def _row(field: Line, message: Message | Struct) -> tuple[str, ...]:
    """Return the cells of a field, in the order of `_COLUMNS`."""
    low, high = (
        "" if bound is None else exact_text(bound) for bound in allowed_ends(field)
    )
    resolution = factor_text(field.scale.factor) if field.scale else ""
    unit = field.unit_symbol
    kind = field.enum.name if field.enum else field.type
    bits = f"{field.count} x {field.bits}" if field.count else str(field.bits)
    # For the part itself, and not for a field of a struct in it.
    part = _variable_part(message, field)
    if part is not None and part.name == field.name:
        bits = f"up to {part.most} x {8 * part.step}"
    place = ("", "", "derived") if field.derived else (str(field.at), bits, kind)
    notes = [
        *remarks(field, message=message if isinstance(message, Message) else None),
        *(e.id for e in field.errata),
    ]
    return (
        *place,
        field.name,
        unit,
        resolution,
        low,
        high,
        "; ".join([*notes, *filter(None, [field.summary])]),
    )


def remarks(
    field: NodePlace,
    number: Callable[[Fraction], str] = exact_text,
    message: Message | None = None,
) -> Iterator[str]:
    """Yield remarks about a field: conditions, counts, orders, constants, exclusive
    limits, special values.

    ``number`` formats numbers. ``message`` is the message of the field, if it can have
    variable-length parts.
    """
    part = _variable_part(message, field)
    if part is not None and not part.is_rest:
        yield f"as many as {count_text(part.counter, part.plus)} says"
    elif part is not None:
        end = "the fields behind it" if part.behind else "the end of the frame"
        yield f"up to {end}"
    front = message.layout.part_in_front_of(field.steps[0].node) if message else None
    if front is not None:
        yield f"behind {front.name}"
    if field.conditions:
        conditions = [condition_text(each, message) for each in field.conditions]
        yield f"only there if {' and '.join(conditions)}"
    if field.aliases:
        yield f"also called {', '.join(field.aliases)}"
    if field.derived is not None:
        yield f"derived: {field.formula}"
    elif field.is_read_only:
        yield "a view of bits that other fields have"
    if orders := orders_text(field):
        yield orders
    # Only lines of an ICD have levels; the rows of a page are single elements.
    for level in field.levels if isinstance(field, Line) else ():
        if level.struct is not None and level.count:
            most = "up to " if part is not None else ""
            if level.count > 1:
                stride = byte_count(level.struct.length)
                yield f"{most}{level.count} times, every {stride}"
            else:
                yield f"{most}once"
        size = level.node.size if isinstance(level.node, Array) else None
        # That of a part of the message is above.
        if isinstance(size, Counted) and (part is None or level.node is not part.node):
            yield f"up to {size.most} of {level.node.name}, as many as {count_text(size.counter, size.plus)} says"
    if field.display is not None:
        yield field.display.words
    if field.curve is not None and field.curve.points:
        yield f"points {points_text(field.curve, 12)}"
    if field.const is not None:
        yield f"always {value_text(field.const)}"
    # Inclusive limits are in the columns `from` and `to`.
    for bound in bounds_of_limits(field.limits):
        if bound.key in ("above", "below"):
            yield f"{bound.kind.words} {number(bound.value)}"
    for special in field.special:
        if special.number:
            value = special_text(special)
        else:
            value = number(Fraction(special.value))
        yield f"{value}: {special.meaning}"


def _variable_part(
    message: Message | Struct | None, field: NodePlace
) -> VariablePart | None:
    """Return the variable-length part that contains a field; None for a field of the
    fixed part.
    """
    return message.layout.part_of(field.steps[0].node) if message else None
