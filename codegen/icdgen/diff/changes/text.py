"""Rules about text: summaries, references to tables, and spelling.

No rule here concerns existing software; all of them have the severity "note".
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

from icdgen.diff.context import ComparisonContext
from icdgen.diff.generated import is_renamed
from icdgen.diff.pairs import (
    EnumPair,
    FieldPair,
    IdentifiedPair,
    MessagePair,
    NodePair,
    Pair,
    differing,
    orders,
    place_of,
)
from icdgen.diff.rule import CheckResult, rule
from icdgen.diff.where import Places, Where
from icdgen.icd.layout import LayoutNode, struct_layout_of
from icdgen.icd.lines import Line
from icdgen.icd.model import Enum, Member, Message, Node, Struct
from icdgen.wording import quote

Described: TypeAlias = Node | Message | Line | Enum | Member | Struct | LayoutNode
"""Things with a summary."""


@rule("DIF401", "node", "message", "field", "enum", "member", severity="note")
def summary_changed(pair: Pair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    yield from _words_changed(pair.old, pair.new, pair.where())
    if isinstance(pair, NodePair):
        structs = {struct.name: struct for struct in pair.old.structs}
        for struct in pair.new.structs:
            if struct.name in structs:
                yield from _words_changed(structs[struct.name], struct, pair.where())
    if isinstance(pair, MessagePair):  # lines that use a struct form no field pair
        lines = {
            line.name: line for line in pair.old.layout.nodes if struct_layout_of(line)
        }
        for line in pair.new.layout.nodes:
            if struct_layout_of(line) and line.name in lines:
                yield from _words_changed(
                    lines[line.name], line, pair.where()._replace(field=line.name)
                )


def _words_changed(
    old: Described, new: Described, where: Where
) -> Iterator[CheckResult]:
    for key in ("summary", "title", "hazard"):
        was, now = getattr(old, key, ""), getattr(new, key, "")
        if was != now:
            verb = "says otherwise"
            if not was:
                verb = "is new"
            elif not now:
                verb = "is gone"
            places = place_of(old, (key,)), place_of(new, (key,))
            yield CheckResult(
                f"the {key} of {quote(new.name)} {verb}",
                (key,),
                was,
                now,
                where=where,
                places=places,
            )
    was, now = (", ".join(getattr(side, "aliases", ())) for side in (old, new))
    if was != now:
        text = f"{quote(new.name)} is also called {now or 'nothing else'}, was {was or 'nothing else'}"
        places = place_of(old, ("aliases",)), place_of(new, ("aliases",))
        yield CheckResult(text, ("aliases",), was, now, where=where, places=places)


@rule("DIF402", "message", "enum", "node", severity="note")
def reference_changed(
    pair: MessagePair | EnumPair | NodePair, ctx: ComparisonContext
) -> Iterator[CheckResult]:
    if isinstance(pair, NodePair):
        was, now = (
            ", ".join(f"{k} {v}" for k, v in side.document)
            for side in (pair.old, pair.new)
        )
    else:
        was, now = (_reference(side) for side in (pair.old, pair.new))
    if was != now:
        text = f"{quote(pair.new.name)} is described in {now or 'no table'}, was in {was or 'no table'}"
        yield CheckResult(text, ("source",), was, now)


def _reference(side: object) -> str:
    table, page = getattr(side, "table", None), getattr(side, "page", None)
    return ", ".join(
        f"{word} {number}"
        for word, number in (("table", table), ("page", page))
        if number is not None
    )


@rule("DIF406", "message", "field", "enum", "member", severity="note")
def respelled(pair: IdentifiedPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old, new = pair.old, pair.new
    if pair.is_of_struct or not is_renamed(pair):
        return
    if pair.is_of_another_node or not ctx.generated.renamed(pair):
        was, now = (
            f"{side.name} ({side.identifier})" if side.identifier else side.name
            for side in (old, new)
        )
        text = (
            f"{quote(new.name)} is spelled otherwise, its generated names are the same"
        )
        yield CheckResult(text, ("name", "identifier"), was, now)


@rule("DIF407", "message", severity="note")
def group_changed(pair: MessagePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old, new = pair.old.group, pair.new.group
    if old != new:
        yield CheckResult(
            f"{quote(pair.new.name)} belongs to {quote(new)}, did to {quote(old)}",
            ("group",),
            old,
            new,
        )


@rule("DIF408", "message", severity="note")
def parts_said_otherwise(
    pair: MessagePair, ctx: ComparisonContext
) -> Iterator[CheckResult]:
    old, new = (
        frozenset((p.message, p.at) for p in side.contains)
        for side in (pair.old, pair.new)
    )
    if old != new:
        was, now = (
            ", ".join(f"{name} at {at}" for name, at in sorted(parts))
            for parts in (old - new, new - old)
        )
        text = f"{quote(pair.new.name)} now declares repeated frames"
        yield CheckResult(text, ("contains",), was, now)


@rule("DIF416", "message", severity="note")
def reserved_said_otherwise(
    pair: MessagePair, ctx: ComparisonContext
) -> Iterator[CheckResult]:
    was, now = pair.old.reserved, pair.new.reserved
    if was != now:
        text = f"{quote(pair.new.name)} now declares at its end {now or 'no'} reserved bytes, was with {was or 'none'}"
        yield CheckResult(text, ("reserved", "length"), str(was), str(now))


@rule("DIF417", "field", severity="note")
def displayed_otherwise(
    pair: FieldPair, ctx: ComparisonContext
) -> Iterator[CheckResult]:
    was, now = (
        side.display.words if side.display else "" for side in (pair.old, pair.new)
    )
    if was != now:
        default = "displayed by its resolution"
        text = f"{quote(pair.new.name)} is {now or default}, was {was or default}"
        yield CheckResult(text, ("display",), was, now)


@rule("DIF409", "node", severity="note")
def missing_changed(pair: NodePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    for key, was, now in differing(
        pair.old.missing, pair.new.missing, lambda entry: (entry.kind, entry.id)
    ):
        verb = _verb(
            was,
            now,
            "is missing from the manual",
            "is no longer missing",
            "is missing for another reason",
        )
        entry = now or was
        assert entry is not None
        text = f"{key[0]} {key[1]} {quote(entry.name)} {verb}"
        yield CheckResult(
            text,
            (),
            was.why if was else "",
            now.why if now else "",
            places=_sections(pair, "missing"),
        )


def _verb(
    was: object, now: object, when_added: str, when_removed: str, when_changed: str
) -> str:
    if was is None:
        return when_added
    return when_removed if now is None else when_changed


def _sections(pair: NodePair, key: str) -> Places:
    return pair.old.source.at(key), pair.new.source.at(key)


@rule("DIF411", "node", severity="note")
def order_restated(pair: NodePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    if orders(pair.old) == orders(pair.new):
        return
    # Then DIF112 reports the order.
    if any(
        not field.same_bits for message in pair.messages for field in message.common
    ):
        return
    was, now = (" ".join(orders(side)) for side in (pair.old, pair.new))
    text = f"the order of bytes and bits of `{pair.new.name}` is stated otherwise, no field is read otherwise"
    yield CheckResult(text, ("byte_order", "bit_order"), was, now)


@rule("DIF414", "node", severity="note")
def unit_described_otherwise(
    pair: NodePair, ctx: ComparisonContext
) -> Iterator[CheckResult]:
    for symbol, was, now in differing(
        pair.old.units, pair.new.units, lambda unit: unit.symbol
    ):
        verb = _verb(
            was,
            now,
            "is declared now",
            "is no longer declared",
            "is described otherwise",
        )
        texts = [" ".join(filter(None, u[1:])) if u else "" for u in (was, now)]
        yield CheckResult(
            f"the unit {quote(symbol)} {verb}",
            (),
            texts[0],
            texts[1],
            places=_sections(pair, "units"),
        )


@rule("DIF415", "node", severity="note")
def mask_bit_named_otherwise(
    pair: NodePair, ctx: ComparisonContext
) -> Iterator[CheckResult]:
    for bit, was, now in differing(
        pair.old.loggable, pair.new.loggable, lambda row: row.bit
    ):
        if was and now and was.name != now.name:
            places = (place_of(was, ("name",)), place_of(now, ("name",)))
            where = pair.where()._replace(section=f"loggable {bit}")
            text = f"the frame of log mask bit {bit} is called {quote(now.name)}, was {quote(was.name)}"
            yield CheckResult(text, (), was.name, now.name, where=where, places=places)
