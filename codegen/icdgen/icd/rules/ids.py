"""Message ids: ranges, widths, and messages that share an id.

The rules take the ids of messages and of entries of `missing`, per direction, in a node
with the nodes that it includes. `icdgen.icd.variants` decides whether two messages of
one id can be distinguished. On links that are not framed, only the id identifies a
message. ICD059 and ICD065 report keys that do not suit the kind of a message.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diagnostics import Related
from icdgen.frozen import NamedTuple
from icdgen.icd import variants, wire_ids
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map
from icdgen.icd.model import KEYS_OF_IDS, TELECOMMAND, TELEMETRY, Message, Node
from icdgen.icd.rules.context import PATH_OF_BUSES, Context
from icdgen.icd.rules.duplicates import (
    brings_together,
    included_with_both,
    together,
)
from icdgen.icd.rules.protocol_limits import section_in_effect
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import line_of
from icdgen.icd.trees import mappings
from icdgen.wording import count, listing, quote

LINKED_BITS = 8  # width of ids on links that are not framed


class IdUse(NamedTuple):
    """Use of an id in one direction, by a message or an entry of `missing`."""

    node: Node
    direction: str
    id: int
    source: Map
    key: str
    message: Message | None = None  # None for an entry of `missing`


def _uses(node: Node) -> Iterator[IdUse]:
    """Yield the ids of the messages of a node, and of its entries of `missing`."""
    for message in node.messages:
        for key, direction in KEYS_OF_IDS[message.kind]:
            yield IdUse(
                node,
                direction,
                wire_ids.number(message.source[key]),
                message.source,
                key,
                message,
            )
    for item in mappings(node.source.get("missing")):
        if item.get("kind") in (TELECOMMAND, TELEMETRY) and _is_id(item.get("id")):
            yield IdUse(node, item["kind"], wire_ids.number(item["id"]), item, "id")


def _uses_in_scope(ctx: Context, node: Node) -> Iterator[IdUse]:
    """Yield the uses of ids in a node and its included nodes."""
    for owner in ctx.scope(node):
        yield from _uses(owner)


def _is_id(value: object) -> bool:
    """Return whether a value is a valid id; an entry of `missing` may violate the
    schema.
    """
    if isinstance(value, list):
        most = wire_ids.size(wire_ids.MOST_BITS)
        return 0 < len(value) <= most and all(
            isinstance(byte, int) and 0 <= byte <= 255 for byte in value
        )
    return isinstance(value, int) and 0 <= value < 1 << wire_ids.MOST_BITS


@rule("ICD055")
def messages_of_one_id_are_distinguishable(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        # On a link other than `link`, only the id identifies a message.
        is_linked = ctx.is_linked(node)
        seen: dict[tuple[str, int], list[IdUse]] = {}
        for use in _uses_in_scope(ctx, node):
            before = seen.setdefault((use.direction, use.id), [])
            for first in before:
                if not is_linked and _are_distinguishable(first, use):
                    continue
                # The clash belongs to the first node that has both. A node with a link
                # can include a node without one, where the two messages are permitted:
                # then it belongs to the first node with the link.
                reporting = (
                    other
                    for other in included_with_both(ctx, node, first.node, use.node)
                    if ctx.is_linked(other) or not is_linked
                )
                if use.node is node or not any(reporting):
                    yield _same_id(ctx, node, first, use, is_linked)
                    break
            before.append(use)


@rule("ICD181")
def shared_ids_are_confirmed(ctx: Context) -> Iterator[Fault]:
    """Report distinguishable messages with the same id that do not both have the key
    `shares_id`.

    Copying a message and forgetting to change its id also gives two messages that
    differ in length or in a constant. Therefore a difference does not show that the id
    is shared on purpose.
    """
    # ICD055 reports any two messages with the same id, if links identify a message by
    # its id alone.
    for node in filter(lambda node: not ctx.is_linked(node), ctx.icd.nodes):
        seen: dict[tuple[str, int], IdUse] = {}
        for use in (
            use for use in _uses_in_scope(ctx, node) if use.message is not None
        ):
            first = seen.setdefault((use.direction, use.id), use)
            if (
                first is use
                or not brings_together(ctx, node, first.node, use.node)
                or not _are_distinguishable(first, use)
            ):
                continue
            unconfirmed = [
                each
                for each in (first, use)
                if each.source.get("shares_id") is not True
            ]
            if unconfirmed:
                yield _unconfirmed(ctx, node, first, use, unconfirmed)


def _unconfirmed(
    ctx: Context, node: Node, first: IdUse, use: IdUse, unconfirmed: list[IdUse]
) -> Fault:
    """Return the fault of two uses of an id, of which one or both lack `shares_id`."""
    line = line_of(first.source.at(first.key), use.source.at(use.key))
    first_name = quote(first.source.get("name"))
    message = f"{_id(ctx, use)} already belongs to {first_name} ({line}){together(node, use.node)}"
    if len(unconfirmed) == 1:
        message += ", and only one of the two has `shares_id`"
    to = (
        "each of the two"
        if len(unconfirmed) == 2
        else quote(unconfirmed[0].source.get("name"))
    )
    help = f"correct one `{use.key}`; or, if they share the id on purpose, add `shares_id: true` to {to}"
    return Fault.at(use.source, use.key, message, help, related=_first_use(first))


@rule("ICD182", severity="warning", needs_complete=True)
def confirmed_ids_are_shared(ctx: Context) -> Iterator[Fault]:
    """Report `shares_id` of a message whose id no other message has: the key would
    later confirm an id that was copied.
    """
    # A message can share its id with one of a node that includes this one, so all nodes
    # are considered before any finding.
    shared: set[int] = set()
    for node in ctx.icd.nodes:
        users: dict[tuple[str, int], list[IdUse]] = {}
        for use in _uses_in_scope(ctx, node):
            users.setdefault((use.direction, use.id), []).append(use)
        shared.update(
            id(use.source) for uses in users.values() if len(uses) > 1 for use in uses
        )
    for message, _ in ctx.messages:
        if message.source.get("shares_id") is True and id(message.source) not in shared:
            text = f"{quote(message.name)} has `shares_id`, but no other message has its id"
            yield Fault.at(
                message.source, "shares_id", text, "remove the key, or correct the id"
            )


def _are_distinguishable(first: IdUse, second: IdUse) -> bool:
    """Return whether frames of two uses of an id are distinguishable.

    Entries of `missing` never are.
    """
    if first.message is None or second.message is None:
        return False
    return variants.are_distinguishable(
        (first.message, first.node), (second.message, second.node)
    )


def _same_id(
    ctx: Context, node: Node, first: IdUse, use: IdUse, is_linked: bool
) -> Fault:
    """Return the fault of two uses of an id that cannot be distinguished."""
    other = f"{quote(first.source.get('name'))} ({line_of(first.source.at(first.key), use.source.at(use.key))})"
    message = f"{_id(ctx, use)} already belongs to {other}{together(node, use.node)}"
    help = f"correct one `{use.key}`"
    if first.message is not None and use.message is not None:
        if not is_linked:
            message += ", and the two cannot be distinguished"
            help += ", or give each a field with another `const` at the same place"
        elif _are_distinguishable(first, use):
            message += ", and the links that `protocol` describes distinguish messages only by id"
    return Fault.at(use.source, use.key, message, help, related=_first_use(first))


def _id(ctx: Context, use: IdUse) -> str:
    """Return direction and id in the spelling of the file: ``telemetry id 0x82``."""
    return f"{use.direction} id {ctx.written(use.source, use.key)}"


def _first_use(use: IdUse) -> Related:
    """Return the place of the first use of an id."""
    return Related(use.source.at(use.key), f"the id of {quote(use.source.get('name'))}")


@rule("ICD056")
def ids_are_in_range(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        ranges = _ranges(ctx, node)
        for use in _uses_in_scope(ctx, node):
            first, last = ranges.get(use.direction, (0, (1 << node.id_bits) - 1))
            # ICD111 reports an id with the wrong number of bytes, whose value has no
            # meaning.
            if not first <= use.id <= last and _has_its_bytes(use):
                help = _remedy(ctx, node, use, ranges)
                message = f"{_id(ctx, use)} is outside the range of {use.direction} ids, {_range_text(ctx, node, use, ranges)}"
                yield Fault.at(use.source, use.key, message, help)


def _range_text(
    ctx: Context, node: Node, use: IdUse, ranges: dict[str, tuple[int, int]]
) -> str:
    """Return the range of the protocol section in its spelling, ``0x80 to 0xFF``, or
    else the range of `id_bits`.
    """
    if use.direction not in ranges:
        return f"0 to {(1 << node.id_bits) - 1}"
    section = section_in_effect(ctx, node, "link", "ids", use.direction)
    assert section is not None
    return f"{ctx.written(section, 'first')} to {ctx.written(section, 'last')}"


def _remedy(
    ctx: Context, node: Node, use: IdUse, ranges: dict[str, tuple[int, int]]
) -> str:
    """Return the help for an id that is out of range."""
    if not ranges and ctx.is_linked(node):
        return f"correct `{use.key}`: UART, I2C and CAN carry ids of one byte here, and framed links any (`link: framing`)"
    if not ranges:
        # Identifiers of CAN have 11 or 29 bits, other ids whole bytes.
        widths = (29, 32) if node.id_bits == 11 else (8, 16, 24, 32)
        needed = next(bits for bits in widths if use.id < 1 << bits)
        return f"correct `{use.key}`, or widen the ids of all messages: `id_bits: {needed}` in `node`"
    other = next(
        (
            direction
            for direction, (first, last) in ranges.items()
            if first <= use.id <= last
        ),
        None,
    )
    written = ctx.written(use.source, use.key)
    wrong = (
        f"{written} is a {other} id: correct `{use.key}` or `kind`"
        if other
        else f"correct `{use.key}`"
    )
    return f"{wrong}, or the range in `link: ids`"


def _has_its_bytes(use: IdUse) -> bool:
    """Return whether an id is a number, or a list of the right number of bytes."""
    written = use.source[use.key]
    return not isinstance(written, list) or len(written) == wire_ids.size(
        use.node.id_bits
    )


@rule("ICD111")
def ids_have_the_declared_bytes(ctx: Context) -> Iterator[Fault]:
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
def links_can_carry_ids(ctx: Context) -> Iterator[Fault]:
    for node in filter(ctx.is_linked, ctx.icd.nodes):
        if node.id_bits > LINKED_BITS:
            message = f"ids have {node.id_bits} bits, but the links that `protocol` describes carry ids of one byte"
            help = (
                "describe it in `link`, or leave `protocol` out; or correct `id_bits`"
            )
            yield Fault.at(node.source["node"], "id_bits", message, help)


@rule("ICD114")
def uart_ids_determine_the_direction(ctx: Context) -> Iterator[Fault]:
    reported: set[int] = set()
    for node in ctx.icd.nodes:
        declared = _ranges(ctx, node)
        # ICD056 and ICD103 check declared ranges.
        if (
            ctx.fact(node, *PATH_OF_BUSES, "uart", "framing") is None
            or len(declared) == 2
        ):
            continue
        uses = [use for use in _uses_in_scope(ctx, node) if use.message is not None]
        # Without declared ranges the generated client takes the span of the telemetry
        # ids. `max` of nothing is -1, so that the range is empty.
        ids = [use.id for use in uses if use.direction == TELEMETRY]
        first, last = declared.get(
            TELEMETRY, (min(ids, default=0), max(ids, default=-1))
        )
        for use in uses:
            if (
                use.direction == TELECOMMAND
                and first <= use.id <= last
                and id(use.source) not in reported
            ):
                # Once, although several nodes can include the message.
                reported.add(id(use.source))
                among = f"{_id(ctx, use)} is in the range of telemetry ids, {first} to {last}"
                message = f"{among}: on a UART only the id tells the direction, so an acknowledge is taken for a reply"
                help = "give each direction ids of its own, one range before the other; or leave `framing` out"
                yield Fault.at(use.source, use.key, message, help)


@rule("ICD059")
def id_keys_match_the_kind(ctx: Context) -> Iterator[Fault]:
    for message, _ in ctx.messages:
        own = [key for key, _ in KEYS_OF_IDS[message.kind]]
        for key in ("id", "set_id", "get_id"):
            if key in message.source and key not in own:
                text = f"a {message.kind} message has no `{key}`"
                names = listing(f"`{name}`" for name in own)
                yield Fault.at(
                    message.source, key, text, f"remove it: {message.kind} has {names}"
                )


@rule("ICD065")
def telemetry_has_no_keys_of_telecommands(ctx: Context) -> Iterator[Fault]:
    for message, _ in ctx.messages:
        if message.kind == TELEMETRY:
            for key in ("acknowledge", "hazard"):
                if key in message.source:
                    text = f"`{key}` is for messages that are sent to the node; {quote(message.name)} is telemetry"
                    yield Fault.at(
                        message.source, key, text, "remove it, or correct `kind`"
                    )


def _ranges(ctx: Context, node: Node) -> dict[str, tuple[int, int]]:
    """Return the first and last id of each direction that `link: ids` declares."""
    ranges = {}
    for direction in (TELECOMMAND, TELEMETRY):
        first, last = (
            ctx.fact(node, "link", "ids", direction, key) for key in ("first", "last")
        )
        if isinstance(first, int) and isinstance(last, int):
            ranges[direction] = first, last
    return ranges
