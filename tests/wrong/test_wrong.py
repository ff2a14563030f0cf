"""Every invalid ICD gives exactly the report next to it, and every rule has an invalid
ICD.
"""

from __future__ import annotations

import re

import pytest

from icdgen.icd import rules
from tests.wrong.cases import CASES, name, report


@pytest.mark.parametrize("case", CASES, ids=name)
def test_the_report_is_exactly_the_expected_one(case):
    assert report(case) == case.with_suffix(".txt").read_text(encoding="utf-8")


def test_there_is_a_wrong_icd_for_every_rule():
    reported = set()
    for case in CASES:
        reported.update(
            re.findall(
                r"\[(ICD[0-9]{3})\]",
                case.with_suffix(".txt").read_text(encoding="utf-8"),
            )
        )
    assert reported == set(rules.ALL)


def test_every_wrong_icd_has_findings():
    assert [
        name(c)
        for c in CASES
        if "ICD" not in c.with_suffix(".txt").read_text(encoding="utf-8")
    ] == []


def test_every_expected_report_belongs_to_a_wrong_icd():
    reports = {p for case in CASES for p in case.parent.glob("*.txt")}
    assert reports == {case.with_suffix(".txt") for case in CASES}
