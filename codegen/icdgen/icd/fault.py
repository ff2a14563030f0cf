"""Result of a rule: a fault, with its place and remedy.

Rules yield faults. `icdgen.icd.rules.check` makes findings of those that no erratum
accepts.
"""

from __future__ import annotations

from icdgen.diagnostics import Finding, Fix, Place, Related
from icdgen.frozen import NamedTuple
from icdgen.icd.located import Map


class Fault(NamedTuple):
    """A violation of a rule.

    An erratum with `accept` on the mapping ``owner`` suppresses it.
    """

    owner: Map | None
    place: Place
    message: str
    help: str = ""
    fix: Fix | None = None
    related: Related | None = None

    @classmethod
    def of_place(
        cls, owner: Map | None, place: Place, message: str, help: str, fix: str = ""
    ) -> Fault:
        """Return a fault at any place; ``fix`` is the replacement text, if it is known."""
        return cls(owner, place, message, help, Fix(place, fix) if fix else None)

    @classmethod
    def at(
        cls,
        owner: Map,
        key: str,
        message: str,
        help: str,
        fix: str = "",
        related: Related | None = None,
    ) -> Fault:
        """Return a fault of the value of a key; ``fix`` is the correct value as YAML,
        if it is known.
        """
        place = owner.at(key)
        return cls(
            owner, place, message, help, Fix(place, fix) if fix else None, related
        )

    @classmethod
    def at_key(
        cls, owner: Map, key: str, message: str, help: str, fix: str = ""
    ) -> Fault:
        """Return a fault of a key itself; ``fix`` is the correct key as YAML, if it is
        known.
        """
        return cls.of_place(owner, owner.key_at(key), message, help, fix)

    def finding(self, code: str, severity: str = "error") -> Finding:
        """Return the fault as a finding with the code of its rule."""
        return Finding(
            code, self.message, self.place, self.help, severity, self.fix, self.related
        )
