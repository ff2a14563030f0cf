"""Responses to telecommands on framed links, as the ICD declares them: ``commands`` of a
`link` for all telecommands, and the key ``response`` of one.

`icdgen.icd.rules.responses` checks them; `icdgen.protocol.responding` makes tables of
them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import ceil
from typing import Any

from icdgen.frozen import NamedTuple
from icdgen.icd.enumeration import Enum
from icdgen.icd.layout import Orders
from icdgen.icd.model import Message, Node
from icdgen.icd.pieces import pieces_at
from icdgen.icd.places import NodePlace

ACK, REPLY, NAK, BUSY, PROGRESS = KINDS = ("ack", "reply", "nak", "busy", "progress")
"""Statement of a response about a telecommand: it was accepted; here is the requested
telemetry; it was refused; the device is busy; it is still being executed.
"""

AGAIN = "again"
"""Statement of a refusal with the reason ``checksum``: the telecommand was damaged on the
line, and may be sent again at once.
"""

NEEDED = (ACK, REPLY)  # a telecommand is done when each of these has arrived
NONE = "none"  # a response that a telecommand does not have
STATUS_SETS = {"success": "", "busy": BUSY, "progress": PROGRESS}
"""Keys of a response with a status -> kind of response for the listed values. A success
is an acknowledge or a reply, as the response itself.
"""

ID = "id"  # in `echo`: the id of the telecommand
HEADER = "header."  # in `echo`: in front of the name of a field of its header
MOST_SOURCES = 4  # different numbers of a telecommand that responses repeat
MOST_BYTES = 4  # of a number that a client compares
ID_BYTES = 4  # of the id of a telecommand, in front of its data
_ID_BYTE = re.compile(r"id\[(\d+)\]")

Section = Mapping[str, Any]


class NumberRun(NamedTuple):
    """Position of a field whose bits are contiguous in a number of at most 4 bytes: the
    first byte, the number of bytes, the lowest bit within the number, and the byte
    order.
    """

    byte: int
    size: int
    shift: int
    little: bool


def declared_responses(commands: Section, message: Message) -> dict[str, Section]:
    """Return the responses to a telecommand by kind, as `responses_in` does.

    ``commands`` contains the responses to all telecommands. The key ``response`` of the
    telecommand overrides them.
    """
    own = message.response
    if own == NONE:
        return {}
    return responses_in({**commands, **(own if isinstance(own, Mapping) else {})})


def responses_in(keys: Section) -> dict[str, Section]:
    """Return the responses of `link: commands`, or of a `response`, by kind.

    A response that is only a name is a mapping with the key ``message`` here.
    """
    rows = {kind: keys[kind] for kind in KINDS if keys.get(kind, NONE) != NONE}
    return {
        kind: row if isinstance(row, Mapping) else {"message": row}
        for kind, row in rows.items()
    }


def echoes_of(row: Section) -> dict[str, str]:
    """Return the numbers that a response repeats: its field -> ``id``, a byte of the id
    such as ``id[0]``, a field of the telecommand, or one of its header such as
    ``header.sequence``.
    """
    echo = row.get("echo", {})
    return {echo: ID} if isinstance(echo, str) else dict(echo)


def reason_of(row: Section) -> str | None:
    """Return the field with the reason of a refusal; None without one."""
    name: str | None = row.get("reason", row.get("status"))
    return name


def status_of(kind: str, row: Section) -> str | None:
    """Return the field whose values distinguish the meanings of a response; None
    without one.

    That of a refusal is its reason, if some reasons mean that the device is busy.
    """
    if kind == NAK:
        return reason_of(row) if BUSY in row else None
    name: str | None = row.get("status")
    return name


def id_byte_of(node: Node, name: str) -> int | None:
    """Return the position of a byte such as ``id[0]`` in an id of 4 bytes, from 0 for
    the most significant byte; None for any other name.

    ``id[0]`` is the most significant byte of an id of the node.
    """
    match, size = _ID_BYTE.fullmatch(name), ceil(node.id_bits / 8)
    index = int(match[1]) if match else size
    # Clients store each id in 4 bytes, with zeros in front of a shorter id.
    return ID_BYTES - size + index if index < size else None


def field_of(message: Message, name: str | None) -> NodePlace | None:
    """Return a scalar by its name; None without one."""
    return next((place for place in message.fields if place.name == name), None)


def number_run(place: NodePlace, node: Node) -> NumberRun | None:
    """Return the position of a field as a number.

    None if the field has no bits, if its bits are not contiguous in the number, or if
    they extend over more than 4 bytes.
    """
    orders = place.orders_in_effect(Orders(node.byte_order, node.bit_order))
    pieces = pieces_at(place.at, place.bits, orders.byte, orders.bit)
    upwards = sorted(pieces, key=lambda piece: piece.at)
    # Only the lowest bits can begin, and only the highest end, within a byte.
    is_run = all(piece.reaches_top for piece in upwards[:-1]) and not any(
        piece.shift for piece in upwards[1:]
    )
    if not pieces or len(pieces) > MOST_BYTES or not is_run:
        return None
    little = orders.byte == "little"
    return NumberRun(pieces[0].byte, len(pieces), upwards[0].shift, little)


def number_of(value: object, enum: Enum | None) -> int | None:
    """Return a value that is given as a number or as a member of an enumeration; None if
    there is no such member.
    """
    if isinstance(value, int):
        return int(value)
    members = enum.members if enum else ()
    return next((member.value for member in members if member.name == value), None)
