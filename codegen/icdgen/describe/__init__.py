"""What every output says of an ICD, worked out once and in no language: names in words, widths of integers, steps of scales,
values with names, and the paragraphs of comments. A backend only spells it.

`describe` gives the `Description` of a set of ICDs; from there ``node``, ``message`` and ``enum`` lead to the parts.
"""

from __future__ import annotations

from icdgen.describe.enums import EnumDescription, enum_widths
from icdgen.describe.fields import FieldDescription
from icdgen.describe.messages import MessageDescription
from icdgen.describe.nodes import NodeDescription
from icdgen.icd.model import Enum, Icd, Message, Node

__all__ = [
    "Description",
    "EnumDescription",
    "FieldDescription",
    "MessageDescription",
    "NodeDescription",
    "describe",
]


class Description:
    """A set of ICDs. ``nodes`` stand in the order of the set: each after those that it includes."""

    def __init__(self, icd: Icd) -> None:
        self.icd = icd
        self._enum_bits = enum_widths(icd)
        self._messages: dict[tuple[str, str], MessageDescription] = {}
        self._enums: dict[tuple[str, str], EnumDescription] = {}
        self._nodes = {node.name: NodeDescription(self, node) for node in icd.nodes}
        self.nodes = tuple(self._nodes.values())

    @property
    def id_bits(self) -> int:
        """8 or 16: bits of the integer that holds every id."""
        return 8 if all(id < 256 for n in self.icd.nodes for m in n.messages for id in m.ids) else 16

    def node(self, node: str | Node) -> NodeDescription:
        """The description of a node, by its name or of the node itself. Raises `KeyError`."""
        return self._nodes[node if isinstance(node, str) else node.name]

    def message(self, message: Message) -> MessageDescription:
        """The description of a message, whoever speaks it."""
        key = message.node, message.name
        found = self._messages.get(key)
        if found is None or found.model is not message:
            found = self._messages[key] = MessageDescription(self, message, self.icd.node(message.node))
        return found

    def enum(self, enum: Enum) -> EnumDescription:
        """The description of an enumeration, whoever uses it."""
        key = enum.node, enum.name
        found = self._enums.get(key)
        if found is None or found.model is not enum:
            found = self._enums[key] = EnumDescription(enum, self.icd.node(enum.node), self._enum_bits[key])
        return found


_kept: list[Description] = []


def describe(icd: Icd) -> Description:
    """The description of a set of ICDs. The last ones are kept, so that the backends of one run share theirs."""
    for known in _kept:
        if known.icd is icd:
            return known
    _kept[:] = [*_kept[-1:], Description(icd)]
    return _kept[-1]
