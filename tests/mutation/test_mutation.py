"""The vectors detect changes of the ICD, and the measurement detects vectors that do
not.
"""

from __future__ import annotations

import copy
import random
from collections import Counter

import pytest

from tests.conformance.icds import icd_of, vectors_of
from tests.mutation.measure import LANGUAGES, measure
from tests.mutation.mutants import mutants


@pytest.fixture(scope="module")
def icd():
    return icd_of()


@pytest.fixture(scope="module")
def files(icd):
    return vectors_of(icd)


def test_every_number_of_a_message_is_changed(demo):
    kinds = Counter(mutant.kind for mutant in mutants(icd_of([demo])))
    assert (
        kinds["offset"] == 4 * 3
        and kinds["width"] == 2 * 3
        and kinds["id"] == kinds["length"] == 2 * 2
    )
    assert (
        kinds["enum value"] == 2 * 2 and kinds["byte order"] == kinds["bit order"] == 2
    )
    assert kinds["formula"] == 2 * 7  # 0.00, 0.02, 0.10, 0.001, -raw, + 1, none


def test_no_sampled_mutant_survives_in_any_language(icd, files):
    chosen = random.Random(2).sample(list(mutants(icd)), 24)
    *_, (_, scores, refused) = measure(icd, files, chosen, list(LANGUAGES.values()))
    for score in scores.values():
        assert score.survived == {} and score.crashed == []
        assert sum(score.killed.values()) + sum(score.same.values()) + sum(
            refused.values()
        ) == len(chosen)
        assert sum(score.killed.values()) > 8


def test_mutants_survive_poor_vectors(icd, files):
    """With frames of all zeros only, most changes are not detected."""
    poor = copy.deepcopy(files)
    for data in poor.values():
        for message in data["messages"]:
            del message["vectors"][1:]
            for field in message["fields"]:
                field.pop("unfit", None)
                field.pop("set", None)
    chosen = [
        m
        for m in mutants(icd)
        if m.node == "cubemag" and m.kind in ("swap", "offset", "type")
    ]
    *_, (_, scores, _) = measure(icd, poor, chosen, [LANGUAGES["python"]])
    assert sum(map(len, scores["python"].survived.values())) > 5
