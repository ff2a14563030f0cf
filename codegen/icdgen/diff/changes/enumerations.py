"""Rules about enumerations: names of the values of a field.

Each function yields the changes of one pair of fields or members (see
`icdgen.diff.rule`); ``enumerations.md`` explains the rules to users.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diff.context import ComparisonContext
from icdgen.diff.pairs import EnumPair, FieldPair, MemberPair
from icdgen.diff.rule import CheckResult, rule
from icdgen.diff.similar import other_senses, same_sense
from icdgen.diff.wording import some
from icdgen.icd.model import Enum
from icdgen.wording import quote


@rule("DIF204", "field")
def other_enumeration(pair: FieldPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old, new = pair.old.enum, pair.new.enum
    # A renamed enumeration is no other enumeration (`same_enum`).
    if (pair.old.type == "enum") == (pair.new.type == "enum") and ctx.match.same_enum(
        old, new
    ):
        return
    was, now = old.name if old else "", new.name if new else ""
    details = _differences(old, new) if old and new else ()
    if now and was:
        text = f"the values of {quote(pair.new.name)} are those of {quote(now)}, were those of {quote(was)}"
    elif now:
        text = (
            f"the values of {quote(pair.new.name)} now have names, as in {quote(now)}"
        )
    else:
        text = f"the values of {quote(pair.new.name)} no longer have names; they were in {quote(was)}"
    yield CheckResult(
        text, ("enum", "type"), was, now, details, None if was and now else "warning"
    )


def _differences(old: Enum, new: Enum) -> tuple[str, ...]:
    other = [str(value) for value in other_senses(old, new)]
    removed = [
        m.name
        for m in sorted(old.members, key=lambda m: m.value)
        if not new.member_of(m.value)
    ]
    lines = [f"Another sense: {', '.join(other)}."] if other else []
    return (*lines, *([f"Without a name now: {some(removed)}."] if removed else []))


def _used(owner: EnumPair, ctx: ComparisonContext) -> tuple[str, ...]:
    """Return a detail that lists the fields with values of the enumeration."""
    users = ctx.users.get(id(owner.new), ())
    return (f"Used by {some(users)}.",) if users else ()


@rule("DIF205", "member")
def other_sense(pair: MemberPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old, new = pair.old, pair.new
    if (
        old.values == new.values
        and old.name != new.name
        and not same_sense(old.name, new.name)
    ):
        text = f"{new.values} of {quote(pair.owner.new.name)} is {quote(new.name)}, was {quote(old.name)}"
        yield CheckResult(text, ("name",), old.name, new.name, _used(pair.owner, ctx))


@rule("DIF206", "member")
def renumbered(pair: MemberPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old, new = pair.old, pair.new
    if old.values != new.values:
        text = f"{quote(new.name)} of {quote(pair.owner.new.name)} is {new.values}, was {old.values}"
        yield CheckResult(
            text, ("value",), old.values, new.values, _used(pair.owner, ctx)
        )


@rule("DIF207", "member", severity="warning", presence="removed")
def member_removed(pair: MemberPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    text = f"{pair.old.values} of {quote(pair.owner.any.name)} has no name now, was {quote(pair.old.name)}"
    yield CheckResult(
        text,
        ("name",),
        f"{pair.old.values} = {pair.old.name}",
        "",
        _used(pair.owner, ctx),
    )


@rule("DIF208", "member", severity="note", presence="added", addition=True)
def member_added(pair: MemberPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    text = f"{pair.new.values} of {quote(pair.owner.any.name)} is {quote(pair.new.name)}; it had no name"
    yield CheckResult(
        text,
        ("name",),
        "",
        f"{pair.new.values} = {pair.new.name}",
        _used(pair.owner, ctx),
    )
