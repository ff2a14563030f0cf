"""Two sets of ICDs -> all changes between them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
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
    text,
)
from icdgen.diff.context import Context
from icdgen.diff.layers import LAYERS
from icdgen.diff.match import match
from icdgen.diff.pairs import Match, MessagePair, NodePair, Pair
from icdgen.diff.rule import REGISTERED, Check, Found, Rule
from icdgen.icd.annex import Erratum
from icdgen.icd.model import Icd

RULES: dict[str, Rule] = dict(sorted(REGISTERED.items()))
_CHECKS: dict[tuple[str, str], dict[Check, str]] = {}  # and the code of what it finds, unless it names another
for _rule in RULES.values():
    for _of in _rule.of:
        _CHECKS.setdefault((_of, _rule.when), {})[_rule.check] = _rule.code


@dataclass
class Comparison:
    """What changed, in the order of the new ICD, and what was compared with what."""

    match: Match
    changes: list[Change]
    context: Context


def compare(old: Icd, new: Icd) -> Comparison:
    """Everything that differs between two sound sets of ICDs. Order, formatting and spelling of formulas are no difference."""
    context = Context(match(old, new))
    changes = sorted(_all(context), key=lambda c: LAYERS.index(c.layer))
    return Comparison(context.match, changes, context)


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
    said = [(found.code or code, found) for check, code in checks.items() for found in check(pair, context)]
    for code, found in sorted(said, key=itemgetter(0)):
        yield _change(RULES[code], pair, found)


def _change(rule: Rule, pair: Pair, found: Found) -> Change:
    old, new = found.places or pair.places(found.keys)
    return Change(
        rule=rule,
        message=found.message,
        where=found.where or pair.where(),
        was=found.was,
        now=found.now,
        old=None if pair.before is None and not found.places else old,
        new=None if pair.after is None and not found.places else new,
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
    said = []
    for key in sorted(old.keys() | new.keys()):
        before, after = old.get(key), new.get(key)
        if before != after and any(_holds(entry, keys) for entry in (before, after) if entry is not None):
            said.append(f"{key} {'is new' if before is None else 'is gone' if after is None else 'says otherwise'}")
    return tuple(said)


def _holds(entry: Erratum, keys: tuple[str, ...]) -> bool:
    return any(key in keys for key, _ in entry.held)
