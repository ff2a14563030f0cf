"""Rules about names with another meaning, acknowledges, and identification of a node."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diff.context import Context
from icdgen.diff.pairs import FieldPair, MessagePair, NodePair
from icdgen.diff.rule import CheckResult, rule
from icdgen.diff.similar import extends, same_sense
from icdgen.icd.model import Message
from icdgen.wording import quote


@rule("DIF212", "message")
def answer_changed(pair: MessagePair, ctx: Context) -> Iterator[CheckResult]:
    old, new = _answer(pair.old), _answer(pair.new)
    if old != new:
        detail = "A program that waits for the acknowledge times out."
        if pair.old.acknowledge == pair.new.acknowledge:
            detail = (
                "No answer comes in either case, but the node restarts in one of them."
            )
        elif pair.new.acknowledge:
            detail = "The device sends an acknowledge that old programs do not expect."
        yield CheckResult(
            f"{quote(pair.new.name)} is {new} now",
            ("acknowledge", "name"),
            old,
            new,
            (detail,),
        )


def _answer(message: Message) -> str:
    if message.acknowledge:
        return "acknowledged"
    return "answered by a restart" if message.expects_reset else "not acknowledged"


@rule("DIF213", "field", "message", severity="warning")
def name_says_otherwise(
    pair: FieldPair | MessagePair, ctx: Context
) -> Iterator[CheckResult]:
    old, new = pair.old.name, pair.new.name
    # Other spellings and more precise names keep the meaning.
    if old != new and not same_sense(old, new) and not extends(old, new):
        text = f"what was called {quote(old)} is called {quote(new)}: make sure that it is the same thing"
        yield CheckResult(text, ("name",), old, new)


@rule("DIF215", "node", severity="warning")
def node_says_otherwise(pair: NodePair, ctx: Context) -> Iterator[CheckResult]:
    for key in ("node_type", "interface_version"):
        old, new = getattr(pair.old, key), getattr(pair.new, key)
        if old != new:
            was, now = ("" if value is None else str(value) for value in (old, new))
            what = f"the {key.replace('_', ' ')} of `{pair.new.name}`"
            yield CheckResult(
                f"{what} is {now or 'not stated'}, was {was or 'not stated'}",
                (key,),
                was,
                now,
            )
