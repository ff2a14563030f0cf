"""Two sets of ICDs -> all changes between them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from operator import itemgetter

from icdgen.diff.change import Change
from icdgen.diff.changes import (  # noqa: F401  (importing a theme registers its rules)
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
from icdgen.diff.context import Context
from icdgen.diff.layers import LAYERS
from icdgen.diff.match import match
from icdgen.diff.pairs import FieldPair, Match, MessagePair, NodePair, Pair
from icdgen.diff.rule import REGISTERED, Check, Found, Rule
from icdgen.icd.model import Icd
from icdgen.icd.rules.wording import listing, quote

RULES: dict[str, Rule] = dict(sorted(REGISTERED.items()))
_CHECKS: dict[tuple[str, str], dict[Check, str]] = {}  # and the code of what it finds, unless it names another
for _rule in RULES.values():
    for _of in _rule.of:
        _CHECKS.setdefault((_of, _rule.when), {})[_rule.check] = _rule.code


MOST_PLACES = 3  # that are shown of a change of a struct


@dataclass
class Comparison:
    """What changed, in the order of the new ICD, and what was compared with what."""

    match: Match
    changes: list[Change]
    context: Context


def compare(old: Icd, new: Icd) -> Comparison:
    """Everything that differs between two sound sets of ICDs. Order, formatting and spelling of formulas are no difference."""
    context = Context(match(old, new))
    changes = sorted(_once(_all(context)), key=lambda c: LAYERS.index(c.layer))
    return Comparison(context.match, changes, context)


def _once(changes: Iterable[Change]) -> list[Change]:
    """What changed in a struct is said where it stands first, with the other places."""
    result: list[Change] = []
    indexes: dict[object, int] = {}
    other_places: dict[int, list[str]] = {}
    for change in changes:
        key = _in_struct(change)
        if key is None or key not in indexes:
            if key is not None:
                indexes[key] = len(result)
            result.append(change)
        else:
            where = change.where
            other_places.setdefault(indexes[key], []).append(f"{quote(where.field)} of {quote(where.message)}")
    for index, places in other_places.items():
        if len(places) > MOST_PLACES:
            places[MOST_PLACES - 1 :] = [f"{len(places) - MOST_PLACES + 1} more"]
        result[index] = replace(result[index], details=(*result[index].details, f"The same of {listing(places)}."))
    return result


def _in_struct(change: Change) -> object:
    """What a change of a field of a struct has in common with the same change wherever the struct stands; None of others."""
    pair: object = change.pair
    if isinstance(pair, MessagePair):  # many fields are looked at together
        pair = next((part for part in pair.parts if part.any.name == change.where.field), None)
    if not isinstance(pair, FieldPair) or not pair.is_of_struct:
        return None
    sides = [side for side in (pair.before, pair.after) if side is not None]
    return change.rule.code, change.old, change.new, sides[-1].at - sides[0].at


def _all(context: Context) -> Iterator[Change]:
    for check, code in _CHECKS["icd", "both"].items():
        for found in check(context):
            assert found.pair is not None
            yield _change(RULES[code], found.pair, found)
    for node in context.match.nodes:
        yield from _run("node", node, context)
        for owner in node.declared:
            if not owner.changed or (not node.both and not owner.both):
                continue  # what comes or goes with its node is not said again
            of, parts = ("message", "field") if isinstance(owner, MessagePair) else ("enum", "member")
            yield from _run(of, owner, context)
            for part in owner.parts if owner.both else ():
                if part.changed:
                    yield from _run(parts, part, context)


def _run(of: str, pair: Pair, context: Context) -> Iterator[Change]:
    when = "both" if pair.both else "gone" if pair.after is None else "come"
    checks = _CHECKS.get((of, when), {})
    results = [(found.code or code, found) for check, code in checks.items() for found in check(pair, context)]
    for code, found in sorted(results, key=itemgetter(0)):
        yield _change(RULES[code], pair, found)


def _change(rule: Rule, pair: Pair, found: Found) -> Change:
    old, new = found.places or pair.places(found.keys)
    return Change(
        rule=rule,
        message=found.message,
        where=found.where or pair.where(),
        was=found.was,
        now=found.now,
        old=old,
        new=new,
        details=found.details,
        severity=found.severity or rule.severity,
        addition=rule.addition if found.addition is None else found.addition,
        sure=pair.sure,
        errata=_decisions(pair, found.keys),
        pair=pair,
    )


def _decisions(pair: Pair, keys: tuple[str, ...]) -> tuple[str, ...]:
    """Errata that came, went or changed, and that hold something else for one of these keys of the pair."""
    if isinstance(pair, NodePair):
        return ()
    old, new = ({e.id: e for e in side.errata} if side is not None else {} for side in (pair.before, pair.after))
    decisions = []
    for key in sorted(old.keys() | new.keys()):
        before, after = old.get(key), new.get(key)
        held = [name for entry in (before, after) if entry for name, _ in entry.held]
        if before != after and any(name in keys for name in held):
            decisions.append(
                f"{key} {'is new' if before is None else 'is gone' if after is None else 'says otherwise'}"
            )
    return tuple(decisions)
