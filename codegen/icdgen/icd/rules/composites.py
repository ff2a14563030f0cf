"""Frames that repeat other frames, and list tables that repeat what detail tables say."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diagnostics import Place
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map
from icdgen.icd.model import Message, Node, Part
from icdgen.icd.places import NodePlace, scalars_in
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import VERBATIM, line_of, listing, quote
from icdgen.icd.suggestions import suggestion
from icdgen.icd.trees import mappings
from icdgen.icd.wire_ids import number

_KEYS = ("bits", "type", "enum", "unit", "formula", "points", "outside")
_IDS = ("id", "set_id", "get_id")


def _parts(ctx: Context) -> Iterator[tuple[Message, Node, Part, Map]]:
    """Every part of every composite frame, with the mapping that declares it."""
    for message, node in ctx.messages:
        if message.contains:
            entries = [(row.get("message"), row.get("at"), row) for row in mappings(message.source["contains"])]
            rows = {(name, at): row for name, at, row in entries if isinstance(name, str) and isinstance(at, int)}
            for part in message.contains:
                yield message, node, part, rows[part.message, part.at]


@rule("ICD046")
def part_exists(ctx: Context) -> Iterator[Fault]:
    for message, node, part, row in _parts(ctx):
        frames = {m.name: m for m in ctx.messages_of(node)}
        frame = frames.get(part.message)
        if frame is None:
            if ctx.complete:
                help, fix = suggestion(part.message, frames, VERBATIM)
                text = f"there is no message {quote(part.message)}"
                yield Fault.of_place(message.source, row.at("message"), text, help, fix)
        elif message.name in _repeated(frame, frames):
            text = f"{quote(message.name)} contains itself"
            if frame is not message:
                text = f"{text}, in {quote(frame.name)}"
            yield Fault(message.source, row.at("message"), text, "name another frame")
        elif not frame.layout.sequence and part.at + frame.length * 8 > message.length * 8:
            end = part.at + frame.length * 8
            text = f"{quote(frame.name)} ends at bit {end:,}, but {quote(message.name)} has {message.length * 8:,} bits"
            yield Fault(message.source, row.at("at"), text, "correct `at`, or the `length` of either")


def _repeated(frame: Message, frames: dict[str, Message]) -> set[str]:
    """Return the name of a frame and of all frames that it repeats, directly or through others."""
    repeated: set[str] = set()
    left = [frame.name]
    while left:
        name = left.pop()
        if name not in repeated and name in frames:
            repeated.add(name)
            left += [part.message for part in frames[name].contains]
    return repeated


@rule("ICD047", whole=True)
def part_matches(ctx: Context) -> Iterator[Fault]:
    composite: Message | None = None
    fields: list[NodePlace] = []  # of the composite frame
    for message, node, part, row in _parts(ctx):
        if message is not composite:
            composite, fields = message, _fields_with_bits(message)
        frame = next((m for m in ctx.messages_of(node) if m.name == part.message), None)
        if frame is None or frame is message or frame.layout.sequence:
            continue  # ICD046 or ICD122 reports it
        start, end = part.at, part.at + frame.length * 8
        if end > message.length * 8:
            continue  # ICD046 reports it
        wanted = {part.at + field.at: field for field in _fields_with_bits(frame)}
        reported = set()
        for field in fields:
            if field.at >= end or field.at + field.bits <= start:
                continue
            source = field.scalar.source
            twin = wanted.pop(field.at, None)
            if id(source) in reported:
                continue  # another element of the same array
            if twin is None:
                reported.add(id(source))
                text = f"{quote(frame.name)} has no field at bit {field.at - start:,}, where {quote(field.name)} begins"
                if field.at < start:
                    text = f"{quote(field.name)} crosses bit {start:,}, where {quote(frame.name)} begins"
                yield Fault.at(source, "at", text, _compare(frame, source.at("at")))
            else:
                differences = list(_differences(field, twin, frame))
                reported |= {id(fault.owner) for fault in differences}
                yield from differences
        if wanted:
            names = [f"{quote(f.name)} at bit {at:,}" for at, f in list(wanted.items())[:3]]
            more = [f"{len(wanted) - 3} more"] if len(wanted) > 3 else []
            text = f"{quote(message.name)} lacks fields of {quote(frame.name)}: {listing(names + more)}"
            yield Fault(message.source, row.at("at"), text, _compare(frame, row.at("at")))


def _fields_with_bits(message: Message) -> list[NodePlace]:
    """Return the fields of the longest frame that have bits of their own."""
    return [field for field in scalars_in(message.layout) if not (field.is_count or field.view)]


def _compare(frame: Message, here: Place) -> str:
    return f"compare with {quote(frame.name)} ({line_of(frame.source.at('name'), here)})"


def _quoted_value(source: Map, key: str) -> str:
    return quote(source[key]) if key in source else "absent"


def _differences(field: NodePlace, twin: NodePlace, frame: Message) -> Iterator[Fault]:
    """Yield a fault for the attributes in which a field differs from that of the repeated frame."""
    mine, other = field.scalar.source, twin.scalar.source
    keys = [key for key in _KEYS if mine.get(key) != other.get(key)]
    keys += (key for key in ("byte_order", "bit_order") if getattr(field, key) != getattr(twin, key))
    scale = field.scalar.scale
    if scale is not None and scale == twin.scalar.scale and "formula" in keys:
        keys.remove("formula")  # written differently, and the same
    if keys:
        key = keys[0]
        place = mine.at(key) if key in mine else mine.place
        values = "; ".join(f"{k} {_quoted_value(mine, k)} here, {_quoted_value(other, k)} there" for k in keys)
        there = f"{quote(twin.name)} in {quote(frame.name)} ({line_of(other.place, place)})"
        yield Fault(mine, place, f"{quote(field.name)} differs from {there}: {values}", "correct the wrong one")


@rule("ICD048")
def list_agrees(ctx: Context) -> Iterator[Fault]:
    for message, _ in ctx.messages:
        listed = message.source.get("listed")
        if not isinstance(listed, Map):
            continue
        for key, value in listed.items():
            held = message.source.get(key)
            if held != value and not (key in _IDS and held is not None and number(held) == number(value)):
                sides = (listed, message.source)
                values = [
                    quote(ctx.written(side, key) if key in _IDS and key in side else side.get(key)) for side in sides
                ]
                what = f"the {key.replace('_', ' ')} {values[0]}"
                text = f"the list table gives {quote(message.name)} {what}, the detail table {values[1]}"
                help = f"decide in an erratum: `held` has the other `{key}`, or `listed: null` to ignore the list table"
                yield Fault(message.source, listed.at(key), text, help)
