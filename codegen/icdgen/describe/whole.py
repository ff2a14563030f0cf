"""A set of ICDs as a whole: from here the descriptions of its parts are reached, each made once."""

from __future__ import annotations

from icdgen.describe.description import StructDescription
from icdgen.describe.enums import EnumDescription, enum_widths
from icdgen.describe.messages import MessageDescription
from icdgen.describe.nodes import NodeDescription
from icdgen.describe.storage import holding
from icdgen.icd.model import Enum, Icd, Message, Node, Struct
from icdgen.icd.variants import Ids
from icdgen.once import cached_property


class Description:
    """A set of ICDs. ``nodes`` stand in the order of the set: each after those that it includes."""

    def __init__(self, icd: Icd) -> None:
        self.icd = icd
        self._enum_bits = enum_widths(icd)
        self._messages: dict[tuple[str, str], MessageDescription] = {}
        self._enums: dict[tuple[str, str], EnumDescription] = {}
        self._structs: dict[tuple[str, str], StructDescription] = {}
        self._nodes = {node.name: NodeDescription(self, node) for node in icd.nodes}
        self.nodes = tuple(self._nodes.values())

    @cached_property
    def id_bits(self) -> int:
        """8, 16 or 32: bits of the integer that holds every id of the set."""
        used = (id.bit_length() for node in self.icd.nodes for message in node.messages for id in message.ids)
        return holding(max((*(node.id_bits for node in self.icd.nodes), *used), default=8))

    def node(self, node: str | Node) -> NodeDescription:
        """The description of a node, by its name or of the node itself. Raises `KeyError`."""
        return self._nodes[node if isinstance(node, str) else node.name]

    def log_bits(self, node: Node) -> dict[int, int]:
        """See `NodeDescription.log_bits`."""
        return self.node(node).log_bits

    def spoken(self, node: Node) -> tuple[MessageDescription, ...]:
        """See `NodeDescription.spoken`."""
        return self.node(node).spoken

    def known_ids(self, node: Node) -> Ids:
        """See `NodeDescription.known_ids`."""
        return self.node(node).known_ids

    def message(self, message: Message) -> MessageDescription:
        """The description of a message, whoever speaks it."""
        key = message.node, message.name
        found = self._messages.get(key)
        if found is None or found.model is not message:
            found = self._messages[key] = MessageDescription(self, message, self.icd.node(message.node))
        return found

    def struct(self, struct: Struct) -> StructDescription:
        """The description of a struct, whoever uses it."""
        key = struct.node, struct.name
        found = self._structs.get(key)
        if found is None or found.model is not struct:
            found = self._structs[key] = StructDescription(self, struct, self.icd.node(struct.node))
        return found

    def enum(self, enum: Enum) -> EnumDescription:
        """The description of an enumeration, whoever uses it."""
        key = enum.node, enum.name
        found = self._enums.get(key)
        if found is None or found.model is not enum:
            found = self._enums[key] = EnumDescription(enum, self.icd.node(enum.node), self._enum_bits[key], self.icd)
        return found


_kept: list[Description] = []


def describe(icd: Icd) -> Description:
    """The description of a set of ICDs. The last ones are kept, so that the backends of one run share theirs."""
    for known in _kept:
        if known.icd is icd:
            return known
    _kept[:] = [*_kept[-1:], Description(icd)]
    return _kept[-1]
