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
# (kind of pair, presence) -> check -> code of its rule. A check of several rules names
# the code in each result instead.
_CHECKS: dict[tuple[str, str], dict[Check, str]] = {}
for _rule in RULES.values():
    for _of in _rule.of:
        _CHECKS.setdefault((_of, _rule.presence), {})[_rule.check] = _rule.code


MOST_OTHER_USES = 3  # maximum number of other uses shown for a change of a struct


@dataclass
class Comparison:
    """Changes by layer, and the matched pairs.

    In each layer, changes are in the order of the new ICD; those of removed objects
    come last.
    """

    match: Match
    changes: list[Change]
    context: ComparisonContext


def compare(old: Icd, new: Icd) -> Comparison:
    """Return all differences between two valid sets of ICDs.

    Order, formatting and spelling of formulas are ignored.
    """
    context = ComparisonContext(match(old, new))
    # The sort is stable: within a layer, changes keep the order of the pairs.
    changes = sorted(
        _merge_struct_changes(_all_changes(context)),
        key=lambda c: LAYERS.index(c.layer),
    )
    return Comparison(context.match, changes, context)


def _merge_struct_changes(changes: Iterable[Change]) -> list[Change]:
    """Return the changes with each change of a struct once, at its first use; its
    details list the other uses.
    """
    result: list[Change] = []
    indexes: dict[object, int] = {}
    other_uses: dict[int, list[str]] = {}
    for change in changes:
        key = _struct_key(change)
        if key is None or key not in indexes:
            if key is not None:
                indexes[key] = len(result)
            result.append(change)
        else:
            where = change.where
            other_uses.setdefault(indexes[key], []).append(
                f"{quote(where.field)} of {quote(where.message)}"
            )
    for index, uses in other_uses.items():
        if len(uses) > MOST_OTHER_USES:
            uses[MOST_OTHER_USES - 1 :] = [f"{len(uses) - MOST_OTHER_USES + 1} more"]
        result[index] = replace(
            result[index],
            details=(*result[index].details, f"The same of {listing(uses)}."),
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
    # All uses of a struct have the source places of its fields. A use that is shifted
    # by another number of bits has a different change.
    return change.rule.code, change.old, change.new, sides[-1].at - sides[0].at


def _all_changes(context: ComparisonContext) -> Iterator[Change]:
    """Yield the changes of whole ICDs, then those of each node and of its parts."""
    # Checks of whole ICDs name the pair of each result themselves.
    for check, code in _CHECKS["icd", "both"].items():
        for result in check(context):
            assert result.pair is not None
            yield _change(RULES[code], result.pair, result)
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
    """Yield the changes that the rules of a kind of pair find in a pair, by code."""
    if pair.both:
        presence = "both"
    else:
        presence = "removed" if pair.after is None else "added"
    checks = _CHECKS.get((of, presence), {})
    results = [
        (result.code or code, result)
        for check, code in checks.items()
        for result in check(pair, context)
    ]
    for code, result in sorted(results, key=itemgetter(0)):
        yield _change(RULES[code], pair, result)


def _change(rule: DiffRule, pair: Pair, result: CheckResult) -> Change:
    """Return the result of a check as a change; the pair and the rule supply what the
    result leaves out.
    """
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
        confidence=pair.confidence,
        errata=_errata_notes(pair, result.keys),
        pair=pair,
    )


def _errata_notes(pair: Pair, keys: tuple[str, ...]) -> tuple[str, ...]:
    """Return a note on each erratum that was added, removed or changed and that
    concerns one of these keys of the pair.
    """
    if isinstance(pair, NodePair):
        return ()
    old, new = (
        {e.id: e for e in side.errata} if side is not None else {}
        for side in (pair.before, pair.after)
    )
    notes = []
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
            notes.append(f"{key} is new")
        elif after is None:
            notes.append(f"{key} is gone")
        else:
            notes.append(f"{key} says otherwise")
    return tuple(notes)
