"""Messages that play a part in a procedure -> where their numbers stand."""

from __future__ import annotations

from icdgen import codec, layout
from icdgen.backends.rust.literals import Optional, Part, Raw, Rows, Struct, flat
from icdgen.describe.fresh import fresh_values
from icdgen.icd.model import Field, Message
from icdgen.naming import camel
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import Step

ROLES = frozenset(
    (
        "all", "block_size", "busy", "checksum", "counter", "destination", "error", "ignore_hole_map", "interface_version",
        "length", "node_type", "number", "offset", "program", "ready", "size", "time", "type",
    )
)  # fmt: skip
NUMBER_BITS = 32  # of what the wire layer handles


def field_of(message: Message, name: str) -> Field | None:
    """The field of that name."""
    return next((field for field in message.fields if field.name == name), None)


def place(known: Facts, message: Message, name: str) -> Rows | Raw:
    """Where a number stands."""
    field = field_of(message, name)
    if field is None:
        return Raw("&[]")
    pieces = [
        f"Piece {{ byte: {one.byte}, shift: {one.shift}, bits: {one.bits}, at: {one.at} }}"
        for one in layout.pieces(field, known.node)
    ]
    return Raw(f"&[{', '.join(pieces)}]")


def step(known: Facts, given: Step | None, direction: str) -> Struct | None:
    """A message in a procedure; None if the node does not have it in that direction."""
    if given is None:
        return None
    message = given.message
    id = message.telecommand_id if direction == "telecommand" else message.telemetry_id
    if id is None:
        return None
    places, payload = [], None
    for role, name in given.fields.items():
        field = field_of(message, name)
        if field is None:
            continue
        if field.type == "bytes":
            payload = flat("Span", at=field.at // 8, bytes=field.bits // 8)
        elif role in ROLES and field.bits <= NUMBER_BITS:
            places.append((Raw(f"Role::{camel(tuple(role.split('_')))}"), place(known, message, name)))
    return Struct(
        "Step",
        (
            Part("id", id),
            Part("fresh", fresh(known, message)),
            Part("places", Rows(places)),
            Part("payload", Optional(payload)),
        ),
    )


def fresh(known: Facts, message: Message) -> bytes:
    """The frame of a fresh message."""
    return codec.encode(known.node, message, fresh_values(message))
