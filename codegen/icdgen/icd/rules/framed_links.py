"""Rules of links with header, trailer and roles of fields (ICD170 to ICD172).

A framed link sends the data of a message between a header and a trailer. Each field of
these has a role, such as `id` or `length`. The rules take the `link` sections of the
YAML files. `framed_links.md` has their pages; `frame_checksums` continues with the
checksums.

Other rules list links with `framed_links` and `bus_links`, and messages with
`messages_with_ids`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from icdgen.frozen import NamedTuple
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq, unread
from icdgen.icd.model import TELECOMMAND, TELEMETRY, Message, Node, framed_link
from icdgen.icd.packets import Packet, Packets, declared_packets
from icdgen.icd.rules.context import Context, section_of
from icdgen.icd.rules.rule import rule
from icdgen.icd.trees import at_path, mappings
from icdgen.once import cached_by_owner
from icdgen.wording import count, listing, quote

DIRECTIONS = (TELECOMMAND, TELEMETRY)
# Roles of fields whose value the ICD gives.
CONSTANT_ROLES = ("sync", "constant")
# Roles of fields whose value is computed from the message.
COMPUTED_ROLES = ("id", "length", "response_length", "checksum")
# Roles of which a packet can have several fields. The fields of an id have its bits in
# turn, the most significant first.
REPEATED_ROLES = (*CONSTANT_ROLES, "id", "length")
WORD = 32  # largest width of a field in bits
MOST_SPAN = 4  # largest number of bytes that a field can be in
# The runtimes store the last sequence number in 32 bits, and need a value for "none yet".
MOST_SEQUENCE_BITS = 31
# Key that only fields of some roles can have -> these roles.
ROLES_OF_KEY = {
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


class LinkPacket(NamedTuple):
    """Packet format of a link.

    ``of_packet`` names it at the end of a phrase: " of the packet `Data`". It is empty
    if the link has one format only, which has no name.
    """

    declared: Packet
    of_packet: str
    fields_by_part: list[tuple[str, Map]]  # ("header" or "trailer", field), in order

    def fields_with_roles(self, *roles: str) -> list[Map]:
        """Return the fields that have one of these roles."""
        return [field for _, field in self.fields_by_part if field.get("role") in roles]

    @property
    def overhead(self) -> int:
        """Return the number of bytes of header and trailer."""
        ends = {"header": 0, "trailer": 0}  # in bits
        for part, field in self.fields_by_part:
            ends[part] = max(ends[part], field["at"] + field["bits"])
        # Each is padded to whole bytes.
        return sum((end + 7) // 8 for end in ends.values())


class DeclaredLink(NamedTuple):
    """Section `link` of a node, with its packet formats."""

    node: Node
    section: Map
    declared: Packets
    packets: list[LinkPacket]

    @property
    def fields_by_part(self) -> Iterator[tuple[str, Map]]:
        """Yield each field with its part ("header" or "trailer").

        A field that several packets share is yielded once.
        """
        seen: set[int] = set()
        for packet in self.packets:
            for part, field in packet.fields_by_part:
                if id(field) not in seen:
                    seen.add(id(field))
                    yield part, field

    @property
    def checksums(self) -> Map:
        """Return the declarations of the checksums, by name."""
        checksums = self.section.get("checksums")
        return checksums if isinstance(checksums, Map) else unread()

    @property
    def framing(self) -> object:
        """Return how a receiver finds the packets in a stream of bytes: `framing: by`."""
        return at_path(self.section, ("framing", "by"))

    def place(self, packet: LinkPacket) -> tuple[Map, str]:
        """Return the mapping and the key at which a fault of a whole packet is shown."""
        if packet.of_packet:
            return self.section["packets"][packet.declared.name], "from"
        return self.section, "framing"


def framed_links(ctx: Context) -> Iterator[DeclaredLink]:
    """Yield the links of the nodes that declare a valid `link` with `framing`
    themselves, not in an included file.
    """
    return (link for link in declared_links(ctx) if "framing" in link.section)


def bus_links(ctx: Context) -> Iterator[DeclaredLink]:
    """Yield the links of the nodes that declare a valid `link` themselves and for which
    no framing is in effect, not even that of an included file.
    """
    for link in declared_links(ctx):
        if not framed_link(ctx.protocol_of(link.node)):
            yield link


@cached_by_owner
def declared_links(ctx: Context) -> tuple[DeclaredLink, ...]:
    """Return the links of the nodes that declare a valid `link` themselves."""
    links = []
    for node in ctx.icd.nodes:
        section = section_of(node, "link")
        if section is None:
            continue
        telecommands = [each for _, each in messages_with_ids(ctx, node, TELECOMMAND)]
        declared = declared_packets(section, telecommands)
        packets = []
        for packet in declared.all:
            of_packet = f" of the packet {quote(packet.name)}" if packet.name else ""
            fields = [("header", field) for field in mappings(packet.header)]
            fields += [("trailer", field) for field in mappings(packet.trailer)]
            packets.append(LinkPacket(packet, of_packet, fields))
        if all(
            _has_usable_types(field)
            for packet in packets
            for _, field in packet.fields_by_part
        ):
            links.append(DeclaredLink(node, section, declared, packets))
    return tuple(links)


def _has_usable_types(field: Map) -> bool:
    """Return whether these rules can compute with the values of a field.

    Otherwise the schema check reports the field, and the rules leave out its link.
    """
    numbers: list[Any] = [field.get("at"), field.get("bits")]
    numbers += [field.get("unit", 1), field.get("plus", 0)]
    # Not `isinstance`, because `true` is an `int` in Python.
    if not all(type(number) is int for number in numbers):
        return False
    at, bits, unit, _ = numbers
    if at < 0 or not 0 < bits <= WORD or unit < 1:
        return False
    texts = [field.get("role")]
    texts += [field.get(key, "") for key in ("checksum", "name", "enum")]
    value = field.get("value", 0)
    values = [*value.values()] if isinstance(value, Map) else [value]
    return all(isinstance(text, str) for text in texts) and all(
        _is_number_or_bytes(each) for each in values
    )


def _is_number_or_bytes(value: object) -> bool:
    if isinstance(value, Seq | list):
        return all(type(byte) is int and 0 <= byte <= 0xFF for byte in value)
    return type(value) is int


def has_one_length(message: Message) -> bool:
    """Return whether a message is always sent with the same number of bytes."""
    return message.layout.shortest == message.length and not message.may_end_early


def messages_with_ids(
    ctx: Context, node: Node, direction: str
) -> list[tuple[int, Message]]:
    """Return (id, message) for each message of a node in a direction."""
    pairs = [
        (getattr(message, f"{direction}_id"), message)
        for message in ctx.messages_of(node)
    ]
    return [(id, message) for id, message in pairs if id is not None]


def messages_in_packet(
    ctx: Context, link: DeclaredLink, packet: Packet, direction: str
) -> list[tuple[int, Message]]:
    """Return (id, message) for each message that is sent in a packet in a direction."""
    return [
        (id, message)
        for id, message in messages_with_ids(ctx, link.node, direction)
        if packet in link.declared.packets_of_message(message.name, direction)
    ]


@rule("ICD170")
def links_are_described_once(ctx: Context) -> Iterator[Fault]:
    """Report keys that have no effect with `framing`, and keys that need it."""
    for link in framed_links(ctx):
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
        framed_keys: tuple[str, ...] = FRAMED_ONLY
        # An included file can have the framing. Its packets are declared there as well.
        if framed_link(ctx.protocol_of(node)):
            framed_keys += WITH_FRAMING_OR_BUSES
        key = next((key for key in section if key in framed_keys), None)
        if key is not None and "framing" not in section:
            message = f"`{key}` belongs to a framed link, and `framing` is missing"
            help = "add `framing: {by: ...}`, how bytes become packets"
            yield Fault.at_key(section, key, message, help)


@rule("ICD171")
def roles_are_complete(ctx: Context) -> Iterator[Fault]:
    """Report roles that occur twice, that are missing, or whose fields have the wrong
    keys.
    """
    for link in framed_links(ctx):
        yield from _check_repeated_roles(link)
        for _, field in link.fields_by_part:
            yield from _check_keys_of_role(field)
        for packet in link.packets:
            yield from _check_missing_roles(ctx, link, packet)


def _check_repeated_roles(link: DeclaredLink) -> Iterator[Fault]:
    reported: set[int] = set()  # fields: packets can share them
    for packet in link.packets:
        seen: set[str] = set()
        for _, field in packet.fields_by_part:
            role = field["role"]
            is_twice = role in seen and role not in REPEATED_ROLES
            if is_twice and id(field) not in reported:
                reported.add(id(field))
                message = f"there are two fields of the role `{role}`{packet.of_packet}"
                help = "give one of them its own role, or make it a `constant`"
                yield Fault.at(field, "role", message, help)
            seen.add(role)


def _check_keys_of_role(field: Map) -> Iterator[Fault]:
    role = field["role"]
    if role in CONSTANT_ROLES and "value" not in field:
        message = f"a `{role}` has no `value`"
        yield Fault.at(field, "role", message, "add `value:`, what it always is")
    if role in COMPUTED_ROLES and "value" in field:
        message = f"the {role} follows from the message, so it has no `value`"
        help = "remove `value`, or make the field a `constant`"
        yield Fault.at_key(field, "value", message, help)
    for key, roles in ROLES_OF_KEY.items():
        if key in field and role not in roles:
            owner = " or ".join(f"`{each}`" for each in roles)
            message = (
                f"`{key}` applies to a field of the role {owner}, not of a `{role}`"
            )
            yield Fault.at_key(field, key, message, "remove it, or correct `role`")


def _check_missing_roles(
    ctx: Context, link: DeclaredLink, packet: LinkPacket
) -> Iterator[Fault]:
    """Report that a packet lacks an id or a length that its receiver needs."""
    place, of_packet = link.place(packet), packet.of_packet
    # With another framing than `length`, special bytes delimit the packets.
    is_delimited = link.framing != "length"
    is_answering = packet.declared.name == link.declared.answering
    length_parts = [
        part for part, field in packet.fields_by_part if field["role"] == "length"
    ]
    lengths = packet.fields_with_roles("length")
    if lengths and "header" not in length_parts and not is_delimited:
        message = "the length that delimits messages is after their data"
        for field in lengths:
            yield Fault.at(field, "role", message, "move it to `header`")
    carried: list[Message] = []
    needs_id = ""  # first direction with several messages
    for direction in packet.declared.directions:
        pairs = messages_in_packet(ctx, link, packet.declared, direction)
        carried += [message for _, message in pairs]
        if len({id for id, _ in pairs}) > 1:
            needs_id = needs_id or direction
    # The request shows which message is in an answering packet.
    if needs_id and not packet.fields_with_roles("id") and not is_answering:
        message = f"no field{of_packet} has the role `id`, and there are several messages in one direction ({needs_id})"
        help = "add one: the link has no other way to distinguish them"
        yield Fault.at(*place, message, help)
    if lengths or is_delimited:
        return
    varying = next((each for each in carried if not has_one_length(each)), None)
    sizes = sorted({message.length for message in carried})
    if varying is not None:
        message = f"no field{of_packet} has the role `length`, and {quote(varying.name)} has no fixed length"
    elif is_answering and len(sizes) > 1:
        # Without an id, the receiver of the bytes cannot look up the length.
        texts = listing(f"{size}" for size in sizes)
        message = f"no field{of_packet} has the role `length`, and the telemetry in it has {texts} bytes"
    else:
        return
    yield Fault.at(*place, message, "add one, or choose another `framing`")


@rule("ICD172")
def frame_fields_fit(ctx: Context) -> Iterator[Fault]:
    """Report fields that cannot represent their values, or that no client can read."""
    for link in framed_links(ctx):
        for _, field in link.fields_by_part:
            yield from _check_position(link, field)
        for _, field in link.fields_by_part:
            yield from _check_given_values(field)
        for packet in link.packets:
            yield from _check_computed_values(ctx, link, packet)
        for _, field in link.fields_by_part:
            if field["role"] == "sequence" and field["bits"] > MOST_SEQUENCE_BITS:
                text = f"a sequence number has at most {MOST_SEQUENCE_BITS} bits"
                help = "make it narrower, and the rest a `constant`"
                yield Fault.at(field, "bits", text, help)


def _check_position(link: DeclaredLink, field: Map) -> Iterator[Fault]:
    """Report a field that is in too many bytes, or not contiguous.

    ICD092 reports overlaps.
    """
    at, bits, role = field["at"], field["bits"], field["role"]
    size = (at + bits - 1) // 8 - at // 8 + 1
    if size > MOST_SPAN:
        message = f"the {role} spans {count(size, 'byte')}, more than {MOST_SPAN}"
        help = "make it narrower, or begin it at a whole byte"
        yield Fault.at(field, "bits", message, help)
    # A field across bytes is contiguous only if the byte order continues the bit
    # order: big with msb0, little with lsb0.
    order = field.get("byte_order", link.node.byte_order)
    is_whole_bytes = bits % 8 == 0 and at % 8 == 0
    is_contiguous = (order == "big") == (link.node.bit_order == "msb0")
    if size > 1 and not is_whole_bytes and not is_contiguous:
        message = f"the {role} crosses bytes in {order} order, though bits are {link.node.bit_order}"
        help = "use whole bytes: only these can have a byte order that differs from the bit order"
        yield Fault.at(field, "at", message, help)


def _check_given_values(field: Map) -> Iterator[Fault]:
    """Report a `value` that does not fit its field."""
    value, bits = field.get("value"), field["bits"]
    # A mapping has a value for each direction.
    for each in value.values() if isinstance(value, Map) else [value]:
        if isinstance(each, Seq | list) and len(each) * 8 != bits:
            are = "is" if len(each) == 1 else "are"
            text = f"{count(len(each), 'byte')} {are} given for {count(bits, 'bit')}"
        elif isinstance(each, int) and each >> bits > 0:
            text = f"{each} does not fit {count(bits, 'bit')}"
        else:
            continue
        yield Fault.at(field, "value", text, "correct `bits` or `value`")


def _check_computed_values(
    ctx: Context, link: DeclaredLink, packet: LinkPacket
) -> Iterator[Fault]:
    """Report ids and lengths that do not fit their fields, and messages that would send
    no byte.
    """
    pairs: list[tuple[int, Message]] = []
    for direction in packet.declared.directions:
        pairs += messages_in_packet(ctx, link, packet.declared, direction)
    id_fields = packet.fields_with_roles("id")
    bits = sum(field["bits"] for field in id_fields)
    id, message = max(pairs, key=lambda pair: pair[0], default=(0, None))
    if message is not None and id_fields and id >> bits:
        text = f"an id of {count(bits, 'bit')} cannot represent 0x{id:X}, that of {quote(message.name)}"
        help = "make the field wider, or correct the id"
        yield Fault.at(id_fields[0], "bits", text, help)
    messages = [message for _, message in pairs]
    empty = next((each for each in messages if each.layout.shortest == 0), None)
    if empty is not None and packet.overhead == 0:
        text = f"no byte is sent for {quote(empty.name)}, which can have no data"
        help = "add a field to `header`, such as an id"
        yield Fault.at(*link.place(packet), text, help)
    for field in packet.fields_with_roles("length"):
        yield from _check_length_field(field, messages, packet.overhead)


def _check_length_field(
    field: Map, messages: list[Message], overhead: int
) -> Iterator[Fault]:
    """Report the first message whose length does not fit a length field.

    The field has the bytes of the data, or of the whole packet (`counts: message`),
    divided by `unit`, and increased by `plus`.
    """
    around = overhead if field.get("counts") == "message" else 0
    unit, plus = field.get("unit", 1), field.get("plus", 0)
    for message in messages:
        shortest = (message.layout.shortest + around) // unit + plus
        longest = (message.length + around) // unit + plus
        if longest >= 1 << field["bits"]:
            text = f"a length of {count(field['bits'], 'bit')} does not hold {longest}, that of {quote(message.name)}"
            help = "make the field wider, or the message shorter"
            yield Fault.at(field, "bits", text, help)
            return
        if shortest < 0:
            text = f"the length of {quote(message.name)} would be {shortest}"
            help = "correct `plus`, or let the message have more bytes"
            yield Fault.at(field, "plus", text, help)
            return
