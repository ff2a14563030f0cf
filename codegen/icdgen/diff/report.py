"""Content of a report on a comparison, before it is written in a format.

`make_report` is the entry of the package: it compares two sides and evaluates the
result. The formats are in ``reports``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

from icdgen.diff.accepted import Acceptance, sort_changes
from icdgen.diff.change import Change
from icdgen.diff.compare import Comparison, compare
from icdgen.diff.compatibility import DirectionCompatibility, directions
from icdgen.diff.inputs.side import ComparisonSide
from icdgen.diff.layers import LAYERS
from icdgen.diff.uses import NameUse
from icdgen.diff.version import VersionStep, step

ADDITIONS = "additions"


@dataclass
class DiffReport:
    """Report on a comparison.

    ``changes`` contains the changes that are not accepted. Places refer to files as the
    user named them.
    """

    old: ComparisonSide
    new: ComparisonSide
    comparison: Comparison
    changes: list[Change]
    accepted: list[tuple[Change, Acceptance]]
    stale: list[Acceptance]
    directions: tuple[DirectionCompatibility, ...]
    step: VersionStep
    uses: Sequence[NameUse] | None = None  # None: not requested

    def of_layer(self, layer: str) -> list[Change]:
        return [change for change in self.changes if change.layer == layer]

    def counts(self) -> dict[str, int]:
        """Return the number of changes of each layer."""
        counts = Counter(change.layer for change in self.changes)
        return {layer: counts[layer] for layer in LAYERS}

    def additions(self, layer: str) -> int:
        """Return the number of additions of a layer."""
        return sum(1 for change in self.of_layer(layer) if change.addition)

    def fails(self, layers: Sequence[str]) -> list[Change]:
        """Return the changes of the given layers that make the command fail.

        Additions count only if ``additions`` is given.
        """
        return [
            c for c in self.changes if (ADDITIONS if c.addition else c.layer) in layers
        ]


def _placed(change: Change, old: ComparisonSide, new: ComparisonSide) -> Change:
    """Return the change with places in files as the user named them."""
    places = old.place(change.old), new.place(change.new)
    return (
        change
        if places == (change.old, change.new)
        else replace(change, old=places[0], new=places[1])
    )


def make_report(
    old: ComparisonSide, new: ComparisonSide, acceptances: Sequence[Acceptance] = ()
) -> DiffReport:
    """Return the report on two sides."""
    comparison = compare(old.icd, new.icd)
    comparison.changes = [_placed(change, old, new) for change in comparison.changes]
    sorted_changes = sort_changes(comparison.changes, acceptances)
    return DiffReport(
        old,
        new,
        comparison,
        *sorted_changes,
        directions(comparison),
        step(comparison.changes),
    )
