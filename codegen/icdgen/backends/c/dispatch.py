"""The dispatchers of a node: from an id to the message."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.c.plan import Planner
from icdgen.backends.c.statement import call, parameters
from icdgen.backends.c.text import literal
from icdgen.icd.model import CONFIGURATION, TELECOMMAND, TELEMETRY, Message, Node


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
    cases: list[Case]
    decode_parameters: str
    encode_parameters: str


def dispatchers(node: Node, planner: Planner) -> list[Dispatcher]:
    """Telemetry and telecommands of the node and what it includes; a direction without messages is left out."""
    messages = planner.icd.messages_of(node)
    found = []
    for kind, id_of, suffix in ((TELEMETRY, "telemetry_id", "GET_ID"), (TELECOMMAND, "telecommand_id", "SET_ID")):
        cases = [_case(m, suffix, planner) for m in messages if getattr(m, id_of) is not None]
        if cases:
            found.append(_dispatcher(kind, f"{node.name}_{kind}", cases))
    return found


def _dispatcher(kind: str, name: str, cases: list[Case]) -> Dispatcher:
    message, buffer = f"{name}_t *ICDGEN_RESTRICT message", "uint8_t *ICDGEN_RESTRICT buffer"
    decode_parameters = parameters(message, "uint16_t id", f"const {buffer}", "size_t length")
    return Dispatcher(kind, name, cases, decode_parameters, parameters(f"const {message}", buffer, "size_t capacity"))


def _case(message: Message, suffix: str, planner: Planner) -> Case:
    stem = planner.names.message(message)
    upper, member = stem.upper(), planner.names.file(message)
    return Case(
        id=f"{upper}_{suffix}" if message.kind == CONFIGURATION else f"{upper}_ID",
        type=f"{stem}_t",
        member=member,
        length=f"{upper}_LENGTH",
        text=literal(message.name),
        decode=call(f"return {stem}_decode", (f"&message->as.{member}", "buffer", "length"), depth=2),
        encode=call(f"return {stem}_encode", (f"&message->as.{member}", "buffer", "capacity"), depth=2),
    )
