"""Decoded frame: a message with its bytes and the value of each field.

`decoded_frame` makes it from the bytes of a frame. Encoding (`icdgen.values.encode`)
returns it, too. `icdgen.values.text` shows it as a table.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from dataclasses import field as dataclass_field
from fractions import Fraction

from icdgen import codec, frame_bits
from icdgen.describe.bounds import bounds_of_limits
from icdgen.describe.display import digits_of, integer_text, number_text
from icdgen.describe.numbers import bit_range, exact_text, value_text
from icdgen.icd import floats
from icdgen.icd.frames import FrameField, frame_fields
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.pieces import pieces_at
from icdgen.icd.places import AnyScalar
from icdgen.protocol import facts
from icdgen.protocol.packet_formats import Stream


@dataclass(frozen=True, slots=True)
class FieldValue:
    """Value of a field in a frame."""

    field: FrameField
    raw: int | bytes  # as in `icdgen.codec`: of a float its IEEE 754 bits
    remarks: tuple[str, ...] = ()

    @property
    def physical(self) -> Fraction | None:
        """Exact physical value of a field with a scale; None for any other field."""
        return (
            None
            if isinstance(self.raw, bytes)
            else codec.physical(self.field, self.raw)
        )

    @property
    def number(self) -> float | None:
        """Physical value as the nearest double, or the number of a float field; None
        for any other field.
        """
        if isinstance(self.raw, bytes):
            return None
        if self.field.type == "float" and self.field.curve is None:
            return codec.float_value(self.field, self.raw)
        return codec.physical_double(self.field, self.raw)

    @property
    def member(self) -> str | None:
        """Name of the member of the enumeration; None if no member has the value."""
        member = self.field.enum.member_of(self.raw) if self.field.enum else None
        return member.name if member else None

    @property
    def raw_text(self) -> str:
        """Raw value as text: a number in its display format, floats and bytes in
        hexadecimal; empty for derived values.
        """
        if self.field.derived is not None:
            return ""
        if isinstance(self.raw, bytes):
            return self.raw.hex(" ")
        if self.field.type == "float":
            return f"0x{self.raw:0{self.field.bits // 4}X}"
        return integer_text(self.field, self.raw)

    @property
    def text(self) -> str:
        """Value as text: the physical value, the name of the member, true or false."""
        kind = self.field.type
        if isinstance(self.raw, bytes):
            return codec.text(self.raw) if kind == "text" else self.raw_text
        if kind == "enum":
            return (
                self.member if self.member is not None else f"unknown {self.raw_text}"
            )
        if kind == "bool":
            return "true" if self.raw else "false"
        # Without a display format, a float is shown as the shortest decimal that
        # identifies it.
        is_rounded = kind == "float" and digits_of(self.field) is not None
        if self.number is not None and (self.field.curve is not None or is_rounded):
            return number_text(self.field, self.number)
        if kind == "float":
            return floats.text_of(
                codec.float_value(self.field, self.raw), self.field.bits
            )
        physical = self.physical
        return self.raw_text if physical is None else number_text(self.field, physical)

    def to_json(self) -> dict[str, object]:
        """Return the field as values for JSON: ``{"name", "type", "raw", "value",
        ...}``.

        ``value`` is the one to display.
        """
        kind = self.field.type
        raw: object = self.raw
        value: object
        if isinstance(self.raw, bytes):
            raw = self.raw.hex()
            value = codec.text(self.raw) if kind == "text" else raw
        elif kind == "float":
            # Bits in hexadecimal, because JSON has no NaN.
            raw = f"{self.raw:0{self.field.bits // 4}x}"
            # Not `or`: a negative zero is false, but keeps its sign.
            number = 0.0 if self.number is None else self.number
            # JSON has no NaN and no infinity.
            value = number if math.isfinite(number) else repr(number)
        elif kind == "bool":
            raw = value = bool(self.raw)
        elif kind == "enum":
            value = self.member
        else:
            value = self.raw if self.number is None else self.number
        result: dict[str, object] = {
            "name": self.field.name,
            "type": kind,
            "raw": raw,
            "value": value,
        }
        if self.physical is not None:
            result |= {"physical": self.number, "exact": str(self.physical)}
        elif kind == "float" or self.field.curve is not None:
            result["physical"] = value
        if self.field.unit:
            result["unit"] = self.field.unit.symbol
        if self.field.enum:
            result["enum"] = self.field.enum.name
        if self.remarks:
            result["remarks"] = list(self.remarks)
        return result


@dataclass(frozen=True, slots=True)
class DecodedFrame:
    """A decoded frame."""

    # The node that the message was looked up in; an included node can declare the
    # message.
    node: Node
    message: Message
    data: bytes
    rows: tuple[FieldValue, ...]
    remarks: tuple[str, ...] = ()  # about the frame, not about one field
    # Framing of the node.
    form: Stream | None = dataclass_field(default=None, compare=False, repr=False)

    @property
    def wrong_constants(self) -> list[FieldValue]:
        """Constant fields with another value than their constant."""
        return [
            row
            for row in self.rows
            if row.field.const is not None and row.raw != row.field.const
        ]

    def to_json(self) -> dict[str, object]:
        """Return the frame as values for JSON.

        The keys are ``node``, ``message``, ``kind``, ``id`` (or ``set_id`` and
        ``get_id``), ``length``, ``bytes`` and ``fields``, and ``remarks`` if there are
        any.
        """
        message = self.message
        ids = {
            key: getattr(message, key)
            for key in ("id", "set_id", "get_id")
            if getattr(message, key) is not None
        }
        result = {
            "node": self.node.name,
            "message": message.name,
            "kind": message.kind,
            **ids,
            "length": len(self.data),
        }
        result |= {
            "bytes": self.data.hex(),
            "fields": [row.to_json() for row in self.rows],
        }
        return result | ({"remarks": list(self.remarks)} if self.remarks else {})


def decoded_frame(
    icd: Icd,
    node: Node,
    message: Message,
    data: bytes,
    notes: dict[str, str] | None = None,
) -> DecodedFrame:
    """Decode ``data``.

    ``notes`` are further remarks by field name. Raises `codec.LengthError`.
    """
    owner = icd.node(message.node)  # with the default orders of the message
    values = codec.decode_frame(owner, message, data)
    rows = []
    for field in codec.fields_of_frame(owner, message, values):
        # A count without bits is visible as the number of elements.
        if field.role == "count":
            continue
        raw = values[field.name]
        extra = (notes or {}).get(field.name)
        rows.append(
            FieldValue(
                field,
                raw,
                (*remarks_on_value(field, raw), *((extra,) if extra else ())),
            )
        )
    form = facts.of(icd, node).stream
    return DecodedFrame(
        node, message, data, tuple(rows), tuple(_reserved(owner, message, data)), form
    )


def remarks_on_value(field: AnyScalar, raw: int | bytes) -> list[str]:
    """Return the remarks about a value: its special meaning, or why the ICD does not
    allow it.
    """
    if isinstance(raw, bytes):
        return []
    # A special value is allowed even if it is outside of the limits.
    special = codec.special_of(field, raw)
    return violations_of_value(field, raw) if special is None else [special.meaning]


def violations_of_value(field: AnyScalar, raw: int) -> list[str]:
    """Return why the ICD does not allow a raw value: constants, members, limits."""
    return [*reasons_not_listed(field, raw), *reasons_out_of_limits(field, raw)]


def reasons_not_listed(field: AnyScalar, raw: int) -> list[str]:
    """Return why a raw value differs from the constant, or from all members of the
    enumeration, of a field.
    """
    reasons = []
    if field.const is not None and raw != field.const:
        reasons.append(f"must be {value_text(field.const)}")
    if field.enum and field.enum.member_of(raw) is None:
        reasons.append(f"no member of {field.enum.name}")
    return reasons


def reasons_out_of_limits(field: AnyScalar, raw: int) -> list[str]:
    """Return the limits of a field that a raw value violates."""
    if field.limits is None:
        return []
    value: Fraction | float = raw
    if field.type == "float" or field.curve is not None:
        physical = codec.physical_double(field, raw)
        value = codec.float_value(field, raw) if physical is None else physical
        if value != value:
            return ["not a number"]
    elif field.scale:
        value = field.scale.physical(raw)
    unit = f" {field.unit.symbol}" if field.unit else ""
    broken = (
        bound for bound in bounds_of_limits(field.limits) if not bound.holds(value)
    )
    return [f"{bound.kind.refusal} {exact_text(bound.value)}{unit}" for bound in broken]


def _reserved(node: Node, message: Message, data: bytes) -> list[str]:
    """Return a remark for each run of reserved bits that is not 0."""
    reasons = []
    fields = frame_fields(message.layout, node.orders)
    for gap in frame_bits.reserved_bits_between(fields, (), message.length, node):
        pieces = pieces_at(gap.at, gap.bits, node.byte_order, node.bit_order)
        if any(
            data[piece.byte] & piece.mask for piece in pieces if piece.byte < len(data)
        ):
            reasons.append(
                f"reserved {bit_range(gap.at, gap.bits)} {'is' if gap.bits == 1 else 'are'} not 0"
            )
    return reasons
