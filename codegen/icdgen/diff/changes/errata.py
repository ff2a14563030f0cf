"""Rules about errata: decisions on faults of the manual.

They report the added, removed and changed errata of a node. The effects of an erratum
on fields are reported by the rules for fields.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diff.context import ComparisonContext
from icdgen.diff.pairs import NodePair, differing, place_of
from icdgen.diff.rule import CheckResult, rule
from icdgen.icd.erratum import Erratum
from icdgen.wording import listing

_PARTS = (
    "title",
    "why",
    "evidence",
    "confidence",
    "tables",
    "printed",
    "held",
    "is_note",
)


@rule("DIF403", "node", severity="note")
@rule("DIF404", "node", severity="note")
@rule("DIF405", "node", severity="note")
def erratum_differs(pair: NodePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    for _, old, new in differing(
        pair.old.errata, pair.new.errata, lambda entry: entry.id
    ):
        entry = new or old
        assert entry is not None
        was, now = old.title if old else "", new.title if new else ""
        if old is not None and new is not None:
            code, what, was, now = "DIF405", *_differences(old, new)
        else:
            code, what = ("DIF403", "is new") if new else ("DIF404", "is gone")
            what += "" if entry.is_note else f" ({_kind(entry)})"
        text = f"{entry.label.lower()} {entry.id} {what}: {entry.title}"
        where = pair.where()._replace(erratum=entry.id)
        places = place_of(old, ("id",)), place_of(new, ("id",))
        yield CheckResult(
            text, ("name",), was, now, where=where, places=places, code=code
        )


def _differences(old: Erratum, new: Erratum) -> tuple[str, str, str]:
    """Return the description of a changed entry, its old text and its new text."""
    parts = [part for part in _PARTS if getattr(old, part) != getattr(new, part)]
    was, now = _kind(old), _kind(new)
    # Entries of the same kind: the first differing attribute shows the change best.
    if was == now:
        was = str(getattr(old, parts[0])) if parts else ""
        now = str(getattr(new, parts[0])) if parts else ""
    what = listing(parts) if parts else "what it changes"
    return f"says otherwise ({what})", was, now


def _kind(entry: Erratum) -> str:
    if entry.is_note:
        return "a note"
    if not entry.changes:
        return "changes nothing"
    return f"holds {', '.join(f'{key}: {_plain(value)}' for key, value in entry.held)}"


def _plain(value: object) -> str:
    text = "(absent)" if value is None else str(value)
    if isinstance(value, bool):
        text = text.lower()  # as in YAML
    return text if len(text) <= 40 else text[:37] + "..."
