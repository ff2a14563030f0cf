"""Rules about the meaning of raw values: scale, unit, limits, constants and special
values.

These changes do not move any bit, so old software reads wrong values without an error.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

from icdgen.describe.bounds import KEYS, bounds_of_limits
from icdgen.describe.numbers import point_text
from icdgen.diff.context import ComparisonContext
from icdgen.diff.pairs import FieldPair, differing
from icdgen.diff.rule import CheckResult, rule
from icdgen.diff.similar import same_sense
from icdgen.diff.wording import MOST, formula, number
from icdgen.icd.curve import Curve
from icdgen.icd.formula import RAW, Scale
from icdgen.icd.lines import Line
from icdgen.icd.meanings import Limits, Special
from icdgen.wording import count, listing, quote


@rule("DIF201", "field")
@rule("DIF203", "field")
def scale_changed(pair: FieldPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    if pair.old.derived is not None and pair.new.derived is not None:
        if is_derived_otherwise(pair):
            was, now = pair.old.formula, pair.new.formula
            text = f"{quote(pair.new.name)} is derived by {quote(now)}, was by {quote(was)}"
            yield CheckResult(text, ("formula",), was, now, code="DIF201")
        return
    old, new = (field.curve or field.scale or RAW for field in (pair.old, pair.new))
    if old == new:
        return
    was, now = formula(old), formula(new)
    if isinstance(old, Curve) or isinstance(new, Curve):
        text = f"the value of {quote(pair.new.name)} is {now}, was {was}"
        yield CheckResult(
            text,
            ("points", "outside", "formula", "unit"),
            was,
            now,
            _points(old, new),
            code="DIF201",
        )
    # An inverted sign is more dangerous than another scale, so it has its own rule.
    elif old.factor == -new.factor:
        text = f"the sign of {quote(pair.new.name)} is turned: {now}, was {was}"
        yield CheckResult(text, ("formula",), was, now, code="DIF203")
    else:
        text = f"the value of {quote(pair.new.name)} is {now}, was {was}"
        yield CheckResult(
            text, ("formula", "unit"), was, now, _times(old, new), code="DIF201"
        )


def is_derived_otherwise(pair: FieldPair) -> bool:
    """Return whether a value is derived by different formulas in the two ICDs."""
    old, new = pair.old.derived, pair.new.derived
    # A renamed field in a formula is no difference.
    names = {field.old.name: field.new.name for field in pair.owner.common}
    return old is not None and new is not None and old.sense(names) != new.sense({})


def _points(old: Curve | Scale, new: Curve | Scale) -> tuple[str, ...]:
    """Return the removed and added points of a lookup table."""
    tables = [
        curve for curve in (old, new) if isinstance(curve, Curve) and curve.points
    ]
    if len(tables) < 2:
        return ()
    was, now = (frozenset(curve.points) for curve in tables)
    removed, added = (sorted(points) for points in (was - now, now - was))
    details = []
    for what, points in (("It had", removed), ("It has", added)):
        texts = list(map(point_text, points[:MOST]))
        if len(points) > MOST:
            texts.append(count(len(points) - MOST, "more point"))
        if points:
            details.append(f"{what} {listing(texts)}.")
    return tuple(details)


@lru_cache(maxsize=4096)
def _times(old: Scale, new: Scale) -> tuple[str, ...]:
    if old.offset != new.offset:
        return ()
    return (f"Identical bits give {number(new.factor / old.factor)} times the value.",)


@rule("DIF202", "field")
def unit_changed(pair: FieldPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old, new = (field.unit_symbol for field in (pair.old, pair.new))
    if old != new:
        text = f"the unit of {quote(pair.new.name)} is {new or 'no longer stated'}, was {old or 'not stated'}"
        severity = None if old and new else "warning"
        yield CheckResult(text, ("unit",), old, new, severity=severity)


@rule("DIF209", "field")
def const_changed(pair: FieldPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old, new = pair.old.const, pair.new.const
    if old == new:
        return
    was, now = (
        "" if value is None else f"{value} (0x{value:02X})" for value in (old, new)
    )
    if new is None:
        text, severity = f"{quote(pair.new.name)} need no longer be {was}", "warning"
    else:
        text, severity = (
            f"{quote(pair.new.name)} must be {now}, was {was or 'free'}",
            None,
        )
    yield CheckResult(text, ("const",), was, now, severity=severity)


def _specials(field: Line) -> list[Special]:
    """Return the special values.

    Named float values such as NaN are compared by name, because their bits depend on
    the width.
    """
    return [
        replace(special, value=0) if special.number else special
        for special in field.special
    ]


@rule("DIF210", "field", severity="warning")
@rule("DIF412", "field", severity="note")
def special_changed(pair: FieldPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old_specials, new_specials = _specials(pair.old), _specials(pair.new)
    for (named, raw), old, new in differing(
        old_specials, new_specials, lambda special: (special.number, special.value)
    ):
        value = named or raw
        was, now = old.meaning if old else "", new.meaning if new else ""
        code, text = "DIF210", f"the raw value {value} of {quote(pair.new.name)}"
        if not was:
            text += f" stands for {quote(now)} now"
        elif not now:
            text += f" no longer stands for {quote(was)}"
        elif same_sense(was, now):
            code, text = (
                "DIF412",
                f"what {value} of {quote(pair.new.name)} stands for is spelled otherwise",
            )
        else:
            text += f" stands for {quote(now)}, stood for {quote(was)}"
        yield CheckResult(text, ("special",), was, now, code=code)


def _limits(field: Line) -> str:
    return " and ".join(
        f"{bound.kind.sign} {number(bound.value)}"
        for bound in bounds_of_limits(field.limits)
    )


def is_wider(old: Limits | None, new: Limits | None) -> bool:
    """Return whether the new limits permit all values that the old limits permitted."""
    old, new = old or Limits(), new or Limits()
    for key, sign in (("min", 1), ("above", 1), ("max", -1), ("below", -1)):
        before, after = getattr(old, key), getattr(new, key)
        if after is not None and (before is None or sign * after > sign * before):
            return False
    return True


@rule("DIF211", "field", severity="warning")
def limits_changed(pair: FieldPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old, new = pair.old.limits or Limits(), pair.new.limits or Limits()
    if old == new:
        return
    was, now = _limits(pair.old), _limits(pair.new)
    text = f"{quote(pair.new.name)} may be {now or 'anything'}, could be {was or 'anything'}"
    detail = (
        "Values that were allowed are still allowed."
        if is_wider(old, new)
        else "Values that were allowed no longer are."
    )
    yield CheckResult(text, KEYS, was, now, (detail,))
