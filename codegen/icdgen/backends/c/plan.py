"""What is decided about a message before anything is written: names, types, runs."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.c.names import Names
from icdgen.backends.c.runs import Flags, Row, runs
from icdgen.backends.c.storage import Storage, Storages
from icdgen.icd.model import Field, Icd, Message, Node

EMPTY = "empty"
"""Member of the struct of a message without fields: C has no empty structs."""


class Member(NamedTuple):
    """A field with its name and storage; ``storage`` means nothing for a byte array."""

    field: Field
    name: str
    storage: Storage


class Plan(NamedTuple):
    """A message with its C names."""

    message: Message
    node: Node
    stem: str  # "demo_estimated_roll"
    file: str  # "estimated_attitude_angles"
    members: tuple[Member, ...]
    runs: dict[int, Flags | Row]

    @property
    def type(self) -> str:
        return f"{self.stem}_t"

    @property
    def names(self) -> list[str]:
        return [member.name for member in self.members]


class Planner:
    """Makes plans for the messages of one set of ICDs."""

    def __init__(self, icd: Icd) -> None:
        self.icd = icd
        self.names = Names(icd)
        self.storages = Storages(icd, self.names)

    def plan(self, message: Message) -> Plan:
        """The plan of a message."""
        node = self.names.node_of(message)
        of = self.storages.of
        members = tuple(Member(f, self.names.field(message, f), of(f)) for f in message.fields)
        found = runs(message.fields, [m.storage for m in members], node)
        return Plan(message, node, self.names.message(message), self.names.file(message), members, found)
