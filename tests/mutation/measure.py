"""Runs the unchanged vectors on mutants, in batches, and counts the results."""

from __future__ import annotations

import tempfile
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from icdgen.icd.model import Icd
from tests.conformance.build import build
from tests.conformance.cases import (
    Case,
    MessageCases,
    enum_cases,
    member_names,
    node_itself,
)
from tests.conformance.compare import difference
from tests.conformance.driver import Testee
from tests.conformance.languages import Language
from tests.conformance.languages import c as c_language
from tests.conformance.languages import python as python_language
from tests.conformance.languages import rust as rust_language
from tests.conformance.robust import line
from tests.mutation.batches import Batch, baseline, key, prepare, split
from tests.mutation.meaning import is_same_meaning
from tests.mutation.mutants import Mutant, unchanged

# Not optimised: a mutant is built once and run for a moment.
LANGUAGES = {
    "c": Language(
        "c",
        c_language.BACKENDS,
        ("gcc",),
        partial(c_language.build, compiler="gcc", flags=("-O0",)),
    ),
    "python": next(
        language for language in python_language.LANGUAGES if language.name == "python"
    ),
    "rust": Language(
        "rust",
        rust_language.BACKENDS,
        ("cargo", "rustc"),
        partial(rust_language.build, profile="dev"),
    ),
}

ANY = "@"  # placeholder for the mutant's node in prepared requests
STEPS = (
    6,
    40,
    400,
    10**9,
)  # numbers of cases after which the answers of a mutant are compared


@dataclass
class Score:
    """Results of the mutants in one language, by kind of change."""

    killed: Counter = field(default_factory=Counter)
    # rejected by the rules, and also killed by the vectors or not
    rejected_and_killed: Counter = field(default_factory=Counter)
    rejected_and_survived: Counter = field(default_factory=Counter)
    # survived, and provably have the same meaning
    same: Counter = field(default_factory=Counter)
    survived: dict[str, list[str]] = field(default_factory=lambda: defaultdict(list))
    crashed: list[str] = field(default_factory=list)


@dataclass
class Prepared:
    """A case as bytes to send, except for the name of the node."""

    start: bytes
    end: bytes
    answer: dict

    def line(self, node: str) -> bytes:
        return self.start + node.encode() + self.end


class Vectors:
    """The cases of every message and enumeration, prepared at first use."""

    def __init__(self, files: dict[str, dict]) -> None:
        self.files, self.enums = files, member_names(files)
        self.messages = {
            (node, m["name"]): m
            for node, data in files.items()
            for m in data["messages"]
        }
        self.prepared: dict[tuple, list[Prepared]] = {}

    def of(self, mutant: Mutant) -> list[Prepared]:
        name = key(mutant)
        if name not in self.prepared:
            # Limit the memory; most mutants of a message follow each other.
            if len(self.prepared) > 20:
                self.prepared.clear()
            self.prepared[name] = [_prepared(case) for case in self._cases(mutant)]
        return self.prepared[name]

    def _cases(self, mutant: Mutant) -> Iterable[Case]:
        data = self.files[mutant.node]
        if mutant.enum is not None:
            return (
                case
                for case in enum_cases({**data, "node": ANY})
                if case.request["enum"] == mutant.enum
            )
        if mutant.message is None:
            return [node_itself({**data, "node": ANY})]
        message = self.messages[mutant.node, mutant.message]
        cases = MessageCases(ANY, message, self.enums, data["never_set"])
        return sorted(
            cases.all(), key=lambda case: case.request["op"] != "constants"
        )  # first the cheap case that detects most changes


def _prepared(case: Case) -> Prepared:
    text = line(case.request)
    start, end = text.split(b'"node": "@"', 1)
    return Prepared(start + b'"node": "', b'"' + end, case.answer)


def measure(
    icd: Icd, files: dict[str, dict], chosen: list[Mutant], languages: list[Language]
) -> Iterator[tuple[int, dict[str, Score], dict[str, int]]]:
    """Yield after each batch the number of finished mutants, the score of each
    language, and the number of rejected mutants.

    Raises `BuildError`.
    """
    scores = {language.name: Score() for language in languages}
    refused: Counter = Counter()
    vectors = Vectors(files)
    with tempfile.TemporaryDirectory() as folder:
        accepted = baseline(list(unchanged(icd)), Path(folder))
    done = 0
    for part in split(chosen):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "icd").mkdir()
            batch = prepare(part, folder / "icd", accepted)
            refused.update(batch.mutants[name].kind for name in batch.refused)
            for language in languages:
                run(
                    icd,
                    batch,
                    language,
                    vectors,
                    scores[language.name],
                    folder / "build",
                )
        done += len(part)
        yield done, scores, dict(refused)


def run(
    icd: Icd,
    batch: Batch,
    language: Language,
    vectors: Vectors,
    score: Score,
    folder: Path,
) -> None:
    """Build the batch and run the vectors of every mutant until one fails."""
    alive = [node.name for node in batch.icd.nodes]
    if not alive:
        return
    # Most mutants fail one of the first cases. The number of cases therefore grows in
    # steps.
    testee = Testee(build(language, batch.icd, folder))
    first = 0
    for last in STEPS:
        alive = [
            name
            for name in alive
            if _survives(testee, batch, name, vectors, score, first, last)
        ]
        first = last
    testee.close()
    for name in alive:
        mutant = batch.mutants[name]
        if name in batch.refused:
            score.rejected_and_survived[mutant.kind] += 1
        elif _means_the_same(icd, batch, name):
            score.same[mutant.kind] += 1
        else:
            score.survived[mutant.kind].append(mutant.about)


def _survives(
    testee: Testee,
    batch: Batch,
    name: str,
    vectors: Vectors,
    score: Score,
    first: int,
    last: int,
) -> bool:
    mutant = batch.mutants[name]
    cases = vectors.of(mutant)[first:last]
    replies = testee.ask([case.line(name) for case in cases])
    if name not in batch.refused and any(reply is None for reply in replies):
        score.crashed.append(f"{mutant.kind}: {mutant.about}: {testee.complaint()}")
    if all(
        difference(case.answer, reply) is None
        for case, reply in zip(cases, replies, strict=True)
    ):
        return True
    (score.rejected_and_killed if name in batch.refused else score.killed)[
        mutant.kind
    ] += 1
    return False


def _means_the_same(icd: Icd, batch: Batch, name: str) -> bool:
    mutant, node = batch.mutants[name], icd.node(batch.mutants[name].node)
    if mutant.message is None:
        return False
    message = next(m for m in node.messages if m.name == mutant.message)
    other = batch.node(name)
    return is_same_meaning(node, message, other, other.messages[0])
