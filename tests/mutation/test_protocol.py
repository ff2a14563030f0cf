"""The wire vectors detect changes of a protocol section, and the measurement recognizes
a section without changes.
"""

from __future__ import annotations

import random

import pytest

from tests.conformance.icds import icd_of
from tests.mutation.protocol import REFERENCE, Mutant, measure, mutants

FRAMING = ("link", "buses", "uart", "framing")


@pytest.fixture(scope="module")
def icd():
    return icd_of()


def test_no_sampled_mutant_survives(icd, tmp_path):
    chosen = random.Random(4).sample(list(mutants(icd)), 6)
    results = measure(icd, chosen, [REFERENCE, "python"], tmp_path)
    assert [
        str(mutant) for mutant, ends in results.items() if "survived" in ends.values()
    ] == []


def test_another_escape_byte_is_detected_in_every_language(icd, tmp_path):
    framing = icd.node("common").protocol["link"]["buses"]["uart"]["framing"]
    other = Mutant("common", (*FRAMING, "escape"), framing["escape"] ^ 0x10)
    assert measure(icd, [other], [REFERENCE, "python"], tmp_path)[other] == {
        REFERENCE: "killed",
        "python": "killed",
    }


def test_a_node_that_only_repeats_the_section_answers_all_vectors(icd, tmp_path):
    framing = icd.node("common").protocol["link"]["buses"]["uart"]["framing"]
    same = Mutant("common", (*FRAMING, "escape"), framing["escape"])
    assert measure(icd, [same], [REFERENCE, "python"], tmp_path)[same] == {
        REFERENCE: "same",
        "python": "same",
    }
