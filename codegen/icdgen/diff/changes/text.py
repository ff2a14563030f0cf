"""Words: summaries, references to tables, spellings."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diagnostics import Place
from icdgen.diff.context import Context
from icdgen.diff.facts import facts, shown
from icdgen.diff.pairs import (
    EnumPair,
    FieldPair,
    IdentifiedPair,
    MessagePair,
    NodePair,
    Pair,
    is_of_another_node,
    orders,
    place_of,
)
from icdgen.diff.rule import Found, rule
from icdgen.diff.similar import same_sense
from icdgen.icd.model import Node
from icdgen.icd.rules.wording import quote


@rule("DIF401", "node", "message", "field", "enum", "member", severity="note")
def summary_changed(pair: Pair, ctx: Context) -> Iterator[Found]:
    for key in ("summary", "title", "hazard"):
        old, new = getattr(pair.old, key, ""), getattr(pair.new, key, "")
        if old != new:
            verb = "is new" if not old else "is gone" if not new else "says otherwise"
            yield Found(f"the {key} of {quote(pair.new.name)} {verb}", (key,), old, new)


@rule("DIF402", "message", "enum", "node", severity="note")
def reference_changed(pair: MessagePair | EnumPair | NodePair, ctx: Context) -> Iterator[Found]:
    if isinstance(pair, NodePair):
        was, now = (", ".join(f"{k} {v}" for k, v in side.document) for side in (pair.old, pair.new))
    else:
        was, now = (_reference(side) for side in (pair.old, pair.new))
    if was != now:
        text = f"{quote(pair.new.name)} is described in {now or 'no table'}, was in {was or 'no table'}"
        yield Found(text, ("source",), was, now)


def _reference(side: object) -> str:
    table, page = getattr(side, "table", None), getattr(side, "page", None)
    return ", ".join(f"{word} {number}" for word, number in (("table", table), ("page", page)) if number is not None)


@rule("DIF406", "message", "field", "enum", "member", severity="note")
def respelled(pair: IdentifiedPair, ctx: Context) -> Iterator[Found]:
    old, new = pair.old, pair.new
    if (old.name, old.identifier) == (new.name, new.identifier):
        return
    if is_of_another_node(pair) or not ctx.generated.renamed(pair):
        was, now = (f"{side.name} ({side.identifier})" if side.identifier else side.name for side in (old, new))
        text = f"{quote(new.name)} is spelled otherwise, its generated names are the same"
        yield Found(text, ("name", "identifier"), was, now)


@rule("DIF407", "message", severity="note")
def group_changed(pair: MessagePair, ctx: Context) -> Iterator[Found]:
    old, new = pair.old.group, pair.new.group
    if old != new:
        yield Found(f"{quote(pair.new.name)} belongs to {quote(new)}, did to {quote(old)}", ("group",), old, new)


@rule("DIF408", "message", severity="note")
def parts_said_otherwise(pair: MessagePair, ctx: Context) -> Iterator[Found]:
    old, new = (frozenset((p.message, p.at) for p in side.contains) for side in (pair.old, pair.new))
    if old != new:
        was, now = (", ".join(f"{name} at {at}" for name, at in sorted(some)) for some in (old - new, new - old))
        text = f"{quote(pair.new.name)} is said to repeat other frames"
        yield Found(text, ("contains",), was, now)


@rule("DIF409", "node", severity="note")
def missing_changed(pair: NodePair, ctx: Context) -> Iterator[Found]:
    old, new = ({(m.kind, m.id): m for m in side.missing} for side in (pair.old, pair.new))
    for key in sorted(old.keys() | new.keys()):
        was, now = old.get(key), new.get(key)
        either = now or was
        if was != now and either is not None:
            what = f"{key[0]} {key[1]} {quote(either.name)}"
            verb = "is missing from the manual" if was is None else "is no longer missing" if now is None else ""
            text = f"{what} {verb or 'is missing for another reason'}"
            places = _section(pair.old, "missing"), _section(pair.new, "missing")
            yield Found(text, (), was.why if was else "", now.why if now else "", places=places)


def _section(side: Node, key: str) -> Place | None:
    return side.source.at(key) if side.source is not None else None


@rule("DIF411", "node", severity="note")
def order_restated(pair: NodePair, ctx: Context) -> Iterator[Found]:
    if orders(pair.old) == orders(pair.new):
        return
    for message in pair.messages:
        if any(not one.same_bits for one in message.kept):
            return
    was, now = (" ".join(orders(side)) for side in (pair.old, pair.new))
    text = f"the order of bytes and bits of `{pair.new.name}` is stated otherwise, no field is read otherwise"
    yield Found(text, ("byte_order", "bit_order"), was, now)


@rule("DIF412", "field", severity="note")
def special_respelled(pair: FieldPair, ctx: Context) -> Iterator[Found]:
    old, new = ({s.value: s.meaning for s in field.special} for field in (pair.old, pair.new))
    for value in sorted(old.keys() & new.keys()):
        was, now = old[value], new[value]
        if was != now and same_sense(was, now):
            yield Found(
                f"what {value} of {quote(pair.new.name)} stands for is spelled otherwise", ("special",), was, now
            )


@rule("DIF413", "node", severity="note")
def protocol_words(pair: NodePair, ctx: Context) -> Iterator[Found]:
    for fact in facts(pair.old, pair.new):
        if fact.is_word:
            where = pair.where()._replace(section=fact.path)
            yield Found(
                f"`{fact.path}` says otherwise", (), shown(fact.old), shown(fact.new), where=where, places=fact.places
            )


@rule("DIF414", "node", severity="note")
def unit_described_otherwise(pair: NodePair, ctx: Context) -> Iterator[Found]:
    old, new = ({u.symbol: u for u in side.units} for side in (pair.old, pair.new))
    for symbol in sorted(old.keys() | new.keys()):
        was, now = old.get(symbol), new.get(symbol)
        if was != now:
            verb = (
                "is declared now"
                if was is None
                else "is no longer declared" if now is None else "is described otherwise"
            )
            said = [" ".join(filter(None, u[1:])) if u else "" for u in (was, now)]
            places = _section(pair.old, "units"), _section(pair.new, "units")
            yield Found(f"the unit {quote(symbol)} {verb}", (), said[0], said[1], places=places)


@rule("DIF415", "node", severity="note")
def mask_bit_named_otherwise(pair: NodePair, ctx: Context) -> Iterator[Found]:
    old, new = ({row.bit: row for row in side.loggable} for side in (pair.old, pair.new))
    for bit in sorted(old.keys() & new.keys()):
        was, now = old[bit], new[bit]
        if was.name != now.name:
            places = (place_of(was, ("name",)), place_of(now, ("name",)))
            where = pair.where()._replace(section=f"loggable {bit}")
            text = f"the frame of log mask bit {bit} is called {quote(now.name)}, was {quote(was.name)}"
            yield Found(text, (), was.name, now.name, where=where, places=places)
