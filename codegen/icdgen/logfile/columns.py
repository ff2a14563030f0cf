"""The columns of a log: which bits of an entry are which field."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Literal

from icdgen import layout, naming
from icdgen.describe.steps import Steps, steps
from icdgen.icd.curve import Curve
from icdgen.icd.frames import FrameField
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.pieces import Piece
from icdgen.protocol.facts import Facts, need
from icdgen.protocol.sections import LogBit

TIME = "time"


@dataclass(frozen=True, slots=True)
class Column:
    """A field of a frame, or a whole slot without a frame. Bytes are counted from the start of an entry."""

    name: str
    frame: str
    message: Message | None
    field: FrameField | None  # None: the slot as it is
    start: int  # of the slot
    length: int
    byte_order: str
    pieces: tuple[Piece, ...]  # of a number, in the entry
    operands: tuple[Column, ...] = ()  # of what is derived, the fields

    @property
    def at(self) -> int:
        """First byte."""
        return self.start + (self.field.at // 8 if self.field else 0)

    @property
    def size(self) -> int:
        """Bytes that it touches."""
        return len(layout.byte_range(self.field)) if self.field else self.length

    @property
    def kind(self) -> str:
        return self.field.type if self.field else "bytes"

    @property
    def unit(self) -> str:
        return self.field.unit_symbol if self.field else ""

    @property
    def steps(self) -> Steps | None:
        """How the physical value is computed from the raw one; None without a scale."""
        return steps(self.field) if self.field is not None else None

    @property
    def curve(self) -> Curve | None:
        """How it is computed in doubles."""
        return self.field.curve if self.field is not None else None


@dataclass(frozen=True, slots=True)
class Plan:
    """How entries of a log with that mask are read. ``seconds``, ``milliseconds``: offset and size."""

    node: Node
    slots: tuple[LogBit, ...]
    entry_bytes: int
    seconds: tuple[int, int]
    milliseconds: tuple[int, int]
    order: Literal["little", "big"]
    columns: tuple[Column, ...]


def plan(icd: Icd, known: Facts, mask: bytes) -> Plan:
    """The columns of all frames that the mask selects. Raises `icdgen.protocol.facts.Unsupported`."""
    form, slot_bytes = need(known.log_file, "telemetry_log"), need(known.mask, "log_mask").slot_bytes
    slots = need(known.mask, "log_mask").selected(mask)
    columns: list[Column] = []
    for number, slot in enumerate(slots):
        columns += _columns(icd, known, slot, form.frames_at + number * slot_bytes)
    return Plan(
        known.node,
        tuple(slots),
        form.frames_at + len(slots) * slot_bytes,
        form.seconds,
        form.milliseconds,
        "little" if known.little else "big",
        tuple(unique(columns)),
    )


def _columns(icd: Icd, known: Facts, slot: LogBit, start: int) -> Iterator[Column]:
    message = known.telemetry.get(slot.id) if slot.id is not None else None
    if message is None:
        yield Column(f"bit_{slot.bit}", slot.name or f"bit {slot.bit}", None, None, start, slot.length, "", ())
    else:
        yield from columns_of(icd, message, start, slot.length)


def columns_of(icd: Icd, message: Message, start: int = 0, length: int | None = None) -> Iterator[Column]:
    """The fields of a message whose bytes begin at ``start``; ``length``: those that lie in so many."""
    owner, size = icd.node(message.node), message.length if length is None else length
    frame = _snake(message.identifier or message.name, owner.vocabulary)
    made: dict[str, Column] = {}
    for field in icd.longest_frame(message):
        of = field.derived.fields if field.derived is not None else ()
        if field.role == "count" or not made.keys() >= set(of) or (not of and field.at + field.bits > size * 8):
            continue
        name = f"{frame}__{_snake(field.alias or field.name, owner.vocabulary)}"
        if field.unit:
            name += f"_{naming.snake(naming.words(field.unit.identifier))}"
        pieces = tuple(p._replace(byte=p.byte + start) for p in layout.pieces(field, owner))
        operands = tuple(made[one] for one in of)
        made[field.name] = Column(name, message.name, message, field, start, size, field.byte_order, pieces, operands)
        yield made[field.name]


def _snake(name: str, vocabulary: tuple[str, ...]) -> str:
    return naming.snake(naming.words(name, vocabulary)) or "unnamed"


def unique(columns: Iterable[Column]) -> Iterator[Column]:
    """The columns, each under a name of its own."""
    seen: set[str] = {TIME}
    for column in columns:
        name, number = column.name, 1
        while name in seen:
            number += 1
            name = f"{column.name}_{number}"
        seen.add(name)
        yield column if name == column.name else replace(column, name=name)
