"""Composite messages, which repeat other frames, and list tables of the manual, which
repeat its detail tables.

The rules look at the keys `contains` and `listed` of messages: ICD046 checks that
repeated frames exist and fit, ICD047 compares each field with its counterpart at the
same bit, and ICD048 compares the two tables. Names and summaries of fields may differ,
because manuals abbreviate them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from icdgen.diagnostics import Place
from icdgen.icd.fault import Fault
from icdgen.icd.layout import Orders
from icdgen.icd.located import Map
from icdgen.icd.model import ContainedMessage, Message, Node
from icdgen.icd.places import NodePlace, scalars_in
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import VERBATIM, line_of
from icdgen.icd.suggestions import suggestion
from icdgen.icd.trees import mappings
from icdgen.icd.wire_ids import number
from icdgen.wording import listing, quote

# Attributes that must be equal. A finding points to the first one that differs. Names
# and summaries may differ, because manuals abbreviate them in lists of frames.
_KEYS = ("bits", "type", "enum", "unit", "formula", "points", "outside")
_IDS = ("id", "set_id", "get_id")


def _parts(ctx: Context) -> Iterator[tuple[Message, Node, ContainedMessage, Map]]:
    """Yield each part of each composite message, with the message, its node and the
    mapping of the part.
    """
    for message, node in ctx.messages:
        if message.contains:
            entries = [
                (row.get("message"), row.get("at"), row)
                for row in mappings(message.source["contains"])
            ]
            # The model has only valid parts, without the line that declares them.
            rows = {
                (name, at): row
                for name, at, row in entries
                if isinstance(name, str) and isinstance(at, int)
            }
            for part in message.contains:
                yield message, node, part, rows[part.message, part.at]


@rule("ICD046")
def repeated_frames_exist_and_fit(ctx: Context) -> Iterator[Fault]:
    for message, node, part, row in _parts(ctx):
        frames = {each.name: each for each in ctx.messages_of(node)}
        frame = frames.get(part.message)
        if frame is None:
            if ctx.complete:
                help, fix = suggestion(part.message, frames, VERBATIM)
                text = f"there is no message {quote(part.message)}"
                yield Fault.of_place(message.source, row.at("message"), text, help, fix)
        # A cycle has no end when the frame is expanded, and no length.
        elif message.name in _repeated(frame, frames):
            text = f"{quote(message.name)} contains itself"
            if frame is not message:
                text = f"{text}, in {quote(frame.name)}"
            yield Fault(message.source, row.at("message"), text, "name another frame")
        elif (
            # ICD122 reports a repeated frame of variable length.
            not frame.layout.sequence
            and part.at + frame.length * 8 > message.length * 8
        ):
            end = part.at + frame.length * 8
            text = f"{quote(frame.name)} ends at bit {end:,}, but {quote(message.name)} has {message.length * 8:,} bits"
            yield Fault(
                message.source,
                row.at("at"),
                text,
                f"correct `at`, or the `length` of {quote(frame.name)} or {quote(message.name)}",
            )


def _repeated(frame: Message, frames: dict[str, Message]) -> set[str]:
    """Return the name of a frame and of all frames that it repeats, directly or
    indirectly.
    """
    repeated: set[str] = set()
    queue = [frame.name]
    while queue:
        name = queue.pop()
        if name not in repeated and name in frames:
            repeated.add(name)
            queue += [part.message for part in frames[name].contains]
    return repeated


@rule("ICD047", needs_complete=True)
def composites_match_their_parts(ctx: Context) -> Iterator[Fault]:
    composite: Message | None = None
    fields: list[NodePlace] = []  # of the composite message
    for message, node, part, row in _parts(ctx):
        if message is not composite:
            composite, fields = message, _fields_with_bits(message)
        frame = next(
            (each for each in ctx.messages_of(node) if each.name == part.message), None
        )
        if frame is None or frame is message or frame.layout.sequence:
            continue  # ICD046 or ICD122 reports it
        home = ctx.home_of(frame, node)
        start, end = part.at, part.at + frame.length * 8
        if end > message.length * 8:
            continue  # ICD046 reports it
        missing = {part.at + field.at: field for field in _fields_with_bits(frame)}
        reported = set()
        for field in fields:
            # Not in the repeated frame, not even with one bit.
            if field.at >= end or field.at + field.bits <= start:
                continue
            source = field.scalar.source
            # Fields at the same bit are counterparts; those of the repeated frame that
            # remain have none.
            counterpart = missing.pop(field.at, None)
            if id(source) in reported:
                continue  # another element of the same array
            if counterpart is None:
                reported.add(id(source))
                text = (
                    f"{quote(field.name)} begins at bit {field.at:,}, which is bit {field.at - start:,} of "
                    f"{quote(frame.name)}, where no field begins"
                )
                if field.at < start:
                    text = f"{quote(field.name)} crosses bit {start:,}, where {quote(frame.name)} begins"
                yield Fault.at(
                    source,
                    "at",
                    text,
                    _position_in(frame, field.name, start, source.at("at")),
                )
            else:
                orders = (
                    field.declared_orders.within(node.orders),
                    counterpart.declared_orders.within(home.orders),
                )
                differences = list(_differences(field, counterpart, frame, orders))
                reported |= {id(fault.owner) for fault in differences}
                yield from differences
        if missing:
            names = [
                f"{quote(field.name)} (bit {at:,})"
                for at, field in list(missing.items())[:3]
            ]
            more = [f"{len(missing) - 3} more"] if len(missing) > 3 else []
            text = (
                f"{quote(message.name)} repeats {quote(frame.name)}, but no field begins where "
                f"{listing(names + more)} should begin"
            )
            yield Fault(
                message.source, row.at("at"), text, _compare(frame, row.at("at"))
            )


def _fields_with_bits(message: Message) -> list[NodePlace]:
    """Return the fields of the longest frame that own bits."""
    return [
        field
        for field in scalars_in(message.layout)
        if not (field.is_count or field.is_read_only)
    ]


def _compare(frame: Message, here: Place) -> str:
    """Return the help that points to the repeated frame."""
    return (
        f"compare with {quote(frame.name)} ({line_of(frame.source.at('name'), here)})"
    )


def _position_in(frame: Message, name: str, start: int, here: Place) -> str:
    """Return the help with the position of the field of this name in the repeated
    frame, which begins at bit ``start``.
    """
    same_name = next(
        (field for field in _fields_with_bits(frame) if field.name == name), None
    )
    if same_name is None:
        return _compare(frame, here)
    where = f"{quote(frame.name)} has {quote(name)} at bit {same_name.at:,} ({line_of(same_name.scalar.source.at('at'), here)})"
    return f"{where}, which is bit {start + same_name.at:,} here: correct `at`, or the field before it"


def _orders_with_effect(field: NodePlace) -> tuple[str, ...]:
    """Return the keys of the orders on which the bits of a field depend."""
    has_whole_bytes = field.at % 8 == 0 and field.bits % 8 == 0
    is_in_a_byte = field.at % 8 + field.bits <= 8
    keys = {
        "byte_order": not is_in_a_byte and not field.scalar.is_bytes,
        "bit_order": not has_whole_bytes,
    }
    return tuple(key for key, has_effect in keys.items() if has_effect)


def _quoted_value(source: Mapping[str, Any], key: str) -> str:
    """Return the value of a key in backticks, or ``absent``."""
    return quote(source[key]) if key in source else "absent"


def _differences(
    field: NodePlace,
    counterpart: NodePlace,
    frame: Message,
    orders: tuple[Orders, Orders],
) -> Iterator[Fault]:
    """Yield a fault with all attributes in which a field differs from its counterpart
    in the repeated frame. ``orders`` are those in effect for both.
    """
    own, other = field.scalar.source, counterpart.scalar.source
    keys = [key for key in _KEYS if own.get(key) != other.get(key)]
    own_orders, other_orders = (
        {"byte_order": each.byte, "bit_order": each.bit} for each in orders
    )
    keys += (
        key
        for key in _orders_with_effect(field)
        if own_orders[key] != other_orders[key]
    )
    scale = field.scalar.scale
    if scale is not None and scale == counterpart.scalar.scale and "formula" in keys:
        keys.remove("formula")  # the formulas differ in spelling only
    if keys:
        key = keys[0]
        place = own.at(key) if key in own else own.place
        # Orders in effect: the field, its owners or the node can declare them.
        here, there = {**own, **own_orders}, {**other, **other_orders}
        values = "; ".join(
            f"{key} {_quoted_value(here, key)} here, {_quoted_value(there, key)} there"
            for key in keys
        )
        reference = f"{quote(counterpart.name)} in {quote(frame.name)} ({line_of(other.place, place)})"
        yield Fault(
            own,
            place,
            f"{quote(field.name)} differs from {reference}: {values}",
            "correct the wrong one",
        )


@rule("ICD048")
def list_tables_match_detail_tables(ctx: Context) -> Iterator[Fault]:
    for message, _ in ctx.messages:
        listed = message.source.get("listed")
        if not isinstance(listed, Map):
            continue
        for key, value in listed.items():
            own = message.source.get(key)
            # A list table can print an id as a number, and the detail table as bytes.
            if own != value and not (
                key in _IDS and own is not None and number(own) == number(value)
            ):
                listed_value = quote(_as_written(ctx, listed, key))
                own_value = (
                    quote(_as_written(ctx, message.source, key))
                    if own is not None
                    else "none"
                )
                name = key.replace("_", " ")
                text = f"the list table gives {quote(message.name)} the {name} {listed_value}, the detail table {own_value}"
                help = f"decide in an erratum: `held` has the other `{key}`, or `listed: null` to ignore the list table"
                yield Fault(message.source, listed.at(key), text, help)


def _as_written(ctx: Context, entries: Map, key: str) -> object:
    """Return a value of a list or detail table, an id in the spelling of its file."""
    if key in _IDS and key in entries:
        return ctx.written(entries, key)
    return entries.get(key)
