"""Where fields lie: inside their message, apart from each other, as wide as their type allows."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain
from operator import attrgetter
from typing import NamedTuple

from icdgen.diagnostics import Related
from icdgen.icd import tails
from icdgen.icd.conditions import are_understood, exclude
from icdgen.icd.division import obstacles
from icdgen.icd.fault import Fault
from icdgen.icd.layout import Array, Derived, Layout, LayoutNode, stride, struct_layout_of
from icdgen.icd.model import Message, Node
from icdgen.icd.places import NodePlace, places_in, scalars_in
from icdgen.icd.rules.context import Context, Owner, is_overlay
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import count, line_of, quote

_INTEGER = (frozenset(range(1, 65)), "1 to 64 bits")
WIDTHS = {
    "uint": _INTEGER,
    "int": _INTEGER,
    "enum": _INTEGER,
    "bool": (frozenset({1}), "1 bit"),
    "float": (frozenset({32, 64}), "32 or 64 bits"),
}
_OVERLAPPING = "correct `at` or `bits`"
_ALTERNATIVES = "let them depend on different values of the same field, or correct `at` or `bits`"
_ORDERLY = {"bytes": "bytes", "text": "characters"}


class Overlap(NamedTuple):
    """Two places that have bits in common, in the order of the ICD."""

    first: NodePlace
    second: NodePlace
    bits: str = ""  # in words; empty for those between the later begin and the earlier end


@rule("ICD020")
def past_the_end(ctx: Context) -> Iterator[Fault]:
    for node, owner, _ in ctx.lines:
        source, room = node.source, owner.length * 8
        end = node.at + _fixed_bits(node)
        if end > room and id(source) not in ctx.behind_variable_fields:
            is_array, size_key = isinstance(node, Array), "struct" if struct_layout_of(node) else "bits"
            key = "at" if node.at >= room else "count" if is_array else size_key
            has = f"{quote(owner.name)} has {count(room, 'bit')} ({count(owner.length, 'byte')})"
            length = line_of(owner.source.at("length"), source.at(key))
            help = f"correct `at`{', `count`' if is_array else ''} or `{size_key}`, or the `length` in {length}"
            yield Fault.at(source, key, f"{quote(node.name)} ends at bit {end:,}, but {has}", help)


@rule("ICD021")
def overlap(ctx: Context) -> Iterator[Fault]:
    reported = set()
    for overlap in chain(_overlaps(ctx), _overlaps_within_structs(ctx)):
        pair = id(overlap.first.source), id(overlap.second.source)
        if pair not in reported and ctx.behind_variable_fields.isdisjoint(pair):  # each element of an array may overlap
            reported.add(pair)
            yield _fault(overlap)


def _overlaps(ctx: Context) -> Iterator[Overlap]:
    """Yield the overlaps within each message and struct; structs count as a whole."""
    for owner, icd_node in ctx.owners:
        if _are_apart(owner.layout):
            continue
        own = [place for place in places_in(owner.layout) if _has_own_bits(place)]
        elements = [element for place in own for element in (place.elements() if place.count else (place,))]
        if any("when" in place.source or place.bit_order not in ("", icd_node.bit_order) for place in own):
            yield from _overlaps_among(owner, icd_node, (one for one in elements if are_understood(one.node)))
            continue
        end, widest = -1, -1  # end of the place that reaches farthest, and its index
        for index in sorted(range(len(elements)), key=lambda i: elements[i].at):
            element = elements[index]
            if element.at < end:
                yield Overlap(elements[min(index, widest)], elements[max(index, widest)])
            if element.at + element.bits > end:
                end, widest = element.at + element.bits, index


def _are_apart(layout: Layout) -> bool:
    """Return whether it is plain that no two nodes have bits in common: true of most layouts, and quickly decided."""
    end = 0
    for node in sorted(layout.fixed, key=attrgetter("at")):
        if node.at < end or node.orders.bit:
            return False
        end = node.at + _fixed_bits(node)
    return not layout.sequence or end <= 8 * layout.length


def _fixed_bits(node: LayoutNode) -> int:
    """Return the bits of a node of fixed size; of a variable-length one those of an element."""
    return stride(node) * (node.size if isinstance(node, Array) and isinstance(node.size, int) else 1)


def _has_own_bits(place: NodePlace) -> bool:
    """Return whether a place has bits that are no other field's."""
    return not (place.is_count or isinstance(place.node, Derived) or is_overlay(place.node))


def _overlaps_within_structs(ctx: Context) -> Iterator[Overlap]:
    """Yield the overlaps in structs that stand where bits are counted in another way than where they are declared."""
    for owner, icd_node in ctx.owners:
        if not any(map(struct_layout_of, owner.layout.nodes)):
            continue
        for place in places_in(owner.layout):
            _, home = ctx.struct_of.get(id(place.struct), (None, None))
            if home is not None and place.orders_in_effect(icd_node.orders).bit != home.bit_order:
                yield from _overlaps_among(owner, icd_node, place.elements()[0].scalars())  # all elements are alike


def _overlaps_among(owner: Owner, icd_node: Node, fields: Iterable[NodePlace]) -> Iterator[Overlap]:
    """Yield the overlaps where fields count bits in different ways, or where fields are optional.

    Fields that are never in the same frame may have the same bits.
    """
    before: list[tuple[NodePlace, int]] = []
    for field in fields:
        if field.at + field.bits > owner.length * 8:
            continue  # ICD020 reports it
        mask = _mask(field.at, field.bits, field.orders_in_effect(icd_node.orders).bit)
        for other, other_mask in before:
            shared = mask & other_mask
            if shared and not exclude(other.when, field.when):
                yield Overlap(other, field, _bits_of(shared))
                break
        before.append((field, mask))


def _bits_of(mask: int) -> str:
    """``2 bits of byte 1``"""
    low = (mask & -mask).bit_length() - 1
    size = count(mask.bit_count(), "bit")
    return f"{size} of byte {low // 8}" if mask >> low // 8 * 8 < 256 else size


def _mask(begin: int, bits: int, bit_order: str) -> int:
    """Return which bits of the frame a field has; bit w of byte b is bit 8 * b + w."""
    if bit_order == "lsb0" or begin % 8 == 0 == bits % 8:
        return ((1 << bits) - 1) << begin
    return sum(1 << (at // 8 * 8 + 7 - at % 8) for at in range(begin, begin + bits))


def _fault(overlap: Overlap) -> Fault:
    """Return the fault of an overlap, at its second field."""
    first, second, bits = overlap
    start, end = max(first.at, second.at), min(first.at + first.bits, second.at + second.bits)
    bits = bits or (f"bit {start:,}" if end - start == 1 else f"bits {start:,} to {end - 1:,}")
    other = f"{quote(first.name)} ({line_of(first.source.place, second.source.at('at'))})"
    text = f"{quote(second.name)} overlaps {other} in {bits}"
    text += ", and both can be present" if first.when or second.when else ""
    related = Related(first.source.at("at"), f"{quote(first.name)} begins here")
    return Fault.at(second.source, "at", text, _help(first, second), related=related)


def _help(first: NodePlace, second: NodePlace) -> str:
    """Return how two places can be kept apart."""
    if first.when and second.when:
        return _ALTERNATIVES
    help = "correct `at`, or the `length` of the struct" if second.struct else _OVERLAPPING
    for place in (first, second):
        if place.index and type(place.source.get("count")) is int:  # not the first of its elements
            help += f", or the `count` of {quote(place.node.name)}"
    is_field = second.struct is None and second.index is None and len(second.steps) == 1
    view = f"; if {quote(second.node.name)} reads the same bits in another way, give it `view: true`"
    return help + view if is_field else help


@rule("ICD022")
def width(ctx: Context) -> Iterator[Fault]:
    for field, _ in ctx.fields:
        if field.is_bytes:
            fits, words = field.bits % 8 == 0, "whole bytes: a multiple of 8 bits"
        else:
            allowed, words = WIDTHS[field.type]
            fits = field.bits in allowed
        if not fits:
            article = "an" if field.type[0] in "aeio" else "a"
            message = f"{article} `{field.type}` field takes {words}, not {field.bits:,}"
            fix = "1" if field.type == "bool" else ""
            yield Fault.at(field.source, "bits", message, "correct `bits` or `type`", fix)


@rule("ICD023")
def bytes_boundary(ctx: Context) -> Iterator[Fault]:
    for field, line in ctx.fields:
        at = line.node.at
        if field.is_bytes and at % 8:
            text = f"{quote(field.name)} is `{field.type}`, but bit {at:,} is not the beginning of a byte"
            help = f"correct `at`: the nearest bytes begin at bits {at // 8 * 8:,} and {at // 8 * 8 + 8:,}"
            yield Fault.at(field.source, "at", text, help)


@rule("ICD026")
def order_of_nothing(ctx: Context) -> Iterator[Fault]:
    for key in ("byte_order", "bit_order"):
        for field, _ in ctx.fields_with[key]:
            if field.is_bytes or (field.type == "bool" and key == "byte_order"):
                what = f"{_ORDERLY[field.type]} are sent in order" if field.is_bytes else "it is one bit"
                message = f"{quote(field.name)} is `{field.type}`: {what}, so `{key}` has no effect"
                yield Fault.at(field.source, key, message, f"remove `{key}`")


@rule("ICD029")
def view_of_fields(ctx: Context) -> Iterator[Fault]:
    for field, line in ctx.fields_with["view"]:
        node, message, icd_node = line
        if not isinstance(message, Message):
            continue  # ICD143 reports overlay fields of structs
        source, name = field.source, quote(field.name)
        if not is_overlay(node) or "bitfields" in source or node.at + field.bits > message.length * 8:
            continue  # not an overlay field, or ICD025 or ICD020 reports it
        if isinstance(node, Array):
            help = "write an overlay field for each element"
            yield Fault.at(source, "view", f"{name} is an array, but an overlay field is one number", help)
            continue
        if field.is_bytes:
            text = f"{name} is `{field.type}`, but an overlay field is a number"
            yield Fault.at(source, "view", text, "remove `view`")
            continue
        if field.const is not None:
            text = f"{name} is an overlay field, whose value is never set, so it cannot have `const`"
            yield Fault.at(source, "const", text, "give `const` to the field that has the bits")
        free = _mask(node.at, field.bits, line.orders.bit)
        for owner in scalars_in(message.layout):
            if _has_own_bits(owner) and not owner.when:
                free &= ~_mask(owner.at, owner.bits, owner.orders_in_effect(icd_node.orders).bit)
        if free and is_read(message):
            always = "always " if any(other.present_if for other in message.layout.nodes) else ""
            text = f"{name} is an overlay of {_bits_of(free)} that no field {always}has"
            yield Fault.at(source, "at", text, "describe these bits as a field, or correct `at` or `bits`")


def is_read(message: Message) -> bool:
    """Return whether the layout has all fields of the ICD. A field with a finding may have the bits that others lack."""
    read = {id(node.source) for node in message.layout.nodes}
    return all(id(entry) in read or "bitfields" in entry for entry in message.source.get("fields", ()))


def covered_bytes(message: Message) -> int:
    """Return the bytes up to the end of the last field, in the longest frame."""
    if message.layout.sequence:
        return message.layout.longest
    return max((node.at + _fixed_bits(node) + 7 for node in message.layout.fixed), default=0) // 8


@rule("ICD027", whole=True)
def reserved_end(ctx: Context) -> Iterator[Fault]:
    for message, _ in ctx.messages:
        free = max(message.length - covered_bytes(message), 0) if message.reserved else 0
        if message.reserved > free and not tails.open_parts(message.source):  # else ICD121
            text = f"{quote(message.name)} has {count(free, 'byte')} after its last field, but `reserved` is {message.reserved}"
            yield Fault.at(message.source, "reserved", text, "correct `reserved` or `length`, or the fields")


@rule("ICD024", whole=True)
def undescribed_end(ctx: Context) -> Iterator[Fault]:
    for message, _ in ctx.messages:
        covered = covered_bytes(message)
        if covered + message.reserved < message.length and is_read(message):
            left = message.length - covered - message.reserved
            described = f"its fields describe {covered:,}" if message.layout.nodes else "no field describes them"
            text = f"{quote(message.name)} has {count(message.length, 'byte')}, but {described}"
            missing = "the last byte" if left == 1 and not message.reserved else f"the last {count(left, 'byte')}"
            missing = f"{count(left, 'byte')} before those" if message.reserved else missing
            pronoun = "it" if left + message.reserved == 1 else "them"
            reserve = (
                f"write `reserved: {left + message.reserved}` beside `length` if the manual calls {pronoun} reserved"
            )
            yield Fault.at(message.source, "length", text, f"describe {missing}, or correct `length`; {reserve}")


@rule("ICD025")
def bitfields(ctx: Context) -> Iterator[Fault]:
    for field, line in ctx.fields_with["bitfields"]:
        yield from obstacles(field.source, line.orders.byte, line.orders.bit)
