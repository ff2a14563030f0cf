"""Rules about names with another meaning, acknowledges, responses, and identification
of a node.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diff.context import Context
from icdgen.diff.facts import RESPONSES, facts, shown
from icdgen.diff.pairs import FieldPair, MessagePair, NodePair
from icdgen.diff.rule import CheckResult, rule
from icdgen.diff.similar import extends, same_sense
from icdgen.icd.model import Message
from icdgen.icd.responses import ACK, KINDS
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


@rule("DIF216", "node")
def general_responses_changed(pair: NodePair, ctx: Context) -> Iterator[CheckResult]:
    for fact in facts(pair.old, pair.new):
        if fact.is_word or not RESPONSES.fullmatch(fact.path):
            continue
        was, now = shown(fact.old), shown(fact.new)
        steps = fact.path.split(".")
        # The key after `commands`; the whole section may be new.
        kind = steps[3] if len(steps) > 3 else ""
        effect = _effect_of_response(kind, fact.old, fact.new)
        yield CheckResult(
            f"`{fact.path}` is {now or 'not stated'}, was {was or 'not stated'}",
            (steps[-1],),
            was,
            now,
            (effect,) if effect else (),
            severity=None if effect else "warning",
            where=pair.where()._replace(section=fact.path),
            places=fact.places,
        )


@rule("DIF217", "message")
def response_changed(pair: MessagePair, ctx: Context) -> Iterator[CheckResult]:
    name = quote(pair.new.name)
    if pair.old.response != pair.new.response:
        was, now = (_responses(message) for message in (pair.old, pair.new))
        yield CheckResult(
            f"the responses to {name} are {now}, were {was}",
            ("response", "name"),
            was,
            now,
            (
                "A client of the old ICD waits for a response that does not come, or "
                "takes one that it does not know for telemetry.",
            ),
        )
    if pair.old.repeat != pair.new.repeat:
        was, now = (
            "sent again after a time-out" if message.repeat else "sent once"
            for message in (pair.old, pair.new)
        )
        yield CheckResult(f"{name} is {now}, was {was}", ("repeat", "name"), was, now)


def _responses(message: Message) -> str:
    own = message.response
    return "those of all telecommands" if own is None else shown(own)


def _effect_of_response(kind: str, old: object, new: object) -> str:
    """Return what a client of the old ICD does with a response to all telecommands;
    empty if it is not affected.
    """
    if kind not in KINDS or (new is None and kind != ACK):
        return ""
    if new is None:
        return "A client of the old ICD waits for this response, which does not come."
    if old is not None:
        return (
            "A client of the old ICD may take it for a response to another telecommand."
        )
    end = "" if kind == ACK else ", and the telecommand ends with a time-out"
    return f"A client of the old ICD reports this response as telemetry{end}."


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
