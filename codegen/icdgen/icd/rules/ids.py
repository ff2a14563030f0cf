"""The ids of messages on the wire."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from icdgen.icd.located import Map
from icdgen.icd.model import CONFIGURATION, TELECOMMAND, TELEMETRY, Node
from icdgen.icd.rules.context import Context, mappings
from icdgen.icd.rules.duplicates import is_news, together
from icdgen.icd.rules.fault import Fault
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import line_of, listing, quote

# kind -> the keys of its ids and the direction each belongs to
KEYS = {
    TELECOMMAND: (("id", TELECOMMAND),),
    TELEMETRY: (("id", TELEMETRY),),
    CONFIGURATION: (("set_id", TELECOMMAND), ("get_id", TELEMETRY)),
}
BYTE = (0, 255)


class Use(NamedTuple):
    """One id in one direction."""

    node: Node
    direction: str
    id: int
    source: Map
    key: str


def _uses(node: Node) -> Iterator[Use]:
    for message in node.messages:
        for key, direction in KEYS[message.kind]:
            yield Use(node, direction, message.source[key], message.source, key)
    for item in mappings(node.source.get("missing")):
        if item.get("kind") in (TELECOMMAND, TELEMETRY) and isinstance(item.get("id"), int):
            yield Use(node, item["kind"], item["id"], item, "id")


@rule("ICD055")
def ids_distinct(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        seen: dict[tuple[str, int], Use] = {}
        for use in (u for n in ctx.scope(node) for u in _uses(n)):
            first = seen.setdefault((use.direction, use.id), use)
            if first is not use and is_news(ctx, node, first.node, use.node):
                place = use.source.at(use.key)
                other = f"{quote(first.source.get('name'))} ({line_of(first.source.at(first.key), place)})"
                message = f"{use.direction} id {use.id} already belongs to {other}{together(node, use.node)}"
                yield Fault(use.source, place, message, f"correct one `{use.key}`")


@rule("ICD056")
def ids_in_range(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        ranges = _ranges(ctx, node)
        for use in (u for n in ctx.scope(node) for u in _uses(n)):
            first, last = ranges.get(use.direction, BYTE)
            if not first <= use.id <= last:
                help = _remedy(use, ranges)
                message = f"{use.direction} ids go from {first} to {last}: {use.id} is not one of them"
                yield Fault(use.source, use.source.at(use.key), message, help)


def _remedy(use: Use, ranges: dict[str, tuple[int, int]]) -> str:
    if not ranges:
        return f"correct `{use.key}`: an id is one byte, longer ones cannot be described"
    other = next((d for d, (first, last) in ranges.items() if first <= use.id <= last), None)
    wrong = f"{use.id} is a {other} id: correct `{use.key}` or `kind`" if other else f"correct `{use.key}`"
    return f"{wrong}, or the range in `protocol: message_id`"


@rule("ICD059")
def ids_of_kind(ctx: Context) -> Iterator[Fault]:
    for message, _ in ctx.messages:
        own = [key for key, _ in KEYS[message.kind]]
        for key in ("id", "set_id", "get_id"):
            if key in message.source and key not in own:
                text = f"a {message.kind} message has no `{key}`"
                names = listing(f"`{k}`" for k in own)
                yield Fault(message.source, message.source.at(key), text, f"remove it: {message.kind} has {names}")


@rule("ICD065")
def only_what_is_sent(ctx: Context) -> Iterator[Fault]:
    for message, _ in ctx.messages:
        if message.kind == TELEMETRY:
            for key in ("acknowledge", "hazard"):
                if key in message.source:
                    text = f"`{key}` says something of what is sent, and {quote(message.name)} is telemetry"
                    yield Fault(message.source, message.source.at(key), text, "remove it, or correct `kind`")


def _ranges(ctx: Context, node: Node) -> dict[str, tuple[int, int]]:
    """First and last id of each direction, where the protocol section `message_id` gives them."""
    section = ctx.protocol_of(node).get("message_id")
    found = {}
    for direction in (TELECOMMAND, TELEMETRY):
        rule_ = section.get(direction) if isinstance(section, dict) else None
        if isinstance(rule_, dict) and isinstance(rule_.get("first"), int) and isinstance(rule_.get("last"), int):
            found[direction] = (rule_["first"], rule_["last"])
    return found
