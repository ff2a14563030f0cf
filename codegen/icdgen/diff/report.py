"""Everything that a report of a comparison tells, finished."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

from icdgen.diff.accepted import Acceptance, sort
from icdgen.diff.change import Change
from icdgen.diff.compare import Comparison, compare
from icdgen.diff.compatibility import Direction, directions
from icdgen.diff.inputs.side import Side
from icdgen.diff.layers import LAYERS
from icdgen.diff.uses import Use
from icdgen.diff.version import Step, step

ADDITIONS = "additions"


@dataclass
class Report:
    """``changes`` are those that nobody accepted. Places are as a user knows them."""

    old: Side
    new: Side
    comparison: Comparison
    changes: list[Change]
    accepted: list[tuple[Change, Acceptance]]
    stale: list[Acceptance]
    directions: tuple[Direction, ...]
    step: Step
    texts: dict[str, str]
    uses: Sequence[Use] | None = None  # None: nobody asked

    def of_layer(self, layer: str) -> list[Change]:
        return [change for change in self.changes if change.layer == layer]

    def counts(self) -> dict[str, int]:
        """Changes of each layer."""
        found = Counter(change.layer for change in self.changes)
        return {layer: found[layer] for layer in LAYERS}

    def fails(self, asked: Sequence[str]) -> list[Change]:
        """Changes of the layers asked for; additions only if they are asked for too."""
        return [c for c in self.changes if c.layer in asked and (not c.addition or ADDITIONS in asked)] + [
            c for c in self.changes if c.addition and ADDITIONS in asked and c.layer not in asked
        ]


def _placed(change: Change, old: Side, new: Side) -> Change:
    """With places as a user knows them; those of errata in their overlays."""
    places = []
    for side, place in ((old, change.old), (new, change.new)):
        erratum = change.where.erratum
        places.append(side.erratum(erratum) if erratum else side.place(place))
    old_place, new_place = places
    return (
        change if (change.old, change.new) == (old_place, new_place) else replace(change, old=old_place, new=new_place)
    )


def make(old: Side, new: Side, acceptances: Sequence[Acceptance] = ()) -> Report:
    """Compares two sides."""
    comparison = compare(old.icd, new.icd)
    comparison.changes = [_placed(change, old, new) for change in comparison.changes]
    found = sort(comparison.changes, list(acceptances))
    return Report(
        old, new, comparison, found.open, found.accepted, found.stale, directions(comparison), step(comparison.changes),
        {**old.texts, **new.texts},
    )  # fmt: skip
