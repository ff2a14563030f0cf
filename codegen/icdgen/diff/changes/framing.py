"""Framing, checksums, addresses, logs: the protocol section and the log mask."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diff.context import Context
from icdgen.diff.facts import Fact, facts, shown
from icdgen.diff.pairs import NodePair, place_of
from icdgen.diff.rule import Found, rule
from icdgen.icd.model import Loggable
from icdgen.icd.rules.wording import quote

LONGEST = 80


def _found(pair: NodePair, fact: Fact, text: str) -> Found:
    where = pair.where()._replace(section=fact.path)
    was, now = _short(shown(fact.old)), _short(shown(fact.new))
    return Found(text, (fact.path.rsplit(".", 1)[-1],), was, now, where=where, places=fact.places)


def _short(text: str) -> str:
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


@rule("DIF120", "node")
def fact_changed(pair: NodePair, ctx: Context) -> Iterator[Found]:
    for fact in facts(pair.old, pair.new):
        if not fact.is_word and fact.old is not None and fact.new is not None:
            was, now = _short(shown(fact.old)), _short(shown(fact.new))
            yield _found(pair, fact, f"`{fact.path}` is {now}, was {was}")


@rule("DIF121", "node", severity="warning")
def fact_stated(pair: NodePair, ctx: Context) -> Iterator[Found]:
    for fact in facts(pair.old, pair.new):
        if not fact.is_word and (fact.old is None) != (fact.new is None):
            if fact.new is None:
                yield _found(pair, fact, f"`{fact.path}` is no longer stated; it was {_short(shown(fact.old))}")
            else:
                yield _found(pair, fact, f"`{fact.path}` is stated now: {_short(shown(fact.new))}")


def _rows(rows: tuple[Loggable, ...]) -> dict[int, Loggable]:
    return {row.bit: row for row in rows}


def _masks(pair: NodePair) -> tuple[dict[int, Loggable], dict[int, Loggable]]:
    return _rows(pair.old.loggable), _rows(pair.new.loggable)


def _mask_bit(pair: NodePair, bit: int, old: Loggable | None, new: Loggable | None, text: str) -> Found:
    where = pair.where()._replace(section=f"loggable {bit}")
    places = (place_of(old, ("id",)), place_of(new, ("id",)))
    was, now = (f"telemetry {row.id}" if row else "" for row in (old, new))
    return Found(text, ("id",), was, now, where=where, places=places)


def _frame(row: Loggable) -> str:
    return f"telemetry {row.id}" + (f" {quote(row.name)}" if row.name else "")


@rule("DIF122", "node")
def mask_bit_changed(pair: NodePair, ctx: Context) -> Iterator[Found]:
    old, new = _masks(pair)
    for bit in sorted(old.keys() & new.keys()):
        if old[bit].id != new[bit].id:
            text = f"log mask bit {bit} selects {_frame(new[bit])}, selected {_frame(old[bit])}"
            yield _mask_bit(pair, bit, old[bit], new[bit], text)


@rule("DIF123", "node")
def mask_bit_removed(pair: NodePair, ctx: Context) -> Iterator[Found]:
    old, new = _masks(pair)
    for bit in sorted(old.keys() - new.keys()):
        text = f"log mask bit {bit} no longer selects {_frame(old[bit])}"
        yield _mask_bit(pair, bit, old[bit], None, text)


@rule("DIF124", "node", severity="note", addition=True)
def mask_bit_added(pair: NodePair, ctx: Context) -> Iterator[Found]:
    old, new = _masks(pair)
    for bit in sorted(new.keys() - old.keys()):
        yield _mask_bit(pair, bit, None, new[bit], f"log mask bit {bit} selects {_frame(new[bit])}")
