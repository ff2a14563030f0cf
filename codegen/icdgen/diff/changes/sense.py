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
from icdgen.icd.responses import ACK, BUSY, KINDS, NAK, PROGRESS
from icdgen.wording import quote

# What a program does not learn from a response that it does not know.
_NOT_LEARNT = {
    NAK: "that the telecommand was refused",
    BUSY: "that the device is busy",
    PROGRESS: "that the telecommand is still being executed",
}


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
        # The keys below `commands`; none if the whole section is new or gone.
        keys = fact.path.split(".")[3:]
        if len(keys) == 1 and _response(fact.old) == _response(fact.new):
            continue  # another spelling
        was, now = shown(fact.old), shown(fact.new)
        what = _response_words(keys)
        if fact.old is None:
            text = f"{what} is new: {now}"
        elif fact.new is None:
            text = f"{what} is gone; it was {was}"
        else:
            text = f"{what} is {now}, was {was}"
        effect = _effect_of_response(keys, fact.old, fact.new)
        yield CheckResult(
            text,
            (fact.path.rsplit(".", 1)[-1],),
            was,
            now,
            (effect,) if effect else (),
            severity=None if effect else "warning",
            where=pair.where()._replace(section=fact.path),
            places=fact.places,
        )


def _response(value: object) -> object:
    """Return a response with the key ``message`` if it is only a name."""
    return {"message": value} if isinstance(value, str) else value


def _response_words(keys: list[str]) -> str:
    """Return the words for a value below `commands`."""
    if not keys:
        return "the section `commands` with responses to telecommands"
    kind, *inner = keys
    if kind not in KINDS:
        return f"`{'.'.join(keys)}` in `commands`"
    response = f"the response `{kind}` to telecommands"
    return f"`{'.'.join(inner)}` of {response}" if inner else response


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


def _effect_of_response(keys: list[str], old: object, new: object) -> str:
    """Return what a program with the old ICD does with a response to all telecommands;
    empty if it is not affected.
    """
    kind = keys[0] if keys else ""
    if (kind and kind not in KINDS) or "reason" in keys:
        return ""
    if len(keys) > 1 or (kind and old is not None and new is not None):
        return (
            "A program with the old ICD may not recognize this response, or take it for "
            "the response to another telecommand."
        )
    if new is None:
        return (
            "A program with the old ICD waits until its time-out, because this response "
            "does not come."
            if kind in ("", ACK)
            else ""
        )
    end = f" and does not learn {_NOT_LEARNT[kind]}" if kind in _NOT_LEARNT else ""
    return f"A program with the old ICD reports this response as other telemetry{end}."


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
