"""Decisions about the manual's faults."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diff.context import Context
from icdgen.diff.pairs import NodePair, differing
from icdgen.diff.rule import Found, rule
from icdgen.icd.model import Erratum
from icdgen.icd.rules.wording import listing

_PARTS = ("title", "why", "evidence", "confidence", "tables", "printed", "held", "is_note")


def _differing(pair: NodePair) -> list[tuple[Erratum | None, Erratum | None]]:
    return [(old, new) for _, old, new in differing(pair.old.errata, pair.new.errata, lambda entry: entry.id)]


def _found(pair: NodePair, entry: Erratum, said: str, was: str, now: str) -> Found:
    text = f"{entry.label.lower()} {entry.id} {said}: {entry.title}"
    return Found(text, ("name",), was, now, where=pair.where()._replace(erratum=entry.id))


def _kind(entry: Erratum) -> str:
    if entry.is_note:
        return "a note"
    if not entry.changes:
        return "changes nothing"
    return f"holds {', '.join(f'{key}: {_plain(value)}' for key, value in entry.held)}"


def _effect(entry: Erratum) -> str:
    return "" if entry.is_note else f" ({_kind(entry)})"


def _plain(value: object) -> str:
    text = "(absent)" if value is None else str(value).lower() if isinstance(value, bool) else str(value)
    return text if len(text) <= 40 else text[:37] + "..."


@rule("DIF403", "node", severity="note")
def erratum_added(pair: NodePair, ctx: Context) -> Iterator[Found]:
    for old, new in _differing(pair):
        if old is None and new is not None:
            yield _found(pair, new, f"is new{_effect(new)}", "", new.title)


@rule("DIF404", "node", severity="note")
def erratum_removed(pair: NodePair, ctx: Context) -> Iterator[Found]:
    for old, new in _differing(pair):
        if old is not None and new is None:
            yield _found(pair, old, f"is gone{_effect(old)}", old.title, "")


@rule("DIF405", "node", severity="note")
def erratum_changed(pair: NodePair, ctx: Context) -> Iterator[Found]:
    for old, new in _differing(pair):
        if old is None or new is None:
            continue
        parts = [part for part in _PARTS if getattr(old, part) != getattr(new, part)]
        was, now = _kind(old), _kind(new)
        if was == now:
            was, now = (str(getattr(entry, parts[0])) if parts else "" for entry in (old, new))
        said = f"says otherwise ({listing(parts) if parts else 'what it changes'})"
        yield _found(pair, new, said, was, now)
