"""Errata of a thing and of what is in it."""

from __future__ import annotations

from collections.abc import Iterable

from icdgen.icd.model import Enum, Erratum, Field, Member, Message


def errata_of_message(message: Message) -> list[Erratum]:
    """Those of the message and of its fields, each once."""
    return _each_once((message, *message.fields))


def errata_of_enum(enum: Enum) -> list[Erratum]:
    """Those of the enumeration and of its members, each once."""
    return _each_once((enum, *enum.members))


def _each_once(things: Iterable[Message | Field | Enum | Member]) -> list[Erratum]:
    return list(dict.fromkeys(erratum for thing in things for erratum in thing.errata))
