"""The dispatchers of a node: from an id to the message."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.c.plan import Planner
from icdgen.backends.c.text import literal
from icdgen.icd.model import CONFIGURATION, TELECOMMAND, TELEMETRY, Message, Node


class Case(NamedTuple):
    """A message under its id in one direction."""

    id: str
    stem: str
    type: str
    member: str
    length: str
    text: str


class Dispatcher(NamedTuple):
    """All messages of one direction."""

    kind: str
    name: str
    cases: list[Case]


def dispatchers(node: Node, planner: Planner) -> list[Dispatcher]:
    """Telemetry and telecommands of the node and what it includes; a direction without messages is left out."""
    messages = planner.icd.messages_of(node)
    found = []
    for kind, id_of, suffix in ((TELEMETRY, "telemetry_id", "GET_ID"), (TELECOMMAND, "telecommand_id", "SET_ID")):
        cases = [_case(m, suffix, planner) for m in messages if getattr(m, id_of) is not None]
        if cases:
            found.append(Dispatcher(kind, f"{node.name}_{kind}", cases))
    return found


def _case(message: Message, suffix: str, planner: Planner) -> Case:
    stem = planner.names.message(message)
    upper = stem.upper()
    return Case(
        id=f"{upper}_{suffix}" if message.kind == CONFIGURATION else f"{upper}_ID",
        stem=stem,
        type=f"{stem}_t",
        member=planner.names.file(message),
        length=f"{upper}_LENGTH",
        text=literal(message.name),
    )
