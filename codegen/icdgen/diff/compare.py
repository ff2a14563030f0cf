"""Comparison of two sets of ICDs with all changes between them.

`compare` matches the objects of both sides and runs each rule on the pairs for which
the rule is registered. The import of the modules of ``changes`` registers their rules.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from operator import itemgetter

from icdgen.diff.change import Change
from icdgen.diff.changes import (  # noqa: F401
    enumerations,
    errata,
    frames,
    framing,
    layout,
    names,
    numbers,
    sense,
    structs,
    text,
)
from icdgen.diff.context import ComparisonContext
from icdgen.diff.layers import LAYERS
from icdgen.diff.match import match
from icdgen.diff.pairs import FieldPair, Match, MessagePair, NodePair, Pair
from icdgen.diff.rule import REGISTERED, Check, CheckResult, DiffRule
from icdgen.icd.model import Icd
from icdgen.wording import listing, quote

RULES: dict[str, DiffRule] = dict(sorted(REGISTERED.items()))
# (kind of pair, presence) -> check -> default code
_CHECKS: dict[tuple[str, str], dict[Check, str]] = {}
for _rule in RULES.values():
    for _of in _rule.of:
        _CHECKS.setdefault((_of, _rule.when), {})[_rule.check] = _rule.code


MOST_PLACES = 3  # maximum number of places shown for a change of a struct


@dataclass
class Comparison:
    """Changes in the order of the new ICD, and the matched pairs."""

    match: Match
    changes: list[Change]
    context: ComparisonContext


def compare(old: Icd, new: Icd) -> Comparison:
    """Return all differences between two valid sets of ICDs.

    Order, formatting and spelling of formulas are ignored.
    """
    context = ComparisonContext(match(old, new))
    # The sort is stable: within a layer, changes keep the order of the ICD.
    changes = sorted(
        _merge_struct_changes(_all_changes(context)),
        key=lambda c: LAYERS.index(c.layer),
    )
    return Comparison(context.match, changes, context)


def _merge_struct_changes(changes: Iterable[Change]) -> list[Change]:
    """Report a change of a struct once, at its first use, and list the other uses in
    its details.
    """
    result: list[Change] = []
    indexes: dict[object, int] = {}
    other_places: dict[int, list[str]] = {}
    for change in changes:
        key = _struct_key(change)
        if key is None or key not in indexes:
            if key is not None:
                indexes[key] = len(result)
            result.append(change)
        else:
            where = change.where
            other_places.setdefault(indexes[key], []).append(
                f"{quote(where.field)} of {quote(where.message)}"
            )
    for index, places in other_places.items():
        if len(places) > MOST_PLACES:
            places[MOST_PLACES - 1 :] = [f"{len(places) - MOST_PLACES + 1} more"]
        result[index] = replace(
            result[index],
            details=(*result[index].details, f"The same of {listing(places)}."),
        )
    return result


def _struct_key(change: Change) -> object:
    """Return a key that is equal for one change of a struct in all its uses; None for
    other changes.
    """
    pair: object = change.pair
    # Some checks evaluate all fields of a message at once
    if isinstance(pair, MessagePair):
        pair = next(
            (part for part in pair.parts if part.any.name == change.where.field), None
        )
    if not isinstance(pair, FieldPair) or not pair.is_of_struct:
        return None
    sides = [side for side in (pair.before, pair.after) if side is not None]
    return change.rule.code, change.old, change.new, sides[-1].at - sides[0].at


def _all_changes(context: ComparisonContext) -> Iterator[Change]:
    # Checks of whole ICDs name the pair of each result themselves.
    for check, code in _CHECKS["icd", "both"].items():
        for finding in check(context):
            assert finding.pair is not None
            yield _change(RULES[code], finding.pair, finding)
    for node in context.match.nodes:
        yield from _run("node", node, context)
        for owner in node.declared:
            # Additions and removals of a node include its messages and enumerations.
            if not owner.changed or (not node.both and not owner.both):
                continue
            is_message = isinstance(owner, MessagePair)
            yield from _run("message" if is_message else "enum", owner, context)
            for part in owner.parts if owner.both else ():
                if part.changed:
                    yield from _run("field" if is_message else "member", part, context)


def _run(of: str, pair: Pair, context: ComparisonContext) -> Iterator[Change]:
    # Rules are registered for pairs with both sides, or with one side only.
    if pair.both:
        when = "both"
    else:
        when = "gone" if pair.after is None else "come"
    checks = _CHECKS.get((of, when), {})
    results = [
        (result.code or code, result)
        for check, code in checks.items()
        for result in check(pair, context)
    ]
    for code, result in sorted(results, key=itemgetter(0)):
        yield _change(RULES[code], pair, result)


def _change(rule: DiffRule, pair: Pair, result: CheckResult) -> Change:
    old, new = result.places or pair.places(result.keys)
    return Change(
        rule=rule,
        message=result.message,
        where=result.where or pair.where(),
        was=result.was,
        now=result.now,
        old=old,
        new=new,
        details=result.details,
        severity=result.severity or rule.severity,
        addition=rule.addition if result.addition is None else result.addition,
        sure=pair.sure,
        errata=_decisions(pair, result.keys),
        pair=pair,
    )


def _decisions(pair: Pair, keys: tuple[str, ...]) -> tuple[str, ...]:
    """Return the errata that were added, removed or changed and that concern one of
    these keys of the pair.
    """
    if isinstance(pair, NodePair):
        return ()
    old, new = (
        {e.id: e for e in side.errata} if side is not None else {}
        for side in (pair.before, pair.after)
    )
    decisions = []
    for key in sorted(old.keys() | new.keys()):
        before, after = old.get(key), new.get(key)
        # `held` of an erratum lists the keys that it corrects, with their values.
        affected_keys: set[str] = set()
        for entry in (before, after):
            if entry is not None:
                affected_keys.update(name for name, _ in entry.held)
        if before == after or affected_keys.isdisjoint(keys):
            continue
        if before is None:
            decisions.append(f"{key} is new")
        elif after is None:
            decisions.append(f"{key} is gone")
        else:
            decisions.append(f"{key} says otherwise")
    return tuple(decisions)
