"""While a rule of the workbench has errors, its last valid form is used instead."""

from __future__ import annotations

import pytest

from icdgen.diagnostics import Findings
from icdgen.importer.workbench.valid_rules import read_profile

HEAD = "profile: 1\nnode: {byte_order: little}\nrules:\n"
GOOD = "  - {rule: a, tables: {head: A}, columns: {A: name}}\n"
BAD = "  - {rule: b, tables: {head: B}, columns: {B: nam}}\n"
WORSE = "  - {rule: c, tables: {head: C}, columns: {C: nam, D: typ}}\n"
UNTABLED = "  - {rule: d, columns: {D: name}}\n"
IGNORED = {"what": "ignore", "also": True}


def read(*rules: str, last=None, head: str = HEAD, behind: str = ""):
    """Return the kinds of the rules, their indices, the indices of rules with errors,
    and the last valid forms.
    """
    valid = read_profile(
        head + "".join(rules) + behind, "rules.yaml", last or [None] * len(rules)
    )
    kinds = [(rule.what, rule.head) for rule in valid.words.rules]
    errors = [index for index, _ in valid.errors]
    return kinds, valid.indices, errors, valid.last_valid


def form(letter: str, role: str = "name") -> dict:
    return {
        "rule": letter.lower(),
        "tables": {"head": letter},
        "columns": {letter: role},
    }


def test_rules_without_errors_are_their_own_last_valid_form():
    other = GOOD.replace("A", "B").replace("rule: a", "rule: b")
    assert read(GOOD, other) == (
        [("message", "A"), ("message", "B")],
        [0, 1],
        [],
        [form("A"), form("B")],
    )


def test_the_tables_of_a_rule_that_never_was_valid_are_ignored():
    assert read(BAD, GOOD) == (
        [("ignore", "B"), ("message", "A")],
        [0, 1],
        [0],
        [None, form("A")],
    )


def test_a_rule_with_errors_has_its_last_valid_form():
    last = [form("A"), form("B", "type")]
    assert read(GOOD, BAD, last=last) == (
        [("message", "A"), ("message", "B")],
        [0, 1],
        [1],
        last,
    )
    # The last form of a rule without errors is replaced.
    assert read(GOOD, BAD, last=[form("A", "type"), last[1]])[3] == last


def test_a_last_form_that_is_not_valid_any_more_is_not_used():
    last = [form("B", "nam"), form("A")]
    kinds, indices, errors, kept = read(BAD, GOOD, last=last)
    assert kinds == [("ignore", "B"), ("message", "A")]
    # The errors are those of the text only.
    assert (indices, errors, kept) == ([0, 1], [0], last)


def test_a_rule_without_tables_is_left_out():
    assert read(GOOD, UNTABLED, BAD) == (
        [("message", "A"), ("ignore", "B")],
        [0, 2],
        # Errors of the form are found before others.
        [1, 2],
        [form("A"), None, None],
    )
    assert read("  - 3\n", GOOD)[:3] == ([("message", "A")], [1], [0])


def test_all_errors_of_several_rules_are_returned_by_rule():
    kinds, indices, errors, kept = read(BAD, GOOD, WORSE)
    assert [what for what, _ in kinds] == ["ignore", "message", "ignore"]
    assert sorted(errors) == [0, 2, 2]
    assert (indices, kept) == ([0, 1, 2], [None, form("A"), None])


def test_rules_in_one_line_are_told_apart():
    rules = "".join(rule[4:-1] + ", " for rule in (GOOD, BAD))
    text = f"{HEAD[:-1]} [{rules}]\n"
    valid = read_profile(text, "rules.yaml", [None, None])
    assert [index for index, _ in valid.errors] == [1]
    assert [rule.what for rule in valid.words.rules] == ["message", "ignore"]


@pytest.mark.parametrize(
    ("head", "behind"),
    [
        (HEAD.replace("little", "middle"), ""),
        (HEAD, "nodes: 3\n"),
        (HEAD, "shared: [{}]\n"),
    ],
)
def test_errors_outside_of_the_rules_are_raised(head, behind):
    with pytest.raises(Findings) as caught:
        read(GOOD, BAD, head=head, behind=behind)
    lines = {finding.place.line for finding in caught.value.findings}
    assert lines == ({2} if not behind else {6})


def test_a_profile_without_rules_has_none():
    assert read(head=HEAD.replace("rules:", "rules: []")) == ([], [], [], [])
