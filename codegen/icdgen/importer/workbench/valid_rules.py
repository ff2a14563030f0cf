"""Profile of the workbench while some of its rules have errors: their last valid forms
are applied instead.

`read_profile` takes the text of a profile and returns a `ValidProfile`: the profile
without errors, the errors by rule, and the last valid form of each rule. The tables of
a rule that never was valid are ignored. The text of the user is not changed. `session`
calls it after each change.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from typing import Any

from icdgen.diagnostics import Finding, Findings, Place
from icdgen.icd import source
from icdgen.icd.located import Map, Seq
from icdgen.importer import profile
from icdgen.importer.workbench import rule_text

RuleKeys = dict[str, Any]


@dataclass
class ValidProfile:
    """A profile without the errors of a text."""

    words: profile.Profile
    indices: list[int]  # for each rule of ``words``, its index in the text
    # Index of a rule in the text, and what is wrong in it.
    errors: list[tuple[int, Finding]]
    last_valid: list[RuleKeys | None]  # for each rule of the text


def read_profile(
    text: str, name: str, last_valid: list[RuleKeys | None]
) -> ValidProfile:
    """Return the profile of a text, with the last valid form of each rule that has
    errors.

    ``last_valid``: the last valid form of each rule; None for a rule that was never
    valid. If such a rule has errors, its tables are ignored. Raises `Findings` for
    errors outside the rules.
    """
    rules = rule_text.rules_of(text)
    indices = list(range(len(rules)))
    substitutes = [
        [last, _ignoring(rule)] for last, rule in zip(last_valid, rules, strict=True)
    ]
    errors: list[tuple[int, Finding]] = []
    # The loop ends: each pass with errors uses up a substitute or removes a rule.
    while True:
        tree = source.parse(text.encode("utf-8"), name)
        try:
            words = profile.profile_of_tree(tree)
        except Findings as error:
            wrong = _by_rule(tree, error.findings)
        else:
            invalid = {index for index, _ in errors}
            last_valid = [
                last_valid[i] if i in invalid else rule for i, rule in enumerate(rules)
            ]
            return ValidProfile(words, indices, errors, last_valid)
        reported = {index for index, _ in errors}
        # From the last to the first, as the removal of a rule moves those behind it.
        for position in sorted(wrong, reverse=True):
            index = indices[position]
            if index not in reported:
                errors += [(index, finding) for finding in wrong[position]]
            substitute = next(
                (keys for keys in substitutes[index] if keys is not None), None
            )
            if substitute is None:
                del indices[position]
            else:
                substitutes[index][substitutes[index].index(substitute)] = None
            text = rule_text.with_rule(text, position, substitute)


def _ignoring(rule: Any) -> RuleKeys | None:
    """Return a rule that has the tables of ``rule`` and reads nothing from them."""
    if not isinstance(rule, dict) or "tables" not in rule:
        return None
    return {"tables": rule["tables"], "what": "ignore", "also": True}


def _by_rule(tree: Map, findings: list[Finding]) -> dict[int, list[Finding]]:
    """Return the findings by the index of their rule.

    Raises `Findings` if some findings are outside the rules.
    """
    by_rule: dict[int | None, list[Finding]] = {}
    for finding in findings:
        by_rule.setdefault(_rule_at(tree, finding.place), []).append(finding)
    if None in by_rule:
        raise Findings(by_rule[None])
    return {index: own for index, own in by_rule.items() if index is not None}


def _rule_at(tree: Map, place: Place) -> int | None:
    """Return the index of the rule at a place."""
    rules = tree.get("rules")
    if not isinstance(rules, Seq) or not rules:
        return None
    # Rules can stand in one line: `rules: [{...}, {...}]`.
    starts = [rules.item_at(index)[1:3] for index in range(len(rules))]
    behind = [at[1:3] for key in tree if (at := tree.key_at(key))[1:3] > starts[-1]]
    if behind and place[1:3] >= min(behind):
        return None
    return bisect_right(starts, place[1:3]) - 1 if place[1:3] >= starts[0] else None
