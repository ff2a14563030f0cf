"""Decisions about the manual's faults."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diff.context import Context
from icdgen.diff.pairs import NodePair
from icdgen.diff.rule import Found, rule
from icdgen.icd.model import Erratum, Node
from icdgen.icd.rules.wording import listing

_PARTS = ("title", "why", "evidence", "confidence", "tables", "printed", "held", "is_note")


def _entries(node: Node) -> dict[str, Erratum]:
    return {entry.id: entry for entry in node.errata}


def _found(pair: NodePair, entry: Erratum, text: str, was: str, now: str) -> Found:
    return Found(text, ("name",), was, now, where=pair.where()._replace(erratum=entry.id))


def _name(entry: Erratum) -> str:
    return f"{entry.label.lower()} {entry.id}"


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
    old, new = _entries(pair.old), _entries(pair.new)
    for key in [k for k in new if k not in old]:
        yield _found(
            pair, new[key], f"{_name(new[key])} is new{_effect(new[key])}: {new[key].title}", "", new[key].title
        )


@rule("DIF404", "node", severity="note")
def erratum_removed(pair: NodePair, ctx: Context) -> Iterator[Found]:
    old, new = _entries(pair.old), _entries(pair.new)
    for key in [k for k in old if k not in new]:
        yield _found(
            pair, old[key], f"{_name(old[key])} is gone{_effect(old[key])}: {old[key].title}", old[key].title, ""
        )


@rule("DIF405", "node", severity="note")
def erratum_changed(pair: NodePair, ctx: Context) -> Iterator[Found]:
    old, new = _entries(pair.old), _entries(pair.new)
    for key in [k for k in new if k in old and new[k] != old[k]]:
        parts = [part for part in _PARTS if getattr(old[key], part) != getattr(new[key], part)]
        was, now = _kind(old[key]), _kind(new[key])
        if was == now:
            was, now = (str(getattr(entry, parts[0])) if parts else "" for entry in (old[key], new[key]))
        text = f"{_name(new[key])} says otherwise ({listing(parts) if parts else 'what it changes'}): {new[key].title}"
        yield _found(pair, new[key], text, was, now)
