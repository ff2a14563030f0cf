"""Nodes: what they declare, and what they speak in each direction."""

from __future__ import annotations

from typing import Any, NamedTuple

from icdgen.describe.description import Composite, MessageDescription, StructDescription, Whole
from icdgen.describe.enums import EnumDescription
from icdgen.icd.identifiers import Identifier
from icdgen.icd.model import Node
from icdgen.once import cached_property


class Direction(NamedTuple):
    """What a node speaks in one direction: messages, each with the name of its id there (``id``, ``set_id`` or ``get_id``)."""

    kind: str  # "telecommand" | "telemetry"
    messages: tuple[tuple[MessageDescription, str], ...]


class NodeDescription:
    """A node (``model``) of the set."""

    def __init__(self, description: Whole, node: Node) -> None:
        self._description, self.model, self.name = description, node, node.name

    def identifier(self, scope: str, name: str) -> Identifier:
        """A name that generated code declares for it."""
        return Identifier(scope, name, f"node `{self.name}`", self.model.source)

    @cached_property
    def messages(self) -> tuple[MessageDescription, ...]:
        """Those that it declares."""
        return tuple(map(self._description.message, self.model.messages))

    @cached_property
    def enums(self) -> tuple[EnumDescription, ...]:
        """Those that it declares."""
        return tuple(map(self._description.enum, self.model.enums))

    @cached_property
    def structs(self) -> tuple[StructDescription, ...]:
        """Those that it declares, each after those that it has in it."""
        return tuple(map(self._description.struct, self.model.structs))

    @property
    def composites(self) -> tuple[Composite[Any], ...]:
        """Structs and messages that it declares, each after those that it has in it."""
        return (*self.structs, *self.messages)

    @cached_property
    def spoken(self) -> tuple[MessageDescription, ...]:
        """All messages that it speaks: those of included nodes first."""
        return tuple(map(self._description.message, self._description.icd.messages_of(self.model)))

    @property
    def telecommands(self) -> tuple[MessageDescription, ...]:
        """Those of `spoken` that can be sent to it."""
        return tuple(one for one in self.spoken if one.model.telecommand_id is not None)

    @property
    def telemetry(self) -> tuple[MessageDescription, ...]:
        """Those of `spoken` that can be requested from it."""
        return tuple(one for one in self.spoken if one.model.telemetry_id is not None)

    @property
    def directions(self) -> tuple[Direction, ...]:
        """Telecommands, then telemetry; without one of which it has none."""
        found = (
            Direction("telecommand", tuple((one, one.telecommand_id_name) for one in self.telecommands)),
            Direction("telemetry", tuple((one, one.telemetry_id_name) for one in self.telemetry)),
        )
        return tuple(direction for direction in found if direction.messages)

    @property
    def is_linked(self) -> bool:
        """Whether it is known how its messages travel."""
        return bool(self._description.icd.protocol_of(self.model))

    @property
    def has_client(self) -> bool:
        """Whether requests can be sent on its link, which is not so of an envelope."""
        return self.is_linked and "stream" not in self._description.icd.protocol_of(self.model)

    @property
    def id_bits(self) -> int:
        """Those of the set: see `Description.id_bits`."""
        return self._description.id_bits

    @cached_property
    def log_bits(self) -> dict[int, int]:
        """Telemetry id -> the bit of the log mask that selects it."""
        return {row.id: row.bit for row in self.model.loggable}
