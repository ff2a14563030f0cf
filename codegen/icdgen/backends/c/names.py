"""The C names of nodes, messages, fields and enumerations."""

from __future__ import annotations

from functools import lru_cache

from icdgen import naming
from icdgen.icd.model import Enum, Field, Icd, Member, Message, Node


class Names:
    """Names of everything in an ICD set. All file-scope names begin with the name of the declaring node."""

    def __init__(self, icd: Icd) -> None:
        self._nodes = {node.name: node for node in icd.nodes}

    def vocabulary(self, node: str) -> tuple[str, ...]:
        return self._nodes[node].vocabulary

    def file(self, message: Message) -> str:
        """``estimated_attitude_angles``: the file without suffix, and the member of the dispatcher's union."""
        return _snake(message, self.vocabulary(message.node))

    def message(self, message: Message) -> str:
        """``demo_estimated_roll``: stem of the functions and the type."""
        return f"{message.node}_{_snake(message, self.vocabulary(message.node))}"

    def enum(self, enum: Enum) -> str:
        """``demo_mode``"""
        return f"{enum.node}_{_snake(enum, self.vocabulary(enum.node))}"

    def member(self, enum: Enum, member: Member) -> str:
        """``DEMO_MODE_IDLE``"""
        return f"{self.enum(enum)}_{_snake(member, self.vocabulary(enum.node))}".upper()

    def field(self, message: Message, field: Field) -> str:
        """``estimated_roll_angle``"""
        return _snake(field, self.vocabulary(message.node))

    def node_of(self, message: Message) -> Node:
        """The node that declares the message."""
        return self._nodes[message.node]


def _snake(named: Message | Field | Enum | Member, vocabulary: tuple[str, ...]) -> str:
    return _joined(named.identifier or named.name, vocabulary)


@lru_cache(maxsize=8192)
def _joined(text: str, vocabulary: tuple[str, ...]) -> str:
    return naming.snake(naming.words(text, vocabulary))


def accessor_unit(field: Field) -> str:
    """What names of the physical value end in: the unit's identifier, or ``physical``."""
    return field.unit.identifier if field.unit else "physical"
