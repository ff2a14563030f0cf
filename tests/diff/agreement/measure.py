"""Run the vectors of the old ICDs on code generated from the new ones, and compare the
outcome with the diff.
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
from tests.diff.agreement.demands import all_cases, on_the_wire, plain
from tests.diff.agreement.pieces import EditCase

STEPS = (4, 40, 10**9)  # requests that are sent before the answers are compared


@dataclass
class Score:
    """Number of edits by verdict of the diff, number of failed vectors, and the
    disagreements.
    """

    wire: int = 0
    no_wire: int = 0
    # text changes only: all vectors pass
    unchanged: int = 0
    by_edit: Counter = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)


def measure(cases: list[EditCase], language: Language, folder: Path) -> Score:
    """Build all new ICDs at once and send each the requests of the old vectors. Raises
    `BuildError`.
    """
    score = Score()
    testee = Testee(build(language, Icd(tuple(case.node for case in cases)), folder))
    for case in cases:
        score.by_edit[case.edit] += 1
        _judge(case, testee, score)
    testee.close()
    return score


def _judge(case: EditCase, testee: Testee, score: Score) -> None:
    comparison = compare(case.old, case.new)
    layers = {change.layer for change in comparison.changes}
    data = json.loads(vector_file_text(make_vectors(case.old, case.old.nodes[0])))
    other_ids = tuple(
        number for message in case.node.messages for number in message.ids
    )
    failure = _first_failure(
        testee, on_the_wire(data, comparison, other_ids), wire=True
    )
    change_texts = [f"{change.code} {change.message}" for change in comparison.changes]
    about = f"{case.edit} of {case.old.nodes[0].messages[0].name!r}: {change_texts}"
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
    # The vectors use the names of the manual.
    respelled = any(change.code == "DIF406" for change in comparison.changes)
    if not layers & {MEANING, SOURCE} and not respelled:
        score.unchanged += 1
        failure = _first_failure(testee, all_cases(data), wire=False)
        if failure is not None:
            score.wrong.append(f"{about}: words only, and a vector fails: {failure}")


def _first_failure(testee: Testee, demands: Iterable[Demand], wire: bool) -> str | None:
    rows, first = list(demands), 0
    for last in STEPS:
        part = rows[first:last]
        replies = testee.ask([json.dumps(case.request).encode() for case in part])
        for case, reply in zip(part, replies, strict=True):
            if wire and reply is not None:
                reply = json.dumps(plain(json.loads(reply))).encode()
            difference_text = difference(
                plain(case.answer) if wire else case.answer, reply
            )
            if difference_text is not None:
                return f"{case.about}: {difference_text}"
        first = last
    return None
