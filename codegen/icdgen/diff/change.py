"""What a change is."""

from __future__ import annotations

from dataclasses import dataclass, field

from icdgen.diagnostics import Place
from icdgen.diff.pairs import Pair
from icdgen.diff.rule import Rule
from icdgen.diff.where import Where

CERTAIN, LIKELY = 0.95, 0.7  # from here on a match is called certain, likely; else uncertain


@dataclass(frozen=True, slots=True)
class Change:
    """One change. ``sure`` tells how sure it is that old and new are the same thing, 1 where the name says so."""

    rule: Rule
    message: str
    where: Where
    was: str
    now: str
    old: Place | None
    new: Place | None
    details: tuple[str, ...]
    severity: str  # "error" | "warning" | "note"
    addition: bool  # something came that nobody relied upon
    sure: float
    errata: tuple[str, ...]  # decisions about the manual that make the difference: "ACP-007 is new"
    pair: Pair = field(compare=False, repr=False)

    @property
    def code(self) -> str:
        return self.rule.code

    @property
    def layer(self) -> str:
        return self.rule.layer

    @property
    def breaks(self) -> bool:
        """Whether it can harm what relied upon the old ICD."""
        return self.severity != "note" and not self.addition

    @property
    def place(self) -> Place | None:
        """Where to look: in the new ICD if it is there."""
        return self.new or self.old

    @property
    def kind(self) -> str:
        """In a word: ``addition``, or how bad it is."""
        return "addition" if self.addition else self.severity

    @property
    def places(self) -> list[Place]:
        """Where it was and where it is."""
        return [place for place in (self.old, self.new) if place is not None]

    @property
    def certainty(self) -> str:
        """How sure it is that old and new are the same thing, in a word; empty for a match by name."""
        if self.sure >= 1:
            return ""
        return "certain" if self.sure >= CERTAIN else "likely" if self.sure >= LIKELY else "uncertain"

    @property
    def notes(self) -> list[str]:
        """What is said below a change: consequences, how sure the match is, decisions about the manual."""
        said = list(self.details)
        if self.certainty:
            said.append(f"Matched by similarity, {self.certainty} ({self.sure:.0%}).")
        if self.errata:
            said.append(f"Because erratum {', '.join(self.errata)}.")
        return said
