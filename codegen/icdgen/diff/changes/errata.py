"""Decisions about the manual's faults."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diff.context import Context
from icdgen.diff.pairs import NodePair, differing
from icdgen.diff.rule import Found, rule
from icdgen.icd.erratum import Erratum
from icdgen.icd.rules.wording import listing

_PARTS = ("title", "why", "evidence", "confidence", "tables", "printed", "held", "is_note")


@rule("DIF403", "node", severity="note")
@rule("DIF404", "node", severity="note")
@rule("DIF405", "node", severity="note")
def erratum_differs(pair: NodePair, ctx: Context) -> Iterator[Found]:
    for _, old, new in differing(pair.old.errata, pair.new.errata, lambda entry: entry.id):
        if old is not None and new is not None:
            yield _erratum_changed(pair, old, new)
        elif new is not None:
            yield _found("DIF403", pair, new, f"is new{_effect(new)}", "", new.title)
        elif old is not None:
            yield _found("DIF404", pair, old, f"is gone{_effect(old)}", old.title, "")


def _erratum_changed(pair: NodePair, old: Erratum, new: Erratum) -> Found:
    parts = [part for part in _PARTS if getattr(old, part) != getattr(new, part)]
    was, now = _kind(old), _kind(new)
    if was == now:
        was, now = (str(getattr(entry, parts[0])) if parts else "" for entry in (old, new))
    return _found("DIF405", pair, new, f"says otherwise ({listing(parts) if parts else 'what it changes'})", was, now)


def _found(code: str, pair: NodePair, entry: Erratum, said: str, was: str, now: str) -> Found:
    text = f"{entry.label.lower()} {entry.id} {said}: {entry.title}"
    return Found(text, ("name",), was, now, where=pair.where()._replace(erratum=entry.id), code=code)


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
