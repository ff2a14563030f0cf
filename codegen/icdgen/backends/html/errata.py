"""The page of all errata and notes."""

from __future__ import annotations

from dataclasses import dataclass

from icdgen.backends.html.relations import Place, Relations
from icdgen.icd.erratum import Erratum
from icdgen.icd.model import Node

_FEW = 6
_LEVELS = ("certain", "likely", "open")


@dataclass(frozen=True, slots=True)
class Entry:
    """An erratum or a note, where it applies, and the names of the messages among that."""

    erratum: Erratum
    places: list[Place]
    more: list[Place]
    messages: list[str]


@dataclass(frozen=True, slots=True)
class Group:
    """Those of a node: anchor, title and entries of its errata and its notes."""

    node: Node
    kinds: list[tuple[str, str, list[Entry]]]


def values(relations: Relations) -> dict[str, object]:
    """Values of the page: of each node that has some, its errata and its notes in their order."""
    groups = [_group(relations, node) for node in relations.icd.nodes if node.errata]
    entries = [entry for group in groups for _, _, some in group.kinds for entry in some]
    return {
        "groups": groups,
        "messages": sorted({name for entry in entries for name in entry.messages}),
        "levels": [level for level in _LEVELS if any(entry.erratum.confidence == level for entry in entries)],
    }


def _group(relations: Relations, node: Node) -> Group:
    errata = [_entry(relations, one) for one in node.errata if not one.is_note]
    notes = [_entry(relations, one) for one in node.errata if one.is_note]
    return Group(node, [(f"{node.name}-errata", "Errata", errata), (f"{node.name}-notes", "Notes", notes)])


def _entry(relations: Relations, erratum: Erratum) -> Entry:
    places = relations.places[erratum.id, erratum.title]
    return Entry(erratum, places[:_FEW], places[_FEW:], list(dict.fromkeys(one.text.split(": ")[0] for one in places)))


def changed(erratum: Erratum) -> list[tuple[str, str, str]]:
    """Key, as printed, as held; for errata that change something."""
    printed = dict(erratum.printed)
    return [(key, shown(printed.get(key)), shown(held)) for key, held in erratum.held] if erratum.changes else []


def shown(value: object) -> str:
    """A value of the ICD file as text."""
    if value is None:
        return "absent"
    return str(value).lower() if isinstance(value, bool) else str(value)
