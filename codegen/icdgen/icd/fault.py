"""What a rule finds."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.diagnostics import Finding, Fix, Place, Related
from icdgen.icd.located import Map


class Fault(NamedTuple):
    """One breach of a rule. ``owner`` is the mapping that it concerns, by which an erratum's `accept` finds it."""

    owner: Map | None
    place: Place
    message: str
    help: str = ""
    fix: Fix | None = None
    related: Related | None = None

    @classmethod
    def of_place(cls, owner: Map | None, place: Place, message: str, help: str, fix: str = "") -> Fault:
        """A fault at any place; ``fix`` is what belongs there, if it is known."""
        return cls(owner, place, message, help, Fix(place, fix) if fix else None)

    @classmethod
    def at(cls, owner: Map, key: str, message: str, help: str, fix: str = "", related: Related | None = None) -> Fault:
        """A fault of the value of a key; ``fix`` is the right value as YAML, if it is known."""
        place = owner.at(key)
        return cls(owner, place, message, help, Fix(place, fix) if fix else None, related)

    @classmethod
    def at_key(cls, owner: Map, key: str, message: str, help: str, fix: str = "") -> Fault:
        """A fault of a key; ``fix`` is the right key as YAML, if it is known."""
        return cls.of_place(owner, owner.key_at(key), message, help, fix)

    def finding(self, code: str, severity: str = "error") -> Finding:
        """The fault as a finding of a rule."""
        return Finding(code, self.message, self.place, self.help, severity, self.fix, self.related)
