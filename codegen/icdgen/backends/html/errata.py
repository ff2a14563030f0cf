"""The page of all errata and notes."""

from __future__ import annotations

from icdgen.backends.html.relations import Relations
from icdgen.icd.model import Erratum

_FEW = 6


def values(relations: Relations) -> dict[str, object]:
    """Values of the page: of each node that has some, its errata and its notes in their order."""
    return {
        "groups": [
            (node, [[_entry(relations, e) for e in node.errata if e.is_note == kind] for kind in (False, True)])
            for node in relations.icd.nodes
            if node.errata
        ],
    }


def _entry(relations: Relations, erratum: Erratum) -> dict[str, object]:
    places = relations.places_of(erratum)
    return {"erratum": erratum, "places": places[:_FEW], "more": places[_FEW:]}


def changed(erratum: Erratum) -> list[tuple[str, str, str]]:
    """Key, as printed, as held; for errata that change something."""
    printed = dict(erratum.printed)
    return [(key, shown(printed.get(key)), shown(held)) for key, held in erratum.held] if erratum.changes else []


def shown(value: object) -> str:
    """A value of the ICD file as text."""
    if value is None:
        return "absent"
    return str(value).lower() if isinstance(value, bool) else str(value)
