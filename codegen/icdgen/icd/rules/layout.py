"""Where fields lie: inside their message, apart from each other, as wide as their type allows."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain

from icdgen.diagnostics import Related
from icdgen.icd import tails
from icdgen.icd.conditions import are_understood, exclude
from icdgen.icd.division import obstacles
from icdgen.icd.fault import Fault
from icdgen.icd.model import Field, Message, Node
from icdgen.icd.paths import placed
from icdgen.icd.rules.context import Context, Owner
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
Overlap = tuple[Fault, tuple[int, int]]  # and the two fields as they were read
_OVERLAPPING = "correct `at` or `bits`"
_VIEW = "; if it reads the same bits in another way: `view: true`"
_ALTERNATIVES = "let them depend on different values of the same field, or correct `at` or `bits`"
_ORDERLY = {"bytes": "bytes", "text": "characters"}


@rule("ICD020")
def past_the_end(ctx: Context) -> Iterator[Fault]:
    behind = _behind(ctx)
    for field, message, _ in ctx.members:
        end, room = field.at + field.width, message.length * 8
        if end > room and id(field.source) not in behind:
            source = field.source
            whole = "struct" if field.struct else "bits"
            key = "at" if field.at >= room else "count" if field.count else whole
            has = f"{quote(message.name)} has {count(room, 'bit')} ({count(message.length, 'byte')})"
            length = line_of(message.source.at("length"), source.at(key))
            help = f"correct `at`{', `count`' if field.count else ''} or `{whole}`, or the `length` in {length}"
            yield Fault.at(source, key, f"{quote(field.name)} ends at bit {end:,}, but {has}", help)


def _behind(ctx: Context) -> set[int]:
    """Fields that ICD121 reports: they are placed behind a variable-length field."""
    return {id(item) for message, _ in ctx.messages for item in tails.fixed_behind(message.source)}


@rule("ICD021")
def overlap(ctx: Context) -> Iterator[Fault]:
    behind = _behind(ctx)
    reported = set()
    for fault, pair in chain(_overlaps(ctx), _overlaps_within(ctx)):
        if pair not in reported and behind.isdisjoint(pair):  # each element of an array may overlap
            reported.add(pair)
            yield fault


def _overlaps(ctx: Context) -> Iterator[Overlap]:
    for message, node in ctx.owners:
        fields = _standing(message)
        if any("when" in field.source or field.bit_order not in ("", node.bit_order) for field in fields):
            yield from _overlaps_among(message, node, filter(are_understood, fields))
            continue
        reached, widest = -1, -1
        for index in sorted(range(len(fields)), key=lambda i: fields[i].at):
            field = fields[index]
            if field.at < reached:
                yield _overlap(fields[min(index, widest)], fields[max(index, widest)])
            if field.at + field.bits > reached:
                reached, widest = field.at + field.bits, index


def _overlaps_within(ctx: Context) -> Iterator[Overlap]:
    """Those within structs that stand where bits are counted in another way than where they are declared."""
    homes = {id(struct): node for struct, node in ctx.structs}
    for member, owner, node in ctx.members:
        if member.struct is None or id(member.struct) not in homes:
            continue
        if member.orders(node)[1] != homes[id(member.struct)].bit_order:
            yield from _overlaps_among(owner, node, placed(member, member.places[0], member.struct.fields))


def _standing(owner: Owner) -> tuple[Field, ...]:
    """What has bits: fields, elements of arrays, structs as wholes."""
    members = owner.members
    if members is owner.fields:
        return owner.owners
    return tuple(place for member in members if not member.view for place in member.places)


def _overlaps_among(message: Owner, node: Node, fields: Iterable[Field]) -> Iterator[Overlap]:
    """`_overlaps` where fields count bits in different ways, or are not always there.

    Those that are never there together may have the same bits.
    """
    seen: list[tuple[Field, int]] = []
    for field in fields:
        if field.at + field.bits > message.length * 8:
            continue  # a finding already
        mask = _mask(field, node)
        clashes = (
            (one, shared) for one, other in seen if (shared := mask & other) and not exclude(one.when, field.when)
        )
        clash = next(clashes, None)
        if clash is not None:
            yield _overlap(clash[0], field, _bits_of(clash[1]))
        seen.append((field, mask))


def _bits_of(mask: int) -> str:
    """``2 bits of byte 1``"""
    low = (mask & -mask).bit_length() - 1
    size = count(mask.bit_count(), "bit")
    return f"{size} of byte {low // 8}" if mask >> low // 8 * 8 < 256 else size


def _mask(field: Field, node: Node) -> int:
    """The bits of the frame that the field has; bit w of byte b is bit 8 * b + w."""
    if field.orders(node)[1] == "lsb0" or field.at % 8 == 0 == field.bits % 8:
        return ((1 << field.bits) - 1) << field.at
    return sum(1 << (at // 8 * 8 + 7 - at % 8) for at in range(field.at, field.at + field.bits))


def _help(first: Field, second: Field) -> str:
    if first.when and second.when:
        return _ALTERNATIVES
    help = "correct `at`, or the `length` of the struct" if second.struct else _OVERLAPPING
    for one in (first, second):
        if one.path and one.path[0].index and type(one.source.get("count")) is int:  # not the first of its elements
            help += f", or the `count` of {quote(one.source['name'])}"
    return help if second.struct or second.path else help + _VIEW


def _overlap(first: Field, second: Field, bits: str = "") -> Overlap:
    start, end = max(first.at, second.at), min(first.at + first.bits, second.at + second.bits)
    bits = bits or (f"bit {start:,}" if end - start == 1 else f"bits {start:,} to {end - 1:,}")
    other = f"{quote(first.name)} ({line_of(first.source.place, second.source.at('at'))})"
    text = f"{quote(second.name)} overlaps {other} in {bits}"
    text += ", and both can be present" if first.when or second.when else ""
    related = Related(first.source.at("at"), f"{quote(first.name)} begins here")
    fault = Fault.at(second.source, "at", text, _help(first, second), related=related)
    return fault, (id(first.source), id(second.source))


@rule("ICD022")
def width(ctx: Context) -> Iterator[Fault]:
    for field, _, _ in ctx.fields:
        if field.is_bytes:
            fits, words = field.bits % 8 == 0, "whole bytes: a multiple of 8 bits"
        else:
            allowed, words = WIDTHS[field.type]
            fits = field.bits in allowed
        if not fits:
            article = "an" if field.type[0] in "aeio" else "a"
            message = f"{article} `{field.type}` field takes {words}, not {field.bits:,}"
            yield Fault.at(
                field.source, "bits", message, "correct `bits` or `type`", "1" if field.type == "bool" else ""
            )


@rule("ICD023")
def bytes_boundary(ctx: Context) -> Iterator[Fault]:
    for field, _, _ in ctx.fields:
        if field.is_bytes and field.at % 8:
            text = f"{quote(field.name)} is `{field.type}`, but bit {field.at:,} is not the beginning of a byte"
            help = f"correct `at`: the nearest bytes begin at bits {field.at // 8 * 8:,} and {field.at // 8 * 8 + 8:,}"
            yield Fault.at(field.source, "at", text, help)


@rule("ICD026")
def order_of_nothing(ctx: Context) -> Iterator[Fault]:
    for key in ("byte_order", "bit_order"):
        for field, _, _ in ctx.having[key]:
            if field.is_bytes or (field.type == "bool" and key == "byte_order"):
                what = f"{_ORDERLY[field.type]} are sent in order" if field.is_bytes else "it is one bit"
                message = f"{quote(field.name)} is `{field.type}`: {what}, so `{key}` has no effect"
                yield Fault.at(field.source, key, message, f"remove `{key}`")


@rule("ICD029")
def view_of_fields(ctx: Context) -> Iterator[Fault]:
    for field, message, node in ctx.having["view"]:
        if not isinstance(message, Message):
            continue  # a struct has none
        if not field.view or "bitfields" in field.source or field.at + field.bits > message.length * 8:
            continue  # no view, or a finding already
        source, name = field.source, quote(field.name)
        if field.count:
            help = "write an overlay field for each element"
            yield Fault.at(source, "view", f"{name} is an array, but an overlay field is one number", help)
            continue
        if field.is_bytes:
            yield Fault.at(
                source, "view", f"{name} is `{field.type}`, but an overlay field is a number", "remove `view`"
            )
            continue
        if field.const is not None:
            text = f"{name} is an overlay field, whose value is never set, so it cannot have `const`"
            yield Fault.at(source, "const", text, "give `const` to the field that has the bits")
        free = _mask(field, node)
        for owner in message.owners:
            free &= ~0 if owner.when else ~_mask(owner, node)
        if free and is_read(message):
            text = f"{name} is an overlay of {_bits_of(free)} that no field {'always ' * message.has_conditions}has"
            yield Fault.at(source, "at", text, "describe these bits as a field, or correct `at` or `bits`")


def is_read(message: Message) -> bool:
    """Whether no field was left out for a finding of its own; it may have the bits that others seem to lack."""
    read = {id(field.source) for field in (*message.fields, *message.members)}
    return all(id(entry) in read or "bitfields" in entry for entry in message.source.get("fields", ()))


def covered_bytes(message: Message) -> int:
    """Bytes up to the end of the last field."""
    return max((one.at + one.width + 7 for one in message.members if one.derived is None), default=0) // 8


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
            described = f"its fields describe {covered:,}" if message.fields else "no field describes them"
            text = f"{quote(message.name)} has {count(message.length, 'byte')}, but {described}"
            help = f"describe {'' if message.reserved else 'the last '}{count(left, 'byte')} or correct `length`"
            reserve = f"if the manual calls them reserved: `reserved: {left + message.reserved}`"
            yield Fault.at(message.source, "length", text, f"{help}; {reserve}")


@rule("ICD025")
def bitfields(ctx: Context) -> Iterator[Fault]:
    for field, _, node in ctx.having["bitfields"]:
        yield from obstacles(field.source, *field.orders(node))
