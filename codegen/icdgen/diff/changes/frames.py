"""Rules about messages: additions, removals, ids, kinds and lengths.

``frames.md`` explains the rules to users; ``layout`` has the rules about the fields of
a message.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.describe.numbers import length_text
from icdgen.diff.context import ComparisonContext, by_id
from icdgen.diff.pairs import MessagePair, NodePair
from icdgen.diff.rule import CheckResult, rule
from icdgen.diff.wording import ids, some
from icdgen.icd.layout import VariablePart
from icdgen.icd.model import Message
from icdgen.wording import count, quote

DIRECTIONS = {"telecommand": "telecommand_id", "telemetry": "telemetry_id"}


def _summary(message: Message) -> str:
    return f"{message.kind} {ids(message.ids)}, {length_text(message)}"


@rule("DIF101", "message", presence="removed")
def removed(pair: MessagePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    text = f"{quote(pair.old.name)} is gone: {pair.old.kind} {ids(pair.old.ids)} is no longer spoken"
    yield CheckResult(text, ("name",), _summary(pair.old), "")


@rule("DIF102", "message", presence="added", severity="note", addition=True)
def added(pair: MessagePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    yield CheckResult(
        f"{quote(pair.new.name)} is new: {_summary(pair.new)}",
        ("name",),
        "",
        _summary(pair.new),
    )


@rule("DIF103", "message")
def id_changed(pair: MessagePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old, new = pair.old, pair.new
    for kind, key in DIRECTIONS.items():
        before, after = getattr(old, key), getattr(new, key)
        if before is not None and after is not None and before != after:
            own = "set_id" if kind == "telecommand" else "get_id"
            keys = (own,) if new.kind == old.kind == "configuration" else ("id", own)
            text = f"the {kind} id of {quote(new.name)} is {after}, was {before}"
            yield CheckResult(text, keys, str(before), str(after))


@rule("DIF104", "icd")
def id_taken_over(ctx: ComparisonContext) -> Iterator[CheckResult]:
    reported = set()
    for node in ctx.match.nodes:
        if not node.both:
            continue
        for kind, key in DIRECTIONS.items():
            keys = ("id", "set_id" if kind == "telecommand" else "get_id")
            before, after = (
                by_id(icd.messages_of(side), key) for icd, side in ctx.sides(node)
            )
            for number in sorted(before.keys() & after.keys()):
                old, new = _exchanged(ctx, before[number], after[number])
                if old is None or new is None or (id(old), id(new), kind) in reported:
                    continue
                old_pair, new_pair = ctx.pair(old), ctx.pair(new)
                reported.add((id(old), id(new), kind))
                # An exchange of messages of equal length passes all length checks of
                # decoders.
                same = (
                    " Both have the same length, so no decoder can notice."
                    if old.length == new.length
                    else ""
                )
                yield CheckResult(
                    f"{kind} {number} was {quote(old.name)} and is {quote(new.name)} now",
                    was=old.name,
                    now=new.name,
                    details=(f"Old software takes one for the other.{same}",),
                    pair=new_pair,
                    places=(old_pair.places(keys)[0], new_pair.places(keys)[1]),
                )


def _exchanged(
    ctx: ComparisonContext, before: list[Message], after: list[Message]
) -> tuple[Message | None, Message | None]:
    """Return a message that lost the id and a message that gained it, of equal length
    if possible.
    """
    losing = [
        message
        for message in before
        if not any(ctx.pair(message) is ctx.pair(other) for other in after)
    ]
    gaining = [
        message
        for message in after
        if not any(ctx.pair(message) is ctx.pair(other) for other in before)
    ]
    candidates = [(old, new) for old in losing for new in gaining]
    return min(
        candidates,
        key=lambda pair: pair[0].length != pair[1].length,
        default=(None, None),
    )


@rule("DIF105", "message")
def kind_changed(pair: MessagePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old, new = pair.old, pair.new
    if old.kind == new.kind:
        return
    lost = [
        kind
        for kind, key in DIRECTIONS.items()
        if getattr(old, key) is not None and getattr(new, key) is None
    ]
    details = tuple(
        f"It can no longer be {'sent' if kind == 'telecommand' else 'requested'}."
        for kind in lost
    )
    text = f"{quote(new.name)} is a {new.kind} now, was a {old.kind}"
    yield CheckResult(
        text, ("kind",), old.kind, new.kind, details, None if lost else "note", not lost
    )


@rule("DIF106", "message")
def length_changed(pair: MessagePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old, new = pair.old, pair.new
    # Rule DIF119 reports changes of the variable part itself.
    if old.layout.sequence or new.layout.sequence:
        if (
            old.layout.sequence
            and new.layout.sequence
            and old.layout.fixed_length != new.layout.fixed_length
        ):
            text = f"{quote(new.name)} has {length_text(new)}, had {length_text(old)}"
            yield CheckResult(text, ("length",), length_text(old), length_text(new))
        return
    if old.length == new.length:
        return
    shorter, by = (
        min(old.length, new.length),
        count(abs(new.length - old.length), "byte"),
    )
    tail = [p.any.name for p in ctx.at_the_end(pair)]
    if new.length > old.length:
        what = f"gained {some(tail, 'field')} at its end" if tail else f"grew by {by}"
    else:
        what = f"lost {some(tail, 'field')} at its end" if tail else f"shrank by {by}"
    text = f"{quote(new.name)} has {count(new.length, 'byte')}, had {old.length}: it {what}"
    taken = (
        length_text(old)
        if old.may_end_early
        else f"exactly {count(old.length, 'byte')}"
    )
    details = [f"Decoders of the other release refuse the frame: they take {taken}."]
    if tail and not ctx.is_touched_before(pair, shorter * 8):
        first = (
            "byte is as it was" if shorter == 1 else f"{shorter} bytes are as they were"
        )
        details.append(f"The first {first}.")
    yield CheckResult(
        text, ("length",), f"{old.length} bytes", f"{new.length} bytes", tuple(details)
    )


@rule("DIF119", "message")
def open_end_changed(
    pair: MessagePair, ctx: ComparisonContext
) -> Iterator[CheckResult]:
    old, new = pair.old, pair.new
    was, now = _variable_parts(old), _variable_parts(new)
    if was == now:
        return
    details = []
    if old.layout.lengths != new.layout.lengths:
        details.append(f"Frames have {length_text(new)}, had {length_text(old)}.")
    old_parts, new_parts = old.layout.parts, new.layout.parts
    if old_parts and len(new_parts) == 1 and old_parts[-1].most < new_parts[-1].most:
        details.append(
            f"Decoders of the other release refuse frames of more than {old_parts[-1].most}."
        )
    text = f"what ends {quote(new.name)} is {now}, was {was}"
    yield CheckResult(text, ("length",), was, now, tuple(details))


def _variable_parts(message: Message) -> str:
    """Return the variable parts and the fields behind them: ``up to 12 of `Levels`,
    counted by `Levels Count`, behind it `CRC` ``.
    """
    layout = message.layout
    parts = (
        quote(node.name) if part is None else _variable_part(part)
        for node in layout.sequence
        for part in [layout.part_of(node)]
    )
    return ", behind it ".join(parts) or "of fixed size"


def _variable_part(part: VariablePart) -> str:
    plus = f" {'+' if part.plus > 0 else '-'} {abs(part.plus):,}" if part.plus else ""
    counted = (
        "as many as come" if part.is_rest else f"counted by {quote(part.counter)}{plus}"
    )
    inner = "".join(f", each with {_variable_part(inner)}" for inner in part.inner)
    return f"up to {part.most} of {quote(part.name)}, {counted}{inner}"


@rule("DIF125", "message")
@rule("DIF126", "message", severity="note")
def end_changed(pair: MessagePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    old, new = pair.old, pair.new
    if old.may_end_early == new.may_end_early:
        return
    if new.may_end_early:
        details = "Decoders of the other release take whole frames only."
        code, text = (
            "DIF125",
            f"{quote(new.name)} may be sent without the zeros that it ends with",
        )
    else:
        code, text = (
            "DIF126",
            f"{quote(new.name)} is always sent with the zeros that it ends with",
        )
        details = "Decoders of the other release take such frames, too."
    yield CheckResult(
        text,
        ("may_end_early", "length"),
        length_text(old),
        length_text(new),
        (details,),
        code=code,
    )


@rule("DIF130", "node", presence="removed")
def node_removed(pair: NodePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    text = f"node `{pair.old.name}` is gone, with {count(len(pair.old.messages), 'message')}"
    yield CheckResult(text, ("name",), pair.old.name, "")


@rule("DIF131", "node", presence="added", severity="note", addition=True)
def node_added(pair: NodePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    text = f"node `{pair.new.name}` is new, with {count(len(pair.new.messages), 'message')}"
    yield CheckResult(text, ("name",), "", pair.new.name)


@rule("DIF132", "node")
@rule("DIF133", "node", severity="note", addition=True)
def used_messages_changed(
    pair: NodePair, ctx: ComparisonContext
) -> Iterator[CheckResult]:
    details = ("They are still there, and declared or included elsewhere.",)
    less, more = (
        [m.name for m in ctx.messages_not_used(pair, side)] for side in (0, 1)
    )
    if less:
        text = f"`{pair.new.name}` no longer speaks {some(less, 'message')}"
        yield CheckResult(
            text, ("include",), count(len(less), "message"), "", details, code="DIF132"
        )
    if more:
        text = f"`{pair.new.name}` speaks {some(more, 'message')} too"
        yield CheckResult(
            text, ("include",), "", count(len(more), "message"), details, code="DIF133"
        )
