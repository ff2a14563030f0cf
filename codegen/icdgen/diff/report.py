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
    uses: Sequence[Use] | None = None  # None: nobody asked

    def of_layer(self, layer: str) -> list[Change]:
        return [change for change in self.changes if change.layer == layer]

    def counts(self) -> dict[str, int]:
        """Changes of each layer."""
        found = Counter(change.layer for change in self.changes)
        return {layer: found[layer] for layer in LAYERS}

    def additions(self, layer: str) -> int:
        """How many of the layer's changes are additions."""
        return sum(1 for change in self.of_layer(layer) if change.addition)

    def fails(self, asked: Sequence[str]) -> list[Change]:
        """Changes of the layers asked for; additions only if they are asked for too."""
        return [c for c in self.changes if (ADDITIONS if c.addition else c.layer) in asked]


def _placed(change: Change, old: Side, new: Side) -> Change:
    """With places as a user knows them."""
    places = old.place(change.old), new.place(change.new)
    return change if places == (change.old, change.new) else replace(change, old=places[0], new=places[1])


def make(old: Side, new: Side, acceptances: Sequence[Acceptance] = ()) -> Report:
    """Compares two sides."""
    comparison = compare(old.icd, new.icd)
    comparison.changes = [_placed(change, old, new) for change in comparison.changes]
    sorted_changes = sort(comparison.changes, acceptances)
    return Report(old, new, comparison, *sorted_changes, directions(comparison), step(comparison.changes))
