"""Runs the vectors of the old ICDs on code generated from the new ones, and holds the
outcome against the diff.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from icdgen.diff.compare import compare
from icdgen.diff.layers import MEANING, SOURCE, WIRE
from icdgen.icd.model import Icd
from icdgen.vectors.make import make_vectors
from icdgen.vectors.write import vector_file_text
from tests.conformance.build import build
from tests.conformance.cases import Case as Demand
from tests.conformance.compare import difference
from tests.conformance.driver import Testee
from tests.conformance.languages import Language
from tests.diff.agreement.demands import altogether, on_the_wire, plain
from tests.diff.agreement.pieces import Case

STEPS = (4, 40, 10**9)  # so many demands are put before the answers are looked at


@dataclass
class Score:
    """How many edits the diff called a change of the wire, of how many a vector failed,
    and where the two disagree.
    """

    wire: int = 0
    no_wire: int = 0
    # no wire, meaning or source: all vectors pass, whatever they look at
    nothing: int = 0
    by_edit: Counter = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)


def measure(cases: list[Case], language: Language, folder: Path) -> Score:
    """Builds all new ICDs at once and asks each what the old one's vectors demand.

    Raises `BuildError`.
    """
    score = Score()
    testee = Testee(build(language, Icd(tuple(case.node for case in cases)), folder))
    for case in cases:
        score.by_edit[case.edit] += 1
        _judge(case, testee, score)
    testee.close()
    return score


def _judge(case: Case, testee: Testee, score: Score) -> None:
    comparison = compare(case.old, case.new)
    layers = {change.layer for change in comparison.changes}
    data = json.loads(vector_file_text(make_vectors(case.old, case.old.nodes[0])))
    others = tuple(number for message in case.node.messages for number in message.ids)
    failure = _first_failure(testee, on_the_wire(data, comparison, others), wire=True)
    said = [f"{change.code} {change.message}" for change in comparison.changes]
    about = f"{case.edit} of {case.old.nodes[0].messages[0].name!r}: {said}"
    if WIRE in layers:
        score.wire += 1
        if failure is None:
            score.wrong.append(
                f"{about}: a change of the wire, and every vector passes"
            )
        return
    score.no_wire += 1
    if failure is not None:
        score.wrong.append(
            f"{about}: no change of the wire, and a vector fails: {failure}"
        )
    respelled = any(
        change.code == "DIF406" for change in comparison.changes
    )  # vectors speak in the manual's names
    if not layers & {MEANING, SOURCE} and not respelled:
        score.nothing += 1
        failure = _first_failure(testee, altogether(data), wire=False)
        if failure is not None:
            score.wrong.append(f"{about}: words only, and a vector fails: {failure}")


def _first_failure(testee: Testee, demands: Iterable[Demand], wire: bool) -> str | None:
    rows, first = list(demands), 0
    for last in STEPS:
        part = rows[first:last]
        replies = testee.ask([json.dumps(one.request).encode() for one in part])
        for one, reply in zip(part, replies, strict=True):
            if wire and reply is not None:
                reply = json.dumps(plain(json.loads(reply))).encode()
            found = difference(plain(one.answer) if wire else one.answer, reply)
            if found is not None:
                return f"{one.about}: {found}"
        first = last
    return None
