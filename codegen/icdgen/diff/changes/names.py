"""Rules about names and types in generated code of each language.

`icdgen.diff.generated` computes the names; ``structs`` has the rules about structs.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.backends import TITLES
from icdgen.diff.context import ComparisonContext
from icdgen.diff.generated import Name, is_renamed, may_rename
from icdgen.diff.pairs import (
    EnumPair,
    FieldPair,
    IdentifiedPair,
    MemberPair,
    MessagePair,
    NodePair,
    Pair,
)
from icdgen.diff.rule import CheckResult, rule
from icdgen.icd.lines import Line
from icdgen.wording import count, listing, quote

MOST = 2  # maximum number of names shown for each language

_WHAT = {
    MessagePair: "message",
    FieldPair: "field",
    EnumPair: "enumeration",
    MemberPair: "value",
    NodePair: "node",
}
Renamed = list[tuple[Name | None, Name | None]]


def _either(old: Name | None, new: Name | None) -> Name:
    """Return the old name, or the new name if there is no old one."""
    name = old or new
    assert name is not None, "neither was nor is"
    return name


def renamed_lines(renamed: Renamed) -> tuple[str, ...]:
    """Return one line per language: ``C: `a` -> `b` and 3 more``.

    If all names were added or all removed, only the names.
    """
    rows_by_language: dict[str, list[str]] = {}
    one_way = any(all(pair[side] is None for pair in renamed) for side in (0, 1))
    # Types first
    for old, new in sorted(
        renamed, key=lambda names: not _either(*names).text.endswith("_t")
    ):
        if one_way:
            text = f"`{_either(old, new).text}`"
        else:
            was = f"`{old.text}`" if old else "(new)"
            now = f"`{new.text}`" if new else "(gone)"
            text = f"{was} -> {now}"
        rows = rows_by_language.setdefault(_either(old, new).language, [])
        if text not in rows:
            rows.append(text)
    result = []
    for language, rows in sorted(rows_by_language.items()):
        remaining = [f"{len(rows) - MOST} more"] if len(rows) > MOST else []
        result.append(f"{TITLES[language]}: {listing(rows[:MOST] + remaining)}")
    return tuple(result)


def _renamed(pair: IdentifiedPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    # DIF310 reports names that change because of another node.
    if not is_renamed(pair) or pair.is_of_another_node:
        return
    renamed = ctx.generated.renamed(pair)
    if renamed:
        old, new = pair.old, pair.new
        if old.name != new.name:
            text = f"{_WHAT[type(pair)]} {quote(new.name)} was called {quote(old.name)}"
            was, now = old.name, new.name
        else:
            was, now = old.identifier or old.name, new.identifier or new.name
            text = f"{_WHAT[type(pair)]} {quote(new.name)} has other identifiers, from {quote(now)}, were from {quote(was)}"
        yield CheckResult(
            text, ("name", "identifier"), was, now, renamed_lines(renamed)
        )


for _code, _of in (
    ("DIF301", "message"),
    ("DIF302", "field"),
    ("DIF303", "enum"),
    ("DIF304", "member"),
):
    rule(_code, _of)(_renamed)


@rule("DIF305", "node")
def node_renamed(pair: NodePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old, new = pair.old.name, pair.new.name
    if old != new:
        text = f"node `{new}` was called `{old}`: every generated name of it changes"
        what = f"{count(len(pair.new.messages), 'message')} and {count(len(pair.new.enums), 'enumeration')}"
        yield CheckResult(text, ("name",), old, new, (f"It declares {what}.",))


@rule("DIF306", "message", "field", "enum", "member", "node", presence="removed")
def names_gone(pair: Pair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    if pair.is_of_struct:
        return
    removed_names: Renamed = [(name, None) for name in ctx.generated.old(pair)]
    text = f"the generated names of {_WHAT[type(pair)]} {quote(pair.old.name)} are gone"
    yield CheckResult(
        text, ("name", "identifier"), pair.old.name, "", renamed_lines(removed_names)
    )


@rule("DIF307", "field")
def retyped(pair: FieldPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old, new = pair.old, pair.new
    was, now = (
        (side.type, side.bits, side.count, not side.conditions) for side in (old, new)
    )
    if was == now and ctx.match.same_enum(old.enum, new.enum):
        return
    changed = ctx.generated.retyped(pair)
    if changed:
        details = tuple(
            f"{TITLES[language]}: `{a}` -> `{b}`" for language, a, b in changed
        )
        words = listing([TITLES[language] for language, _, _ in changed])
        text = f"{quote(new.name)} has another type in {words}"
        yield CheckResult(
            text,
            ("type", "bits", "enum", "count", "when"),
            changed[0][1],
            changed[0][2],
            details,
        )


@rule("DIF308", "field")
def accessors_changed(pair: FieldPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    is_moved = pair.owner.is_of_another_node or pair.owner.has_another_vocabulary
    if is_moved or is_renamed(pair) or not may_rename(pair):
        return
    renamed = ctx.generated.renamed(pair)
    if renamed:
        was, now = (
            next((name.text for name in side if name), "")
            for side in zip(*renamed, strict=True)
        )
        text = f"accessors or constants of {quote(pair.new.name)} {'change' if was else 'are new'}"
        keys = ("unit", "formula", "points", "special", "min", "max", "above", "below")
        severity, addition = (None, None) if was else ("note", True)
        yield CheckResult(
            text, keys, was, now, renamed_lines(renamed), severity, addition
        )


@rule("DIF309", "node")
def words_split_otherwise(
    pair: NodePair, ctx: ComparisonContext
) -> Iterator[CheckResult]:
    old, new = pair.old.vocabulary, pair.new.vocabulary
    # The order of the vocabulary has no effect.
    if frozenset(old) == frozenset(new):
        return
    renamed: Renamed = []
    for owner in pair.declared:
        for part in (owner, *owner.parts):
            if part.both and not is_renamed(part) and not owner.is_of_another_node:
                renamed += ctx.generated.renamed(part)
    if renamed:
        text = f"words are split in another way: {count(len(renamed), 'generated name')} of `{pair.new.name}` change"
        was, now = (
            ", ".join(sorted(set(a) - set(b))) for a, b in ((old, new), (new, old))
        )
        places = pair.old.source.at("vocabulary"), pair.new.source.at("vocabulary")
        yield CheckResult(
            text, ("vocabulary",), was, now, renamed_lines(renamed), places=places
        )


@rule("DIF310", "message", "enum")
def declared_elsewhere(
    pair: MessagePair | EnumPair, ctx: ComparisonContext
) -> Iterator[CheckResult]:
    if pair.is_of_another_node:
        old, new = pair.old_node.name, pair.new_node.name
        text = f"{_WHAT[type(pair)]} {quote(pair.new.name)} is declared by `{new}`, was by `{old}`"
        yield CheckResult(
            text, ("name",), old, new, renamed_lines(ctx.generated.renamed(pair))
        )


@rule(
    "DIF311",
    "message",
    "field",
    "enum",
    "member",
    "node",
    presence="added",
    severity="note",
    addition=True,
)
def names_come(pair: Pair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    if pair.is_of_struct:
        return
    added_names: Renamed = [(None, name) for name in ctx.generated.new(pair)]
    text = f"{_WHAT[type(pair)]} {quote(pair.new.name)} has generated names now"
    yield CheckResult(
        text, ("name", "identifier"), "", pair.new.name, renamed_lines(added_names)
    )


@rule("DIF312", "field")
def became_a_view(pair: FieldPair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    was, now = map(_origin, (pair.old, pair.new))
    if was != now:
        is_view = pair.new.is_read_only and pair.new.derived is None
        details = (
            ("The encoded value follows from the fields that own the bits.",)
            if is_view
            else ()
        )
        yield CheckResult(
            f"{quote(pair.new.name)} is {now}, was {was}",
            ("view", "at", "name"),
            was,
            now,
            details,
        )


def _origin(line: Line) -> str:
    if line.derived is not None:
        return "derived from other fields"
    return "a view" if line.is_read_only else "a field with bits of its own"
