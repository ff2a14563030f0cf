"""Errata of a thing and of what is in it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from icdgen.icd.erratum import Erratum
from icdgen.icd.model import Enum, Member, Message, Struct
from icdgen.icd.places import NodePlace, places_in, scalars_in

Thing = Message | Struct | NodePlace | Enum | Member


def errata_of_message(message: Message) -> list[Erratum]:
    """Those of the message, of the structs in it and of its fields, each once."""
    return _each_once((message, *places_in(message.layout), *scalars_in(message.layout)))


def errata_of_enum(enum: Enum) -> list[Erratum]:
    """Those of the enumeration and of its members, each once."""
    return _each_once((enum, *enum.members))


def _each_once(things: Iterable[Thing]) -> list[Erratum]:
    return list(dict.fromkeys(erratum for thing in things for erratum in thing.errata))


def first_owners(things: Iterable[Thing]) -> dict[str, Thing]:
    """By the ids of errata: the first thing that has it, whose comment tells of it."""
    found: dict[str, Thing] = {}
    for thing in things:
        for erratum in thing.errata:
            found.setdefault(erratum.id, thing)
    return found


def owners_elsewhere(thing: NodePlace | Member, by: Mapping[str, Thing]) -> dict[str, str]:
    """By the ids of those errata of a thing that another one tells of: the name of that one."""
    return {one.id: by[one.id].name for one in thing.errata if by.get(one.id, thing) is not thing}
