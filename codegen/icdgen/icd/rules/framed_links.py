"""Protocol section `link`: links whose frames have header and trailer fields with
roles.

`links` and `links_on_buses` list the links of an ICD for the themes `packets`,
`responses`, `escapes` and `buses`, too.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from icdgen.frozen import NamedTuple
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq, unread
from icdgen.icd.model import TELECOMMAND, TELEMETRY, Message, Node, framed_link
from icdgen.icd.packets import Packet, Packets, declared_packets
from icdgen.icd.procedures import nested_steps
from icdgen.icd.rules.context import Context, section_of
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import line_of, of_wide_value
from icdgen.icd.suggestions import suggestion
from icdgen.icd.trees import at_path, mappings
from icdgen.once import cached_by_owner
from icdgen.wording import count, listing, quote

DIRECTIONS = (TELECOMMAND, TELEMETRY)
PARTS = ("header", "trailer")
FIXED = ("sync", "constant")
DERIVED = ("id", "length", "response_length", "checksum")
WORD = 32  # largest width of a field in bits
MOST_SEQUENCE_BITS = 31
MOST_SPAN = 4  # largest number of bytes that a field can be in
DATA = "data"
# Keys that only fields of some roles can have.
ONLY_WITH = {
    "counts": ("length",),
    "plus": ("length",),
    "unit": ("length", "response_length"),
    "per": ("sequence",),
    "checksum": ("checksum",),
    "covers": ("checksum",),
    "enum": ("status", "reason"),
    "optional": ("checksum",),
}
# Keys of a protocol section with a framed link.
ALLOWED_WITH_LINK = ("link", "boot", "procedures")
# Keys of `link` that only framed links have.
FRAMED_ONLY = ("line", "header", "trailer")
# Keys of `link` that belong to its framing, or to its buses.
WITH_FRAMING_OR_BUSES = ("packets", "commands", "requests")
# Keys of `link` that framed links do not have.
WITHOUT_FRAMING_ONLY = ("ids", "buses")
BITS_OF = {"fletcher": 16, "fletcher_255": 16, "xor": 8}


class LinkPacket(NamedTuple):
    """Packet format of a link. ``title`` names it in a sentence; it is empty for the
    only one of a link.
    """

    packet: Packet
    title: str
    rows: list[tuple[str, Map]]  # header or trailer, and a field, in order

    def fields_of_roles(self, *roles: str) -> list[Map]:
        """Return the fields of these roles."""
        return [row for _, row in self.rows if row.get("role") in roles]

    @property
    def overhead(self) -> int:
        """Return the bytes of header and trailer."""
        overhead = 0
        for part in PARTS:
            ends = (row["at"] + row["bits"] for of, row in self.rows if of == part)
            # Round up to whole bytes.
            overhead += -(-max(ends, default=0) // 8)
        return overhead


class DeclaredLink(NamedTuple):
    """Framing of the link of a node."""

    node: Node
    section: Map
    declared: Packets
    packets: list[LinkPacket]

    @property
    def rows(self) -> Iterator[tuple[str, Map]]:
        """Yield header or trailer, and each field, once: packets can share fields."""
        seen: set[int] = set()
        for packet in self.packets:
            for part, row in packet.rows:
                if id(row) not in seen:
                    seen.add(id(row))
                    yield part, row

    @property
    def checksums(self) -> Map:
        """Return the declarations of the checksums, by name."""
        checksums = self.section.get("checksums")
        return checksums if isinstance(checksums, Map) else unread()

    @property
    def framing(self) -> object:
        """Return how bytes become packets."""
        return at_path(self.section, ("framing", "by"))

    def place(self, packet: LinkPacket) -> tuple[Map, str]:
        """Return mapping and key that describe a packet as a whole."""
        if packet.title:
            return self.section["packets"][packet.packet.name], "from"
        return self.section, "framing"


def links(ctx: Context) -> Iterator[DeclaredLink]:
    """Yield the framed links of the nodes that declare a valid one themselves."""
    return (link for link in all_links(ctx) if "framing" in link.section)


def links_on_buses(ctx: Context) -> Iterator[DeclaredLink]:
    """Yield the other links of the nodes that declare a valid `link` themselves."""
    for link in all_links(ctx):
        if not framed_link(ctx.protocol_of(link.node)):
            yield link


@cached_by_owner
def all_links(ctx: Context) -> tuple[DeclaredLink, ...]:
    """Return the links of the nodes that declare a valid `link` themselves."""
    return tuple(_links(ctx))


def _links(ctx: Context) -> Iterator[DeclaredLink]:
    for node in ctx.icd.nodes:
        section = section_of(node, "link")
        if section is None:
            continue
        telecommands = [message for _, message in ids_of(ctx, node, TELECOMMAND)]
        declared = declared_packets(section, telecommands)
        packets = []
        for packet in declared.all:
            title = f" of the packet {quote(packet.name)}" if packet.name else ""
            rows = [("header", row) for row in mappings(packet.header)]
            rows += [("trailer", row) for row in mappings(packet.trailer)]
            packets.append(LinkPacket(packet, title, rows))
        # Otherwise the schema check reports the fields.
        if all(_is_sound(row) for packet in packets for _, row in packet.rows):
            yield DeclaredLink(node, section, declared, packets)


def _is_sound(row: Map) -> bool:
    """Return whether the values of a field that these rules use conform to the schema."""
    numbers: list[Any] = [row.get("at"), row.get("bits")]
    numbers += [row.get("unit", 1), row.get("plus", 0)]
    if (
        not all(type(number) is int for number in numbers)
        or numbers[0] < 0
        or not 0 < numbers[1] <= WORD
        or numbers[2] < 1
    ):
        return False
    texts = [
        row.get("role"),
        *(row.get(key, "") for key in ("checksum", "name", "enum")),
    ]
    value = row.get("value", 0)
    values = [*value.values()] if isinstance(value, Map) else [value]
    return all(isinstance(text, str) for text in texts) and all(map(_is_value, values))


def _is_value(value: object) -> bool:
    """Return whether a value is a number, or bytes."""
    if isinstance(value, Seq | list):
        return all(type(byte) is int and 0 <= byte <= 0xFF for byte in value)
    return type(value) is int


@rule("ICD170")
def links_are_described_once(ctx: Context) -> Iterator[Fault]:
    for link in links(ctx):
        protocol = link.node.source["protocol"]
        for key in protocol:
            if key not in ALLOWED_WITH_LINK:
                message = f"`{key}` has no effect beside `link: framing`"
                help = f"remove `{key}` or `framing`"
                yield Fault.at_key(protocol, key, message, help)
        for key in WITHOUT_FRAMING_ONLY:
            if key in link.section:
                message = f"`{key}` has no effect beside `framing`"
                help = f"remove `{key}` or `framing`"
                if key == "buses":
                    help = "remove one: a node has one framed link, or buses"
                yield Fault.at_key(link.section, key, message, help)
        client = link.section.get("client")
        for key in ("poll_interval_ms", "poll_timeout_ms"):
            if isinstance(client, Map) and key in client:
                message = f"`{key}` has no effect, because framed links do not poll"
                yield Fault.at_key(client, key, message, "remove it")
    for node in ctx.icd.nodes:
        section = section_of(node, "link") or unread()
        keys: tuple[str, ...] = FRAMED_ONLY
        if framed_link(ctx.protocol_of(node)):  # of an included file
            keys += WITH_FRAMING_OR_BUSES
        key = next((key for key in section if key in keys), None)
        if key is not None and "framing" not in section:
            message = f"`{key}` belongs to a framed link, and `framing` is missing"
            help = "add `framing: {by: ...}`, how bytes become packets"
            yield Fault.at_key(section, key, message, help)


@rule("ICD171")
def roles_are_complete(ctx: Context) -> Iterator[Fault]:
    for link in links(ctx):
        reported: set[int] = set()
        for packet in link.packets:
            seen: set[str] = set()
            for _, row in packet.rows:
                role = row["role"]
                is_twice = role in seen and role not in (*FIXED, "id", "length")
                if is_twice and id(row) not in reported:
                    reported.add(id(row))
                    message = f"there are two fields of the role `{role}`{packet.title}"
                    help = "give one of them its own role, or make it a `constant`"
                    yield Fault.at(row, "role", message, help)
                seen.add(role)
        for _, row in link.rows:
            role = row["role"]
            if role in FIXED and "value" not in row:
                yield Fault.at(
                    row,
                    "role",
                    f"a `{role}` has no `value`",
                    "add `value:`, what it always is",
                )
            if role in DERIVED and "value" in row:
                message = f"the {role} follows from the message, so it has no `value`"
                yield Fault.at_key(
                    row,
                    "value",
                    message,
                    "remove `value`, or make the field a `constant`",
                )
            for key, owners in ONLY_WITH.items():
                if key in row and role not in owners:
                    owner = " or ".join(f"`{each}`" for each in owners)
                    message = f"`{key}` applies to a field of the role {owner}, not of a `{role}`"
                    yield Fault.at_key(
                        row, key, message, "remove it, or correct `role`"
                    )
        yield from _missing(ctx, link)


def _missing(ctx: Context, link: DeclaredLink) -> Iterator[Fault]:
    """Yield the faults of roles that a packet needs and no field has."""
    is_delimited = link.framing != "length"
    for packet in link.packets:
        place = link.place(packet)
        lengths = packet.fields_of_roles("length")
        is_answering = packet.packet.name == link.declared.answering
        parts = {part for part, row in packet.rows if row["role"] == "length"}
        for _, row in packet.rows:
            if row["role"] == "length" and parts == {"trailer"} and not is_delimited:
                message = "the length that delimits messages is after their data"
                yield Fault.at(row, "role", message, "move it to `header`")
        carried = {
            direction: carried_in(ctx, link, packet.packet, direction)
            for direction in packet.packet.directions
        }
        for direction, messages in carried.items():
            is_many = len({id for id, _ in messages}) > 1
            if is_many and not packet.fields_of_roles("id") and not is_answering:
                message = f"no field{packet.title} has the role `id`, and there are several messages in one direction ({direction})"
                help = "add one: the link has no other way to distinguish them"
                yield Fault.at(*place, message, help)
                break
        if lengths or is_delimited:
            continue
        everything = [each for rows in carried.values() for _, each in rows]
        varying = next((each for each in everything if not has_one_length(each)), None)
        if is_answering and varying is None:
            # No id says which of them it is.
            lengths_of = {each.length for each in everything}
            if len(lengths_of) > 1:
                sizes = listing(f"{size}" for size in sorted(lengths_of))
                message = f"no field{packet.title} has the role `length`, and the telemetry in it has {sizes} bytes"
                help = "add one, or choose another `framing`"
                yield Fault.at(*place, message, help)
        if varying is not None:
            message = f"no field{packet.title} has the role `length`, and {quote(varying.name)} has no fixed length"
            help = "add one, or choose another `framing`"
            yield Fault.at(*place, message, help)


def has_one_length(message: Message) -> bool:
    """Return whether a message is always sent with the same number of bytes."""
    return message.layout.shortest == message.length and not message.may_end_early


def ids_of(ctx: Context, node: Node, direction: str) -> list[tuple[int, Message]]:
    """Return the messages of a node in a direction, with their ids."""
    messages = [
        (getattr(message, f"{direction}_id"), message)
        for message in ctx.messages_of(node)
    ]
    return [(id, message) for id, message in messages if id is not None]


def carried_in(
    ctx: Context, link: DeclaredLink, packet: Packet, direction: str
) -> list[tuple[int, Message]]:
    """Return the messages that are sent in a packet, with their ids."""
    return [
        (id, message)
        for id, message in ids_of(ctx, link.node, direction)
        if packet in link.declared.packets_of_message(message.name, direction)
    ]


@rule("ICD172")
def frame_fields_fit(ctx: Context) -> Iterator[Fault]:
    for link in links(ctx):
        yield from _places(link)
        yield from _values(link)
        yield from _contents(ctx, link)


def _places(link: DeclaredLink) -> Iterator[Fault]:
    """Yield the faults of fields that are in too many bytes, or not contiguous.

    ICD092 reports overlaps.
    """
    for _, row in link.rows:
        bits = range(row["at"], row["at"] + row["bits"])
        size = bits[-1] // 8 - bits[0] // 8 + 1
        if size > MOST_SPAN:
            message = (
                f"the {row['role']} spans {count(size, 'byte')}, more than {MOST_SPAN}"
            )
            yield Fault.at(
                row, "bits", message, "make it narrower, or begin it at a whole byte"
            )
        # A field across bytes is contiguous only if the byte order continues the bit
        # order: big with msb0, little with lsb0.
        order = row.get("byte_order", link.node.byte_order)
        if (
            size > 1
            and row["bits"] % 8 + row["at"] % 8
            and (order == "big") != (link.node.bit_order == "msb0")
        ):
            message = f"the {row['role']} crosses bytes in {order} order, though bits are {link.node.bit_order}"
            yield Fault.at(
                row,
                "at",
                message,
                "use whole bytes: only these can have a byte order that differs from the bit order",
            )


def _values(link: DeclaredLink) -> Iterator[Fault]:
    """Yield the faults of constant values that do not have the width of their field."""
    for _, row in link.rows:
        values = row.get("value")
        for value in values.values() if isinstance(values, Map) else [values]:
            if isinstance(value, Seq | list) and len(value) * 8 != row["bits"]:
                text = f"{count(len(value), 'byte')} are given for {count(row['bits'], 'bit')}"
                yield Fault.at(row, "value", text, "correct `bits` or `value`")
            elif isinstance(value, int) and value >> row["bits"] > 0:
                text = f"{value} does not fit {count(row['bits'], 'bit')}"
                yield Fault.at(row, "value", text, "correct `bits` or `value`")


def _contents(ctx: Context, link: DeclaredLink) -> Iterator[Fault]:
    """Yield the faults of fields that are too narrow for the ids and lengths of the
    messages.
    """
    for packet in link.packets:
        messages: list[tuple[int, Message]] = []
        for direction in packet.packet.directions:
            messages += carried_in(ctx, link, packet.packet, direction)
        parts = packet.fields_of_roles("id")
        bits = sum(row["bits"] for row in parts)
        id, message = max(messages, key=lambda pair: pair[0], default=(0, None))
        if message is not None and parts and id >> bits:
            text = f"an id of {count(bits, 'bit')} cannot represent 0x{id:X}, that of {quote(message.name)}"
            help = "make the field wider, or correct the id"
            yield Fault.at(parts[0], "bits", text, help)
        overhead = packet.overhead
        empty = next((each for _, each in messages if each.layout.shortest == 0), None)
        if empty is not None and overhead == 0:
            text = f"no byte is sent for {quote(empty.name)}, which can have no data"
            help = "add a field to `header`, such as an id"
            yield Fault.at(*link.place(packet), text, help)
        for row in packet.fields_of_roles("length"):
            yield from _lengths(row, messages, overhead)
    for _, row in link.rows:
        if row["role"] == "sequence" and row["bits"] > MOST_SEQUENCE_BITS:
            text = f"a sequence number has at most {MOST_SEQUENCE_BITS} bits"
            yield Fault.at(
                row, "bits", text, "make it narrower, and the rest a `constant`"
            )


def _lengths(
    row: Map, messages: list[tuple[int, Message]], overhead: int
) -> Iterator[Fault]:
    """Yield the faults of a length field that cannot represent the length of a message."""
    around = overhead if row.get("counts") == "message" else 0
    unit, plus = row.get("unit", 1), row.get("plus", 0)
    for _, message in messages:
        shortest, longest = (
            (size + around) // unit + plus
            for size in (message.layout.shortest, message.length)
        )
        if longest >= 1 << row["bits"]:
            text = f"a length of {count(row['bits'], 'bit')} does not hold {longest}, that of {quote(message.name)}"
            help = "make the field wider, or the message shorter"
            yield Fault.at(row, "bits", text, help)
            break
        if shortest < 0:
            text = f"the length of {quote(message.name)} would be {shortest}"
            help = "correct `plus`, or let the message have more bytes"
            yield Fault.at(row, "plus", text, help)
            break


@rule("ICD173")
def checksums_can_be_computed(ctx: Context) -> Iterator[Fault]:
    for link in all_links(ctx):
        checksums = link.checksums
        # Without places: it is a copy if several nodes have checksums.
        names = ctx.fact(link.node, "link", "checksums")
        names = names if isinstance(names, Mapping) else {}
        for packet, part, row in _checksum_fields(link):
            name = row.get("checksum", "")
            declared = checksums.get(name)
            if name not in names:
                message = (
                    f"no checksum is called {quote(name)}"
                    if name
                    else "the field names no checksum"
                )
                existing = "there are none"
                if names:
                    existing = listing(f"`{key}`" for key in names)
                yield Fault.at(
                    row,
                    "role",
                    message,
                    f"name one of `checksums` in `checksum:`: {existing}",
                )
            elif isinstance(declared, Map) and _is_valid(declared):
                yield from _field_of(row, declared)
                if "framing" in link.section:
                    yield from _covered(packet, part, row, row.get("covers"))
        for name, declared in checksums.items():
            if _is_valid(declared):
                yield from _checksum(ctx, link, declared)
            if ctx.complete and name not in _used_checksums(ctx, link.node):
                message = f"no field of a packet has the checksum {quote(name)}"
                help = f"add a field `role: checksum, checksum: {name}`, or remove {quote(name)} here"
                yield Fault.at_key(checksums, name, message, help)


def _used_checksums(ctx: Context, node: Node) -> set[str]:
    """Return the names of the checksums in packets and procedures of a node, and of the
    nodes that include it.
    """
    used: set[str] = set()
    for user in ctx.users(node):
        protocol = ctx.protocol_of(user)
        used.update(_checksums_in_steps(protocol.get("procedures")))
        link = protocol.get("link")
        for packet in declared_packets(link).all if isinstance(link, Mapping) else ():
            used.update(
                str(row.get("checksum")) for row in packet.fields_of_role("checksum")
            )
    return used


def _checksums_in_steps(procedures: object) -> Iterator[str]:
    """Yield the names of the checksums that steps of procedures compare."""
    for procedure in procedures.values() if isinstance(procedures, Mapping) else ():
        for step in nested_steps(at_path(procedure, ["steps"])):
            if isinstance(name := at_path(step, ("verify", "checksum")), str):
                yield name


def _checksum_fields(link: DeclaredLink) -> Iterator[tuple[LinkPacket, str, Map]]:
    """Yield each checksum field, the part in which it is, and the first packet with
    it.
    """
    seen: set[int] = set()
    for packet in link.packets:
        for part, row in packet.rows:
            if row["role"] == "checksum" and id(row) not in seen:
                seen.add(id(row))
                yield packet, part, row


def _is_valid(checksum: object) -> bool:
    """Return whether the values of a checksum that these rules use conform to the
    schema.
    """
    if (
        not isinstance(checksum, Map)
        or type(checksum.get("width")) is not int
        or not 0 < checksum["width"] <= 32
    ):
        return False
    return isinstance(checksum.get("kind"), str)


def _field_of(row: Map, checksum: Map) -> Iterator[Fault]:
    """Yield the fault of a checksum that is sent in a field of another width."""
    width: int = checksum["width"]
    required = BITS_OF.get(checksum["kind"])
    if (not required or width == required) and width != row["bits"]:
        yield Fault.at(
            row,
            "bits",
            f"the checksum has {width} bits, its field {row['bits']}",
            f"correct `bits` of the field, or `width` ({line_of(checksum.at('width'), row.at('bits'))})",
        )


def _checksum(ctx: Context, link: DeclaredLink, checksum: Map) -> Iterator[Fault]:
    """Yield the faults of the parameters of a checksum."""
    width: int = checksum["width"]
    required = BITS_OF.get(checksum["kind"])
    if required and width != required:
        message = (
            f"a checksum of kind `{checksum['kind']}` has {required} bits, not {width}"
        )
        yield Fault.at(
            checksum,
            "width",
            message,
            f"write `width: {required}`, or correct `kind`",
            str(required),
        )
        width = required  # the values below are checked against the right width
    for key in ("polynomial", "init", "xor_out", "empty", "check"):
        if isinstance(checksum.get(key), int) and checksum[key] >> width > 0:
            yield Fault.at(
                checksum,
                key,
                f"`{key}` does not fit {count(width, 'bit')}",
                *of_wide_value(key, checksum[key], width),
            )
    if checksum["kind"] != "crc":
        for key in ("polynomial", "reflect_in", "reflect_out", "empty"):
            if key in checksum:
                message = f"`{key}` applies to a CRC, not to a checksum of kind `{checksum['kind']}`"
                yield Fault.at_key(
                    checksum, key, message, "remove it, or correct `kind`"
                )
    yield from _seeds(ctx, link, checksum)


def _covered(
    packet: LinkPacket, part: str, row: Map, covers: object
) -> Iterator[Fault]:
    """Yield the faults of `covers`, which must include the data but not the checksum
    itself.
    """
    if not isinstance(covers, Map):
        message = "nothing says what the checksum covers"
        help = "add `covers: {from: ..., to: ...}`"
        yield Fault.at(row, "checksum", message, help)
        return
    if not all(isinstance(covers.get(key), str) for key in ("from", "to")):
        return  # the schema check reports it
    bounds: dict[str, Map | None] = {}
    for key, where in (("from", "header"), ("to", "trailer")):
        role = covers[key]
        matches = [
            (part_of_row, field)
            for part_of_row, field in packet.rows
            if role in (field.get("name"), field["role"])
        ]
        if role != DATA and not matches:
            message = f"no field{packet.title} has the role or name `{role}`"
            help = "name the role of a field of the frame, or `data`"
            yield Fault.at(covers, key, message, help)
            return
        if role != DATA and matches[0][0] != where:
            message = f"a checksum covers the data, but `{key}: {role}` names a field of the {matches[0][0]}"
            help = "`from` names a field of the header or `data`, `to` one of the trailer or `data`"
            yield Fault.at(covers, key, message, help)
            return
        if role == DATA:
            bounds[key] = None
        else:
            # Of several fields of a role, all are covered.
            _, bounds[key] = matches[0] if key == "from" else matches[-1]
    first, last = bounds["from"], bounds["to"]
    begin = first["at"] if first else None
    end = last["at"] + last["bits"] if last else 0
    if begin is not None and begin % 8:
        yield Fault.at(
            covers,
            "from",
            "it begins within a byte",
            "begin with a field at a whole byte",
        )
    # A checksum in the header must come before the first covered byte, one in the
    # trailer after the last.
    inside = (
        part == "header"
        and begin is not None
        and row["at"] + row["bits"] > begin // 8 * 8
    )
    if inside or (part == "trailer" and row["at"] // 8 < -(-end // 8)):
        message = "the checksum covers itself"
        help = (
            "correct `covers`, so that it ends before the checksum or begins after it"
        )
        yield Fault.at(covers, "from" if inside else "to", message, help)


def _seeds(ctx: Context, link: DeclaredLink, checksum: Map) -> Iterator[Fault]:
    """Yield the faults of `seeds`, the start value of a checksum for each message."""
    seeds = checksum.get("seeds")
    if not isinstance(seeds, Map):
        return
    names = [message.name for message in ctx.messages_of(link.node)]
    broken = ctx.broken_messages(link.node)
    for name in seeds:
        if name not in names and name not in broken:
            help = suggestion(name, names, "correct the name")
            yield Fault.at_key(seeds, name, f"there is no message {quote(name)}", *help)
    without_seed = [name for name in names if name not in seeds]
    if without_seed:
        message = f"{quote(without_seed[0])} has no seed" + (
            f", nor have {len(without_seed) - 1} others" if without_seed[1:] else ""
        )
        yield Fault.at_key(
            checksum, "seeds", message, "give every message a seed, or remove `seeds`"
        )


@rule("ICD174")
def messages_of_one_id_have_one_seed(ctx: Context) -> Iterator[Fault]:
    """Report messages that share an id and differ in seed or `may_end_early`.

    A receiver can distinguish them only by their data, after it has checked and removed
    the framing.
    """
    for link in links(ctx):
        all_seeds = [at_path(each, ["seeds"]) for each in link.checksums.values()]
        for direction in DIRECTIONS:
            first_of_id: dict[int, Message] = {}
            for id, message in ids_of(ctx, link.node, direction):
                first = first_of_id.setdefault(id, message)
                if bool(message.may_end_early) != bool(first.may_end_early):
                    early = message if message.may_end_early else first
                    text = f"zeros of {quote(early.name)} may be omitted, but not the zeros of another message with its id"
                    yield Fault.at(
                        early.source,
                        "may_end_early",
                        text,
                        "add `may_end_early` to both, or to neither",
                    )
                for seeds in all_seeds:
                    if (
                        not isinstance(seeds, Map)
                        or not {message.name, first.name} <= seeds.keys()
                    ):
                        continue
                    if seeds[message.name] != seeds[first.name]:
                        names = f"{quote(message.name)} has a seed different from that of {quote(first.name)}"
                        text = f"{names}, which has the same id"
                        yield Fault.at(
                            seeds,
                            message.name,
                            text,
                            "give both the same seed, or other ids",
                        )
