"""The dispatchers of a node: from an id to the message."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.c import names
from icdgen.backends.c.statement import call, head
from icdgen.backends.c.text import literal
from icdgen.describe import MessageDescription, NodeDescription


class Case(NamedTuple):
    """A message under its id in one direction."""

    id: str
    type: str
    member: str
    length: str
    text: str
    decode: str
    encode: str


class Dispatcher(NamedTuple):
    """All messages of one direction."""

    kind: str
    name: str
    id_type: str
    cases: list[Case]
    decode_head: str
    encode_head: str


def dispatchers(node: NodeDescription, id_bits: int) -> list[Dispatcher]:
    """Telemetry and telecommands of the node and what it includes; a direction without messages is left out."""
    directions = (
        ("telemetry", [_case(m, m.telemetry_id_name) for m in node.telemetry]),
        ("telecommand", [_case(m, m.telecommand_id_name) for m in node.telecommands]),
    )
    return [_dispatcher(kind, f"{node.name}_{kind}", f"uint{id_bits}_t", cases) for kind, cases in directions if cases]


def _dispatcher(kind: str, name: str, id_type: str, cases: list[Case]) -> Dispatcher:
    message, buffer = f"{name}_t *ICDGEN_RESTRICT message", "uint8_t *ICDGEN_RESTRICT buffer"
    decode_parameters = message, f"{id_type} id", f"const {buffer}", "size_t length"
    encode_parameters = f"const {message}", buffer, "size_t capacity"
    decode_head = head("icd_status_t ", f"{name}_decode", *decode_parameters)
    return Dispatcher(
        kind, name, id_type, cases, decode_head, head("icd_status_t ", f"{name}_encode", *encode_parameters)
    )


def _case(message: MessageDescription, id_name: str) -> Case:
    stem, member = names.stem(message), f"&message->as.{message.name}"
    return Case(
        id=names.constant(message, id_name),
        type=f"{stem}_t",
        member=message.name,
        length=names.constant(message, "length"),
        text=literal(message.model.name),
        decode=call(f"return {stem}_decode", (member, "buffer", "length"), depth=2),
        encode=call(f"return {stem}_encode", (member, "buffer", "capacity"), depth=2),
    )
