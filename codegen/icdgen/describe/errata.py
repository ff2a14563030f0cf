"""Errata of a thing and of what is in it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from icdgen.icd.model import Enum, Erratum, Field, Member, Message


def errata_of_message(message: Message) -> list[Erratum]:
    """Those of the message and of its fields, each once."""
    return _each_once((message, *message.fields))


def errata_of_enum(enum: Enum) -> list[Erratum]:
    """Those of the enumeration and of its members, each once."""
    return _each_once((enum, *enum.members))


def _each_once(things: Iterable[Message | Field | Enum | Member]) -> list[Erratum]:
    return list(dict.fromkeys(erratum for thing in things for erratum in thing.errata))


def tellers(things: Iterable[Message | Field | Enum | Member]) -> dict[str, Message | Field | Enum | Member]:
    """By the ids of errata: the first thing that has it, whose comment tells of it."""
    found: dict[str, Message | Field | Enum | Member] = {}
    for thing in things:
        for erratum in thing.errata:
            found.setdefault(erratum.id, thing)
    return found


def told_elsewhere(thing: Field | Member, by: Mapping[str, Message | Field | Enum | Member]) -> dict[str, str]:
    """By the ids of those errata of a thing that another one tells of: the name of that one."""
    return {one.id: by[one.id].name for one in thing.errata if by.get(one.id, thing) is not thing}
