"""Measures which output supports which feature."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

import yaml
from hypothesis import HealthCheck, Phase, given, seed, settings

from icdgen.icd.model import Icd
from tests.conformance import odd
from tests.conformance.icds import LINKS, SHIPPED
from tests.conformance.strategies import icds as random_icds
from tests.features.data import Feature
from tests.features.outputs import (
    LINKED,
    RESULTS,
    Rejected,
    Subject,
    frames_of,
    icd_of,
    is_change_reported,
    is_formatted,
    words_of,
)
from tests.mutation.mutants import mutants, unchanged

# Number of random ICDs in which a feature must occur; most occur in the first draw.
AT_ONCE, DRAWS = 5, 180
BUILT = (
    "c",
    "python",
    "rust",
    "javascript",
)  # the conformance run builds and runs their code, also of the odd ICDs


@dataclass(frozen=True)
class Cell:
    """Whether an output supports a feature.

    ``reason`` is the error of the output for a wrong use, or why it has no support.
    """

    has: bool
    reason: str = ""


def row(feature: Feature, folder: Path) -> dict[str, Cell]:
    """Return for each output, by its key, whether it supports the feature."""
    icd = icd_of(feature.example, folder)
    frames = frames_of(icd)
    subject = partial(
        Subject, feature, folder=folder, frames=frames, words=words_of(icd, frames)
    )
    example, changed = (
        subject(content=feature.example),
        subject(content=feature.changed()),
    )
    cells = {name: _cell(name, example, changed) for name in RESULTS}
    # The decoder of the site has no other input than the data in its pages.
    cells["javascript"] = cells["site"]
    for name in BUILT:
        if cells[name].has and not feature.places(_conformance_icds()):
            cells[name] = Cell(False, "no ICD of the conformance run has it")
    # To prove that a feature is absent, all draws would be necessary.
    draws = 1 if "random" in feature.without else DRAWS
    cells["random"] = Cell(
        any(feature.places(_random(number)) for number in range(draws))
    )
    cells["mutation"] = Cell(_mutated(feature, icd))
    cells["fuzz"] = Cell(bool(feature.places(_conformance_icds())))
    cells["fmt"] = Cell(is_formatted(example))
    cells["check"] = _check(feature, folder)
    cells["diff"] = Cell(is_change_reported(example, changed))
    return cells


def _cell(name: str, example: Subject, changed: Subject) -> Cell:
    try:
        return Cell(_result(name, example) != _result(name, changed))
    except Rejected as error:
        return Cell(False, str(error))


# Results by output, ICD and, for outputs that need a link, feature: several features
# share an example.
_results: dict[tuple[str, ...], str] = {}


def _result(name: str, subject: Subject) -> str:
    """Return the result of an output as text, without the digest of the file.

    A text, because a NaN does not equal another NaN.
    """
    key = (name, subject.content, subject.feature.name if name in LINKED else "")
    if key not in _results:
        text = repr(RESULTS[name](subject))
        _results[key] = text.replace(subject.node.digest, "").replace(
            subject.node.digest[:16], ""
        )
    return _results[key]


def _check(feature: Feature, folder: Path) -> Cell:
    try:
        icd_of(feature.with_error(), folder)
    except Rejected as error:
        return Cell(True, str(error))
    return Cell(False)


def _mutated(feature: Feature, icd: Icd) -> bool:
    """Return whether a mutant changes only the use of the feature."""
    originals = {
        original.message: feature.places(original.tree)
        for original in unchanged(icd)
        if original.message
    }
    return any(
        feature.places(mutant.tree) != originals[mutant.message]
        for mutant in mutants(icd)
        if mutant.message and originals[mutant.message]
    )


@cache
def _conformance_icds() -> list[object]:
    """Return the ICDs of the conformance run, on which the fuzz harnesses also run, as
    trees.
    """
    with tempfile.TemporaryDirectory() as folder:
        odds = odd.write(Path(folder)).glob("*.yaml")
        files = sorted((*SHIPPED.glob("*.yaml"), *odds, *LINKS.glob("*.yaml")))
        return [yaml.load(file.read_bytes(), yaml.CSafeLoader) for file in files]


@cache
def _random(number: int) -> list[object]:
    icds: list[object] = []

    @seed(number)
    @settings(
        max_examples=AT_ONCE,
        database=None,
        phases=(Phase.generate,),
        suppress_health_check=list(HealthCheck),
    )
    @given(random_icds())
    def draw(trees: dict[str, dict]) -> None:
        icds.extend(trees.values())

    draw()
    return icds
