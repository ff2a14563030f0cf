"""Change between two ICDs: the result of a rule, as all reports receive it.

`icdgen.diff.compare` creates the changes from the results of the rules.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from icdgen.diagnostics import Place
from icdgen.diff.pairs import Pair
from icdgen.diff.rule import DiffRule
from icdgen.diff.where import Where

# Lower limits of the confidence of certain and likely matches
CERTAIN, LIKELY = 0.95, 0.7


@dataclass(frozen=True, slots=True)
class Change:
    """Change between two ICDs.

    ``confidence``: from 0 to 1, that old and new side are the same object; 1 if the
    names are equal.
    """

    rule: DiffRule
    message: str
    where: Where
    was: str
    now: str
    old: Place | None
    new: Place | None
    details: tuple[str, ...]
    severity: str  # "error" | "warning" | "note"
    addition: bool  # new object that existing software does not depend on
    confidence: float
    errata: tuple[str, ...]  # errata that cause the change: "ACP-007 is new"
    pair: Pair = field(compare=False, repr=False)

    @property
    def code(self) -> str:
        return self.rule.code

    @property
    def layer(self) -> str:
        return self.rule.layer

    @property
    def breaks(self) -> bool:
        """Whether the change can break software that uses the old ICD."""
        # Additions extend the interface; existing software ignores them.
        return self.severity != "note" and not self.addition

    @property
    def place(self) -> Place | None:
        """Place of the change: in the new ICD if the object exists there."""
        return self.new or self.old

    @property
    def kind(self) -> str:
        """``addition``, or the severity."""
        return "addition" if self.addition else self.severity

    @property
    def places(self) -> list[Place]:
        """Places in the old and in the new ICD."""
        return [place for place in (self.old, self.new) if place is not None]

    @property
    def certainty(self) -> str:
        """Confidence of the match as a word; empty for a match by name."""
        if self.confidence >= 1:
            return ""
        if self.confidence >= CERTAIN:
            return "certain"
        return "likely" if self.confidence >= LIKELY else "uncertain"

    @property
    def notes(self) -> list[str]:
        """Notes of the change: consequences, confidence of the match, errata."""
        notes = list(self.details)
        if self.certainty:
            notes.append(
                f"Matched by similarity, {self.certainty} ({self.confidence:.0%})."
            )
        if self.errata:
            notes.append(f"Because erratum {', '.join(self.errata)}.")
        return notes
