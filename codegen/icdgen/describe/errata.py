"""Errata of messages, enumerations and their parts.

An erratum can concern several fields. Its explanation stands in the comment of the
first one (`first_owners`); the other comments refer to it (`owners_elsewhere`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from icdgen.icd.erratum import Erratum
from icdgen.icd.layout import UNDECLARED, LayoutNode
from icdgen.icd.layout_nodes import walk
from icdgen.icd.model import Enum, Member, Message, Struct
from icdgen.icd.places import NodePlace

PartWithErrata = Message | Struct | NodePlace | Enum | Member


def errata_of_message(message: Message) -> list[Erratum]:
    """Return the errata of a message, of its structs and of its fields, each once."""
    inner = (visit.node for visit in walk(message.layout, UNDECLARED))
    return _each_once((message, *message.layout.nodes, *inner))


def errata_of_enum(enum: Enum) -> list[Erratum]:
    """Return the errata of an enumeration and of its members, each once."""
    return _each_once((enum, *enum.members))


def _each_once(things: Iterable[PartWithErrata | LayoutNode]) -> list[Erratum]:
    # An erratum can hold a mapping, so it cannot be compared by its hash.
    by_id: dict[str, Erratum] = {}
    for thing in things:
        for erratum in thing.errata:
            by_id.setdefault(erratum.id, erratum)
    return list(by_id.values())


def first_owners(things: Iterable[PartWithErrata]) -> dict[str, PartWithErrata]:
    """Return the first part with each erratum, by its id.

    The comment of that part explains the erratum.
    """
    owners: dict[str, PartWithErrata] = {}
    for thing in things:
        for erratum in thing.errata:
            owners.setdefault(erratum.id, thing)
    return owners


def owners_elsewhere(
    thing: NodePlace | Member, by: Mapping[str, PartWithErrata]
) -> dict[str, str]:
    """Return, for errata of a part that the comment of another part explains, the name
    of that part by the id of the erratum.
    """
    return {
        erratum.id: by[erratum.id].name
        for erratum in thing.errata
        if by.get(erratum.id, thing) is not thing
    }
