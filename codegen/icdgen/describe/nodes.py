"""Nodes: what they declare, and what they speak in each direction under which ids."""

from __future__ import annotations

from typing import Any, NamedTuple

from icdgen.describe.description import Composite, StructDescription
from icdgen.describe.enums import EnumDescription
from icdgen.describe.messages import MessageDescription, Whole
from icdgen.icd.identifiers import Identifier
from icdgen.icd.model import Node
from icdgen.icd.variants import Ids, Variant, common_length, ids_of
from icdgen.layout import Sign, signs
from icdgen.once import cached_property


class Direction(NamedTuple):
    """What a node speaks in one direction: messages, each with the name of its id there (``id``, ``set_id`` or ``get_id``)."""

    kind: str  # "telecommand" | "telemetry"
    messages: tuple[tuple[MessageDescription, str], ...]


class Candidate(NamedTuple):
    """A message under an id, the name of its id there, and what bytes show that a frame of its length is it."""

    message: MessageDescription
    id_name: str
    signs: tuple[Sign, ...]


class Under(NamedTuple):
    """The messages of one id, in the order in which a frame is tried with them."""

    id: int
    candidates: tuple[Candidate, ...]
    length: int | None  # that all of them have; None if they have several

    @property
    def first(self) -> Candidate:
        """One of them, whose constant says the id."""
        return self.candidates[0]

    @property
    def is_shared(self) -> bool:
        """Whether it takes more than the id to know the message."""
        return len(self.candidates) > 1

    @property
    def rest(self) -> Candidate | None:
        """The candidate that is left when the frame is none of the others: nothing but its length may be wrong."""
        last = self.candidates[-1]
        return last if not self.is_shared or (self.length is not None and not last.signs) else None

    @property
    def tried(self) -> tuple[Candidate, ...]:
        """Those that a frame has to be looked at for."""
        return self.candidates if self.rest is None else self.candidates[:-1]


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

    def ids(self, direction: str) -> tuple[Under, ...]:
        """The messages of a direction by their ids, in the order of the ICD."""
        return self._ids[direction]

    def shares_ids(self, direction: str) -> bool:
        """Whether messages of the direction have an id in common."""
        return any(one.is_shared for one in self._ids[direction])

    def shares_id(self, direction: str, message: MessageDescription) -> bool:
        """Whether it takes more than the id to know the message."""
        shared = (one.candidates for one in self._ids[direction] if one.is_shared)
        return any(one.message is message for among in shared for one in among)

    @cached_property
    def known_ids(self) -> Ids:
        """All messages that it speaks, by their ids."""
        return ids_of(self._description.icd, self.model)

    @cached_property
    def _ids(self) -> dict[str, tuple[Under, ...]]:
        known = self.known_ids
        named = {"telecommand": "set_id", "telemetry": "get_id"}
        return {
            direction: tuple(self._under(other, id, those) for id, those in getattr(known, direction).items())
            for direction, other in named.items()
        }

    def _under(self, other_name: str, id: int, variants: tuple[Variant, ...]) -> Under:
        candidates = (
            Candidate(
                self._description.message(one.message), "id" if one.message.id is not None else other_name, signs(one)
            )
            for one in variants
        )
        return Under(id, tuple(candidates), common_length(variants))

    @property
    def is_linked(self) -> bool:
        """Whether it is known how its messages travel."""
        return bool(self._description.icd.protocol_of(self.model))

    @property
    def has_client(self) -> bool:
        """Whether its link has messages with an id of one byte: the client, procedures and logs are for such."""
        return self.is_linked and "stream" not in self._description.icd.protocol_of(self.model)

    @property
    def id_bits(self) -> int:
        """Those of the set: see `Description.id_bits`."""
        return self._description.id_bits

    @cached_property
    def log_bits(self) -> dict[int, int]:
        """Telemetry id -> the bit of the log mask that selects it."""
        return {row.id: row.bit for row in self.model.loggable}
