"""Messages: their fields, the end that may be open, and their ids."""

from __future__ import annotations

from typing import Protocol

from icdgen import layout
from icdgen.describe.comments import Comment, message_comment
from icdgen.describe.description import Composite, FieldDescription, Known, TailDescription
from icdgen.describe.named import Id
from icdgen.describe.shared_ids import sharing
from icdgen.icd.model import Icd, Message, Node, Tail
from icdgen.icd.variants import Ids
from icdgen.once import cached_property


class Whole(Known, Protocol):
    """The set of ICDs that all of this describes: `icdgen.describe.whole.Description`."""

    icd: Icd

    @property
    def id_bits(self) -> int: ...

    def log_bits(self, node: Node) -> dict[int, int]: ...

    def spoken(self, node: Node) -> tuple[MessageDescription, ...]: ...

    def known_ids(self, node: Node) -> Ids: ...

    def message(self, message: Message) -> MessageDescription: ...


class MessageDescription(Composite[Message]):
    """A message."""

    def __init__(self, description: Whole, message: Message, node: Node) -> None:
        super().__init__(description, message, node, "message")
        self._whole = description

    @property
    def has_reserved_bits(self) -> bool:
        """Whether some bits of its frame are those of no field."""
        return bool(layout.gaps(self.model, self.node))

    @cached_property
    def conditional(self) -> tuple[FieldDescription, ...]:
        """The members that are not always there."""
        return tuple(field for field in self.fields if field.model.when)

    @cached_property
    def steady(self) -> tuple[FieldDescription, ...]:
        """Those of `sent_fields` that are in every frame."""
        fields = self.sent_fields
        return tuple(field for field in fields if not field.model.when) if self.conditional else fields

    @cached_property
    def tail(self) -> TailDescription | None:
        """Its open end, where frames differ in length."""
        tail = self.model.tail
        return None if tail is None else self._open_part(tail, self.model.begin)

    @cached_property
    def inner(self) -> tuple[TailDescription, ...]:
        """What is open in front of the tail."""
        return tuple(self._open_part(one, one.begin) for one in self.model.inner)

    def _open_part(self, tail: Tail, begin: int) -> TailDescription:
        part, counter = (
            next(one for one in self.members if one.model.name == name) for name in (tail.name, tail.counter)
        )
        return TailDescription(part, counter, begin, tail)

    @cached_property
    def contained(self) -> tuple[tuple[MessageDescription, int], ...]:
        """The messages that it repeats, each with the bit at which it begins, in the order of the ICD."""
        if not self.model.contains:
            return ()
        known = {one.model.name: one for one in self._whole.spoken(self.node)}
        return tuple((known[one.message], one.at) for one in self.model.contains if one.message in known)

    @cached_property
    def ids(self) -> tuple[Id, ...]:
        """The id, or the set id and the get id."""
        message = self.model
        found = (
            ("id", message.id, f"Id of the {message.kind}."),
            ("set_id", message.set_id, "Id of the telecommand that sets it."),
            ("get_id", message.get_id, "Id of the telemetry that gets it."),
        )
        return tuple(Id(name, value, comment) for name, value, comment in found if value is not None)

    @property
    def telecommand_id_name(self) -> str:
        """Name of the id under which it is sent: ``id`` or ``set_id``."""
        return "id" if self.model.id is not None else "set_id"

    @property
    def telemetry_id_name(self) -> str:
        """Name of the id under which it is requested: ``id`` or ``get_id``."""
        return "id" if self.model.id is not None else "get_id"

    @property
    def is_narrow(self) -> bool:
        """Whether a field of it may be given a raw value that does not fit, or a count."""
        return super().is_narrow or any(one.is_bound for one in (*self.inner, *filter(None, (self.tail,))))

    @cached_property
    def comment(self) -> Comment:
        whole, telemetry_id = self._whole, self.model.telemetry_id
        bit = None if telemetry_id is None else whole.log_bits(self.node).get(telemetry_id)
        return message_comment(self.model, bit, sharing(whole.known_ids(self.node), self.model))
