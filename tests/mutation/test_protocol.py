"""The wire vectors notice changes of a protocol section, and the measurement notices when nothing changed."""

from __future__ import annotations

import random

import pytest

from tests.conformance.icds import icd_of
from tests.mutation.protocol import REFERENCE, Mutant, measure, mutants


@pytest.fixture(scope="module")
def icd():
    return icd_of()


def test_no_sampled_mutant_survives(icd, tmp_path):
    chosen = random.Random(4).sample(list(mutants(icd)), 6)
    found = measure(icd, chosen, [REFERENCE, "python"], tmp_path)
    assert [str(mutant) for mutant, ends in found.items() if "survived" in ends.values()] == []
    assert sum("killed" in ends.values() for ends in found.values()) >= 3


def test_a_node_that_only_repeats_the_section_answers_all_vectors(icd, tmp_path):
    framing = icd.node("common").protocol["uart"]["framing"]
    same = Mutant("common", ("uart", "framing", "escape"), framing["escape"])
    assert measure(icd, [same], [REFERENCE, "python"], tmp_path)[same] == {REFERENCE: "same", "python": "same"}
