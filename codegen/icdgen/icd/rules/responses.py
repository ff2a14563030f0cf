"""Responses to telecommands on framed links: ``commands`` of `link`, and the key
`response` of messages. The rules are ICD176 to ICD179 and ICD183. `buses` applies
`declared_responses_in` and `comparison_faults` to links on buses.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from icdgen.frozen import NamedTuple
from icdgen.icd.enumeration import Enum
from icdgen.icd.fault import Fault
from icdgen.icd.layout import Array, Overlay, integer_range
from icdgen.icd.located import Map, Seq, unread
from icdgen.icd.model import TELECOMMAND, TELEMETRY, Message, Node, framed_link
from icdgen.icd.packets import ID_ROLE, Packet
from icdgen.icd.places import NodePlace
from icdgen.icd.responses import (
    BUSY,
    HEADER,
    ID,
    KINDS,
    MOST_SOURCES,
    NAK,
    NEEDED,
    NONE,
    STATUS_SETS,
    declared_responses,
    echoes_of,
    field_of,
    id_byte_of,
    number_of,
    number_run,
    reason_of,
)
from icdgen.icd.rules.context import PATH_OF_BUSES, Context
from icdgen.icd.rules.framed_links import DeclaredLink, framed_links, messages_with_ids
from icdgen.icd.rules.rule import rule
from icdgen.icd.suggestions import suggestion
from icdgen.icd.trees import at_path
from icdgen.wording import count, quote

WHOLE_NUMBERS = ("uint", "int", "bool", "enum")
"""Types of fields with a number that a wider field can repeat, unless it is signed."""

MOST_VALUES = 256  # of a range of reasons, since a client stores the name of each value

OTHER_LINKS = (
    (*PATH_OF_BUSES, "uart", "framing"),
    (*PATH_OF_BUSES, "i2c"),
    (*PATH_OF_BUSES, "can"),
)
"""Paths in a protocol section that describe a link other than a framed one."""

STREAM_SETTINGS = ("busy_pause_ms", "gap_ms", "in_flight", "progress_for_ms")
"""Keys of `client` that only framed links use."""


class DeclaredResponse(NamedTuple):
    """Response that the ICD declares, with the telecommands that have it."""

    link: DeclaredLink
    owner: Map  # mapping with the key `kind`
    kind: str
    row: Map  # mapping of the response; empty if it is only a name
    name: str  # of the telemetry or packet
    telecommands: list[Message]  # none for a request of telemetry
    is_packet: bool = False
    is_of_request: bool = False

    @property
    def packet(self) -> Packet | None:
        """Return the packet that responds; None for telemetry."""
        return self.link.declared.by_name(self.name) if self.is_packet else None

    def fault(self, key: str, message: str, help: str, fix: str = "") -> Fault:
        """Return a fault at a key of the response, or at the response."""
        owner, key = (self.row, key) if key in self.row else (self.owner, self.kind)
        return Fault.at(owner, key, message, help, fix)


def _owners(ctx: Context, link: DeclaredLink) -> list[tuple[Map, list[Message]]]:
    """Return each mapping with responses and the telecommands to which it applies.

    The mapping of responses to telemetry requests applies to no telecommands.
    """
    telecommands = [m for _, m in messages_with_ids(ctx, link.node, TELECOMMAND)]
    commands = link.section.get("commands")
    commands = commands if isinstance(commands, Map) else unread()
    own = [
        (message.response, [message])
        for message in telecommands
        if isinstance(message.response, Map)
    ]
    requests = link.section.get("requests")
    requests = requests if isinstance(requests, Map) else unread()
    return [(commands, telecommands), *own, (requests, [])]


def declared_responses_in(
    ctx: Context, link: DeclaredLink
) -> Iterator[DeclaredResponse]:
    """Yield the responses of a link that conform to the schema."""
    commands, requests = (link.section.get(key) for key in ("commands", "requests"))
    for owner, messages in _owners(ctx, link):
        for kind in KINDS:
            value = owner.get(kind, NONE)
            row = value if isinstance(value, Map) else unread()
            is_packet = "packet" in row and "message" not in row
            name = row.get("packet" if is_packet else "message")
            name = name if isinstance(value, Map) else value
            if isinstance(name, str) and name != NONE and _is_sound(row):
                users = [
                    message
                    for message in messages
                    if owner is not commands or _inherits(message, kind)
                ]
                yield DeclaredResponse(
                    link, owner, kind, row, name, users, is_packet, owner is requests
                )


def _is_sound(row: Map) -> bool:
    """Return whether the values of a response that these rules use conform to the
    schema.
    """
    echo = row.get("echo", "")
    parts = [*echo, *echo.values()] if isinstance(echo, Map) else [echo]
    keys = ("status", "reason", "message", "packet")
    texts = [*parts, *(row.get(key, "") for key in keys)]
    return all(isinstance(text, str) for text in texts)


def _inherits(message: Message, kind: str) -> bool:
    """Return whether a telecommand has the response of all telecommands."""
    own: Any = message.response
    return own is None or (isinstance(own, Map) and kind not in own)


def telemetry_of(ctx: Context, declared: DeclaredResponse) -> Message | None:
    """Return the telemetry that a response names; None for an unknown name."""
    telemetry = messages_with_ids(ctx, declared.link.node, TELEMETRY)
    return next((each for _, each in telemetry if each.name == declared.name), None)


@rule("ICD176")
def responses_are_telemetry(ctx: Context) -> Iterator[Fault]:
    for link in framed_links(ctx):
        telemetry = messages_with_ids(ctx, link.node, TELEMETRY)
        ids = [id for id, _ in telemetry]
        names = {message.name: id for id, message in telemetry}
        telecommands = {
            each.name for _, each in messages_with_ids(ctx, link.node, TELECOMMAND)
        }
        broken = ctx.broken_messages(link.node)
        yield from _sources(ctx, link)
        for declared in declared_responses_in(ctx, link):
            name = declared.name
            if declared.is_packet:
                yield from _packet_faults(declared)
            elif name in telecommands and name not in names:
                message = f"{quote(name)} is a telecommand, and a response comes from the device"
                yield declared.fault("message", message, "name telemetry")
            elif name not in names and name not in broken:
                message = f"there is no telemetry {quote(name)}"
                yield declared.fault(
                    "message", message, *suggestion(name, names, "correct the name")
                )
            elif name in names and ids.count(names[name]) > 1:
                message = f"other telemetry has the id of {quote(name)}, so a client cannot tell that it is a response"
                help = "make it one message, with a field that `status` names"
                yield declared.fault("message", message, help)


def _sources(ctx: Context, link: DeclaredLink) -> Iterator[Fault]:
    """Yield the faults of responses that name neither telemetry nor a packet, or both."""
    for owner, _ in _owners(ctx, link):
        for kind in KINDS:
            row = owner.get(kind)
            if not isinstance(row, Map):
                continue
            if "message" in row and "packet" in row:
                text = "a response is a message or a packet, and this one names both"
                yield Fault.at_key(row, "packet", text, "remove one of them")
            elif "message" not in row and "packet" not in row:
                text = f"nothing says what `{kind}` is"
                help = "add `message:`, the telemetry that responds"
                yield Fault.at_key(owner, kind, text, help)


def _packet_faults(declared: DeclaredResponse) -> Iterator[Fault]:
    """Yield the faults of the packet that is a response."""
    packet, names = declared.packet, [each.name for each in declared.link.declared.all]
    if packet is None:
        message = f"there is no packet {quote(declared.name)}"
        existing = [name for name in names if name]
        remedy = suggestion(declared.name, existing, "add it to `packets`")
        yield declared.fault("packet", message, *remedy)
    elif TELEMETRY not in packet.directions:
        message = f"the host sends the packet {quote(declared.name)}, and a response comes from the device"
        help = "name a packet `from: device`"
        yield declared.fault("packet", message, help)
    elif packet.messages is not None:
        message = f"the packet {quote(declared.name)} carries messages, so it is no response of its own"
        help = "name one of its messages with `message`, or a packet without messages"
        yield declared.fault("packet", message, help)


@rule("ICD177")
def responses_can_be_compared(ctx: Context) -> Iterator[Fault]:
    for link in framed_links(ctx):
        for declared in declared_responses_in(ctx, link):
            if declared.packet is None and telemetry_of(ctx, declared) is None:
                continue  # ICD176
            yield from comparison_faults(ctx, declared)
        yield from _reasons(ctx, link)
        yield from _numbers_of_parts(ctx, link)


def comparison_faults(ctx: Context, declared: DeclaredResponse) -> Iterator[Fault]:
    """Yield the faults of the fields of a response that a client compares."""
    yield from _echoes(ctx, declared)
    yield from _status(ctx, declared)
    yield from _reason(ctx, declared)


class ComparedField(NamedTuple):
    """Field of a response that a client compares with a number."""

    name: str
    bits: int
    enum: Enum | None
    is_signed: bool
    id_bits: int  # bits of the whole id for a part of it, otherwise those of the field

    @property
    def range(self) -> tuple[int, int]:
        """Return the least and the largest raw value."""
        return integer_range(self.bits, self.is_signed)


def compared_field(
    ctx: Context, declared: DeclaredResponse, name: str, key: str
) -> tuple[ComparedField | None, str, str]:
    """Return the field that ``key`` of a response names; otherwise what is wrong, and
    its remedy.
    """
    enum, packet = enum_of(ctx, declared, name), declared.packet
    if packet is not None:
        row = packet.named(name)
        if row is not None:
            parts = packet.fields_of_role(ID_ROLE) if row["role"] == ID_ROLE else [row]
            id_bits = sum(part["bits"] for part in parts)
            return ComparedField(name, row["bits"], enum, False, id_bits), "", ""
        existing = [row.get("name", row["role"]) for row in packet.rows]
        text = f"the packet {quote(packet.name)} has no field {quote(name)}"
        return (
            None,
            text,
            suggestion(name, existing, "name a field by its name or role")[0],
        )
    response = telemetry_of(ctx, declared)
    assert response is not None, "rule ICD176 checks the telemetry"
    field, text, help = _number(response, declared.link.node, name, key)
    if field is None:
        return None, text, help
    signed = field.scalar.is_signed
    return ComparedField(name, field.bits, enum, signed, field.bits), "", ""


def enum_of(ctx: Context, declared: DeclaredResponse, name: str | None) -> Enum | None:
    """Return the enumeration of a field of a response; None without one."""
    if declared.packet is not None:
        row = declared.packet.named(name or "") or {}
        scope = ctx.scope(declared.link.node)
        enums = {enum.name: enum for node in scope for enum in node.enums}
        return enums.get(row.get("enum", ""))
    response = telemetry_of(ctx, declared)
    field = response and field_of(response, name)
    return field.scalar.enum if field else None


def _reason_against_echo(
    ctx: Context, declared: DeclaredResponse, field: ComparedField, repeated: str
) -> tuple[str, str]:
    """Return why a field cannot repeat a part of the telecommands, or of a request of
    telemetry, and the remedy; two empty texts if it can.
    """
    node, name = declared.link.node, field.name
    width = field.id_bits if repeated == ID else field.bits
    if repeated.startswith(HEADER):
        return _reason_against_header_echo(
            declared, name, width, repeated.removeprefix(HEADER)
        )
    if declared.is_of_request:
        if repeated != ID and id_byte_of(node, repeated) is None:
            text = "a request of telemetry has no part but its id and its header"
            return text, "write `id`, or `header.` and the name of a field"
        ids = [id for id, _ in messages_with_ids(ctx, node, TELEMETRY)]
        what, bits = "an id", max(ids, default=0).bit_length()
        if repeated != ID:
            what, bits = quote(repeated), 8
        if bits > width:
            text = f"{quote(name)} of {count(width, 'bit')} cannot repeat {what} of {count(bits, 'bit')}"
            return text, "name another field"
    for message in declared.telecommands:
        text, help = _misfit(node, name, width, message, repeated)
        if text:
            return text, help
    return "", ""


def _numbers_of_parts(ctx: Context, link: DeclaredLink) -> Iterator[Fault]:
    """Yield a fault for each telecommand of which responses repeat too many parts."""
    parts: dict[int, set[str]] = {}
    for declared in declared_responses_in(ctx, link):
        for message in declared.telecommands:
            repeated = parts.setdefault(id(message), set())
            before = len(repeated)
            repeated.update(echoes_of(declared.row).values())
            if before <= MOST_SOURCES < len(repeated):
                text = f"responses repeat {len(repeated)} parts of {quote(message.name)}, more than {MOST_SOURCES}"
                help = "leave out the parts that tell the least"
                yield declared.fault("echo", text, help)


def _number(
    message: Message, node: Node, name: str, role: str
) -> tuple[NodePlace | None, str, str]:
    """Return a field that can be compared with a number; otherwise what is wrong, and
    its remedy.
    """
    field = field_of(message, name)
    obstacle = _obstacle(message, node, name, field)
    if obstacle:
        return None, f"{quote(name)} {obstacle}", f"let `{role}` name another field"
    if field is None:
        names = [place.name for place in message.fields]
        remedy = suggestion(name, names, "correct the name")
        return None, f"{quote(message.name)} has no field {quote(name)}", remedy[0]
    return field, "", ""


def _obstacle(message: Message, node: Node, name: str, field: NodePlace | None) -> str:
    """Return why a client cannot compare a field with a number; empty if it can, and for
    a name that the message does not have.
    """
    if field is None:
        nodes = (each for each in message.layout.nodes if each.name == name)
        return "is an array" if any(isinstance(each, Array) for each in nodes) else ""
    if isinstance(field.node, Overlay):
        return "is an overlay field, which has no bits of its own"
    if field.is_read_only or field.is_count:
        return "is computed and not transmitted"
    if field.index is not None:
        return "is an element of an array"
    if any(step.node.present_if for step in field.steps):
        return "is an optional field, which not every message has"
    if field.steps[0].node not in message.layout.fixed:
        is_variable = field.scalar.length is not None
        return (
            "has a variable length"
            if is_variable
            else "follows a part of variable length, so its place differs between messages"
        )
    if number_run(field, node) is None:
        return "is not a number of at most 32 bits in at most 4 bytes"
    return ""


def _echoes(ctx: Context, declared: DeclaredResponse) -> Iterator[Fault]:
    """Yield the faults of fields that repeat parts of the telecommand."""
    row = declared.row
    echo = row.get("echo")
    owner = echo if isinstance(echo, Map) else row
    for name, repeated in echoes_of(row).items():
        if not isinstance(repeated, str):
            continue
        key = name if isinstance(echo, Map) else "echo"
        field, text, help = compared_field(ctx, declared, name, "echo")
        if field is None:
            yield Fault.at_key(owner, key, text, help)
            continue
        for other in ("status", "reason"):
            if row.get(other) == name:
                text = f"{quote(name)} repeats a part of the telecommand, so it cannot be the {other}"
                help = f"let `echo` or `{other}` name another field"
                yield Fault.at(row, other, text, help)
        text, help = _reason_against_echo(ctx, declared, field, repeated)
        if text:
            yield Fault.at(owner, key, text, help)


def _reason_against_header_echo(
    declared: DeclaredResponse, name: str, width: int, repeated: str
) -> tuple[str, str]:
    """Return why a field cannot repeat a field of the header of the telecommands or of
    a request, and the remedy; two empty texts if it can.
    """
    packets = declared.link.declared
    sent = [packets.by_name(packets.requesting)] if declared.is_of_request else []
    for message in declared.telecommands:
        sent += packets.packets_of_message(message.name, TELECOMMAND)[:1]
    for packet in sent:
        if packet is None:
            continue  # ICD186
        row = packet.named(repeated)
        title = f"the packet {quote(packet.name)}" if packet.name else "the link"
        if row is None or not any(row is each for each in packet.header):
            existing = [each.get("name", each["role"]) for each in packet.header]
            text = f"{title} has no field {quote(repeated)} in its header"
            return text, suggestion(repeated, existing, "name a field of the header")[0]
        if row["role"] == "checksum":
            return "a checksum is not repeated", "name another field of the header"
        if row["bits"] > width:
            bits = count(row["bits"], "bit")
            text = f"{quote(name)} of {count(width, 'bit')} cannot repeat {bits} of {quote(repeated)} in the header"
            return text, "correct the width of the field, or name another field"
    return "", ""


def _misfit(
    node: Node, field: str, width: int, message: Message, repeated: str
) -> tuple[str, str]:
    """Return why a field cannot repeat a part of a telecommand, and the remedy; two
    empty texts if it can.
    """
    source: NodePlace | None = None
    if repeated == ID:
        bits = (message.telecommand_id or 0).bit_length()
    elif id_byte_of(node, repeated) is not None:
        bits = 8
    else:
        source, text, help = _number(message, node, repeated, "echo")
        if source is None:
            return text, f"{help}, or write `id`" if "correct" in help else help
        bits = source.bits
    name = quote(field)
    if bits > width:
        text = f"{name} of {count(width, 'bit')} cannot repeat {count(bits, 'bit')} of {quote(message.name)}"
        return text, "correct the width of the field, or name another field"
    # Clients compare bits. A device that writes a signed number into a wider field
    # extends its sign; for a float or bytes, the bits of the wider field are unknown.
    if source is None or bits == width:
        return "", ""
    is_number = source.scalar.type in WHOLE_NUMBERS
    if is_number and not source.scalar.is_signed:
        return "", ""
    why = "may be negative" if is_number else "is not a whole number"
    part = f"{quote(repeated)} of {quote(message.name)}"
    text = f"{name} of {count(width, 'bit')} cannot repeat {part}, which has {bits} and {why}"
    return text, "give both the same width, or name another field"


def _status(ctx: Context, declared: DeclaredResponse) -> Iterator[Fault]:
    """Yield the faults of the field that says whether the telecommand was executed."""
    row = declared.row
    if declared.kind not in NEEDED:
        # The schema check reports a status.
        yield from _busy_reasons(ctx, declared)
        return
    name = row.get("status")
    if name is None:
        for key in STATUS_SETS:
            if key in row:
                text = f"`{key}` lists values of a status, and there is no `status`"
                yield Fault.at_key(row, key, text, f"add `status`, or remove `{key}`")
        return
    field, text, help = compared_field(ctx, declared, name, "status")
    if field is None:
        yield Fault.at(row, "status", text, help)
        return
    if "success" not in row:
        text = "no value of the status confirms the telecommand"
        yield Fault.at(row, "status", text, "add `success:`, the values that do")
    yield from _values(declared, field)


def _busy_reasons(ctx: Context, declared: DeclaredResponse) -> Iterator[Fault]:
    """Yield the faults of the reasons for which a refusal is only a busy device."""
    row = declared.row
    if declared.kind != NAK or not isinstance(row.get(BUSY), Seq):
        return  # The schema check reports others.
    name = row.get("reason")
    if name is None:
        text = "`busy` lists reasons, and no field has the reason"
        yield Fault.at_key(row, BUSY, text, "add `reason`, or remove `busy`")
    else:
        field, _, _ = compared_field(ctx, declared, name, "reason")
        if field is not None:
            yield from _values(declared, field)


def _values(declared: DeclaredResponse, field: ComparedField) -> Iterator[Fault]:
    """Yield the faults of the listed values of a field, and what each means."""
    row, name = declared.row, field.name
    seen: dict[int, str] = {}
    members = field.enum.members if field.enum else ()
    least, most = field.range
    for key in STATUS_SETS:
        values = row.get(key)
        for value, place in values.placed() if isinstance(values, Seq) else ():
            number = number_of(value, field.enum)
            ranges = [member for member in members if member.to is not None]
            member = next((each for each in ranges if each.name == value), None)
            if member is not None:
                text = f"{quote(member.name)} is a range of values ({member.values})"
                help = f"list the values that mean `{key}` as numbers, such as {member.value}"
                yield Fault(row, place, text, help)
            elif number is None:
                names = [member.name for member in members]
                text = f"{quote(name)} has no value {quote(str(value))}"
                remedy = suggestion(str(value), names, "correct it, or write a number")
                yield Fault.of_place(row, place, text, *remedy)
            elif not least <= number <= most:
                text = (
                    f"{number} does not fit {count(field.bits, 'bit')} of {quote(name)}"
                )
                yield Fault(
                    row, place, text, "correct the value, or name another field"
                )
            elif number in seen:
                text = f"{quote(str(value))} is in `{seen[number]}` already"
                yield Fault(row, place, text, "remove it from one of the two lists")
            else:
                seen[number] = key


def _reason(ctx: Context, declared: DeclaredResponse) -> Iterator[Fault]:
    """Yield the faults of the field with the reason of a refusal."""
    row = declared.row
    yield from _ranges_of_reasons(ctx, declared)
    name = row.get("reason")
    if name is None:
        return
    if declared.kind in NEEDED and "status" not in row:
        text = f"a response `{declared.kind}` without a status refuses nothing, so it has no reason"
        yield Fault.at_key(row, "reason", text, "add `status`, or remove `reason`")
        return
    field, text, help = compared_field(ctx, declared, name, "reason")
    if field is None:
        yield Fault.at(row, "reason", text, help)
    elif field.enum is None:
        text = f"{quote(name)} has no enumeration, so a refusal would be a bare number"
        key = "enum:" if declared.is_packet else "type: enum"
        help = f"give the field `{key}` with the reasons of the manual"
        yield Fault.at(row, "reason", text, help)


def _ranges_of_reasons(ctx: Context, declared: DeclaredResponse) -> Iterator[Fault]:
    """Yield the faults of reasons that are too many values."""
    enum = enum_of(ctx, declared, reason_of(declared.row))
    for member in enum.members if enum else ():
        values = member.last - member.value + 1
        if values > MOST_VALUES:
            text = f"the reason {quote(member.name)} is a range of {values} values, more than {MOST_VALUES}"
            help = "shorten the range to the values that the device uses, or remove it"
            key = "reason" if "reason" in declared.row else "status"
            yield Fault.at(declared.row, key, text, help)


def _reasons(ctx: Context, link: DeclaredLink) -> Iterator[Fault]:
    """Yield the faults of reasons that no refusal has."""
    commands = link.section.get("commands")
    reasons = commands.get("reasons") if isinstance(commands, Map) else None
    if not isinstance(reasons, Map):
        return
    members: list[str] = []
    for declared in declared_responses_in(ctx, link):
        enum = enum_of(ctx, declared, reason_of(declared.row))
        members += [member.name for member in enum.members] if enum else []
    for cause, name in reasons.items():
        if isinstance(name, str) and cause != "assumptions" and name not in members:
            text = f"no refusal has the reason {quote(name)}"
            help = suggestion(name, members, "name a member of the enumeration")
            yield Fault.at(reasons, cause, text, *help)


@rule("ICD178")
def telecommands_of_one_id_have_one_response(ctx: Context) -> Iterator[Fault]:
    for link in framed_links(ctx):
        first_of_id: dict[int, Message] = {}
        for id, message in messages_with_ids(ctx, link.node, TELECOMMAND):
            first = first_of_id.setdefault(id, message)
            for key in ("response", "repeat"):
                if getattr(message, key) != getattr(first, key):
                    owner = message if key in message.source else first
                    text = f"`{key}` of {quote(message.name)} differs from that of {quote(first.name)}, which has the same id"
                    yield Fault.at_key(
                        owner.source, key, text, "give both the same, or other ids"
                    )
            yield from _places_of_variants(link, first, message)


def _places_of_variants(
    link: DeclaredLink, first: Message, message: Message
) -> Iterator[Fault]:
    """Yield a fault if a part that responses repeat is at different places in two
    messages of one id.
    """
    if first is message:
        return
    commands = link.section.get("commands")
    rows = declared_responses(commands if isinstance(commands, Map) else {}, message)
    for name in {name for row in rows.values() for name in echoes_of(row).values()}:
        places = [
            number_run(field, link.node)
            for field in (field_of(first, name), field_of(message, name))
            if field is not None
        ]
        if len(places) == 2 and places[0] != places[1]:
            text = f"{quote(name)}, which a response repeats, is not where {quote(first.name)} has it, which has the same id"
            yield Fault.at(message.source, "name", text, "correct its place, or the id")


@rule("ICD179")
def responses_tell_the_outcome(ctx: Context) -> Iterator[Fault]:
    for link in framed_links(ctx):
        reported: set[tuple[int, str]] = set()
        commands = link.section.get("commands")
        commands = commands if isinstance(commands, Map) else unread()
        for _, message in messages_with_ids(ctx, link.node, TELECOMMAND):
            rows = declared_responses(commands, message)
            for kind, text, help in _contradictions(rows):
                own: Any = message.response
                owner = own if isinstance(own, Map) and kind in own else commands
                if kind in owner and (id(owner), kind) not in reported:
                    reported.add((id(owner), kind))
                    text = text.format(name=quote(message.name))
                    yield Fault.at(owner, kind, text, help)


def _contradictions(rows: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield the kind of each response that contradicts another one, with what is wrong
    and its remedy.
    """
    if rows and not set(rows) & set(NEEDED):
        text = "{name} has no response that confirms it, so a client could not tell success from loss"
        help = "add `ack` or `reply`, or let `response: none` say that nothing responds"
        yield next(iter(rows)), text, help
    seen: dict[object, str] = {}
    for kind, row in rows.items():
        key = "message" if "message" in row else "packet"
        name = row.get(key)
        if not isinstance(name, str):
            continue  # The schema check reports it.
        name = f"{key} {name}"
        if name in seen:
            what = "telemetry" if key == "message" else "packet"
            text = f"`{seen[name]}` and `{kind}` of {{name}} are the same {what}"
            help = "write one `ack` with a `status`, whose values confirm or refuse"
            yield kind, text, help
        seen.setdefault(name, kind)


@rule("ICD183")
def keys_of_responses_have_an_effect(ctx: Context) -> Iterator[Fault]:
    for message, node in ctx.messages:
        for key in ("response", "repeat"):
            if key not in message.source:
                continue
            if message.telecommand_id is None:
                text = f"`{key}` applies to a telecommand, not to telemetry"
                yield Fault.at_key(message.source, key, text, "remove it")
            elif _is_on_other_links(ctx, node) and ctx.complete:
                text = f"`{key}` has an effect on framed links (`link: framing`) only"
                yield Fault.at_key(message.source, key, text, "remove it")
        if "period_ms" not in message.source:
            continue
        if message.telemetry_id is None:
            text = "`period_ms` applies to telemetry, not to a telecommand"
            yield Fault.at_key(message.source, "period_ms", text, "remove it")
        elif _is_on_other_links(ctx, node) and ctx.complete:
            text = "`period_ms` has no effect, because on this link telemetry is sent on request only"
            yield Fault.at_key(message.source, "period_ms", text, "remove it")
    for node in ctx.icd.nodes:
        protocol = node.source.get("protocol")
        client = at_path(protocol, ("link", "client"))
        if isinstance(client, Map) and _is_on_other_links(ctx, node):
            for key in STREAM_SETTINGS:
                if key in client:
                    text = (
                        f"`{key}` has an effect on framed links (`link: framing`) only"
                    )
                    yield Fault.at_key(client, key, text, "remove it")


def _is_on_other_links(ctx: Context, node: Node) -> bool:
    """Return whether the messages of a node are transmitted, and never on a framed link.

    A file that other files include often describes no link.
    """
    protocols = [ctx.protocol_of(user) for user in ctx.users(node)]
    return not any(map(framed_link, protocols)) and any(
        at_path(protocol, path) is not None
        for protocol in protocols
        for path in OTHER_LINKS
    )
