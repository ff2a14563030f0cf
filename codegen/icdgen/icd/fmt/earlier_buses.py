"""Conversion of buses that were written before their acknowledges, message types and
error codes took the form of framed links: packets, commands and requests.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeGuard

from icdgen.icd.fmt.commented import Branch, Child, ScalarText
from icdgen.icd.fmt.scalars import name
from icdgen.icd.fmt.trees import (
    entries_of,
    entry_of,
    item_named,
    items_of,
    mapping,
    move,
    number,
    part_of,
    sequence,
    value_of,
    word,
)

_CAUSES = {"unknown_id": "unknown_id", "length": "length", "parameter": "value", "checksum": "checksum"}  # fmt: skip
_POLLED = {"source": "source", "message": "message", "id": "echo", "until": "until",
    "error": "status", "parameter": "detail", "assumptions": "assumptions"}  # fmt: skip
_ROLES: dict[object, str] = {"id": "id", "error": "status"}
# Keys of `telecommand` and `telemetry` of CAN -> who sends the packet, and the key of the
# packet of which it is a part
_TYPES = {
    "telecommand": {"request": ("host", ""), "extended_request": ("host", "request"),
        "acknowledge": ("device", ""), "failure": ("device", "")},
    "telemetry": {"request": ("host", ""), "response": ("device", ""), "failure": ("device", ""),
        "extended_response": ("device", "response")},
}  # fmt: skip
PATHS = {
    "protocol.link.reasons": "protocol.link.commands.reasons",
    "protocol.link.buses.uart.acknowledge": "protocol.link.packets.acknowledge",
    "protocol.link.buses.i2c.acknowledge": "protocol.link.buses.i2c.commands.ack",
    "protocol.link.buses.can.message_types": "protocol.link.packets",
    "protocol.link.buses.can.telecommand": "protocol.link.buses.can.commands",
    "protocol.link.buses.can.telemetry": "protocol.link.buses.can.requests",
    "protocol.link.buses.can.extended": "protocol.link.buses.can.segments",
}
"""Places of earlier sections -> their present places, for errata."""


def convert_buses(link: Branch, root: Branch) -> bool:
    """Change the buses of a link, and its error codes, to the present keys.

    ``root``: the ICD, for ids and for names of error codes. Return whether there was
    something to change.
    """
    buses = value_of(link, "buses")
    uart, i2c, can = (value_of(buses, bus) for bus in ("uart", "i2c", "can"))
    before = [entry_of(link, "reasons")]
    before += [entry_of(uart, key) for key in ("acknowledge", "unsolicited")]
    before += [entry_of(i2c, "acknowledge")]
    keys = ("message_types", "telecommand", "telemetry", "extended")
    before += [entry_of(can, key) for key in keys]
    if not any(before):
        return False
    # Where the field with the code has no enumeration, its values are numbers.
    rows = items_of(value_of(value_of(uart, "acknowledge"), "data"))
    is_named = any(entry_of(row.value, "enum") for row in rows)
    success, named_success = _convert_reasons(link, root, is_named)
    packets = Branch(True, False, 0)
    if isinstance(uart, Branch):
        _convert_acknowledge(uart, packets, named_success)
        _convert_unsolicited(uart, packets, root)
    if isinstance(i2c, Branch) and (polled := value_of(i2c, "acknowledge")):
        _convert_polled(i2c, polled, success)
    if isinstance(can, Branch):
        _convert_can(can, packets)
    if packets.children:
        own = part_of(link, "packets")
        if own is not None:
            own.children += packets.children
    return True


def _is_mapping(value: object) -> TypeGuard[Branch]:
    """Return whether a value is a mapping; values of other types stay as they are,
    because the schema check reports them.
    """
    return isinstance(value, Branch) and value.mapping


def _convert_reasons(
    link: Branch, root: Branch, is_named: bool
) -> tuple[ScalarText, ScalarText]:
    """Move the error codes to the commands, as members of their enumeration if the field
    with the code has one.

    Return what confirms a telecommand: as a number, and like the error codes.
    """
    reasons = entry_of(link, "reasons")
    success = named_success = number(0)
    if reasons is None or not _is_mapping(reasons.value):
        return success, named_success
    section = reasons.value
    names = _members(root, value_of(section, "enum")) if is_named else {}
    causes: dict[str, ScalarText | Branch] = {}
    for child in section.children:
        key, given = name(child.key), child.value
        if isinstance(given, ScalarText) and isinstance(given.value, int):
            member = names.get(given.value)
            code = given if member is None else word(member)
            if key == "none":
                success, named_success = given, code
            elif key in _CAUSES:
                causes[_CAUSES[key]] = code
    commands = Branch(True, False, 0)
    move(section, {"source": "source"}, commands)
    if causes:
        commands.children.append(Child(word("reasons"), mapping(causes)))
    reasons.before += section.comments()
    reasons.key, reasons.value = word("commands"), commands
    if not commands.children:
        link.children.remove(reasons)
    return success, named_success


def _members(root: Branch, enum: object) -> dict[int, str]:
    """Return the names of an enumeration of the file by their values."""
    names = {}
    for row in items_of(value_of(item_named(value_of(root, "enums"), enum), "members")):
        value, member = (value_of(row.value, key) for key in ("value", "name"))
        if isinstance(value, ScalarText) and isinstance(member, ScalarText):
            if isinstance(value.value, int):
                names[value.value] = str(member.value)
    return names


def _convert_acknowledge(uart: Branch, packets: Branch, success: ScalarText) -> None:
    """Make the acknowledge of the UART a packet, and let it confirm telecommands."""
    acknowledge = entry_of(uart, "acknowledge")
    if acknowledge is None or not _is_mapping(acknowledge.value):
        return
    section = acknowledge.value
    packet = Branch(True, False, 0)
    move(section, {"source": "source"}, packet)
    sender: dict[str, ScalarText | Branch] = {"from": word("device")}
    sender["buses"] = sequence(word("uart"))
    packet.children += mapping(sender).children
    data = entry_of(section, "data")
    if data is not None and isinstance(data.value, Branch):
        section.children.remove(data)
        data.key = word("header")
        end = 0
        for item in items_of(data.value):
            if isinstance(item.value, Branch):
                end = _convert_row(item.value, end)
        packet.children.append(data)
    reasons = value_of(section, "assumptions")
    for child in entries_of(reasons):
        if name(child.key) == "data":
            child.key = word("header")
    move(section, {"assumptions": "assumptions"}, packet)
    response: dict[str, ScalarText | Branch] = {"packet": word("acknowledge")}
    response |= {
        "echo": word("id"),
        "status": word("status"),
        "success": sequence(success),
    }
    commands = mapping({"ack": mapping(response)}, False)
    acknowledge.before += section.comments()
    acknowledge.key, acknowledge.value = word("commands"), commands
    packets.children.append(Child(word("acknowledge"), packet))


def _convert_row(row: Branch, end: int) -> int:
    """Change a row of bytes into a field of a packet. ``end``: end of the row in front of
    it in bytes. Return the end of the row.
    """
    at, size = (value_of(row, key) for key in ("byte", "bytes"))
    first = (
        at.value if isinstance(at, ScalarText) and isinstance(at.value, int) else end
    )
    count = (
        size.value
        if isinstance(size, ScalarText) and isinstance(size.value, int)
        else 1
    )
    role = value_of(row, "role")
    present = _ROLES.get(role.value) if isinstance(role, ScalarText) else None
    if present is None:
        present = "time" if entry_of(row, "format") else "flags"
    field: dict[str, ScalarText | Branch] = {}
    if first != end:
        field["at"] = number(8 * first)
    field |= {"bits": number(8 * count), "role": word(present)}
    unchanged = [entry_of(row, key) for key in ("name", "enum", "summary")]
    row.children = mapping(field).children + [child for child in unchanged if child]
    return first + count


def _convert_unsolicited(uart: Branch, packets: Branch, root: Branch) -> None:
    """Make packets of the telemetry that a node sends unasked on the UART."""
    section = entry_of(uart, "unsolicited")
    rows = items_of(section.value) if section else []
    ids = [_id_of(root, value_of(row.value, "id_of")) for row in rows]
    # An ICD that names a message of another file stays as it is.
    if section is None or not rows or None in ids:
        return
    for row, id in zip(rows, ids, strict=True):
        message = value_of(row.value, "message")
        head = {"bits": number(8), "role": word("constant"), "value": id or number(0)}
        packet: dict[str, ScalarText | Branch] = {
            "from": word("device"),
            "buses": sequence(word("uart")),
            "header": sequence(mapping(head)),
            "messages": sequence(
                message if isinstance(message, ScalarText) else word("")
            ),
        }
        suffix = f" {len(packets.children)}" if len(rows) > 1 else ""
        inside = row.value.comments() if isinstance(row.value, Branch) else []
        comments = [*row.before, *inside, *row.trailing]
        packets.children.append(
            Child(word(f"unasked{suffix}"), mapping(packet, False), comments)
        )
    uart.children.remove(section)


def _id_of(root: Branch, message: object) -> ScalarText | None:
    """Return the id of a message of the file; None without one."""
    item = item_named(value_of(root, "messages"), message)
    id = value_of(item, "id") or value_of(item, "set_id")
    return id if isinstance(id, ScalarText) else None


def _convert_polled(i2c: Branch, polled: object, success: ScalarText) -> None:
    """Let the telemetry that is polled on I2C confirm telecommands."""
    if not _is_mapping(polled):
        return
    response = Branch(True, False, 0)
    move(polled, _POLLED, response)
    response.children.append(Child(word("success"), sequence(success)))
    acknowledge = entry_of(i2c, "acknowledge")
    assert acknowledge is not None
    acknowledge.before += polled.comments()
    acknowledge.key = word("commands")
    acknowledge.value = Branch(True, False, 0, [Child(word("ack"), response)])


def _convert_can(can: Branch, packets: Branch) -> None:
    """Make packets of the message types on CAN, and let them respond."""
    uses: dict[str, dict[str, ScalarText | Branch]] = {}
    for direction, keys in _TYPES.items():
        section = value_of(can, direction)
        for key, (sender, whole_key) in keys.items():
            given, segmented = value_of(section, key), value_of(section, whole_key)
            if isinstance(given, ScalarText):
                use = uses.setdefault(str(given.value), {"from": word(sender)})
                if whole_key and isinstance(segmented, ScalarText):
                    use["segment_of"] = segmented
    types = entry_of(can, "message_types")
    source = value_of(types.value, "source") if types else None
    for row in items_of(value_of(types.value, "values")) if types else ():
        value, packet_name, summary = (
            value_of(row.value, key) for key in ("value", "name", "summary")
        )
        if not isinstance(value, ScalarText) or not isinstance(packet_name, ScalarText):
            continue
        use = uses.get(str(packet_name.value), {"from": word("both")})
        packet: dict[str, ScalarText | Branch] = {}
        if isinstance(source, Branch):
            packet["source"] = source
        packet |= {"from": use.pop("from"), "buses": sequence(word("can"))}
        packet |= {"type": value, **use}
        if isinstance(summary, ScalarText):
            packet["summary"] = summary
        child = Child(packet_name, mapping(packet), row.before, row.trailing)
        packets.children.append(child)
    if types and _is_mapping(types.value):
        can.children.remove(types)
    for direction, present in (("telecommand", "commands"), ("telemetry", "requests")):
        owner = entry_of(can, direction)
        if owner and _is_mapping(owner.value):
            responses = _responses(owner.value, direction)
            owner.before += owner.value.comments()
            owner.key, owner.value = word(present), responses
            if not responses.children:
                can.children.remove(owner)
    if extended := entry_of(can, "extended"):
        extended.key = word("segments")


def _responses(section: Branch, direction: str) -> Branch:
    """Return the responses to telecommands, or to requests of telemetry, on CAN."""
    responses = Branch(True, False, 0)
    move(section, {"source": "source"}, responses)
    keys: Mapping[str, str] = {"acknowledge": "ack", "failure": "nak"}
    if direction == "telemetry":
        keys = {"request": "packet", "failure": "nak"}
    for key, present in keys.items():
        packet = value_of(section, key)
        if isinstance(packet, ScalarText):
            is_response = present != "packet"
            given = mapping({"packet": packet}) if is_response else packet
            responses.children.append(Child(word(present), given))
    return responses
