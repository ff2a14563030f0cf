"""Rules about names with another meaning, acknowledges, responses, and identification
of a node.

Each rule receives a pair of nodes, messages or fields and yields a `CheckResult` for
each change: DIF212, DIF213 and DIF215 to DIF218. ``sense.md`` explains them to users. A
new name is only a warning: `icdgen.diff.similar` compares words, not meanings.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diff.context import ComparisonContext
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
def answer_changed(pair: MessagePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
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
def general_responses_changed(
    pair: NodePair, ctx: ComparisonContext
) -> Iterator[CheckResult]:
    for fact in facts(pair.old, pair.new):
        if fact.is_word or not RESPONSES.fullmatch(fact.path):
            continue
        # The keys below `commands` or `requests`; none if the whole section is new or
        # gone.
        section, *keys = fact.path.split(".")[2:]
        if len(keys) == 1 and _response(fact.old) == _response(fact.new):
            continue  # another spelling
        was, now = shown(fact.old), shown(fact.new)
        what = _response_words(section, keys)
        if fact.old is None:
            text = f"{what} is new: {now}"
        elif fact.new is None:
            text = f"{what} is gone; it was {was}"
        else:
            text = f"{what} is {now}, was {was}"
        effect = _effect_of_response(section, keys, fact.old, fact.new)
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


def _response_words(section: str, keys: list[str]) -> str:
    """Return the words for a value below `commands` or `requests`."""
    to = "telecommands" if section == "commands" else "requests of telemetry"
    if not keys:
        return f"the section `{section}` with responses to {to}"
    kind, *inner = keys
    if kind not in KINDS:
        return f"`{'.'.join(keys)}` in `{section}`"
    response = f"the response `{kind}` to {to}"
    return f"`{'.'.join(inner)}` of {response}" if inner else response


@rule("DIF217", "message")
def response_changed(
    pair: MessagePair, ctx: ComparisonContext
) -> Iterator[CheckResult]:
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
    if pair.old.requested != pair.new.requested:
        was, now = (
            "requested by its id" if message.requested else "not requested by its id"
            for message in (pair.old, pair.new)
        )
        keys = ("requested", "name")
        yield CheckResult(f"{name} is {now}, was {was}", keys, was, now)


def _responses(message: Message) -> str:
    own = message.response
    return "those of all telecommands" if own is None else shown(own)


def _effect_of_response(section: str, keys: list[str], old: object, new: object) -> str:
    """Return what a program with the old ICD does with a response to all telecommands or
    requests; empty if it is not affected.
    """
    kind = keys[0] if keys else ""
    if kind in ("packet", "reserved"):
        return (
            "The device does not take the request of a program with the old ICD for a "
            "request of telemetry."
        )
    if section == "requests" and not kind:
        return (
            "A program with the old ICD requests telemetry in a way that the device does "
            "not know."
            if new is None
            else ""
        )
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


@rule("DIF218", "message", severity="warning")
def period_changed(pair: MessagePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    if pair.old.period_ms != pair.new.period_ms:
        was, now = (
            "not stated" if message.period_ms is None else f"{message.period_ms} ms"
            for message in (pair.old, pair.new)
        )
        text = f"the period of {quote(pair.new.name)} is {now}, was {was}"
        yield CheckResult(text, ("period_ms", "name"), was, now)


@rule("DIF213", "field", "message", severity="warning")
def name_says_otherwise(
    pair: FieldPair | MessagePair, ctx: ComparisonContext
) -> Iterator[CheckResult]:
    old, new = pair.old.name, pair.new.name
    # Other spellings and more precise names keep the meaning.
    if old != new and not same_sense(old, new) and not extends(old, new):
        text = f"what was called {quote(old)} is called {quote(new)}: make sure that it is the same thing"
        yield CheckResult(text, ("name",), old, new)


@rule("DIF215", "node", severity="warning")
def node_says_otherwise(
    pair: NodePair, ctx: ComparisonContext
) -> Iterator[CheckResult]:
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
