"""Links on buses: ``packets``, ``commands`` and ``requests`` of a `link` without
``framing``.

The rules are ICD095, ICD104, ICD105, ICD117 and ICD175. `responses_on_buses` lists the
responses that nodes declare, once for each bus (UART, I2C, CAN) on which they apply.
`KINDS_ON` has the kinds of responses that a bus supports, `NEEDED_ON` the keys that
they need. `responses` checks the fields that a client compares, as for framed links.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from icdgen.diagnostics import Related
from icdgen.frozen import NamedTuple
from icdgen.icd import checksum
from icdgen.icd.buses import BUSES, CAN, I2C, UART, bus_link, buses_with
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq, unread
from icdgen.icd.model import TELECOMMAND, TELEMETRY, Node, buses_of
from icdgen.icd.packets import DEVICE, HOST, ID_ROLE, Packet, Packets, value_of
from icdgen.icd.responses import ACK, BUSY, NAK, number_of
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.frame_checksums import DATA
from icdgen.icd.rules.framed_links import (
    DeclaredLink,
    bus_links,
    framed_links,
    messages_with_ids,
)
from icdgen.icd.rules.responses import (
    DeclaredResponse,
    compared_field,
    comparison_faults,
    declared_responses_in,
    enum_of,
    telemetry_of,
)
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import line_of
from icdgen.icd.suggestions import suggestion
from icdgen.icd.trees import mappings
from icdgen.once import cached_by_owner
from icdgen.wording import count, listing, quote

COMMANDS, REQUESTS = "commands", "requests"
# Responses that each bus can have.
KINDS_ON = {
    (UART, COMMANDS): (ACK,),
    (I2C, COMMANDS): (ACK,),
    (CAN, COMMANDS): (ACK, NAK),
    (CAN, REQUESTS): (NAK,),
}
# Keys that a response on a bus needs.
NEEDED_ON = {
    UART: ("packet", "echo", "status", "success"),
    I2C: ("message", "echo", "until", "status", "success"),
    CAN: ("packet",),
}
ABOUT = ("source", "assumptions")
# What all buses share is in `commands` of the link.
REASONS = "reasons"
BYTE = 8


class BusResponses(NamedTuple):
    """Responses on a bus that a node declares, for this bus or for the whole link."""

    link: DeclaredLink
    bus: str
    key: str  # `commands` or `requests`
    owner: Map  # the mapping of that key
    is_of_link: bool
    kinds: tuple[str, ...]  # kinds that have an effect on the bus
    packets: Packets  # on the bus, including packets of included files

    def is_elsewhere(self, row: Map) -> bool:
        """Return whether a response is a packet that this bus does not have. ICD095
        reports it.
        """
        name = row.get("packet")
        return isinstance(name, str) and self.packets.by_name(name) is None

    def declared(self, ctx: Context) -> Iterator[DeclaredResponse]:
        """Yield the responses that conform to the schema."""
        section = Map(self.owner.spot)
        section[self.key] = self.owner
        link = DeclaredLink(self.link.node, section, self.packets, [])
        for declared in declared_responses_in(ctx, link):
            if declared.owner is self.owner and declared.kind in self.kinds:
                yield declared


@cached_by_owner
def responses_on_buses(ctx: Context) -> tuple[BusResponses, ...]:
    """Return the responses that nodes declare for each of their buses."""
    return tuple(_responses(ctx))


def _responses(ctx: Context) -> Iterator[BusResponses]:
    for link in bus_links(ctx):
        protocol = ctx.protocol_of(link.node)
        own_buses = link.section.get("buses")
        for bus in (bus for bus in BUSES if bus in buses_of(protocol)):
            packets = bus_link(protocol["link"], bus).packets
            own = own_buses.get(bus) if isinstance(own_buses, Map) else None
            own = own if isinstance(own, Map) else unread()
            for key in (COMMANDS, REQUESTS):
                of_bus = KINDS_ON.get((bus, key), ())
                # Responses of the bus precede those of the link.
                given = buses_of(protocol)[bus].get(key)
                given = given if isinstance(given, Mapping) else {}
                of_link = tuple(kind for kind in of_bus if kind not in given)
                for section, kinds in ((own, of_bus), (link.section, of_link)):
                    owner = section.get(key)
                    if isinstance(owner, Map):
                        is_of_link = section is link.section
                        yield BusResponses(
                            link, bus, key, owner, is_of_link, kinds, packets
                        )


@rule("ICD095", needs_complete=True)
def packets_of_responses_exist(ctx: Context) -> Iterator[Fault]:
    for responses in responses_on_buses(ctx):
        if responses.key == REQUESTS and responses.bus == CAN:
            yield from _named_packet(responses, responses.owner, TELECOMMAND)
        for declared in responses.declared(ctx):
            if declared.is_packet:
                yield from _named_packet(responses, declared.row, TELEMETRY)
    for link in bus_links(ctx):
        named = bus_link(ctx.protocol_of(link.node)["link"], CAN).packets
        for section in _sections(link):
            name = section.get("segment_of")
            if not isinstance(name, str):
                continue
            packet = named.by_name(name)
            if packet is None:
                names = [each.name for each in named.all]
                text = f"there is no packet {quote(name)} on `{CAN}`"
                remedy = suggestion(name, names, "correct the name")
                yield Fault.at(section, "segment_of", text, *remedy)
            elif packet.section.get("from") != section.get("from"):
                text = f"{quote(name)} is not sent by the same side"
                help = "correct the name, or `from`"
                yield Fault.at(section, "segment_of", text, help)


def _named_packet(
    responses: BusResponses, owner: Map, direction: str
) -> Iterator[Fault]:
    """Yield the fault of a key `packet` that must name one of the bus in a direction."""
    name = owner.get("packet")
    if not isinstance(name, str):
        return
    packet = responses.packets.by_name(name)
    if packet is None:
        names = [each.name for each in responses.packets.all]
        text = f"there is no packet {quote(name)} on `{responses.bus}`"
        help = "add it to `packets`"
        if responses.is_of_link:
            help += ", or write the response in `commands` of the bus that has it"
        yield Fault.at(owner, "packet", text, *suggestion(name, names, help))
    elif direction not in packet.directions or packet.messages is not None:
        sender = HOST if direction == TELECOMMAND else DEVICE
        text = f"{quote(name)} is no packet of the {sender} without messages"
        yield Fault.at(owner, "packet", text, f"name a packet `from: {sender}`")
    elif responses.bus == CAN and "type" not in packet.section:
        text = f"{quote(name)} has no message type, which tells packets on CAN apart"
        yield Fault.at(owner, "packet", text, "add `type` to the packet")


@rule("ICD105", needs_complete=True)
def responses_on_buses_are_complete(ctx: Context) -> Iterator[Fault]:
    for responses in responses_on_buses(ctx):
        for declared in responses.declared(ctx):
            row = declared.row
            # A response that is only a name is telemetry.
            given = {*row} or {"message"}
            missing = [key for key in NEEDED_ON[responses.bus] if key not in given]
            if responses.is_elsewhere(row):
                continue
            if missing:
                keys = listing([f"`{key}`" for key in missing])
                text = f"`{declared.kind}` on `{responses.bus}` has no {keys}"
                help = f"add {'it' if len(missing) == 1 else 'them'}, or write the response in `commands` of the bus that has it"
                yield Fault.at(declared.owner, declared.kind, text, help)
                continue
            if responses.bus == UART:
                yield from _acknowledge(declared)
            elif isinstance(row.get("echo"), Map):
                text = "a telemetry frame repeats the id only"
                yield Fault.at(row, "echo", text, "name the field that repeats the id")
            yield from _compared_fields(ctx, responses, declared)
        is_request = responses.key == REQUESTS and responses.bus == CAN
        # The schema check reports a request of a bus without a packet.
        if is_request and responses.is_of_link and "packet" not in responses.owner:
            text = "nothing says which packet requests telemetry"
            help = "add `packet:` with its name"
            yield Fault.at_key(responses.link.section, REQUESTS, text, help)
    for link in bus_links(ctx):
        yield from _reasons(ctx, link)


def _acknowledge(declared: DeclaredResponse) -> Iterator[Fault]:
    """Yield the faults of the fields of an acknowledge on the UART, which are a byte
    each.
    """
    packet, row = declared.packet, declared.row
    if packet is None:
        return  # ICD095
    for key, role in (("echo", "id"), ("status", "status")):
        name = row[key]
        field = packet.named(name) if isinstance(name, str) else None
        if field is None:
            if not isinstance(name, str):
                text = "an acknowledge on the UART repeats the id only"
                help = "name the field that repeats the id"
                yield Fault.at(row, key, text, help)
            continue  # `_compared_fields` reports other names
        if field.get("role") != role:
            text = f"{quote(name)} has the role `{field.get('role')}`, not `{role}`"
            yield Fault.at(row, key, text, "name another field, or correct its role")
        elif field["bits"] != BYTE or field["at"] % BYTE:
            text = f"{quote(name)} is not one byte, which an acknowledge on the UART has for it"
            yield Fault.at(row, key, text, "correct `bits` of the field")


@rule("ICD117", needs_complete=True)
def responses_of_the_link_have_an_effect(ctx: Context) -> Iterator[Fault]:
    seen: set[tuple[int, str]] = set()
    for responses in responses_on_buses(ctx):
        if not responses.is_of_link or (
            responses.key == REQUESTS and responses.bus != CAN
        ):
            continue  # The schema check reports keys of a bus.
        for owner, key in _without_effect(responses):
            if (id(owner), key) not in seen:
                seen.add((id(owner), key))
                text = f"`{key}` has no effect on `{responses.bus}`"
                help = "remove it, or say it for the bus that has it"
                yield Fault.at_key(owner, key, text, help)


def _without_effect(responses: BusResponses) -> Iterator[tuple[Map, str]]:
    """Yield the keys of the link that have no effect on a bus, each with its mapping."""
    allowed = (
        *KINDS_ON[responses.bus, responses.key],
        *ABOUT,
        "packet" if responses.key == REQUESTS else REASONS,
    )
    for key in responses.owner:
        if key not in allowed:
            yield responses.owner, key
    reasons = responses.owner.get(REASONS)
    if isinstance(reasons, Map) and BUSY in reasons:
        yield reasons, BUSY  # No response says so.
    for kind in responses.kinds:
        row = responses.owner.get(kind)
        row = row if isinstance(row, Map) else unread()
        for key in () if responses.is_elsewhere(row) else row:
            if key not in (*NEEDED_ON[responses.bus], *ABOUT):
                yield row, key


def _compared_fields(
    ctx: Context, responses: BusResponses, declared: DeclaredResponse
) -> Iterator[Fault]:
    """Yield the faults of the fields of a response that a client compares."""
    if responses.bus == CAN:
        return  # The responses have no fields.
    if declared.packet is None and telemetry_of(ctx, declared) is None:
        telecommands = messages_with_ids(ctx, declared.link.node, TELECOMMAND)
        is_telecommand = any(each.name == declared.name for _, each in telecommands)
        # ICD093 reports other names, and ICD095 packets.
        if is_telecommand and not declared.is_packet:
            text = f"{quote(declared.name)} is a telecommand, and a response comes from the device"
            yield declared.fault("message", text, "name telemetry")
        return
    yield from comparison_faults(ctx, declared)
    for key in ("until", "detail"):
        name = declared.row.get(key)
        if isinstance(name, str):
            field, text, help = compared_field(ctx, declared, name, key)
            if field is None:
                yield Fault.at(declared.row, key, text, help)


def _reasons(ctx: Context, link: DeclaredLink) -> Iterator[Fault]:
    """Yield the faults of reasons that no response on a bus has."""
    commands = link.section.get(COMMANDS)
    reasons = commands.get(REASONS) if isinstance(commands, Map) else None
    if not isinstance(reasons, Map):
        return
    with_status: list[DeclaredResponse] = []
    for responses in responses_on_buses(ctx):
        if responses.link.node not in ctx.users(link.node):
            continue
        for declared in responses.declared(ctx):
            # ICD093 or ICD095 reports a response without telemetry or packet.
            exists = declared.packet or telemetry_of(ctx, declared)
            if "status" in declared.row and exists:
                with_status.append(declared)
    enums = [enum_of(ctx, each, each.row["status"]) for each in with_status]
    named = [enum for enum in enums if enum is not None]
    names = [member.name for enum in named for member in enum.members]
    seen: dict[int, str] = {}
    for declared, enum in zip(with_status, enums, strict=True):
        success = declared.row.get("success")
        for value in success if isinstance(success, Seq) else ():
            if (number := number_of(value, enum)) is not None:
                seen[number] = "success"
    for cause, value in reasons.items():
        if cause == "assumptions" or not isinstance(value, int | str):
            continue
        if not with_status:
            text = "no response on a bus has a status, so it has no reasons"
            yield Fault.at_key(commands or unread(), REASONS, text, "remove it")
            return
        numbers = (number_of(value, enum) for enum in (*named, None))
        number = next((each for each in numbers if each is not None), None)
        if number is None:
            text = f"no refusal has the reason {quote(str(value))}"
            help = suggestion(str(value), names, "name a member of the enumeration")
            yield Fault.at(reasons, cause, text, *help)
        elif seen.setdefault(number, cause) != cause:
            text = f"{number} stands for both `{seen[number]}` and `{cause}`"
            yield Fault.at(reasons, cause, text, "give each its own code")
        else:
            yield from _width(ctx, with_status, reasons, cause, number)


def _width(
    ctx: Context,
    with_status: list[DeclaredResponse],
    reasons: Map,
    cause: str,
    number: int,
) -> Iterator[Fault]:
    """Yield the fault of a reason that is too large for a status."""
    for declared in with_status:
        field, _, _ = compared_field(ctx, declared, declared.row["status"], "status")
        if field and not field.range[0] <= number <= field.range[1]:
            bits = f"{count(field.bits, 'bit')} of {quote(field.name)}"
            text = f"{number} does not fit {bits}"
            yield Fault.at(reasons, cause, text, "correct it, or remove it")
            return


def _sections(link: DeclaredLink) -> list[Map]:
    """Return the mappings of the packets that a node declares itself."""
    packets = link.section.get("packets")
    return [*mappings([*packets.values()])] if isinstance(packets, Map) else []


@rule("ICD104")
def can_message_types_are_unique(ctx: Context) -> Iterator[Fault]:
    for link in bus_links(ctx):
        packets = link.section.get("packets")
        seen: dict[object, tuple[str, Map]] = {}
        for name, section in packets.items() if isinstance(packets, Map) else ():
            value = section.get("type") if isinstance(section, Map) else None
            if not isinstance(value, int):
                continue
            other, first = seen.setdefault(value, (name, section))
            if first is not section:
                line = line_of(first.at("type"), section.at("type"))
                text = f"the type {value} already belongs to {quote(other)} ({line})"
                related = Related(first.at("type"), "the first `type`")
                yield Fault.at(
                    section, "type", text, "correct one `type`", related=related
                )


# Keys of any packet on buses, and of its checksum, that have an effect.
OF_PACKETS = ("source", "from", "buses", "summary", "assumptions")
OF_CHECKSUM = ("at", "bits", "role", "name", "checksum", "covers", "optional", "summary")  # fmt: skip
# Keys that only packets on buses have.
ONLY_ON_BUSES = ("buses", "optional", "type", "segment_of")


@rule("ICD175", needs_complete=True)
def packets_on_buses_have_an_effect(ctx: Context) -> Iterator[Fault]:
    for link in framed_links(ctx):
        packets = link.section.get("packets")
        own = [*packets.values()] if isinstance(packets, Map) else []
        for section in (*mappings(own), *(row for _, row in link.fields_by_part)):
            for key in ONLY_ON_BUSES:
                if key in section:
                    text = f"`{key}` has no effect on framed links"
                    yield Fault.at_key(section, key, text, "remove it")
    for link in bus_links(ctx):
        sections = link.section.get("packets")
        if not isinstance(sections, Map):
            continue
        first: Map | None = None
        heads: dict[int, str] = {}
        for packet in link.declared.all:
            section = sections[packet.name]
            yield from _keys(ctx, link, packet, section)
            if packet.messages and packet.header:
                head = value_of(packet.header[0], TELEMETRY, True)
                if heads.setdefault(head, packet.name) != packet.name:
                    text = f"the packet {quote(heads[head])} begins with {head}, too"
                    yield Fault.at(section, "header", text, "correct `value` of one")
            for row in mappings(section.get("trailer")):
                if row.get("role") != "checksum":
                    text = "on buses, nothing but a checksum is sent behind the data"
                    yield Fault.at(row, "role", text, "remove the field")
                    continue
                yield from _field(ctx, link.node, row)
                first = row if first is None else first
                yield from _differences(row, first)
        yield from _competing(ctx, link, sections)


def _keys(
    ctx: Context, link: DeclaredLink, packet: Packet, section: Map
) -> Iterator[Fault]:
    """Yield the faults of the keys of a packet that have no effect on its buses."""
    protocols = [ctx.protocol_of(user) for user in ctx.users(link.node)]
    in_use = {bus for protocol in protocols for bus in buses_of(protocol)}
    buses = [bus for bus in buses_with(section) if bus in in_use]
    merged = ctx.protocol_of(link.node)["link"]
    is_response = any(
        packet.name in bus_link(merged, bus).packets.responding for bus in buses
    )
    allowed = {*OF_PACKETS}
    if CAN in buses:
        allowed |= {"type", "segment_of"}
    if buses == [UART] and TELECOMMAND not in packet.directions:
        allowed |= {"header"} if is_response else {"header", "messages"}
    if not is_response:
        allowed.add("trailer")
    for key in section:
        if key not in allowed:
            text = f"`{key}` has no effect on this packet of a bus"
            yield Fault.at_key(section, key, text, "remove it")
    if section.keys() & allowed <= {*OF_PACKETS}:
        text = "the packet adds nothing to the id and the data"
        yield Fault.at(section, "from", text, "add what it has, or remove the packet")
    if "messages" in section or ("header" in section and not is_response):
        yield from _unasked(ctx, link, packet, section)
    is_checked = bool(packet.fields_of_role("checksum"))
    if is_checked and TELEMETRY in packet.directions and CAN in buses:
        yield _on_can(section)


def _unasked(
    ctx: Context, link: DeclaredLink, packet: Packet, section: Map
) -> Iterator[Fault]:
    """Yield the faults of a packet with a constant in place of the id, in which one
    message is sent unasked.
    """
    rows, names = packet.header, section.get("messages")
    is_constant = len(rows) == 1 and rows[0].get("role") == "constant"
    if "header" not in section or not is_constant or rows[0]["bits"] != BYTE:
        text = "a message that is sent unasked has one constant byte in place of the id"
        help = "write `header: [{bits: 8, role: constant, value: ...}]`"
        yield Fault.at(section, "header" if rows else "from", text, help)
        return
    if not isinstance(names, Seq) or len(names) != 1:
        text = "the constant in place of the id stands for one message"
        key = "messages" if "messages" in section else "header"
        yield Fault.at(section, key, text, "list one message in `messages`")
        return
    telemetry = {
        each.name: id for id, each in messages_with_ids(ctx, link.node, TELEMETRY)
    }
    if names[0] not in telemetry and names[0] not in ctx.broken_messages(link.node):
        text = f"the node has no telemetry {quote(str(names[0]))}"
        remedy = suggestion(str(names[0]), telemetry, "correct the name")
        yield Fault.of_place(section, names.item_at(0), text, *remedy)
    head = value_of(rows[0], TELEMETRY, True)
    other = next((name for name, id in telemetry.items() if id == head), names[0])
    if other != names[0]:
        text = f"{head} is the id of {quote(other)}, so a receiver could not tell them apart"
        yield Fault.at(section, "header", text, "correct `value`, or the id")


def _competing(ctx: Context, link: DeclaredLink, sections: Map) -> Iterator[Fault]:
    """Yield the faults of packets of messages for which there is another one already."""
    protocol = ctx.protocol_of(link.node)
    reported: set[str] = set()
    for bus in (bus for bus in BUSES if bus in buses_of(protocol)):
        on_bus = bus_link(protocol["link"], bus)
        for direction in (TELECOMMAND, TELEMETRY):
            first = on_bus.carrying(direction)
            for packet in on_bus.packets.carrying(direction):
                if packet.messages is not None or packet.name in (
                    on_bus.packets.requesting,
                    first and first.name,
                    *reported,
                ):
                    continue
                if first is not None and packet.name in sections:
                    reported.add(packet.name)
                    text = f"{direction} on `{bus}` is in the packet {quote(first.name)} already"
                    help = "leave out the bus, or one of the packets"
                    yield Fault.at(sections[packet.name], "from", text, help)


def _on_can(section: Map) -> Fault:
    """Return the fault of a checksum of telemetry on CAN."""
    message = "frames on CAN have no checksum, so the checksum of telemetry has no effect there"
    if "buses" in section:
        return Fault.at(section, "buses", message, "remove `can` from `buses`")
    help = "add `buses`, with the links that have a checksum"
    return Fault.at(section, "from", message, help)


def _field(ctx: Context, node: Node, row: Map) -> Iterator[Fault]:
    """Yield the faults of a checksum that buses cannot have."""
    for key in row:
        if key not in OF_CHECKSUM:
            text = f"`{key}` has no effect on buses"
            yield Fault.at_key(row, key, text, "remove it")
    if isinstance(bits := row.get("bits"), int) and bits % 8:
        text = "on buses, a checksum has whole bytes"
        yield Fault.at(row, "bits", text, "correct `bits` and `width`")
    covers = row.get("covers")
    bounds = (covers.get("from"), covers.get("to")) if isinstance(covers, Map) else ()
    if bounds not in ((ID_ROLE, DATA), (DATA, DATA)):
        text = "on buses, a checksum covers the data, or id and data"
        help = "write `covers: {from: data, to: data}`, or `from: id`"
        yield Fault.at(row, "covers" if "covers" in row else "role", text, help)
    declared = ctx.fact(node, "link", "checksums", str(row.get("checksum")))
    if isinstance(declared, Mapping) and declared.get("kind") != checksum.CRC:
        yield Fault.at(row, "checksum", "on buses, a checksum is a CRC", "name a CRC")
    elif isinstance(declared, Mapping) and "seeds" in declared:
        text = "`seeds` have no effect on buses"
        yield Fault.at(row, "checksum", text, "name a checksum without `seeds`")


def _differences(row: Map, first: Map) -> Iterator[Fault]:
    """Yield the faults of a checksum that is not that of the first packet."""
    for key in ("checksum", "bits", "covers"):
        if row.get(key) != first.get(key):
            text = (
                f"`{key}` is not that of the other packets, and a node has one checksum"
            )
            help = f"give all packets the same `{key}`"
            yield Fault.at(row, key if key in row else "role", text, help)
            return
