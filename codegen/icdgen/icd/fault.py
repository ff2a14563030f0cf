"""What a rule finds."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.diagnostics import Place
from icdgen.icd.located import Map


class Fault(NamedTuple):
    """One breach of a rule. ``owner`` is the mapping that it concerns, by which an erratum's `accept` finds it."""

    owner: Map | None
    place: Place
    message: str
    help: str = ""

    @classmethod
    def at(cls, owner: Map, key: str, message: str, help: str) -> Fault:
        """What is wrong with the value of a key."""
        return cls(owner, owner.at(key), message, help)

    @classmethod
    def at_key(cls, owner: Map, key: str, message: str, help: str) -> Fault:
        """What is wrong with there being a key."""
        return cls(owner, owner.key_at(key), message, help)
