"""Links that are described as an envelope of fields with roles."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq, unread
from icdgen.icd.model import TELECOMMAND, TELEMETRY, Message, Node
from icdgen.icd.rules.context import Context, section_of
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import count, line_of, listing, of_wide_value, quote
from icdgen.icd.suggestions import suggestion
from icdgen.icd.trees import at_path, mappings

DIRECTIONS = (TELECOMMAND, TELEMETRY)
PARTS = ("header", "trailer")
FIXED = ("sync", "constant")
WORD = 32  # bits of a field, at most
MOST_SEQUENCE_BITS = 31
MOST_SPAN = 4  # bytes that a field may have part in
DATA = "data"
ONLY_WITH = {"counts": "length", "plus": "length", "per": "sequence", "checksum": "checksum"}  # keys of one role
BESIDE = ("stream", "checksums", "client", "uart", "boot")  # what else may be said of such a link
BITS_OF = {"fletcher": 16, "fletcher_255": 16, "xor": 8}


class Link(NamedTuple):
    """The envelope of a node."""

    node: Node
    section: Map
    rows: list[tuple[str, Map]]  # in which part, in order

    def of(self, *roles: str) -> list[Map]:
        """The fields of these roles."""
        return [row for _, row in self.rows if row.get("role") in roles]


def links(ctx: Context) -> Iterator[Link]:
    """The envelopes, of the nodes that describe one themselves."""
    for node in ctx.icd.nodes:
        section = section_of(node, "stream")
        if section is not None:
            rows = [(part, row) for part in PARTS for row in mappings(section.get(part))]
            if all(_is_sound(row) for _, row in rows):  # else the schema has told of it
                yield Link(node, section, rows)


def _is_sound(row: Map) -> bool:
    """Whether the schema has nothing to say of what is looked at here."""
    numbers: list[Any] = [row.get("at"), row.get("bits"), row.get("plus", 0)]
    if not all(type(one) is int for one in numbers) or numbers[0] < 0 or not 0 < numbers[1] <= WORD:
        return False
    return isinstance(row.get("role"), str) and isinstance(row.get("checksum", ""), str)


@rule("ICD170")
def described_once(ctx: Context) -> Iterator[Fault]:
    for link in links(ctx):
        protocol = link.node.source["protocol"]
        for key in protocol:
            if key not in BESIDE:
                message = f"`{key}` belongs to another kind of link than `stream` and has no effect"
                yield Fault.at_key(protocol, key, message, f"remove `{key}` or `stream`")
        uart = protocol.get("uart")
        client = protocol.get("client")
        for key in ("poll_interval_ms", "poll_timeout_ms"):
            if isinstance(client, Map) and key in client:
                message = f"`{key}` has no effect, because framed streams do not poll"
                yield Fault.at_key(client, key, message, "remove it")
        for key in ("framing", "acknowledge"):
            if isinstance(uart, Map) and key in uart:
                message = f"`uart: {key}` and `stream` describe how messages are delimited, each in another way"
                yield Fault.at_key(uart, key, message, "remove one of them")
    for node in ctx.icd.nodes:
        checksums = section_of(node, "checksums")
        if checksums is not None and "stream" not in ctx.protocol_of(node):
            protocol = node.source["protocol"]
            message = "there is no `stream` whose messages these checksums could be of"
            yield Fault.at_key(protocol, "checksums", message, "describe the link as a `stream`, or remove them")


@rule("ICD171")
def roles_that_are_needed(ctx: Context) -> Iterator[Fault]:
    for link in links(ctx):
        seen: set[str] = set()
        for _, row in link.rows:
            role = row["role"]
            if role in seen and role not in FIXED:
                message = f"there are two fields of the role `{role}`"
                yield Fault.at(row, "role", message, "give one of them its own role, or make it a `constant`")
            seen.add(role)
            if role in FIXED and "value" not in row:
                yield Fault.at(row, "role", f"a `{role}` has no `value`", "add `value:`, what it always is")
            if role in ("id", "length", "checksum") and "value" in row:
                message = f"the {role} follows from the message, so it has no `value`"
                yield Fault.at_key(row, "value", message, "remove `value`, or make the field a `constant`")
            for key, owner in ONLY_WITH.items():
                if key in row and role != owner:
                    message = f"`{key}` applies to a field of the role `{owner}`, not of a `{role}`"
                    yield Fault.at_key(row, key, message, "remove it, or correct `role`")
        yield from _missing(ctx, link)


def _missing(ctx: Context, link: Link) -> Iterator[Fault]:
    lengths = link.of("length")
    if link.section.get("delimited_by") == "length":
        if not lengths:
            help = "add one, or choose another value of `delimited_by`"
            message = "no field has the role `length`, which delimits messages"
            yield Fault.at(link.section, "delimited_by", message, help)
        elif any(part == "trailer" for part, row in link.rows if row["role"] == "length"):
            message = "the length that delimits messages is behind their data"
            yield Fault.at(lengths[0], "role", message, "move it to `header`")
    for direction in DIRECTIONS:
        if len({id for id, _ in _ids(ctx, link.node, direction)}) > 1 and not link.of("id"):
            message = f"no field has the role `id`, and there are several messages in one direction ({direction})"
            yield Fault.at(
                link.section, "delimited_by", message, "add one: the link has no other way to distinguish them"
            )
            return


def _ids(ctx: Context, node: Node, direction: str) -> list[tuple[int, Message]]:
    """The messages of a direction by id."""
    found = [(getattr(one, f"{direction}_id"), one) for one in ctx.messages_of(node)]
    return [(id, one) for id, one in found if id is not None]


@rule("ICD172")
def fields_that_fit(ctx: Context) -> Iterator[Fault]:
    for link in links(ctx):
        yield from _places(link)
        yield from _values(link)
        yield from _contents(ctx, link)


def _places(link: Link) -> Iterator[Fault]:
    for _, row in link.rows:  # ICD092 sees to overlaps
        bits = range(row["at"], row["at"] + row["bits"])
        size = bits[-1] // 8 - bits[0] // 8 + 1
        if size > MOST_SPAN:
            message = f"the {row['role']} spans {count(size, 'byte')}, more than {MOST_SPAN}"
            yield Fault.at(row, "bits", message, "make it narrower, or begin it at a whole byte")
        order = row.get("byte_order", link.node.byte_order)
        if size > 1 and row["bits"] % 8 + row["at"] % 8 and (order == "big") != (link.node.bit_order == "msb0"):
            message = f"the {row['role']} crosses bytes in {order} order, though bits are {link.node.bit_order}"
            yield Fault.at(
                row, "at", message, "use whole bytes: only these can have a byte order that differs from the bit order"
            )


def _values(link: Link) -> Iterator[Fault]:
    for _, row in link.rows:
        value = row.get("value")
        for one in value.values() if isinstance(value, Map) else [value]:
            if isinstance(one, Seq | list) and len(one) * 8 != row["bits"]:
                message = f"{count(len(one), 'byte')} are given for {count(row['bits'], 'bit')}"
                yield Fault.at(row, "value", message, "correct `bits` or `value`")
            elif isinstance(one, int) and one >> row["bits"] > 0:
                message = f"{one} does not fit {count(row['bits'], 'bit')}"
                yield Fault.at(row, "value", message, "correct `bits` or `value`")


def _contents(ctx: Context, link: Link) -> Iterator[Fault]:
    messages = [pair for direction in DIRECTIONS for pair in _ids(ctx, link.node, direction)]
    for row in link.of("id"):
        id, one = max(messages, key=lambda pair: pair[0], default=(0, None))
        if one is not None and id >> row["bits"]:
            message = f"an id of {count(row['bits'], 'bit')} cannot represent 0x{id:X}, that of {quote(one.name)}"
            yield Fault.at(row, "bits", message, "make the field wider, or correct the id")
    around = sum(
        -(-max((row["at"] + row["bits"] for where, row in link.rows if where == part), default=0) // 8)
        for part in PARTS
    )
    empty = next((one for _, one in messages if one.layout.shortest == 0 and around == 0), None)
    if empty is not None:
        message = f"no byte is sent for {quote(empty.name)}, which can have no data"
        yield Fault.at(link.section, "delimited_by", message, "add a field to `header`, such as an id")
    for row in link.of("length"):
        plus = row.get("plus", 0) + (around if row.get("counts") == "message" else 0)
        for _, one in messages:
            least, most = one.layout.shortest + plus, one.length + plus
            if most >= 1 << row["bits"]:
                message = f"a length of {count(row['bits'], 'bit')} does not hold {most}, that of {quote(one.name)}"
                yield Fault.at(row, "bits", message, "make the field wider, or the message shorter")
                break
            if least < 0:
                message = f"the length of {quote(one.name)} would be {least}"
                yield Fault.at(row, "plus", message, "correct `plus`, or let the message have more bytes")
                break
    for row in link.of("sequence"):
        if row["bits"] > MOST_SEQUENCE_BITS:
            message = f"a sequence number has at most {MOST_SEQUENCE_BITS} bits"
            yield Fault.at(row, "bits", message, "make it narrower, and the rest a `constant`")


@rule("ICD173")
def checksums_of_links(ctx: Context) -> Iterator[Fault]:
    for link in links(ctx):
        checksums = section_of(link.node, "checksums") or unread()
        used: set[str] = set()
        for part, row in link.rows:
            if row["role"] != "checksum":
                continue
            name = row.get("checksum", "")
            used.add(name)
            known = checksums.get(name)
            if known is None:
                message = f"no checksum is called {quote(name)}" if name else "the field names no checksum"
                names = listing(f"`{key}`" for key in checksums) if checksums else "there are none"
                yield Fault.at(row, "role", message, f"name one of `checksums` in `checksum:`: {names}")
            elif _is_known(known):
                yield from _checksum(ctx, link, part, row, known)
        for name in checksums:
            if name not in used:
                message = f"no field of the frame has the checksum {quote(name)}"
                help = "add a field of the role `checksum`, or remove it"
                yield Fault(section_of(link.node), checksums.key_at(name), message, help)


def _is_known(known: object) -> bool:
    """Whether the schema has nothing to say of it."""
    if not isinstance(known, Map) or type(known.get("width")) is not int or not 0 < known["width"] <= 32:
        return False
    covers = known.get("covers")
    bounds = [covers.get(key) for key in ("from", "to")] if isinstance(covers, Map) else [None]
    return isinstance(known.get("kind"), str) and all(isinstance(one, str) for one in bounds)


def _checksum(ctx: Context, link: Link, part: str, row: Map, known: Map) -> Iterator[Fault]:
    width: int = known["width"]
    demanded = BITS_OF.get(known["kind"])
    if demanded and width != demanded:
        message = f"a checksum of kind `{known['kind']}` has {demanded} bits, not {width}"
        yield Fault.at(known, "width", message, f"write `width: {demanded}`, or correct `kind`", str(demanded))
        width = demanded  # the values below are checked against the right width
    elif width != row["bits"]:
        message = f"the checksum has {width} bits, its field {row['bits']}"
        yield Fault.at(
            row,
            "bits",
            message,
            f"correct `bits` of the field, or `width` ({line_of(known.at('width'), row.at('bits'))})",
        )
    for key in ("polynomial", "init", "xor_out", "empty", "check"):
        if isinstance(known.get(key), int) and known[key] >> width > 0:
            yield Fault.at(
                known, key, f"`{key}` does not fit {count(width, 'bit')}", *of_wide_value(key, known[key], width)
            )
    if known["kind"] != "crc":
        for key in ("polynomial", "reflect_in", "reflect_out", "empty"):
            if key in known:
                message = f"`{key}` applies to a CRC, not to a checksum of kind `{known['kind']}`"
                yield Fault.at_key(known, key, message, "remove it, or correct `kind`")
    yield from _covered(link, part, row, known)
    yield from _seeds(ctx, link, known)


def _covered(link: Link, part: str, row: Map, known: Map) -> Iterator[Fault]:
    """The fields that it covers: in one piece, from the header through the data, and without itself."""
    covers = known["covers"]
    bounds: dict[str, Map | None] = {}
    for key, where in (("from", "header"), ("to", "trailer")):
        role = covers[key]
        found = [one for one in link.rows if one[1]["role"] == role]
        if role != DATA and not found:
            message = f"no field has the role `{role}`"
            yield Fault.at(covers, key, message, "name the role of a field of the frame, or `data`")
            return
        if role != DATA and found[0][0] != where:
            message = f"a checksum covers the data, but `{key}: {role}` names a field of the {found[0][0]}"
            help = "`from` names a field of the header or `data`, `to` one of the trailer or `data`"
            yield Fault.at(covers, key, message, help)
            return
        bounds[key] = None if role == DATA else found[0 if key == "from" else -1][1]
    first, last = bounds["from"], bounds["to"]
    begin = first["at"] if first else None
    end = last["at"] + last["bits"] if last else 0
    if begin is not None and begin % 8:
        yield Fault.at(covers, "from", "it begins within a byte", "begin with a field at a whole byte")
    inside = part == "header" and begin is not None and row["at"] + row["bits"] > begin // 8 * 8
    if inside or (part == "trailer" and row["at"] // 8 < -(-end // 8)):
        message = "the checksum covers itself"
        help = "correct `covers`, so that it ends before the checksum or begins behind it"
        yield Fault.at(covers, "from" if inside else "to", message, help)


def _seeds(ctx: Context, link: Link, known: Map) -> Iterator[Fault]:
    seeds = known.get("seeds")
    if not isinstance(seeds, Map):
        return
    names, broken = {one.name: one for one in ctx.messages_of(link.node)}, ctx.broken_messages(link.node)
    for name in seeds:
        if name not in names and name not in broken:
            help = suggestion(name, names, "correct the name")
            yield Fault.at_key(seeds, name, f"there is no message {quote(name)}", *help)
    lacking = [name for name in names if name not in seeds]
    if lacking:
        message = f"{quote(lacking[0])} has no seed" + (f", nor have {len(lacking) - 1} others" if lacking[1:] else "")
        yield Fault.at_key(known, "seeds", message, "give every message a seed, or remove `seeds`")


@rule("ICD174")
def alike_under_an_id(ctx: Context) -> Iterator[Fault]:
    """Messages that share an id are told apart by their data, which the envelope is around."""
    for link in links(ctx):
        checksums = section_of(link.node, "checksums") or unread()
        seeds = [found for one in checksums.values() if isinstance(found := at_path(one, ["seeds"]), Map)]
        for direction in DIRECTIONS:
            first: dict[int, Message] = {}
            for id, one in _ids(ctx, link.node, direction):
                other = first.setdefault(id, one)
                if bool(one.may_end_early) != bool(other.may_end_early):
                    whose = one if one.may_end_early else other
                    message = (
                        f"zeros of {quote(whose.name)} may be omitted, but not the zeros of another message with its id"
                    )
                    yield Fault.at(whose.source, "may_end_early", message, "add `may_end_early` to both, or to neither")
                for known in seeds:
                    if one.name in known and other.name in known and known[one.name] != known[other.name]:
                        message = f"{quote(one.name)} has a seed different from that of {quote(other.name)}, which has the same id"
                        yield Fault.at(known, one.name, message, "give both the same seed, or other ids")


@rule("ICD176")
def replies_that_can_come(ctx: Context) -> Iterator[Fault]:
    for link in links(ctx):
        replies = link.section.get("replies")
        if not isinstance(replies, Map):
            continue
        broken = ctx.broken_messages(link.node)
        for sent, came in replies.items():
            for direction, name, fault in ((TELECOMMAND, sent, Fault.at_key), (TELEMETRY, came, Fault.at)):
                names = {one.name for _, one in _ids(ctx, link.node, direction)}
                if isinstance(name, str) and name not in names and name not in broken:
                    help = suggestion(name, names, "correct the name")
                    yield fault(replies, sent, f"there is no {direction} {quote(name)}", *help)
