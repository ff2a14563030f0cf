"""The generated code agrees with the diff on a sample of edits. ``python -m
tests.diff.agreement`` tries 500 edits.
"""

from __future__ import annotations

import pytest

from icdgen.diff.compare import compare
from tests.conformance.icds import icd_of
from tests.diff.agreement import measure as measuring
from tests.diff.agreement.measure import measure
from tests.diff.agreement.pieces import cases
from tests.diff.edits import BEYOND, EDITS
from tests.mutation.measure import LANGUAGES


@pytest.fixture(scope="module")
def icd():
    return icd_of()


def test_vectors_fail_exactly_if_the_diff_reports_a_wire_change(icd, tmp_path):
    score = measure(cases(icd, 90, seed=7), LANGUAGES["python"], tmp_path)
    assert score.wrong == []
    assert set(score.by_edit) == set(EDITS) - set(BEYOND)
    assert score.wire > 25 and score.no_wire > 25 and score.unchanged > 5


@pytest.mark.parametrize("hidden", ["wire", "others"])
def test_the_measurement_detects_a_wrong_diff(icd, tmp_path, monkeypatch, hidden):
    """Simulate a diff that misses changes of the wire, and one that reports every
    change as one of the wire.
    """
    wire = next(
        c
        for case in cases(icd, 41, seed=1)
        for c in compare(case.old, case.new).changes
        if c.layer == "wire"
    )

    def lying(old, new):
        comparison = compare(old, new)
        comparison.changes = (
            [c for c in comparison.changes if c.layer != "wire"]
            if hidden == "wire"
            else [wire]
        )
        return comparison

    monkeypatch.setattr(measuring, "compare", lying)
    chosen = cases(icd, 41, seed=3)
    score = measure(chosen, LANGUAGES["python"], tmp_path)
    real = sum(
        any(c.layer == "wire" for c in compare(case.old, case.new).changes)
        for case in chosen
    )
    assert (
        len({text.split(":")[0] for text in score.wrong})
        >= (real if hidden == "wire" else len(chosen) - real) - 3
    )
    assert len(score.wrong) >= 15
