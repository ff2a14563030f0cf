"""Every kind of change, by a pair of ICDs: the exact report with its places, and what
`icdgen rule` says of it.
"""

from __future__ import annotations

import re
from contextlib import chdir
from pathlib import Path

import pytest

from icdgen.diff import rule
from icdgen.diff.compare import RULES
from icdgen.diff.layers import LAYERS
from icdgen.diff.report import make_report
from icdgen.loading import load
from tests.diff.cases import CASES, compared, printed
from tests.icd.files import write


def name(case) -> str:
    return case.name


@pytest.mark.parametrize("case", CASES, ids=name)
def test_the_report_is_exactly_the_expected_one(case):
    assert printed(case) == (case / "expected.txt").read_text(encoding="utf-8")


@pytest.mark.parametrize("case", CASES, ids=name)
def test_the_pair_shows_its_change_at_a_line_of_its_files(case):
    found = [change for change in compared(case).changes if change.code == case.name]
    assert found
    with chdir(case):
        for change in found:
            places = [place for place in (change.old, change.new) if place is not None]
            assert places
            for place in places:
                lines = Path(place.file).read_text(encoding="utf-8").splitlines()
                assert place.line <= len(lines) and place.column <= len(
                    lines[place.line - 1]
                )


def test_there_is_a_pair_for_every_rule():
    assert {case.name for case in CASES} == set(RULES)


def test_both_icds_of_every_pair_are_sound():
    assert [
        f
        for case in CASES
        for side in ("previous", "current")
        for f in load([case / side]).findings
    ] == []


@pytest.mark.parametrize("code", RULES)
def test_the_example_of_a_rule_shows_it(code, tmp_path):
    from icdgen.diff.compare import compare

    sides = []
    for side, text in (
        ("before", RULES[code].page.wrong),
        ("after", RULES[code].page.right),
    ):
        (tmp_path / side).mkdir()
        write(tmp_path / side, text)
        loaded = load([tmp_path / side])
        assert loaded.findings == []
        sides.append(loaded.icd)
    assert code in {change.code for change in compare(*sides).changes}


def test_titles_are_one_line_and_say_different_things():
    titles = [one.title for one in RULES.values()]
    assert len(set(titles)) == len(titles)
    assert all(len(title) < 100 and not title.endswith(".") for title in titles)


def test_an_explanation_has_title_layer_reason_and_both_examples():
    text = rule.explain("DIF108")
    page = RULES["DIF108"].page
    assert text.startswith(f"# DIF108: {page.title} (wire, error)\n")
    assert all(
        part in text for part in (page.why, page.wrong, page.right, "Before:", "After:")
    )


def test_the_first_digit_of_a_code_is_its_layer():
    assert {one.layer for one in RULES.values()} == set(LAYERS)
    assert all(LAYERS[int(code[3]) - 1] == one.layer for code, one in RULES.items())
    assert all(re.fullmatch("DIF[1-4][0-9]{2}", code) for code in RULES)


def test_words_are_never_more_than_a_note_and_an_addition_never_more_than_that():
    assert all(
        one.severity == "note"
        for one in RULES.values()
        if one.layer == "text" or one.addition
    )


def test_the_report_of_equal_icds_says_so():
    from icdgen.diff import inputs, reports

    with chdir(CASES[0]):
        one = make_report(*inputs.sides(["current", "current"], []))
    assert reports.get("text")(one) == "current -> current\nno change\n"
