"""Framing, checksums, addresses, logs: the protocol section and the log mask."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diff.context import Context
from icdgen.diff.facts import Fact, facts, shown
from icdgen.diff.pairs import NodePair, differing, place_of
from icdgen.diff.rule import Found, rule
from icdgen.icd.model import Loggable
from icdgen.icd.rules.wording import quote

LONGEST = 80


def _found(pair: NodePair, fact: Fact, said: str) -> Found:
    where = pair.where()._replace(section=fact.path)
    was, now = _short(shown(fact.old)), _short(shown(fact.new))
    text = f"`{fact.path}` {said.format(was=was, now=now)}"
    return Found(text, (fact.path.rsplit(".", 1)[-1],), was, now, where=where, places=fact.places)


def _short(text: str) -> str:
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


@rule("DIF120", "node")
def fact_changed(pair: NodePair, ctx: Context) -> Iterator[Found]:
    for fact in facts(pair.old, pair.new):
        if not fact.is_word and fact.old is not None and fact.new is not None:
            yield _found(pair, fact, "is {now}, was {was}")


@rule("DIF121", "node", severity="warning")
def fact_stated(pair: NodePair, ctx: Context) -> Iterator[Found]:
    for fact in facts(pair.old, pair.new):
        if not fact.is_word and (fact.old is None) != (fact.new is None):
            yield _found(
                pair, fact, "is no longer stated; it was {was}" if fact.new is None else "is stated now: {now}"
            )


def _mask_bits(pair: NodePair) -> Iterator[tuple[int, Loggable | None, Loggable | None]]:
    """Bits of the log mask that select another frame, one where there was none, or none any more."""
    for bit, old, new in differing(pair.old.loggable, pair.new.loggable, lambda row: row.bit):
        if old is None or new is None or old.id != new.id:
            yield bit, old, new


def _mask_bit(pair: NodePair, bit: int, old: Loggable | None, new: Loggable | None, said: str) -> Found:
    where = pair.where()._replace(section=f"loggable {bit}")
    places = (place_of(old, ("id",)), place_of(new, ("id",)))
    was, now = (f"telemetry {row.id}" if row else "" for row in (old, new))
    return Found(f"log mask bit {bit} {said}", ("id",), was, now, where=where, places=places)


def _frame(row: Loggable) -> str:
    return f"telemetry {row.id}" + (f" {quote(row.name)}" if row.name else "")


@rule("DIF122", "node")
def mask_bit_changed(pair: NodePair, ctx: Context) -> Iterator[Found]:
    for bit, old, new in _mask_bits(pair):
        if old and new:
            yield _mask_bit(pair, bit, old, new, f"selects {_frame(new)}, selected {_frame(old)}")


@rule("DIF123", "node")
def mask_bit_removed(pair: NodePair, ctx: Context) -> Iterator[Found]:
    for bit, old, new in _mask_bits(pair):
        if old and not new:
            yield _mask_bit(pair, bit, old, new, f"no longer selects {_frame(old)}")


@rule("DIF124", "node", severity="note", addition=True)
def mask_bit_added(pair: NodePair, ctx: Context) -> Iterator[Found]:
    for bit, old, new in _mask_bits(pair):
        if new and not old:
            yield _mask_bit(pair, bit, old, new, f"selects {_frame(new)}")
