"""Detection of a change of the ICD by golden vectors: a vector detects it if the
reference codec responds differently.

A line number identifies a vector. The line of a row states the values that its frame
decodes to, raw and physical, and the frame that they encode to. The line of a field
states its initial, special and limit values, refused raw values, and results of its
setter.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from itertools import accumulate
from operator import or_
from typing import Any

from icdgen import codec
from icdgen.frozen import NamedTuple
from icdgen.icd.frames import frame_fields
from icdgen.icd.layout import Layout, PlacedNode
from icdgen.icd.layout_copies import with_enum
from icdgen.icd.layout_nodes import overlay_of
from icdgen.icd.model import Enum, Message, Node
from icdgen.icd.places import NodePlace, scalars_in
from icdgen.vectors.lines import MessageLines
from icdgen.vectors.make import FrameVector, MessageVectors, RawValues, ascii_text
from icdgen.vectors.settings import NEVER, bits_of, float_of
from icdgen.vectors.write import raw_json

# A value that no call returns: None is a result of some.
_REFUSED = object()


class LongRow(NamedTuple):
    """Row of the vectors with its frames extended to the longest frame; missing
    elements are zeros.
    """

    row: FrameVector
    frame: bytes
    encoded: bytes
    sent: int  # mask of the bits that the encoded frame contains


class MessageWatch:
    """Golden vectors of a message that ``node`` declares, with detection of changes."""

    def __init__(
        self, node: Node, vectors: MessageVectors, lines: MessageLines
    ) -> None:
        self.node = node
        self.message = vectors.message
        self.vectors = vectors
        self.lines = lines

    def detect_layout(self, now: Message) -> list[int]:
        """Return the lines that detect another layout of the message."""
        olds, news = scalars_in(self.message.layout), scalars_in(now.layout)
        # Another number of elements, for example: the fields have no counterparts.
        if [old.name for old in olds] != [new.name for new in news]:
            return self.detect_places(now, self.node)
        pairs = enumerate(zip(olds, news, strict=True))
        changed = [
            (index, old, new)
            for index, (old, new) in pairs
            if _attributes_of(old) != _attributes_of(new)
        ]
        # With several moved fields, decode the whole message; otherwise one field at a
        # time, which is faster.
        if len(changed) > 1 and any(
            _bit_attributes(old) != _bit_attributes(new) for _, old, new in changed
        ):
            # A field can take bits that another one leaves.
            lines = [
                self.lines.fields[old.name]
                for _, old, new in changed
                if self._field_line_detects(old, new)
            ]
            return lines + self.detect_places(now, self.node)
        return [
            line
            for index, _, new in changed
            for line in self.detect_field(index, new, now)
        ]

    def detect_field(self, index: int, now: NodePlace, message: Message) -> list[int]:
        """Return the lines that detect another field at an index of the message.

        ``message``: changed message.
        """
        old = scalars_in(self.message.layout)[index]
        # Derived values follow from the decoded values, so no frame is decoded again.
        if now.derived is not None:
            pairs = zip(self.lines.rows, self.vectors.rows, strict=True)
            return [
                line
                for line, row in pairs
                if codec.derived_values(message, row.raw).get(now.name)
                != row.raw.get(now.name)
            ]
        lines = (
            [self.lines.fields[old.name]] if self._field_line_detects(old, now) else []
        )
        # The reduced message must contain the fields on which the presence depends.
        needed = {condition.field for condition in (*old.conditions, *now.conditions)}
        reduced_message = self._message_of(
            now,
            *(place for place in scalars_in(message.layout) if place.name in needed),
        )
        rows = zip(
            self.lines.rows,
            self._long_rows,
            self._bits_of_other_fields[index],
            strict=True,
        )
        return lines + [
            number
            for number, row, other_bits in rows
            if _row_detects(row, old, now, self.node, reduced_message, other_bits)
        ]

    def detect_enum(self, old: Enum, new: Enum) -> list[int]:
        """Return the lines that detect a changed enumeration."""
        layout = with_enum(self.message.layout, old, new)
        return (
            []
            if layout is self.message.layout
            else self.detect_layout(replace(self.message, layout=layout))
        )

    def detect_places(self, now: Message, node: Node) -> list[int]:
        """Return the lines that detect other positions of bits, by the layout of the
        message or the orders of its node.
        """
        pairs = zip(self.lines.rows, self.vectors.rows, strict=True)
        return [
            number
            for number, row in pairs
            if _codec_result(node, now, row.frame) != (row.raw, row.encoded)
        ]

    def _message_of(self, *fields: NodePlace) -> Message:
        """Return the message in its longest form, reduced to the given fields."""
        fixed: list[PlacedNode] = []
        for field in fields:
            scalar = replace(
                field.scalar,
                name=field.name,
                at=field.at,
                bits=field.bits,
                length=None,
                orders=field.declared_orders,
            )
            fixed.append(overlay_of(scalar) if field.is_read_only else scalar)
        layout = self.message.layout
        return replace(
            self.message,
            layout=Layout(
                layout.name,
                layout.longest,
                tuple(fixed),
                may_end_early=layout.may_end_early,
            ),
        )

    def detect_id(self, key: str) -> list[int]:
        """Return the lines that detect another id.

        Frames are requested by the set id if a message has two ids.
        """
        rows = self.lines.rows[:1] if key == "get_id" else self.lines.rows
        return [self.lines.head, *rows]

    def detect_length(self) -> list[int]:
        """Return the lines that detect another length."""
        return [self.lines.head, self.lines.lengths, *self.lines.rows]

    def _field_line_detects(self, old: NodePlace, now: NodePlace) -> bool:
        if self._is_in_new_message(old) and _typed_raw(
            old, old.initial_value
        ) != _typed_raw(now, now.initial_value):
            return True
        if [special.value for special in old.special] != [
            special.value for special in now.special
        ] or old.limits != now.limits:
            return True
        unfit = self.vectors.refused_raws.get(old.name, ())
        # The message, and not the field, refuses a count that fits its bits but not the
        # frame.
        if any(part.counter == old.name for part in self.message.layout.counted_parts):
            unfit = [
                value for value in unfit if not old.raw_min <= value <= old.raw_max
            ]
        if any(
            _attempt(codec.check_raw, now, value) is not _REFUSED for value in unfit
        ):
            return True
        # The vectors call the setter of a physical value, or that of a text.
        assignments = self.vectors.assignments.get(old.name, [])
        if not assignments or old.type == "text":
            return any(
                _attempt(codec.raw_from_text, now, text) != _expected(raw)
                for text, raw in assignments
            )
        # Without an inverse there is no setter, which the vectors call.
        if not (now.has_formula and now.is_invertible):
            return True
        # Of floats, `assignments` include these values, because a float can have them.
        attempts = [
            *assignments,
            *((bits, None) for bits in NEVER if old.type != "float"),
        ]
        return any(
            _attempt(codec.raw_from_physical, now, float_of(bits)) != _expected(raw)
            for bits, raw in attempts
        )

    def _is_in_new_message(self, field: NodePlace) -> bool:
        """Return whether a new message contains a field: its variable-length arrays are
        empty.
        """
        # An absent optional field has no initial value.
        if field.conditions and field.name not in self._initial:
            return False
        return field.is_count or field.name in self._initial_names

    @cached_property
    def _initial(self) -> dict[str, int | bytes]:
        """Raw values of a new message."""
        return codec.initial_values(self.node, self.message)

    @cached_property
    def _initial_names(self) -> frozenset[str]:
        """Names of the scalars with bits in the frame of a new message."""
        sizes = codec.sizes_from_counters(self.message, self._initial)
        fields = frame_fields(self.message.layout, self.node.orders, sizes)
        with_bits = (f for f in fields if f.role in ("field", "overlay") and f.bits)
        return frozenset(field.name for field in with_bits)

    @cached_property
    def _long_rows(self) -> list[LongRow]:
        """Rows of the vectors, extended to the longest frame."""
        return [
            LongRow(
                row,
                self._in_longest(row.frame, row.raw),
                self._in_longest(row.encoded, row.raw),
                _frame_number(self._in_longest(b"\xff" * len(row.encoded), row.raw)),
            )
            for row in self.vectors.rows
        ]

    def _in_longest(self, frame: bytes, raw: RawValues) -> bytes:
        """Return the longest frame with the bytes of a shorter frame at their
        positions.

        ``raw``: values of the frame.
        """
        sizes = codec.sizes_from_counters(self.message, raw)
        return self.message.layout.in_longest(frame, sizes)

    @cached_property
    def _bits_of_other_fields(self) -> list[list[int]]:
        """For each field, the bits that all other fields set in the frame of each row."""
        columns = []
        for field in scalars_in(self.message.layout):
            if field.is_read_only or field.is_count:
                columns.append([0] * len(self.vectors.rows))
                continue
            reduced_message = self._message_of(
                replace(field, scalar=replace(field.scalar, present_if=()))
            )
            raws = (row.raw.get(field.name) for row in self.vectors.rows)
            frames = (
                (
                    b""
                    if raw is None
                    else codec.encode(self.node, reduced_message, {field.name: raw})
                )
                for raw in raws
            )
            columns.append([_frame_number(frame) for frame in frames])
        by_row = []
        # Prefix and suffix OR: linear in the number of fields instead of quadratic.
        for row in zip(*columns, strict=True):
            before = accumulate(row[:-1], or_, initial=0)
            after = list(accumulate(row[:0:-1], or_, initial=0))[::-1]
            by_row.append([a | b for a, b in zip(before, after, strict=True)])
        return [list(column) for column in zip(*by_row, strict=True)]


def _row_detects(
    long: LongRow,
    old: NodePlace,
    now: NodePlace,
    node: Node,
    reduced_message: Message,
    other_bits: int,
) -> bool:
    """Return whether a row of the vectors fails with another field.

    ``reduced_message``: message with this field only. ``other_bits``: bits that all
    other fields set.
    """
    answer = _codec_result(node, reduced_message, long.frame)
    if answer is None:
        return True
    raw, read, frame = long.row.raw.get(old.name), answer[0].get(now.name), answer[1]
    # Both must be absent.
    if raw is None or read is None:
        return raw is not read
    # An overlay must have the value in the encoded frame too.
    if (
        now.is_read_only
        and codec.decode(node, reduced_message, long.encoded)[now.name] != raw
    ):
        return True
    if _typed_raw(now, read) != _typed_raw(old, raw) or _member_name(
        now, read
    ) != _member_name(old, raw):
        return True
    if (
        now.type == "text"
        or now.type != old.type
        or _formula(now) != _formula(old)
        or now.bits != old.bits
    ):
        if _physical_bits(now, read) != _physical_bits(old, raw):
            return True
        if old.is_invertible and (
            not now.is_invertible or _set_back(now, read) != _set_back(old, raw)
        ):
            return True  # a non-invertible calibration has no setter
    # The other fields keep their bits, so that the frame is the union of both.
    return (_frame_number(frame) | other_bits) & long.sent != _frame_number(
        long.encoded
    )


def _bit_attributes(field: NodePlace) -> tuple[object, ...]:
    """Return the attributes that determine the bits of a field."""
    return field.at, field.bits, field.declared_orders


def _attributes_of(field: NodePlace) -> tuple[object, ...]:
    """Return all attributes of a field in the ICD."""
    return field.scalar, field.derived, *_bit_attributes(field)


def _codec_result(
    node: Node, message: Message, frame: bytes
) -> tuple[RawValues, bytes] | None:
    """Return the decoded values of a frame and their encoding; None if the codec
    refuses it.
    """
    try:
        raw = codec.decode(node, message, frame)
        return raw, codec.encode(node, message, raw)
    except (ValueError, OverflowError):
        return None


def _attempt(call: Callable[..., object], *arguments: object) -> object:
    """Return the result of the codec, or `_REFUSED` if it refuses the arguments."""
    try:
        return call(*arguments)
    except (ValueError, OverflowError):
        return _REFUSED


def _expected(raw: object) -> object:
    return _REFUSED if raw is None else raw


def _frame_number(frame: bytes) -> int:
    # Bit w of byte b is bit 8 * b + w, for any length of the frame.
    return int.from_bytes(frame, "little")


def _typed_raw(field: NodePlace, raw: Any) -> object:
    """Return a raw value as languages represent it: a boolean differs from a number."""
    return (field.type == "bool", raw_json(field, raw))


def _member_name(field: NodePlace, raw: Any) -> object:
    """Return the name of the member, empty for an unknown value, and None without an
    enumeration.
    """
    if field.enum is None:
        return None
    member = field.enum.member_of(raw)
    return member.name if member else ""


def _physical_bits(field: NodePlace, raw: Any) -> object:
    if field.type == "text":
        return (ascii_text(raw),)
    double = codec.physical_double(field, raw)
    # As bits: NaN is not equal to itself, and -0.0 equals 0.0.
    return None if double is None else bits_of(double)


def _set_back(field: NodePlace, raw: Any) -> object:
    """Return the raw value that results from setting the physical value of a raw value."""
    double = None if field.is_read_only else codec.physical_double(field, raw)
    return None if double is None else _attempt(codec.raw_from_physical, field, double)


def _formula(field: NodePlace) -> object:
    return field.scale, field.curve
