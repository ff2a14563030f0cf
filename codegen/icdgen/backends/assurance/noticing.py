"""Which golden vectors notice a change of the ICD: what the reference codec would then answer is not what they demand.

A vector is named by its line. A row demands what its frame is decoded to and what that is encoded to, raw and physical; the
line of a field its fresh, special and least values, the numbers that it refuses and what setting its physical value gives.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from itertools import accumulate
from operator import or_
from typing import Any, NamedTuple

from icdgen import codec
from icdgen.icd.layout import FixedNode, Layout, overlay_of
from icdgen.icd.layout_copies import with_enum
from icdgen.icd.model import Enum, Message, Node
from icdgen.icd.places import NodePlace, scalars_in
from icdgen.vectors.lines import MessageLines
from icdgen.vectors.make import MessageVectors, Raw, Row, ascii_text
from icdgen.vectors.settings import NEVER, bits_of, float_of
from icdgen.vectors.write import raw_json

_REFUSED = object()


class LongRow(NamedTuple):
    """A row of the vectors with its frames in the form of the longest frame, zeros for the elements that they lack."""

    row: Row
    frame: bytes
    encoded: bytes
    sent: int  # bits of the longest frame that the encoded frame has


class MessageWatch:
    """The vectors of a message that ``node`` declares."""

    def __init__(self, node: Node, vectors: MessageVectors, lines: MessageLines) -> None:
        self.node, self.message, self.vectors, self.lines = node, vectors.message, vectors, lines

    def layout(self, now: Message) -> list[int]:
        """Return the lines that notice another layout of the message."""
        olds, news = scalars_in(self.message.layout), scalars_in(now.layout)
        if [old.name for old in olds] != [new.name for new in news]:
            return self.places(now, self.node)
        pairs = enumerate(zip(olds, news, strict=True))
        changed = [(index, old, new) for index, (old, new) in pairs if _content(old) != _content(new)]
        if len(changed) > 1 and any(_place(old) != _place(new) for _, old, new in changed):
            # A field can take bits that another one leaves.
            lines = [self.lines.fields[old.name] for _, old, new in changed if self._line_notices(old, new)]
            return lines + self.places(now, self.node)
        return [line for index, _, new in changed for line in self.field(index, new, now)]

    def field(self, index: int, now: NodePlace, message: Message) -> list[int]:
        """Return the lines that notice another field at an index of the message, which then is ``message``."""
        old = scalars_in(self.message.layout)[index]
        if now.derived is not None:
            pairs = zip(self.lines.rows, self.vectors.rows, strict=True)
            return [
                line for line, row in pairs if codec.derived(message, row.raw).get(now.name) != row.raw.get(now.name)
            ]
        lines = [self.lines.fields[old.name]] if self._line_notices(old, now) else []
        needed = {condition.field for condition in (*old.when, *now.when)}
        alone = self._alone(now, *(place for place in scalars_in(message.layout) if place.name in needed))
        rows = zip(self.lines.rows, self._long_rows, self._of_others[index], strict=True)
        return lines + [
            number for number, row, other_bits in rows if _notices(row, old, now, self.node, alone, other_bits)
        ]

    def enum(self, old: Enum, new: Enum) -> list[int]:
        """Return the lines that notice that an enumeration is another."""
        layout = with_enum(self.message.layout, old, new)
        return [] if layout is self.message.layout else self.layout(replace(self.message, layout=layout))

    def places(self, now: Message, node: Node) -> list[int]:
        """Return the lines that notice that bits lie elsewhere, by the layout of the message or the orders of its node."""
        pairs = zip(self.lines.rows, self.vectors.rows, strict=True)
        return [number for number, row in pairs if _answer(node, now, row.frame) != (row.raw, row.encoded)]

    def _alone(self, *fields: NodePlace) -> Message:
        """Return the message with the longest frame in which only these fields are."""
        fixed: list[FixedNode] = []
        for field in fields:
            scalar = replace(
                field.scalar, name=field.name, at=field.at, bits=field.bits, length=None, orders=field.declared_orders
            )
            fixed.append(overlay_of(scalar) if field.view else scalar)
        layout = self.message.layout
        return replace(
            self.message, layout=Layout(layout.name, layout.longest, tuple(fixed), may_end_early=layout.may_end_early)
        )

    def id(self, key: str) -> list[int]:
        """Lines that notice another id: frames are asked for by the id, by the set id where there are two."""
        rows = self.lines.rows[:1] if key == "get_id" else self.lines.rows
        return [self.lines.head, *rows]

    def length(self) -> list[int]:
        """Lines that notice another length."""
        return [self.lines.head, self.lines.lengths, *self.lines.rows]

    def _line_notices(self, old: NodePlace, now: NodePlace) -> bool:
        if self._is_fresh(old) and _shown(old, old.initial_value) != _shown(now, now.initial_value):
            return True
        if [special.value for special in old.special] != [
            special.value for special in now.special
        ] or old.limits != now.limits:
            return True
        unfit = self.vectors.unfit.get(old.name, ())
        if any(part.counter == old.name for part in self.message.layout.parts):
            unfit = [value for value in unfit if not old.raw_min <= value <= old.raw_max]
        if any(_attempt(codec.check_raw, now, value) is not _REFUSED for value in unfit):
            return True
        given = self.vectors.settings.get(old.name, [])
        if not given or old.type == "text":
            return any(_attempt(codec.raw_from_text, now, text) != _given(raw) for text, raw in given)
        if not (now.has_formula and now.is_invertible):
            return True
        attempts = [*given, *((bits, None) for bits in NEVER if old.type != "float")]
        return any(_attempt(codec.raw_from_physical, now, float_of(bits)) != _given(raw) for bits, raw in attempts)

    def _is_fresh(self, field: NodePlace) -> bool:
        """Return whether a new message has a field: it has no elements of a variable-length array."""
        if field.when and field.name not in self._initial:
            return False
        return field.is_count or field.at < 8 * self._initial_length

    @cached_property
    def _initial(self) -> dict[str, int | bytes]:
        """Raw values of a new message."""
        return codec.initial_values(self.node, self.message)

    @cached_property
    def _initial_length(self) -> int:
        return len(codec.encode(self.node, self.message, self._initial))

    @cached_property
    def _long_rows(self) -> list[LongRow]:
        """The rows of the vectors, in the form of the longest frame."""
        return [
            LongRow(
                row,
                self._in_longest(row.frame, row.raw),
                self._in_longest(row.encoded, row.raw),
                _number(self._in_longest(b"\xff" * len(row.encoded), row.raw)),
            )
            for row in self.vectors.rows
        ]

    def _in_longest(self, frame: bytes, raw: Raw) -> bytes:
        """Return the longest frame, with the bytes of a frame of these values where they stand in it."""
        layout = self.message.layout
        longest, remaining = frame[: layout.length].ljust(layout.length, b"\0"), frame[layout.length :]
        for part in layout.parts:
            count = raw[part.counter]
            assert isinstance(count, int), "a counter is a number"
            size = (count + part.plus) * part.step
            longest, remaining = longest + remaining[:size].ljust(part.most * part.step, b"\0"), remaining[size:]
        return longest

    @cached_property
    def _of_others(self) -> list[list[int]]:
        """Of each field, the bits that all other fields set in each row's frame."""
        columns = []
        for field in scalars_in(self.message.layout):
            if field.view or field.is_count:
                columns.append([0] * len(self.vectors.rows))
                continue
            alone = self._alone(replace(field, scalar=replace(field.scalar, present_if=())))
            raws = (row.raw.get(field.name) for row in self.vectors.rows)
            frames = (b"" if raw is None else codec.encode(self.node, alone, {field.name: raw}) for raw in raws)
            columns.append([_number(frame) for frame in frames])
        by_row = []
        for row in zip(*columns, strict=True):
            before = accumulate(row[:-1], or_, initial=0)
            after = list(accumulate(row[:0:-1], or_, initial=0))[::-1]
            by_row.append([a | b for a, b in zip(before, after, strict=True)])
        return [list(column) for column in zip(*by_row, strict=True)]


def _notices(long: LongRow, old: NodePlace, now: NodePlace, node: Node, alone: Message, other_bits: int) -> bool:
    """Return whether a row of the vectors fails with another field.

    `alone` is the message with this field only; `other_bits` are the bits that all other fields set.
    """
    answer = _answer(node, alone, long.frame)
    if answer is None:
        return True
    raw, read, frame = long.row.raw.get(old.name), answer[0].get(now.name), answer[1]
    if raw is None or read is None:
        return raw is not read
    # a view is read from what the others are encoded to, too
    if now.view and codec.decode(node, alone, long.encoded)[now.name] != raw:
        return True
    if _shown(now, read) != _shown(old, raw) or _name(now, read) != _name(old, raw):
        return True
    if now.type == "text" or now.type != old.type or _formula(now) != _formula(old) or now.bits != old.bits:
        if _physical(now, read) != _physical(old, raw):
            return True
        if old.is_invertible and (not now.is_invertible or _set_back(now, read) != _set_back(old, raw)):
            return True  # what does not lead back is not asked to
    return (_number(frame) | other_bits) & long.sent != _number(long.encoded)


def _place(field: NodePlace) -> tuple[object, ...]:
    """Return what gives the bits of a field."""
    return field.at, field.bits, field.declared_orders


def _content(field: NodePlace) -> tuple[object, ...]:
    """Return all that the ICD says about a field."""
    return field.scalar, field.derived, *_place(field)


def _answer(node: Node, message: Message, frame: bytes) -> tuple[Raw, bytes] | None:
    """What a frame is decoded to, and that encoded; None if it is refused."""
    try:
        raw = codec.decode(node, message, frame)
        return raw, codec.encode(node, message, raw)
    except (ValueError, OverflowError):
        return None


def _attempt(call: Callable[..., object], *arguments: object) -> object:
    """What the codec answers, which may be that it refuses."""
    try:
        return call(*arguments)
    except (ValueError, OverflowError):
        return _REFUSED


def _given(raw: object) -> object:
    return _REFUSED if raw is None else raw


def _number(frame: bytes) -> int:
    return int.from_bytes(frame, "little")


def _shown(field: NodePlace, raw: Any) -> object:
    """A raw value in the form in which a language answers: a truth value is no number."""
    return (field.type == "bool", raw_json(field, raw))


def _name(field: NodePlace, raw: Any) -> object:
    """Name of the member; whether there are names at all."""
    if field.enum is None:
        return None
    member = field.enum.member_of(raw)
    return member.name if member else ""


def _physical(field: NodePlace, raw: Any) -> object:
    if field.type == "text":
        return (ascii_text(raw),)
    double = codec.physical_double(field, raw)
    return None if double is None else bits_of(double)


def _set_back(field: NodePlace, raw: Any) -> object:
    """What setting the physical value of the raw value gives."""
    double = None if field.view else codec.physical_double(field, raw)
    return None if double is None else _attempt(codec.raw_from_physical, field, double)


def _formula(field: NodePlace) -> object:
    return field.scale, field.curve
