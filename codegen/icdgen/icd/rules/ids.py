"""The ids of messages on the wire."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from icdgen.diagnostics import Related
from icdgen.icd import variants, wire_ids
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map
from icdgen.icd.model import KEYS_OF_IDS, TELECOMMAND, TELEMETRY, Message, Node
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.duplicates import is_news, together
from icdgen.icd.rules.protocol_limits import in_force
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import count, line_of, listing, quote
from icdgen.icd.trees import mappings

LINKED_BITS = 8  # of an id in every frame that a protocol section can describe, but for those of `stream`


class Use(NamedTuple):
    """One id in one direction."""

    node: Node
    direction: str
    id: int
    source: Map
    key: str
    message: Message | None = None  # None: it is said to be missing


def _used(node: Node) -> Iterator[Use]:
    """The ids of its messages."""
    for message in node.messages:
        for key, direction in KEYS_OF_IDS[message.kind]:
            yield Use(node, direction, wire_ids.number(message.source[key]), message.source, key, message)


def _uses(node: Node) -> Iterator[Use]:
    """Those, and the ids of messages that are said to be missing."""
    yield from _used(node)
    for item in mappings(node.source.get("missing")):
        if item.get("kind") in (TELECOMMAND, TELEMETRY) and _is_id(item.get("id")):
            yield Use(node, item["kind"], wire_ids.number(item["id"]), item, "id")


def _is_id(value: object) -> bool:
    """Whether it is a number or bytes: the entry may be broken."""
    if isinstance(value, list):
        most = wire_ids.size(wire_ids.MOST_BITS)
        return 0 < len(value) <= most and all(isinstance(one, int) and 0 <= one <= 255 for one in value)
    return isinstance(value, int) and 0 <= value < 1 << wire_ids.MOST_BITS


@rule("ICD055")
def ids_told_apart(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        is_linked = ctx.is_linked(node)  # an envelope tells an id and the data
        seen: dict[tuple[str, int], list[Use]] = {}
        for use in (u for n in ctx.scope(node) for u in _uses(n)):
            before = seen.setdefault((use.direction, use.id), [])
            for first in before:
                if not is_linked and _are_told_apart(first, use):
                    continue
                if is_news(ctx, node, first.node, use.node) or (is_linked and not ctx.is_linked(use.node)):
                    yield _same_id(ctx, node, first, use, is_linked)
                    break
            before.append(use)


@rule("ICD181")
def ids_shared_on_purpose(ctx: Context) -> Iterator[Fault]:
    """Report messages that share an id, and can be told apart, if they do not both have the key `shares_id`.

    Copying a message and forgetting to change its id also gives two messages that differ in length or in a constant, so
    the difference alone is no evidence of an intention.
    """
    for node in filter(lambda node: not ctx.is_linked(node), ctx.icd.nodes):
        seen: dict[tuple[str, int], Use] = {}
        for use in (u for n in ctx.scope(node) for u in _uses(n) if u.message is not None):
            first = seen.setdefault((use.direction, use.id), use)
            if first is use or not is_news(ctx, node, first.node, use.node) or not _are_told_apart(first, use):
                continue
            silent = [one for one in (first, use) if not _confirms(one)]
            if silent:
                yield _unconfirmed(ctx, node, first, use, silent)


def _confirms(use: Use) -> bool:
    return use.source.get("shares_id") is True


def _unconfirmed(ctx: Context, node: Node, first: Use, use: Use, silent: list[Use]) -> Fault:
    there = line_of(first.source.at(first.key), use.source.at(use.key))
    names = [quote(one.source.get("name")) for one in (first, use)]
    message = f"{_id(ctx, use)} already belongs to {names[0]} ({there}){together(node, use.node)}"
    if len(silent) == 1:
        message += ", and only one of the two has `shares_id`"
    to = "each of the two" if len(silent) == 2 else quote(silent[0].source.get("name"))
    help = f"correct one `{use.key}`; or, if they share the id on purpose, add `shares_id: true` to {to}"
    return Fault.at(use.source, use.key, message, help, related=_first_use(first))


@rule("ICD182", severity="warning", whole=True)
def ids_that_are_shared(ctx: Context) -> Iterator[Fault]:
    """Report the key `shares_id` of a message whose id no other message has: it would confirm a copied id later."""
    shared: set[int] = set()
    for node in ctx.icd.nodes:
        users: dict[tuple[str, int], list[Use]] = {}
        for use in (u for n in ctx.scope(node) for u in _uses(n)):
            users.setdefault((use.direction, use.id), []).append(use)
        shared.update(id(use.source) for uses in users.values() if len(uses) > 1 for use in uses)
    for message, _ in ctx.messages:
        if message.source.get("shares_id") is True and id(message.source) not in shared:
            text = f"{quote(message.name)} has `shares_id`, but no other message has its id"
            yield Fault.at(message.source, "shares_id", text, "remove the key, or correct the id")


def _are_told_apart(one: Use, other: Use) -> bool:
    """Whether a frame shows which of the two it is. What is said to be missing has nothing to show."""
    if one.message is None or other.message is None:
        return False
    return variants.are_distinguishable((one.message, one.node), (other.message, other.node))


def _same_id(ctx: Context, node: Node, first: Use, use: Use, is_linked: bool) -> Fault:
    other = f"{quote(first.source.get('name'))} ({line_of(first.source.at(first.key), use.source.at(use.key))})"
    message = f"{_id(ctx, use)} already belongs to {other}{together(node, use.node)}"
    help = f"correct one `{use.key}`"
    if first.message is not None and use.message is not None:
        if not is_linked:
            message += ", and the two cannot be distinguished"
            help += ", or give each a field with another `const` at the same place"
        elif _are_told_apart(first, use):
            message += ", and the links that `protocol` describes distinguish messages only by id"
    return Fault.at(use.source, use.key, message, help, related=_first_use(first))


def _id(ctx: Context, use: Use) -> str:
    """``telemetry id 0x82``: the id as the file writes it."""
    return f"{use.direction} id {ctx.written(use.source, use.key)}"


def _first_use(use: Use) -> Related:
    """The place where an id is used first."""
    return Related(use.source.at(use.key), f"the id of {quote(use.source.get('name'))}")


@rule("ICD056")
def ids_in_range(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        ranges = _ranges(ctx, node)
        for use in (u for n in ctx.scope(node) for u in _uses(n)):
            first, last = ranges.get(use.direction, (0, (1 << node.id_bits) - 1))
            if not first <= use.id <= last and _has_its_bytes(use):
                help = _remedy(ctx, node, use, ranges)
                message = f"{_id(ctx, use)} is outside the range of {use.direction} ids, {_range_text(ctx, node, use, ranges)}"
                yield Fault.at(use.source, use.key, message, help)


def _range_text(ctx: Context, node: Node, use: Use, ranges: dict[str, tuple[int, int]]) -> str:
    """``0x80 to 0xFF``: the range as the protocol section writes it, or that of the width of ids."""
    if use.direction not in ranges:
        return f"0 to {(1 << node.id_bits) - 1}"
    section = in_force(ctx, node, "message_id", use.direction)
    assert section is not None
    return f"{ctx.written(section, 'first')} to {ctx.written(section, 'last')}"


def _remedy(ctx: Context, node: Node, use: Use, ranges: dict[str, tuple[int, int]]) -> str:
    if not ranges and ctx.is_linked(node):
        return f"correct `{use.key}`: the links that `protocol` describes carry ids of one byte, except a `stream`"
    if not ranges:
        needed = next(bits for bits in (8, 16, 24, 32) if use.id < 1 << bits)
        return f"correct `{use.key}`, or give the width of all ids in `node`: `id_bits: {needed}`"
    other = next((d for d, (first, last) in ranges.items() if first <= use.id <= last), None)
    written = ctx.written(use.source, use.key)
    wrong = f"{written} is a {other} id: correct `{use.key}` or `kind`" if other else f"correct `{use.key}`"
    return f"{wrong}, or the range in `protocol: message_id`"


def _has_its_bytes(use: Use) -> bool:
    """Whether the id is a number, or as many bytes as ids have."""
    written = use.source[use.key]
    return not isinstance(written, list) or len(written) == wire_ids.size(use.node.id_bits)


@rule("ICD111")
def bytes_of_ids(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        size = wire_ids.size(node.id_bits)
        for use in _uses(node):
            if not _has_its_bytes(use):
                has = f"ids have {count(node.id_bits, 'bit')}, which is {count(size, 'byte')}"
                given = count(len(use.source[use.key]), "byte")
                message = f"{has}: {quote(use.source.get('name'))} has an id of {given}"
                help = f"write {count(size, 'byte')}, or correct `id_bits` in `node`"
                yield Fault.at(use.source, use.key, message, help)


@rule("ICD112")
def ids_that_links_carry(ctx: Context) -> Iterator[Fault]:
    for node in filter(ctx.is_linked, ctx.icd.nodes):
        if node.id_bits > LINKED_BITS:
            message = f"ids have {node.id_bits} bits, but the links that `protocol` describes carry ids of one byte"
            help = "describe the link as a `stream`, or leave `protocol` out; or correct `id_bits`"
            yield Fault.at(node.source["node"], "id_bits", message, help)


@rule("ICD114")
def ids_that_tell_the_direction(ctx: Context) -> Iterator[Fault]:
    told: set[int] = set()
    for node in ctx.icd.nodes:
        declared = _ranges(ctx, node)
        if ctx.fact(node, "uart", "framing") is None or len(declared) == 2:  # ICD056 and ICD103 see to ranges
            continue
        uses = [use for one in ctx.scope(node) for use in _used(one)]
        ids = [use.id for use in uses if use.direction == TELEMETRY]
        first, last = declared.get(TELEMETRY, (min(ids, default=0), max(ids, default=-1)))
        for use in uses:
            if use.direction == TELECOMMAND and first <= use.id <= last and id(use.source) not in told:
                told.add(id(use.source))  # once, though other nodes may include it
                among = f"{_id(ctx, use)} is in the range of telemetry ids, {first} to {last}"
                message = f"{among}: on a UART only the id tells the direction, so an acknowledge is taken for a reply"
                help = "give each direction ids of its own, one range before the other; or leave `uart: framing` out"
                yield Fault.at(use.source, use.key, message, help)


@rule("ICD059")
def ids_of_kind(ctx: Context) -> Iterator[Fault]:
    for message, _ in ctx.messages:
        own = [key for key, _ in KEYS_OF_IDS[message.kind]]
        for key in ("id", "set_id", "get_id"):
            if key in message.source and key not in own:
                text = f"a {message.kind} message has no `{key}`"
                names = listing(f"`{k}`" for k in own)
                yield Fault.at(message.source, key, text, f"remove it: {message.kind} has {names}")


@rule("ICD065")
def only_what_is_sent(ctx: Context) -> Iterator[Fault]:
    for message, _ in ctx.messages:
        if message.kind == TELEMETRY:
            for key in ("acknowledge", "hazard"):
                if key in message.source:
                    text = f"`{key}` is for messages that are sent to the node; {quote(message.name)} is telemetry"
                    yield Fault.at(message.source, key, text, "remove it, or correct `kind`")


def _ranges(ctx: Context, node: Node) -> dict[str, tuple[int, int]]:
    """First and last id of each direction, where the protocol section `message_id` gives them."""
    found = {}
    for direction in (TELECOMMAND, TELEMETRY):
        first, last = (ctx.fact(node, "message_id", direction, key) for key in ("first", "last"))
        if isinstance(first, int) and isinstance(last, int):
            found[direction] = first, last
    return found
