"""Semantic version step of the generated packages that a set of changes requires."""

from __future__ import annotations

from collections import Counter

from icdgen.diff.change import Change
from icdgen.diff.layers import LAYERS
from icdgen.frozen import NamedTuple
from icdgen.wording import count, listing

MAJOR, MINOR, PATCH, NONE = "major", "minor", "patch", "none"


class VersionStep(NamedTuple):
    """Version step with its reason.

    ``step``: ``major``, ``minor``, ``patch`` or ``none``. ``deciding``: codes of the
    changes that decide.
    """

    step: str
    reason: str
    deciding: tuple[str, ...] = ()


def step(changes: list[Change]) -> VersionStep:
    """Return the step of Semantic Versioning. Accepted changes count too."""
    breaking = [change for change in changes if change.breaks]
    additions = [change for change in changes if change.addition]
    # https://semver.org: an incompatible change of any layer is a major step.
    if breaking:
        counts = Counter(change.layer for change in breaking)
        counts_by_layer = [
            f"{count(counts[layer], 'change')} of {_OF[layer]}"
            for layer in LAYERS
            if counts[layer]
        ]
        return VersionStep(
            MAJOR,
            f"{listing(counts_by_layer)}, the first: {breaking[0].message}",
            _codes(breaking),
        )
    if additions:
        number = count(len(additions), "addition")
        reason = f"nothing breaks, {number}, the first: {additions[0].message}"
        return VersionStep(MINOR, reason, _codes(additions))
    if changes:
        return VersionStep(
            PATCH, f"{count(len(changes), 'change')} of words only", _codes(changes)
        )
    return VersionStep(NONE, "nothing changed")


_OF = {
    "wire": "the wire format",
    "meaning": "meaning",
    "source": "generated names or types",
    "text": "words",
}


def _codes(changes: list[Change]) -> tuple[str, ...]:
    return tuple(sorted({change.code for change in changes}))
