"""Columns of a log, and the bits of an entry that they contain.

`plan` returns the layout of the entries for a mask; `columns_of` the columns of one
message, also for recordings of links.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Literal

from icdgen import frame_bits, naming
from icdgen.describe.steps import Steps, steps_of_scale
from icdgen.icd.curve import Curve
from icdgen.icd.frames import FrameField
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.pieces import Piece
from icdgen.protocol.facts import Facts, need
from icdgen.protocol.sections import LogBit

TIME = "time"


@dataclass(frozen=True, slots=True)
class LogColumn:
    """A field of a frame, or a slot of an unassigned bit.

    Offsets count from the start of an entry.
    """

    name: str
    frame: str
    message: Message | None
    field: FrameField | None  # None: the bytes of the slot
    start: int  # of the slot
    length: int
    byte_order: str
    pieces: tuple[Piece, ...]  # bits of a number in the entry
    operands: tuple[LogColumn, ...] = ()  # fields from which a value is derived

    @property
    def at(self) -> int:
        """First byte of the field."""
        return self.start + (self.field.at // 8 if self.field else 0)

    @property
    def size(self) -> int:
        """Number of bytes that contain bits of the field."""
        return len(frame_bits.byte_range(self.field)) if self.field else self.length

    @property
    def kind(self) -> str:
        """Type of the field; ``bytes`` for a slot without a frame."""
        return self.field.type if self.field else "bytes"

    @property
    def unit(self) -> str:
        """Symbol of the unit; empty without one."""
        return self.field.unit_symbol if self.field else ""

    @property
    def steps(self) -> Steps | None:
        """Computation of the physical value, or None without a scale."""
        return steps_of_scale(self.field) if self.field is not None else None

    @property
    def curve(self) -> Curve | None:
        """Calibration of the field, which is computed in doubles, or None."""
        return self.field.curve if self.field is not None else None


@dataclass(frozen=True, slots=True)
class EntryLayout:
    """Layout of the entries of a log with one mask.

    ``seconds`` and ``milliseconds`` are offset and size.
    """

    node: Node
    slots: tuple[LogBit, ...]
    entry_bytes: int
    seconds: tuple[int, int]
    milliseconds: tuple[int, int]
    order: Literal["little", "big"]
    columns: tuple[LogColumn, ...]


def plan(icd: Icd, facts: Facts, mask: bytes) -> EntryLayout:
    """Return the columns of all frames that the mask selects.

    Raise `icdgen.protocol.facts.Unsupported`.
    """
    form = need(facts.log_file, "telemetry_log")
    log_mask = need(facts.mask, "log_mask")
    slot_bytes, slots = log_mask.slot_bytes, log_mask.selected(mask)
    columns: list[LogColumn] = []
    for number, slot in enumerate(slots):
        columns += _columns(icd, facts, slot, form.frames_at + number * slot_bytes)
    return EntryLayout(
        facts.node,
        tuple(slots),
        form.frames_at + len(slots) * slot_bytes,
        form.seconds,
        form.milliseconds,
        "little" if facts.little else "big",
        tuple(unique(columns)),
    )


def _columns(icd: Icd, facts: Facts, slot: LogBit, start: int) -> Iterator[LogColumn]:
    """Return the columns of a slot, which begins at byte ``start`` of an entry."""
    message = facts.telemetry.get(slot.id) if slot.id is not None else None
    if message is None:
        yield LogColumn(
            f"bit_{slot.bit}",
            slot.name or f"bit {slot.bit}",
            None,
            None,
            start,
            slot.length,
            "",
            (),
        )
    else:
        yield from columns_of(icd, message, start, slot.length)


def columns_of(
    icd: Icd, message: Message, start: int = 0, length: int | None = None
) -> Iterator[LogColumn]:
    """Return the columns of a message that begins at byte ``start``.

    ``length`` excludes fields beyond this number of bytes.
    """
    owner, size = icd.node(message.node), message.length if length is None else length
    frame = _snake(message.identifier or message.name, owner.vocabulary)
    columns: dict[str, LogColumn] = {}
    for field in icd.longest_frame(message):
        operand_names = field.derived.fields if field.derived is not None else ()
        if field.role == "count":
            continue
        # A derived field has no bits of its own: it is left out with its operands, and
        # not by its place.
        if operand_names:
            is_in_entry = columns.keys() >= set(operand_names)
        else:
            is_in_entry = field.at + field.bits <= size * 8
        if not is_in_entry:
            continue
        name = f"{frame}__{_snake(field.alias or field.name, owner.vocabulary)}"
        if field.unit:
            name += f"_{naming.snake(naming.words(field.unit.identifier))}"
        pieces = tuple(
            p._replace(byte=p.byte + start) for p in frame_bits.pieces(field, owner)
        )
        operands = tuple(columns[operand] for operand in operand_names)
        columns[field.name] = LogColumn(
            name,
            message.name,
            message,
            field,
            start,
            size,
            field.byte_order,
            pieces,
            operands,
        )
        yield columns[field.name]


def _snake(name: str, vocabulary: tuple[str, ...]) -> str:
    return naming.snake(naming.words(name, vocabulary)) or "unnamed"


def unique(columns: Iterable[LogColumn]) -> Iterator[LogColumn]:
    """Return the columns with unique names. Repeated names get a number."""
    seen: set[str] = {TIME}
    for column in columns:
        name, number = column.name, 1
        while name in seen:
            number += 1
            name = f"{column.name}_{number}"
        seen.add(name)
        yield column if name == column.name else replace(column, name=name)
