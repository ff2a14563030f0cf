"""Each rule of the diff has a pair of ICDs with the exact report and its places, and an
explanation in `icdgen rule`.
"""

from __future__ import annotations

import re
from contextlib import chdir
from pathlib import Path

import pytest

from icdgen.diff import rule
from icdgen.diff.change import Change
from icdgen.diff.compare import RULES, compare
from icdgen.diff.layers import LAYERS
from icdgen.diff.report import make_report
from icdgen.loading import load
from tests.diff.cases import CASES, compared, compared_texts, printed
from tests.icd.files import HEAD, status, write


def name(case) -> str:
    return case.name


@pytest.mark.parametrize("case", CASES, ids=name)
def test_the_report_is_exactly_the_expected_one(case):
    assert printed(case) == (case / "expected.txt").read_text(encoding="utf-8")


@pytest.mark.parametrize("case", CASES, ids=name)
def test_the_pair_shows_its_change_at_a_line_of_its_files(case):
    reported = [change for change in compared(case).changes if change.code == case.name]
    assert reported
    with chdir(case):
        for change in reported:
            places = [place for place in (change.old, change.new) if place is not None]
            assert places
            for place in places:
                lines = Path(place.file).read_text(encoding="utf-8").splitlines()
                assert place.line <= len(lines) and place.column <= len(
                    lines[place.line - 1]
                )


def test_there_is_a_pair_for_every_rule():
    assert {case.name for case in CASES} == set(RULES)


def test_both_icds_of_every_pair_pass_the_check():
    assert [
        f
        for case in CASES
        for side in ("previous", "current")
        for f in load([case / side]).findings
    ] == []


@pytest.mark.parametrize("code", RULES)
def test_the_example_of_a_rule_shows_it(code, tmp_path):
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


def test_titles_have_one_line_and_are_unique():
    titles = [rule.title for rule in RULES.values()]
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
    assert {rule.layer for rule in RULES.values()} == set(LAYERS)
    assert all(LAYERS[int(code[3]) - 1] == rule.layer for code, rule in RULES.items())
    assert all(re.fullmatch("DIF[1-4][0-9]{2}", code) for code in RULES)


def test_text_changes_and_additions_are_notes():
    assert all(
        rule.severity == "note"
        for rule in RULES.values()
        if rule.layer == "text" or rule.addition
    )


def test_the_report_of_equal_icds_states_no_change():
    from icdgen.diff import inputs, reports

    with chdir(CASES[0]):
        equal_report = make_report(*inputs.sides(["current", "current"], []))
    assert reports.get("text")(equal_report) == "current -> current\nno change\n"


@pytest.mark.parametrize(
    ("bits", "codes"),
    [((8, 8), ["DIF411"]), ((8, 16), ["DIF112"]), ((16, 16), ["DIF112"])],
)
def test_another_byte_order_is_a_note_only_if_it_concerns_no_field(
    tmp_path, bits, codes
):
    rows = [
        f"at: {at}, bits: {size}, name: Field {at}, type: uint"
        for at, size in zip((0, bits[0]), bits, strict=True)
    ]
    text = HEAD + status(*rows, length=sum(bits) // 8)
    other = text.replace("byte_order: little", "byte_order: big")
    changes = compared_texts(tmp_path, text, other).changes
    assert [change.code for change in changes] == codes


def changes_between(folder: Path, before: str, after: str) -> dict[str, Change]:
    """Return the changes between two ICDs by code."""
    changes = compared_texts(folder, before, after).changes
    return {change.code: change for change in changes}


FIRST, SECOND, THIRD, FOURTH = (
    f"at: {8 * number}, bits: 8, name: Field {number}, type: uint"
    for number in range(4)
)


@pytest.mark.parametrize(
    ("after", "is_unchanged"),
    [((FIRST, THIRD, FOURTH), True), ((FIRST, SECOND, THIRD, FOURTH), False)],
    ids=["new only at the end", "new also between"],
)
def test_the_first_bytes_of_a_longer_message_are_unchanged_if_no_field_of_them_is(
    tmp_path, after, is_unchanged
):
    shorter = status(FIRST, THIRD, length=3)
    changes = changes_between(tmp_path, shorter, status(*after, length=4))
    details = changes["DIF106"].details
    assert ("The first 3 bytes are as they were." in details) == is_unchanged


def test_limits_that_a_field_gets_or_loses_are_constants_that_appear_or_vanish(
    tmp_path,
):
    level = "at: 0, bits: 16, name: Level, type: uint, unit: m"
    free, limited = status(level), status(f"{level}, min: 0, max: 100")
    new = changes_between(tmp_path, free, limited)["DIF308"]
    gone = changes_between(tmp_path, limited, free)["DIF308"]
    assert "Python: `LEVEL_MIN` and `LEVEL_MAX`" in new.details
    assert gone.details == new.details
    assert "are new" in new.message and "are new" not in gone.message
