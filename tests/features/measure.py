"""Measures which output has which feature."""

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
    SAYS,
    Refused,
    Subject,
    differs,
    frames_of,
    icd_of,
    laid_out,
    words_of,
)
from tests.mutation.mutants import mutants, unchanged

# Random ICDs: in so many a feature must turn up; most do in the first.
AT_ONCE, DRAWS = 5, 180
BUILT = (
    "c",
    "python",
    "rust",
    "javascript",
)  # whose code is built and asked, of the odd ICDs, by the conformance run


@dataclass(frozen=True)
class Cell:
    """Whether an output has a feature; ``says`` is what it says of it wrongly said, or
    what keeps it from having it.
    """

    has: bool
    says: str = ""


def row(feature: Feature, folder: Path) -> dict[str, Cell]:
    """What each output, by its key, makes of the feature."""
    icd = icd_of(feature.example, folder)
    frames = frames_of(icd)
    of = partial(
        Subject, feature, folder=folder, frames=frames, words=words_of(icd, frames)
    )
    example, changed = of(content=feature.example), of(content=feature.changed())
    cells = {name: _cell(name, example, changed) for name in SAYS}
    cells["javascript"] = cells[
        "site"
    ]  # the codec of the site works on what stands in its pages
    for name in BUILT:
        if cells[name].has and not feature.places(_tried()):
            cells[name] = Cell(False, "no ICD of the conformance run has it")
    draws = 1 if "random" in feature.without else DRAWS
    cells["random"] = Cell(
        any(feature.places(_random(number)) for number in range(draws))
    )
    cells["mutation"] = Cell(_mutated(feature, icd))
    cells["fuzz"] = Cell(bool(feature.places(_tried())))
    cells["fmt"] = Cell(laid_out(example))
    cells["check"] = _check(feature, folder)
    cells["diff"] = Cell(differs(example, changed))
    return cells


def _cell(name: str, example: Subject, changed: Subject) -> Cell:
    try:
        return Cell(_said(name, example) != _said(name, changed))
    except Refused as refused:
        return Cell(False, str(refused))


_remembered: dict[tuple[str, ...], str] = {}


def _said(name: str, subject: Subject) -> str:
    """What an output says, as text, for no NaN equals another, and but for the digest
    of the file.
    """
    key = (name, subject.content, subject.feature.name if name in LINKED else "")
    if key not in _remembered:
        text = repr(SAYS[name](subject))
        _remembered[key] = text.replace(subject.node.digest, "").replace(
            subject.node.digest[:16], ""
        )
    return _remembered[key]


def _check(feature: Feature, folder: Path) -> Cell:
    try:
        icd_of(feature.spoilt(), folder)
    except Refused as refused:
        return Cell(True, str(refused))
    return Cell(False)


def _mutated(feature: Feature, icd: Icd) -> bool:
    """Whether there is a mutant in which the feature alone is said otherwise."""
    as_it_is = {
        one.message: feature.places(one.tree) for one in unchanged(icd) if one.message
    }
    return any(
        feature.places(one.tree) != as_it_is[one.message]
        for one in mutants(icd)
        if one.message and as_it_is[one.message]
    )


@cache
def _tried() -> list[object]:
    """The ICDs of the conformance run, on which the fuzz harnesses are run in the tests
    as well, as trees.
    """
    with tempfile.TemporaryDirectory() as folder:
        odds = odd.write(Path(folder)).glob("*.yaml")
        files = sorted((*SHIPPED.glob("*.yaml"), *odds, *LINKS.glob("*.yaml")))
        return [yaml.load(file.read_bytes(), yaml.CSafeLoader) for file in files]


@cache
def _random(number: int) -> list[object]:
    found: list[object] = []

    @seed(number)
    @settings(
        max_examples=AT_ONCE,
        database=None,
        phases=(Phase.generate,),
        suppress_health_check=list(HealthCheck),
    )
    @given(random_icds())
    def draw(trees: dict[str, dict]) -> None:
        found.extend(trees.values())

    draw()
    return found
