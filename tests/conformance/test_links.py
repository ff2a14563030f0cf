"""Framed links: every language answers examples and unusual links like the reference
implementation.
"""

from __future__ import annotations

import json
import random

import pytest

from tests.conformance import ROOT, wire, wire_changed
from tests.conformance.build import build
from tests.conformance.compare import difference
from tests.conformance.driver import Testee
from tests.conformance.icds import LINKS, icd_of
from tests.conformance.languages import all_languages

FOLDERS = [ROOT / "examples" / "links", LINKS]


@pytest.fixture(scope="module")
def links():
    icd = icd_of(FOLDERS)
    return icd, wire.vectors_of(icd)


@pytest.mark.parametrize(
    "name", ["reference", "python", "c", "c-sanitizers", "rust-debug"]
)
def test_a_language_agrees_with_the_reference_on_links_of_all_kinds(links, name):
    icd, files = links
    (result,) = wire.run([all_languages()[name]], icd, files)
    assert result.differences == 0, "\n".join(result.shown)
    assert result.vectors == sum(len(node["cases"]) for node in files["nodes"]) > 2500


@pytest.mark.parametrize("name", ["python", "c-sanitizers", "rust-debug"])
def test_changed_requests_about_framed_links_are_answered_like_the_reference(
    links, name
):
    icd, files = links
    expected_answers = list(wire_changed.requests(icd, files, random.Random(7), 2000))
    testee = Testee(build(all_languages()[name], icd))
    answers = testee.ask(
        [json.dumps(request).encode() for request, _ in expected_answers]
    )
    differences = (
        (request, difference(good, answer))
        for (request, good), answer in zip(expected_answers, answers, strict=True)
    )
    assert [(request, what) for request, what in differences if what] == []
    assert testee.close() == 0, testee.complaint()
