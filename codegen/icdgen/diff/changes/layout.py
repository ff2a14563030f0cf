"""Rules about fields: their bits and the interpretation of these bits.

Rules about the meaning of the values (scale, unit, limits) are in ``numbers``.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.describe.comments import condition_text
from icdgen.diff.context import ComparisonContext, free_before
from icdgen.diff.moves import Move
from icdgen.diff.pairs import FieldPair, MessagePair, NodePair, kind, orders
from icdgen.diff.rule import CheckResult, rule
from icdgen.diff.where import Places
from icdgen.diff.wording import bits, read_as, some, span, type_of
from icdgen.icd.lines import Line
from icdgen.icd.model import Message
from icdgen.icd.wire_ids import size
from icdgen.wording import count, listing, quote


@rule("DIF107", "message")
@rule("DIF108", "message")
@rule("DIF109", "message")
def fields_moved(pair: MessagePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    details: tuple[str, ...]
    for move in ctx.moves(pair).moves:
        first, last = move.fields[0], move.fields[-1]
        if move.is_shift:
            code, text = "DIF108", f"{_cause(move)}: {_fields(move)} {_by(move)}"
        elif first is last:
            code, text = (
                "DIF107",
                f"{quote(first.new.name)} is at bit {first.new.at:,}, was at bit {first.old.at:,}",
            )
        else:
            code, text = "DIF109", f"{_fields(move)} moved as a block: they {_by(move)}"
        causes = move.gained + move.lost + move.resized
        if first is last:
            details, where = (), first.where()
        else:
            details = (f"From {quote(first.new.name)} to {quote(last.new.name)}.",)
            where = pair.where()
        if causes:
            where = causes[0].where()
        was, now = f"bit {first.old.at}", f"bit {first.new.at}"
        yield CheckResult(
            text,
            (),
            was,
            now,
            details,
            where=where,
            places=_places(first, causes),
            code=code,
        )


def _places(first: FieldPair, causes: list[FieldPair]) -> Places:
    """Return the places of the first moved field, or of the change that moved it."""
    old, new = first.places(("at",))
    for cause in causes:
        before, after = cause.places(("at", "bits"))
        if cause.before is not None:
            old = before
        if cause.after is not None:
            new = after
    return old, new


def _fields(move: Move) -> str:
    return (
        quote(move.fields[0].new.name)
        if len(move.fields) == 1
        else count(len(move.fields), "field")
    )


def _by(move: Move) -> str:
    side = "towards the end" if move.by > 0 else "towards the beginning"
    verb = "lies" if len(move.fields) == 1 else "lie"
    first = move.fields[0]
    return f"{verb} {bits(abs(move.by))} further {side} (bit {first.old.at:,} -> {first.new.at:,})"


def _cause(move: Move) -> str:
    causes = []
    if move.gained:
        causes.append(
            f"{some([p.new.name for p in move.gained])} inserted at bit {move.gained[0].new.at:,}"
        )
    if move.lost:
        causes.append(
            f"{some([p.old.name for p in move.lost])} taken out at bit {move.lost[0].old.at:,}"
        )
    for pair in move.resized:
        causes.append(
            f"{quote(pair.new.name)} has {count(pair.new.width, 'bit')}, had {pair.old.width}"
        )
    if move.reserved:
        causes.append(
            f"{bits(abs(move.by))} without a field {'inserted' if move.by > 0 else 'taken out'}"
        )
    return listing(causes)


@rule("DIF110", "field")
def width_changed(pair: FieldPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old, new = pair.old, pair.new
    # The width of variable-length bytes is their maximum, which DIF119 reports.
    if old.bits != new.bits and not (new.is_bytes and pair.is_open):
        text = f"{quote(new.name)} has {count(new.bits, 'bit')}, had {old.bits}"
        yield CheckResult(text, ("bits",), f"{old.bits} bits", f"{new.bits} bits")


@rule("DIF118", "field")
def count_changed(pair: FieldPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old, new = pair.old, pair.new
    before, after = old.own_count, new.own_count
    # See DIF119; of structs DIF127
    if before != after and (pair.is_of_struct or not pair.is_open):
        was, now = (
            count(number, "element") if number else "one value"
            for number in (before, after)
        )
        text = f"{quote(new.name)} is {_an_array(after)}, was {_an_array(before)}"
        yield CheckResult(text, ("count", "bits"), was, now)


@rule("DIF128", "field")
def condition_changed(pair: FieldPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    was, now = (
        _needs(line, message)
        for line, message in ((pair.old, pair.owner.old), (pair.new, pair.owner.new))
    )
    if _conditions(pair.old) != _conditions(pair.new):
        text = f"{quote(pair.new.name)} is {now}, was {was}"
        yield CheckResult(
            text,
            ("when", "name"),
            was,
            now,
            ("In other frames its bits belong to other fields or are reserved.",),
        )


def _conditions(field: Line) -> set[tuple[str, frozenset[int]]]:
    return {
        (condition.field, frozenset(condition.values)) for condition in field.conditions
    }


def _needs(field: Line, message: Message) -> str:
    if not field.conditions:
        return "always there"
    conditions = [condition_text(condition, message) for condition in field.conditions]
    return f"there if {' and '.join(conditions)}"


def _an_array(elements: int) -> str:
    return f"an array of {count(elements, 'element')}" if elements else "one value"


@rule("DIF111", "field")
def read_otherwise(pair: FieldPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old, new = pair.old, pair.new
    if kind(old) == kind(new):
        return
    details: tuple[str, ...] = ()
    if {kind(old), kind(new)} == {"unsigned", "int"} and old.bits == new.bits:
        # The first value that the two interpretations read differently.
        half = 1 << (new.bits - 1)
        first, last = (
            (str(half), str(-half)) if new.is_signed else (str(-half), str(half))
        )
        details = (f"Bits read as {first} is read as {last}.",)
    text = f"{quote(new.name)} is a {type_of(new)}, was a {type_of(old)}"
    yield CheckResult(text, ("type",), read_as(old), read_as(new), details)


@rule("DIF112", "node")
def order_changed(pair: NodePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    if orders(pair.old) == orders(pair.new):
        return
    fields, messages = [], set()
    for message in pair.messages:
        for field in message.common:
            # Fields that also moved are reported by their own rules.
            if (
                field.old.at == field.new.at
                and field.old.width == field.new.width
                and not field.same_bits
            ):
                fields.append(field.new.name)
                messages.add(message.new.name)
    for key in ("byte_order", "bit_order"):
        before, after = getattr(pair.old, key), getattr(pair.new, key)
        if before != after and fields:
            text = f"the {key.replace('_', ' ')} of `{pair.new.name}` is {after}, was {before}"
            what = f"{count(len(fields), 'field')} of {count(len(messages), 'message')}"
            yield CheckResult(
                text,
                (key,),
                before,
                after,
                (f"Read otherwise, {what}: {some(fields)}.",),
            )


@rule("DIF117", "field")
def own_order_changed(pair: FieldPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old, new, nodes = pair.old, pair.new, (pair.owner.old_node, pair.owner.new_node)
    if pair.same_bits or (old.at, old.bits, old.count) != (new.at, new.bits, new.count):
        return
    for key in ("byte_order", "bit_order"):
        own = getattr(old, key), getattr(new, key)
        if own[0] == own[1]:
            continue  # then the order of the node has changed (DIF112)
        was, now = (
            order or getattr(node, key) for order, node in zip(own, nodes, strict=True)
        )
        if was != now:
            text = (
                f"the {key.replace('_', ' ')} of {quote(new.name)} is {now}, was {was}"
            )
            yield CheckResult(text, (key, "type"), was, now)


@rule("DIF116", "node")
def id_width_changed(pair: NodePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    was, now = pair.old.id_bits, pair.new.id_bits
    if was != now:
        text = f"ids of `{pair.new.name}` have {now} bits, had {was}"
        same = size(was) == size(now)
        details = (
            ()
            if same
            else (
                f"An id is sent as {count(size(now), 'byte')}, was as {count(size(was), 'byte')}.",
            )
        )
        yield CheckResult(
            text, ("id_bits",), str(was), str(now), details, "note" if same else None
        )


@rule("DIF113", "field", presence="removed")
def field_removed(pair: FieldPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    if not pair.old.is_read_only and not ctx.is_reported_for_message(pair):
        text = f"{quote(pair.old.name)} is gone: {span(pair.old)} no longer carry it"
        yield CheckResult(text, ("at",), f"{span(pair.old)}, {type_of(pair.old)}", "")


@rule("DIF114", "field", presence="added", severity="note", addition=True)
def field_added(pair: FieldPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    if not pair.new.is_read_only and not ctx.is_reported_for_message(pair):
        where = (
            "bits that were reserved"
            if free_before(pair)
            else "bits that carried something else"
        )
        text = f"{quote(pair.new.name)} is new, in {where}: {span(pair.new)}"
        yield CheckResult(text, ("at",), "", f"{span(pair.new)}, {type_of(pair.new)}")
