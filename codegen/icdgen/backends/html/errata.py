"""Page of all errata and notes.

`values` returns what the template ``errata.html.j2`` needs, by node. Places of an
erratum come from `Relations`.
"""

from __future__ import annotations

from dataclasses import dataclass

from icdgen.backends.html.relations import PageLink, Relations
from icdgen.icd.erratum import Erratum
from icdgen.icd.model import Node

_FEW = 6
_LEVELS = ("certain", "likely", "open")


@dataclass(frozen=True, slots=True)
class ErratumEntry:
    """Erratum or note, its places, and the names of affected messages."""

    erratum: Erratum
    places: list[PageLink]
    more: list[PageLink]
    messages: list[str]


@dataclass(frozen=True, slots=True)
class NodeErrata:
    """Errata and notes of a node: anchor, title and entries of both kinds."""

    node: Node
    kinds: list[tuple[str, str, list[ErratumEntry]]]


def values(relations: Relations) -> dict[str, object]:
    """Return the values of the page: errata and notes of each node, in order."""
    groups = [
        _node_errata(relations, node) for node in relations.icd.nodes if node.errata
    ]
    names: set[str] = set()
    used_levels: set[str] = set()
    for group in groups:
        for _, _, entries in group.kinds:
            for entry in entries:
                names.update(entry.messages)
                used_levels.add(entry.erratum.confidence)
    return {
        "groups": groups,
        "messages": sorted(names),
        "levels": [level for level in _LEVELS if level in used_levels],
    }


def _node_errata(relations: Relations, node: Node) -> NodeErrata:
    errata = [
        _erratum_entry(relations, erratum)
        for erratum in node.errata
        if not erratum.is_note
    ]
    notes = [
        _erratum_entry(relations, erratum) for erratum in node.errata if erratum.is_note
    ]
    return NodeErrata(
        node,
        [
            (f"{node.name}-errata", "Errata", errata),
            (f"{node.name}-notes", "Notes", notes),
        ],
    )


def _erratum_entry(relations: Relations, erratum: Erratum) -> ErratumEntry:
    # Equal ids of different nodes are distinguished by their titles.
    places = relations.places[erratum.id, erratum.title]
    return ErratumEntry(
        erratum,
        places[:_FEW],
        places[_FEW:],
        # Places of fields and members are `message: field`. The filter of the page is
        # for messages, each once and in order.
        list(dict.fromkeys(place.text.split(": ")[0] for place in places)),
    )


def changed(erratum: Erratum) -> list[tuple[str, str, str]]:
    """Return key, printed value and corrected value of each change of an erratum."""
    printed = dict(erratum.printed)
    return (
        [
            (key, shown(printed.get(key)), shown(corrected))
            for key, corrected in erratum.held
        ]
        if erratum.changes
        else []
    )


def shown(value: object) -> str:
    """Return a value of the ICD as text."""
    if value is None:
        return "absent"
    return str(value).lower() if isinstance(value, bool) else str(value)
