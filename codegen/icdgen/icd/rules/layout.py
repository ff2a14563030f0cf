"""Layout of messages and structs: positions and widths of fields, overlaps, and bytes
without a field.

The rules (ICD020 to ICD027 and ICD029) take the lines of the context and positions from
`icdgen.icd.places`. Overlay fields and fields that are never present together may share
bits. `_overlaps` compares positions in one pass, or masks of bits if bit orders differ
or fields are optional. `variable_length` has the rules of variable parts.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from itertools import chain
from operator import attrgetter

from icdgen.diagnostics import Related
from icdgen.frozen import NamedTuple
from icdgen.icd import division, variable_length
from icdgen.icd.conditions import are_exclusive, are_valid
from icdgen.icd.fault import Fault
from icdgen.icd.layout import (
    Array,
    Derived,
    Layout,
    bits_of_node,
    struct_layout_of,
)
from icdgen.icd.model import Message, Node
from icdgen.icd.places import NodePlace, places_in, scalars_in
from icdgen.icd.rules.context import Context, Owner, is_overlay
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import line_of
from icdgen.wording import count, quote

# 64 bits are the widest integer that all languages have.
_INTEGER = (frozenset(range(1, 65)), "1 to 64 bits")
WIDTHS = {
    "uint": _INTEGER,
    "int": _INTEGER,
    "enum": _INTEGER,
    "bool": (frozenset({1}), "1 bit"),
    # binary32 and binary64 of IEEE 754, which are `float` and `double` in C, f32 and
    # f64 in Rust.
    "float": (frozenset({32, 64}), "32 or 64 bits"),
}
_OVERLAPPING = "correct `at` or `bits`"
_ALTERNATIVES = (
    "let them depend on different values of the same field, or correct `at` or `bits`"
)
# Units of types that have no byte order.
_ORDERLY = {"bytes": "bytes", "text": "characters"}


class Overlap(NamedTuple):
    """Two places with common bits, in the order of the ICD."""

    first: NodePlace
    second: NodePlace
    # In words; empty if they are the bits from the later start to the earlier end.
    bits: str = ""


@rule("ICD020")
def fields_end_within_the_message(ctx: Context) -> Iterator[Fault]:
    for node, owner, _ in ctx.lines:
        source, room = node.source, owner.length * 8
        end = node.at + bits_of_node(node)
        # ICD121 reports fields of fixed size after a variable-length field.
        if end > room and id(source) not in ctx.behind_variable_fields:
            is_array = isinstance(node, Array)
            size_key = "struct" if struct_layout_of(node) else "bits"
            # Point to the key that is most likely wrong: `at` if the field begins
            # behind the end, otherwise what makes it too long.
            key = "count" if is_array else size_key
            if node.at >= room:
                key = "at"
            has = f"{quote(owner.name)} has {count(room, 'bit')} ({count(owner.length, 'byte')})"
            length = line_of(owner.source.at("length"), source.at(key))
            help = f"correct `at`{', `count`' if is_array else ''} or `{size_key}`, or the `length` in {length}"
            yield Fault.at(
                source, key, f"{quote(node.name)} ends at bit {end:,}, but {has}", help
            )


@rule("ICD021")
def fields_do_not_overlap(ctx: Context) -> Iterator[Fault]:
    reported = set()
    for overlap in chain(_overlaps(ctx), _overlaps_within_structs(ctx)):
        pair = id(overlap.first.source), id(overlap.second.source)
        # Report a pair once, although many elements of an array can overlap.
        if pair not in reported and ctx.behind_variable_fields.isdisjoint(pair):
            reported.add(pair)
            yield _fault(overlap)


def _overlaps(ctx: Context) -> Iterator[Overlap]:
    """Yield the overlaps within each message and struct.

    A struct in it counts as one field.
    """
    for owner, icd_node in ctx.owners:
        if _are_apart(owner.layout):
            continue
        own = [place for place in places_in(owner.layout) if _has_own_bits(place)]
        elements: list[NodePlace] = []
        for place in own:
            elements += place.elements()
        # Positions of different bit orders, and optional fields, must be compared in
        # pairs.
        if any(
            "when" in place.source or place.bit_order not in ("", icd_node.bit_order)
            for place in own
        ):
            with_valid_conditions = (
                element for element in elements if are_valid(element.node)
            )
            yield from _overlaps_among(owner, icd_node, with_valid_conditions)
            continue
        # Otherwise, one pass in the order of positions finds each element that begins
        # before the largest end of the elements before it. `furthest` is its index.
        end, furthest = -1, -1
        for index in sorted(range(len(elements)), key=lambda index: elements[index].at):
            element = elements[index]
            if element.at < end:
                yield Overlap(
                    elements[min(index, furthest)], elements[max(index, furthest)]
                )
            if element.at + element.bits > end:
                end, furthest = element.at + element.bits, index


def _are_apart(layout: Layout) -> bool:
    """Return whether no two nodes have common bits, by a fast check that succeeds for
    most layouts.
    """
    end = 0
    for node in sorted(layout.fixed, key=attrgetter("at")):
        # A bit order of its own counts other bits from the same `at`.
        if node.at < end or node.orders.bit:
            return False
        end = node.at + bits_of_node(node)
    return not layout.sequence or end <= 8 * layout.length


def _has_own_bits(place: NodePlace) -> bool:
    """Return whether a place has its own bits: it is not an overlay field, a derived
    value or a count without bits.
    """
    return not (
        place.is_count or isinstance(place.node, Derived) or is_overlay(place.node)
    )


def _overlaps_within_structs(ctx: Context) -> Iterator[Overlap]:
    """Yield the overlaps in structs that are used with another bit order than the one
    they are declared with.
    """
    for owner, icd_node in ctx.owners:
        if not any(map(struct_layout_of, owner.layout.nodes)):
            continue
        for place in places_in(owner.layout):
            _, home = ctx.struct_of.get(id(place.struct), (None, None))
            if (
                home is not None
                and place.orders_in_effect(icd_node.orders).bit != home.bit_order
            ):
                # All elements have the same layout.
                yield from _overlaps_among(
                    owner, icd_node, place.elements()[0].scalars()
                )


def _overlaps_among(
    owner: Owner, icd_node: Node, fields: Iterable[NodePlace]
) -> Iterator[Overlap]:
    """Yield the overlaps of fields with different bit orders or conditions.

    Fields that are never present in the same frame can have the same bits.
    """
    before: list[tuple[NodePlace, int]] = []
    # Comparing each pair of fields would take quadratic time, and arrays have thousands
    # of elements. Only fields with a common byte are compared.
    indices_by_byte: defaultdict[int, list[int]] = defaultdict(list)  # of `before`
    for field in fields:
        if field.at + field.bits > owner.length * 8:
            continue  # ICD020 reports it
        mask = _mask(field.at, field.bits, field.orders_in_effect(icd_node.orders).bit)
        field_bytes = range(field.at // 8, (field.at + field.bits + 7) // 8)
        near = {index for byte in field_bytes for index in indices_by_byte[byte]}
        # One overlap per field is enough: the correction of `at` or `bits` removes the
        # others, too.
        for other, other_mask in (before[index] for index in sorted(near)):
            shared = mask & other_mask
            if shared and not are_exclusive(other.conditions, field.conditions):
                yield Overlap(other, field, _bits_of(shared))
                break
        for byte in field_bytes:
            indices_by_byte[byte].append(len(before))
        before.append((field, mask))


def _bits_of(mask: int) -> str:
    """Return the bits of a mask in words: ``2 bits of byte 1``."""
    low = (mask & -mask).bit_length() - 1
    size = count(mask.bit_count(), "bit")
    # Below 256, all bits are in the byte of the lowest one.
    return f"{size} of byte {low // 8}" if mask >> low // 8 * 8 < 256 else size


def _mask(begin: int, bits: int, bit_order: str) -> int:
    """Return a mask of the bits of a field in the frame; bit w of byte b is bit 8 * b +
    w.
    """
    # Whole bytes have the same mask in both bit orders.
    if bit_order == "lsb0" or begin % 8 == 0 == bits % 8:
        return ((1 << bits) - 1) << begin
    return sum(1 << (at // 8 * 8 + 7 - at % 8) for at in range(begin, begin + bits))


def _fault(overlap: Overlap) -> Fault:
    """Return the fault of an overlap, at its second field."""
    first, second, bits = overlap
    start = max(first.at, second.at)
    end = min(first.at + first.bits, second.at + second.bits)
    bits = bits or (
        f"bit {start:,}" if end - start == 1 else f"bits {start:,} to {end - 1:,}"
    )
    other = (
        f"{quote(first.name)} ({line_of(first.source.place, second.source.at('at'))})"
    )
    text = f"{quote(second.name)} overlaps {other} in {bits}"
    text += ", and both can be present" if first.conditions or second.conditions else ""
    related = Related(first.source.at("at"), f"{quote(first.name)} begins here")
    return Fault.at(second.source, "at", text, _help(first, second), related=related)


def _help(first: NodePlace, second: NodePlace) -> str:
    """Return the help for an overlap."""
    if first.conditions and second.conditions:
        return _ALTERNATIVES
    help = (
        "correct `at`, or the `length` of the struct" if second.struct else _OVERLAPPING
    )
    for place in (first, second):
        # If an element other than the first overlaps, the array may be too long.
        if place.index and type(place.source.get("count")) is int:
            help += f", or the `count` of {quote(place.node.name)}"
    is_field = second.struct is None and second.index is None and len(second.steps) == 1
    view = f"; if {quote(second.node.name)} reads the same bits in another way, give it `view: true`"
    return help + view if is_field else help


@rule("ICD022")
def widths_suit_the_types(ctx: Context) -> Iterator[Fault]:
    for field, _ in ctx.fields:
        if field.is_bytes:
            fits, words = field.bits % 8 == 0, "whole bytes: a multiple of 8 bits"
        else:
            allowed, words = WIDTHS[field.type]
            fits = field.bits in allowed
        if not fits:
            article = "an" if field.type[0] in "aeio" else "a"
            message = (
                f"{article} `{field.type}` field takes {words}, not {field.bits:,}"
            )
            fix = "1" if field.type == "bool" else ""
            yield Fault.at(
                field.source, "bits", message, "correct `bits` or `type`", fix
            )


@rule("ICD023")
def bytes_begin_at_a_byte(ctx: Context) -> Iterator[Fault]:
    for field, line in ctx.fields:
        at = line.node.at
        if field.is_bytes and at % 8:
            text = f"{quote(field.name)} is `{field.type}`, but bit {at:,} is not the beginning of a byte"
            help = f"correct `at`: the nearest bytes begin at bits {at // 8 * 8:,} and {at // 8 * 8 + 8:,}"
            yield Fault.at(field.source, "at", text, help)


@rule("ICD026")
def orders_have_an_effect(ctx: Context) -> Iterator[Fault]:
    for key in ("byte_order", "bit_order"):
        for field, _ in ctx.fields_with[key]:
            if field.is_bytes or (field.type == "bool" and key == "byte_order"):
                what = (
                    f"{_ORDERLY[field.type]} are sent in order"
                    if field.is_bytes
                    else "it is one bit"
                )
                message = f"{quote(field.name)} is `{field.type}`: {what}, so `{key}` has no effect"
                yield Fault.at(field.source, key, message, f"remove `{key}`")


def _always_owned(message: Message, icd_node: Node) -> int:
    """Return a mask of the bits that fields have in every frame of a message."""
    mask = 0
    for place in scalars_in(message.layout):
        if _has_own_bits(place) and not place.conditions:
            order = place.orders_in_effect(icd_node.orders).bit
            mask |= _mask(place.at, place.bits, order)
    return mask


@rule("ICD029")
def overlay_fields_are_valid(ctx: Context) -> Iterator[Fault]:
    always_owned: dict[int, int] = {}  # by the id() of the message
    for field, line in ctx.fields_with["view"]:
        node, message, icd_node = line
        if not isinstance(message, Message):
            continue  # ICD143 reports overlay fields of structs
        source, name = field.source, quote(field.name)
        if (
            not is_overlay(node)
            or "bitfields" in source
            or node.at + field.bits > message.length * 8
        ):
            continue  # not an overlay field, or ICD025 or ICD020 reports it
        if isinstance(node, Array):
            help = "write an overlay field for each element"
            yield Fault.at(
                source,
                "view",
                f"{name} is an array, but an overlay field is one number",
                help,
            )
            continue
        if field.is_bytes:
            text = f"{name} is `{field.type}`, but an overlay field is a number"
            yield Fault.at(source, "view", text, "remove `view`")
            continue
        if field.const is not None:
            text = f"{name} is an overlay field, whose value is never set, so it cannot have `const`"
            yield Fault.at(
                source, "const", text, "give `const` to the field that has the bits"
            )
        if id(message) not in always_owned:
            always_owned[id(message)] = _always_owned(message, icd_node)
        # Bits that no field has are never set: an encoder sends them as 0.
        free = _mask(node.at, field.bits, line.orders.bit) & ~always_owned[id(message)]
        if free and is_read(message):
            always = "always " if message.has_conditions else ""
            text = f"{name} is an overlay of {_bits_of(free)} that no field {always}has"
            yield Fault.at(
                source,
                "at",
                text,
                "describe these bits as a field, or correct `at` or `bits`",
            )


def is_read(message: Message) -> bool:
    """Return whether the layout has all fields of the ICD.

    If it does not, bits without a field may belong to a field with errors.
    """
    sources = {id(node.source) for node in message.layout.nodes}
    return all(
        id(item) in sources or "bitfields" in item
        for item in message.source.get("fields", ())
    )


def covered_bytes(message: Message) -> int:
    """Return the number of bytes up to the end of the last field of the longest frame."""
    if message.layout.sequence:
        return message.layout.longest
    return (
        max(
            (node.at + bits_of_node(node) + 7 for node in message.layout.fixed),
            default=0,
        )
        // 8
    )


@rule("ICD027", needs_complete=True)
def reserved_bytes_have_no_field(ctx: Context) -> Iterator[Fault]:
    for message, _ in ctx.messages:
        free = (
            max(message.length - covered_bytes(message), 0) if message.reserved else 0
        )
        # ICD121 reports `reserved` of messages of variable length.
        if message.reserved > free and not variable_length.variable_fields(
            message.source
        ):
            text = f"{quote(message.name)} has {count(free, 'byte')} after its last field, but `reserved` is {message.reserved}"
            yield Fault.at(
                message.source,
                "reserved",
                text,
                "correct `reserved` or `length`, or the fields",
            )


@rule("ICD024", needs_complete=True)
def all_bytes_are_described(ctx: Context) -> Iterator[Fault]:
    for message, _ in ctx.messages:
        covered = covered_bytes(message)
        if covered + message.reserved < message.length and is_read(message):
            undescribed = message.length - covered - message.reserved
            described = (
                f"its fields describe {covered:,}"
                if message.layout.nodes
                else "no field describes them"
            )
            total = undescribed + message.reserved
            if message.reserved:
                described += f" and `reserved` {message.reserved:,}"
                missing = f"{count(undescribed, 'byte')} more"
                place = ", which counts all reserved bytes at the end,"
            else:
                missing = (
                    "the last byte"
                    if undescribed == 1
                    else f"the last {count(undescribed, 'byte')}"
                )
                place = " beside `length`"
            pronoun = "it" if total == 1 else "them"
            reserve = f"write `reserved: {total}`{place} if the manual calls {pronoun} reserved"
            text = f"{quote(message.name)} has {count(message.length, 'byte')}, but {described}"
            yield Fault.at(
                message.source,
                "length",
                text,
                f"describe {missing}, or correct `length`; {reserve}",
            )


@rule("ICD025")
def split_fields_are_valid(ctx: Context) -> Iterator[Fault]:
    for field, line in ctx.fields_with["bitfields"]:
        yield from division.faults(field.source, line.orders.byte, line.orders.bit)
