"""Nodes: what they declare and what they speak."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from icdgen.describe.enums import EnumDescription
from icdgen.describe.messages import MessageDescription
from icdgen.icd.model import Node

if TYPE_CHECKING:
    from icdgen.describe import Description


class NodeDescription:
    """A node (``model``) of the set."""

    def __init__(self, description: Description, node: Node) -> None:
        self._description, self.model, self.name = description, node, node.name

    @cached_property
    def messages(self) -> tuple[MessageDescription, ...]:
        """Those that it declares."""
        return tuple(map(self._description.message, self.model.messages))

    @cached_property
    def enums(self) -> tuple[EnumDescription, ...]:
        """Those that it declares."""
        return tuple(map(self._description.enum, self.model.enums))

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
    def is_linked(self) -> bool:
        """Whether it is known how its messages travel."""
        return bool(self._description.icd.protocol_of(self.model))

    @cached_property
    def log_bits(self) -> dict[int, int]:
        """Telemetry id -> the bit of the log mask that selects it."""
        return {row.id: row.bit for row in self.model.loggable}
