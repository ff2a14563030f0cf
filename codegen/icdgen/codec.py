"""Reference codec: slow, simple and exact.

Tests compare all generated code with it, so it does not use ``icdgen.frame_bits``.

Raw values are int (uint, int, enum, bool as 0 or 1), bytes (bytes and text fields) and,
for floats, the int of their IEEE 754 bits, which preserves the payload of a NaN.
Physical values are exact `fractions.Fraction`s; of fields with a curve they are
doubles.

`decode_frame` returns the values that a frame has. Objects of generated code have room
for the longest frame. Therefore `decode` returns and `encode` takes the values of the
longest frame: elements that a frame does not have are 0, and bytes or text of variable
length are padded with zeros. `decode` and `encode_partial` convert between the two
forms. Frames themselves have their real length.

A new message is the object that generated code constructs: see `initial_value`.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import TypeAlias

from icdgen.icd.curve import Curve
from icdgen.icd.frames import FrameField, fixed_fields, frame_fields
from icdgen.icd.layout import Derived, Layout, Overlay, Scalar, Sizes, VariablePart
from icdgen.icd.meanings import Special
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.places import AnyScalar

RawValue: TypeAlias = "int | bytes"


class CodecError(ValueError):
    """A value is out of range, or a frame does not match the message.

    The text has the expected and the actual value.
    """


class LengthError(CodecError):
    """A frame has a length in bytes that the message cannot have, or a counter that is
    out of range or contradicts the length.

    ``expected`` is one length near the actual one that the message can have. It is a
    hint for people and need not be the length that was meant.
    """

    def __init__(self, message: Message, expected: int, actual: int) -> None:
        super().__init__(f"{message.name} has {expected} bytes, {actual} given")
        self.expected, self.actual = expected, actual


def decode(node: Node, message: Message, frame: bytes) -> dict[str, RawValue]:
    """Return the raw values of the longest frame by name, without absent optional
    fields.

    Raises `LengthError`.
    """
    raw = decode_frame(node, message, frame)
    if not message.layout.parts:
        return raw
    for part in message.layout.parts:
        value = raw.get(part.name)
        if isinstance(value, bytes):
            raw[part.name] = value.ljust(part.most, b"\0")
    for field in frame_fields(message.layout, node.orders):
        if field.name not in raw and field.has_bits and not field.conditions:
            raw[field.name] = bytes(field.bits // 8) if field.is_bytes else 0
    return raw


def decode_frame(node: Node, message: Message, frame: bytes) -> dict[str, RawValue]:
    """Return the raw values that a frame has, by name. Raises `LengthError`.

    The result has no entries for array elements that the frame lacks and for absent
    optional fields.
    """
    sizes = sizes_of_frame(node, message, frame)
    fields = frame_fields(message.layout, node.orders, sizes)
    # A frame that ends early lacks trailing zeros only, and missing bits of the number
    # read as 0.
    bits = int.from_bytes(frame, "little")
    raw: dict[str, RawValue] = {}
    optional = []
    for field in fields:
        if field.role == "count":
            raw[field.name] = sizes[message.layout.parts[-1].name]
        elif field.scalar.present_if:
            optional.append(field)
        elif field.role != "derived":
            raw[field.name] = _read_field(field, bits)
    # A condition can name a field that comes later in the frame.
    for field in optional:
        if is_present(field, raw):
            raw[field.name] = _read_field(field, bits)
    return raw | derived_values(message, raw) if message.layout.derived else raw


def fields_of_frame(
    node: Node, message: Message, raw: Mapping[str, RawValue]
) -> list[FrameField]:
    """List the scalars with values in `raw`, at their positions in the frame of these
    values.

    Raises `CodecError`.
    """
    sizes = sizes_from_counters(message, raw)
    fields = frame_fields(message.layout, node.orders, sizes)
    return [field for field in fields if field.name in raw]


def derived_values(
    message: Message, raw: Mapping[str, RawValue]
) -> dict[str, RawValue]:
    """Return the derived values whose operands have raw values, each as the bits of a
    double.
    """
    scalars: dict[str, Scalar] = {}
    for layout_node in message.layout.nodes:
        if isinstance(layout_node, Scalar):
            scalars[layout_node.name] = layout_node
        elif isinstance(layout_node, Overlay | Derived):
            scalars[layout_node.name] = layout_node.scalar
    values, results = dict(raw), dict[str, RawValue]()
    # A derived value can be an operand of a later one.
    for derived in message.layout.derived:
        operands = derived.derivation.fields
        if all(name in values for name in operands):
            doubles = [
                value_double(scalars[name], _number(values[name])) for name in operands
            ]
            bits = float_bits(derived.scalar, derived.derivation.double(doubles))
            values[derived.name] = results[derived.name] = bits
    return results


def sizes_of_frame(node: Node, message: Message, frame: bytes) -> Sizes:
    """Return the size of each variable-length node of a frame.

    Raises `LengthError` if no sizes give its length.
    """
    layout, actual = message.layout, len(frame)
    if actual < layout.shortest:
        raise LengthError(message, layout.shortest, actual)
    counters = _counters(node, layout, frame)
    if not layout.parts:
        _check_length(message, layout.lengths, actual)
        return {}
    last = layout.parts[-1]
    sizes = {last.name: 0}
    # If elements of the last part have variable-length arrays, its own counter is
    # needed to place them.
    for name, part in layout.parts_by_size.items():
        if part is not last or part.inner:
            if not part.low <= counters[part.counter] <= part.high:
                raise LengthError(
                    message,
                    # No size gives an expected length. Any length will do that differs
                    # from the actual one.
                    layout.length if actual == layout.longest else layout.longest,
                    actual,
                )
            sizes[name] = counters[part.counter] + part.plus
    end = layout.size_of_frame(sizes)
    if last.inner:
        _check_length(message, range(end, end + 1), actual)
        return sizes
    _check_length(
        message,
        range(
            end + last.fewest * last.step, end + last.most * last.step + 1, last.step
        ),
        actual,
    )
    sizes[last.name] = (actual - end) // last.step
    if not last.is_rest and counters[last.counter] + last.plus != sizes[last.name]:
        raise LengthError(
            message,
            max(0, end + (counters[last.counter] + last.plus) * last.step),
            actual,
        )
    return sizes


def _counters(node: Node, layout: Layout, frame: bytes) -> dict[str, int]:
    """Return the raw values of the fields that count the elements of variable-length
    nodes.
    """
    names = {part.counter for part in layout.counted_parts if not part.is_rest}
    bits = int.from_bytes(frame, "little")
    fields = fixed_fields(layout, node.orders)
    return {
        field.name: _number(_read_field(field, bits))
        for field in fields
        if field.name in names
    }


def _check_length(message: Message, lengths: range, actual: int) -> None:
    """Raise `LengthError` for a length that is not in `lengths`; it expects the next
    shorter length, or else the shortest.
    """
    if actual not in lengths:
        raise LengthError(
            message,
            max((length for length in lengths if length < actual), default=lengths[0]),
            actual,
        )


def _number(raw: RawValue) -> int:
    assert isinstance(raw, int)
    return raw


def sizes_from_counters(message: Message, raw: Mapping[str, RawValue]) -> Sizes:
    """Return the number of elements, or of bytes, of each variable-length node, from
    the values of the counters.

    Raises `CodecError` if one is out of range.
    """
    return {
        name: size_from_counter(part, raw)
        for name, part in message.layout.parts_by_size.items()
    }


def size_from_counter(part: VariablePart, raw: Mapping[str, RawValue]) -> int:
    """Return the number of elements, or of bytes, of a part from its counter.

    Without a value, the counter has its minimum. Raises `CodecError` if it is out of
    range.
    """
    value = _number(raw.get(part.counter, part.low))
    if not part.low <= value <= part.high:
        raise CodecError(
            f"{part.counter!r} takes {part.low} to {part.high}, not {value}"
        )
    return value + part.plus


def with_numbers(frame: bytes, values: Mapping[FrameField, int]) -> bytes:
    """Return a copy of a frame in which the bits of some numbers are replaced."""
    bits = int.from_bytes(frame, "little")
    for field, value in values.items():
        # All bits of the field, as a value in its range: `_bits_in_frame` checks values.
        mask = _bits_in_frame(field, -1 if field.is_signed else (1 << field.bits) - 1)
        bits = bits & ~mask | _bits_in_frame(field, value)
    return bits.to_bytes(len(frame), "little")


def is_present(field: FrameField, raw: Mapping[str, RawValue]) -> bool:
    """Return whether a message with these raw values meets all conditions of a field.

    A field without a value counts as 0, as all bits of a frame without a value.
    """
    return not field.scalar.present_if or all(
        raw.get(need.field, 0) in need.values for need in field.scalar.present_if
    )


def message_of_frame(
    icd: Icd, messages: Sequence[Message], frame: bytes
) -> Message | None:
    """Return the message of a frame among messages that share an id; None if the frame
    matches none of them.

    A frame matches a message that can have its length and whose constants it has.
    Constants of optional fields, constants behind the fixed part, and constants that
    all the messages have in common are not compared. If several messages match, the
    message with the most constants is returned. Raises `LengthError` if all messages have the same fixed length and the
    frame has another.
    """
    bits = int.from_bytes(frame, "little")
    constants = {
        id(message): _constants(icd.node(message.node), message) for message in messages
    }
    shared = (
        set.intersection(*(set(places) for places in constants.values()))
        if constants
        else set()
    )
    matches = []
    for message in messages:
        own = constants[id(message)]
        if len(frame) not in message.layout.lengths:
            continue
        if all(
            _read_field(field, bits) == field.const
            for place, field in own.items()
            if place not in shared
        ):
            matches.append((len(own), message))
    if matches:
        # Of messages with as many constants, `max` returns the first in the order of
        # the ICD.
        return max(matches, key=lambda match: match[0])[1]
    lengths = {message.layout.shortest for message in messages}
    lengths |= {message.layout.longest for message in messages}
    if len(lengths) == 1 and len(frame) not in lengths:
        raise LengthError(messages[0], lengths.pop(), len(frame))
    return None


def message_of_frame_if_any(
    icd: Icd, messages: Sequence[Message], frame: bytes
) -> Message | None:
    """Return the result of `message_of_frame`; None if it raises `LengthError`."""
    try:
        return message_of_frame(icd, messages, frame)
    except LengthError:
        return None


def encode(node: Node, message: Message, raw: Mapping[str, RawValue]) -> bytes:
    """Return the frame with these values of the longest frame; reserved bits are 0.

    `encode_partial` accepts missing and unknown values. Values of overlay fields,
    derived values and fields that are absent from the frame are ignored.
    Raises `CodecError` for a missing, unknown or invalid value.
    """
    fields = frame_fields(message.layout, node.orders)
    names = {field.name for field in fields}
    for name in raw:
        if name not in names:
            raise CodecError(f"{message.name} has no field {name!r}")
    for field in fields:
        if field.is_raw and field.name not in raw and is_present(field, raw):
            raise CodecError(f"no value for {field.name!r}")
    return encode_partial(node, message, raw)


def initial_values(node: Node, message: Message) -> dict[str, RawValue]:
    """Return the raw values of a new message by name, in the form of the longest frame.

    Overlay fields, derived values and absent optional fields are missing.
    """
    fields = [
        field for field in frame_fields(message.layout, node.orders) if field.is_raw
    ]
    raw = {field.name: initial_value(message, field) for field in fields}
    # Unlike `is_present`, a condition on a field without an initial value is not met.
    return {
        field.name: raw[field.name]
        for field in fields
        if all(raw.get(c.field) in c.values for c in field.conditions)
    }


def initial_frame(node: Node, message: Message) -> bytes:
    """Return the shortest frame of a new message: its variable-length nodes have the
    fewest elements.
    """
    fixed = fixed_fields(message.layout, node.orders)
    counts = {field.name: initial_value(message, field) for field in fixed}
    fields = frame_fields(
        message.layout, node.orders, sizes_from_counters(message, counts)
    )
    # Bytes and text are 0 in a new message, as all bits without a value.
    numbers = (field for field in fields if field.is_raw and not field.is_bytes)
    return encode_partial(
        node, message, {field.name: initial_value(message, field) for field in numbers}
    )


def initial_value(message: Message, field: FrameField) -> RawValue:
    """Return the raw value of a field of a new message: see `Scalar.initial_value`."""
    return field.scalar.initial_value(
        field.bits, message.layout.smallest_raw_of_counter(field.name)
    )


def initial_object_values(node: Node, message: Message) -> dict[str, RawValue]:
    """Return the raw values of the longest frame for a new message.

    Generated code sets constants also in absent elements of variable-length nodes,
    except of the last node.
    """
    values = initial_values(node, message)
    numbers = message.layout.initial_numbers
    fields = frame_fields(message.layout, node.orders)
    arrays = (f for f in fields if f.steps[0].element is not None)
    elements = {
        f.name: values[f.name]
        for f in arrays
        if (f.steps[0].element or 0) < numbers.get(f.steps[0].node.name, 0)
    }
    return decode(node, message, encode(node, message, values)) | elements


def encode_partial(node: Node, message: Message, raw: Mapping[str, RawValue]) -> bytes:
    """Return the frame with some values of the longest frame; all other bits are 0.

    Unlike `encode`, this accepts missing values and ignores unknown names. Raises
    `CodecError` for an invalid value.
    """
    layout, bits = message.layout, 0
    sizes = sizes_from_counters(message, raw)
    for field in frame_fields(layout, node.orders, sizes):
        if not field.is_raw or field.name not in raw or not is_present(field, raw):
            continue
        value = raw[field.name]
        # Cut variable-length bytes, which have the length of the longest frame.
        if field.scalar.length is not None and isinstance(value, (bytes, bytearray)):
            if len(value) != field.scalar.length.most:
                raise CodecError(
                    f"{field.name!r} takes {field.scalar.length.most} bytes"
                )
            value = value[: field.bits // 8]
        bits |= _bits_in_frame(field, value)
    return bits.to_bytes(layout.size_of_frame(sizes), "little")


def check_raw(field: AnyScalar, value: int | bytes) -> None:
    """Raise `CodecError` if the raw value has the wrong type, size or range for the
    field.
    """
    if field.is_bytes:
        if not isinstance(value, (bytes, bytearray)) or len(value) != field.bits // 8:
            raise CodecError(f"{field.name!r} takes {field.bits // 8} bytes")
        return
    if type(value) is not int and (
        isinstance(value, (bytes, bytearray, str)) or value != int(value)
    ):
        raise CodecError(f"{field.name!r} takes an integer")
    low, high = field.raw_min, field.raw_max
    if not low <= value <= high:
        raise CodecError(f"{field.name!r} takes {low} to {high}, not {value}")


def physical(field: AnyScalar, raw: int) -> Fraction | None:
    """Return the exact physical value of an integer field with a scale; None for any
    other field, also with a curve: see `physical_double`.
    """
    return field.scale.physical(raw) if field.scale else None


def physical_double(field: AnyScalar, raw: int) -> float | None:
    """Return the physical value as the nearest double, or the double that a curve
    gives; None without a formula.
    """
    if field.curve is not None:
        return field.curve.double(
            float_value(field, raw) if field.type == "float" else raw
        )
    exact = physical(field, raw)
    return None if exact is None else to_double(exact)


def value_double(field: AnyScalar, raw: int) -> float:
    """Return the value of any number as a double: the physical value, or without a
    formula the number itself.
    """
    physical = physical_double(field, raw)
    if physical is not None:
        return physical
    return float_value(field, raw) if field.type == "float" else float(raw)


def raw_from_physical(field: AnyScalar, value: Fraction | int | float) -> int:
    """Return the nearest raw value, ties to even.

    Raises `CodecError` if the value is not finite or out of range.
    """
    if isinstance(value, float) and not math.isfinite(value):
        raise CodecError(f"{field.name!r} takes a finite number, not {value}")
    if field.curve is not None:
        return _raw_on_curve(
            field,
            field.curve,
            value if isinstance(value, float) else to_double(Fraction(value)),
        )
    exact = Fraction(value)
    # Fraction rounds ties to even.
    raw = round(field.scale.raw(exact) if field.scale else exact)
    if not field.raw_min <= raw <= field.raw_max:
        low, high = sorted(
            float(field.scale.physical(r)) if field.scale else r
            for r in (field.raw_min, field.raw_max)
        )
        raise CodecError(
            f"{field.name!r} takes {low:g} to {high:g}, not {float(exact):g}"
        )
    return raw


def _raw_on_curve(field: AnyScalar, curve: Curve, value: float) -> int:
    """Return the raw value whose physical value on a curve is nearest.

    Raises `CodecError` if the value is out of range.
    """
    if not field.is_invertible:
        raise CodecError(
            f"the physical value of {field.name!r} does not lead back to a raw value"
        )
    if field.type == "float":
        inverse = curve.inverse(value)
        if not math.isfinite(inverse):
            raise CodecError(f"{field.name!r} cannot hold {value:g}")
        return float_bits(field, inverse)
    raw = curve.nearest(value, *field.settable_raws)
    if raw is None:
        low, high = sorted(map(curve.double, field.settable_raws))
        raise CodecError(f"{field.name!r} takes {low:g} to {high:g}, not {value:g}")
    return raw


def text(raw: bytes) -> str:
    """Return the characters of a text field up to the first NUL; U+FFFD for each byte
    that is not ASCII.
    """
    return raw.split(b"\0", 1)[0].decode("ascii", "replace")


def raw_from_text(field: AnyScalar, value: str) -> bytes:
    """Return the bytes of a text, padded with NUL.

    Raises `CodecError` if it is too long, not ASCII or contains a NUL.
    """
    size = field.bits // 8
    if not value.isascii() or "\0" in value or len(value) > size:
        raise CodecError(
            f"{field.name!r} takes up to {size} ASCII characters, none of them NUL"
        )
    return value.encode("ascii").ljust(size, b"\0")


def special_of(field: AnyScalar, raw: int) -> Special | None:
    """Return the special value that a raw value is, if any.

    Floats compare as numbers, so all NaNs are equal.
    """
    if field.type != "float":
        return next(
            (special for special in field.special if special.value == raw), None
        )
    number = float_value(field, raw)
    for special in field.special:
        value = float_value(field, special.value)
        if value == number or (value != value and number != number):
            return special
    return None


def float_value(field: AnyScalar, bits: int) -> float:
    """Return the value of the IEEE 754 bits of a float field."""
    packed = bits.to_bytes(field.bits // 8, "little")
    value: float = struct.unpack("<f" if field.bits == 32 else "<d", packed)[0]
    return value


def float_bits(field: AnyScalar, value: float) -> int:
    """Return the bits of the nearest float of the width of the field.

    Raises `CodecError` on overflow.
    """
    try:
        packed = struct.pack("<f" if field.bits == 32 else "<d", value)
    except OverflowError:
        raise CodecError(
            f"{field.name!r} is a {field.bits}-bit float and cannot hold {value:g}"
        ) from None
    return int.from_bytes(packed, "little")


def to_double(exact: Fraction) -> float:
    """Return the nearest double, ties to even."""
    # Python rounds int / int once, correctly, also for integers that are too large for
    # a double.
    return exact.numerator / exact.denominator


# Below, a frame is one number: bit w (0: least significant) of byte b is bit 8 * b + w
# of the number.


@lru_cache(maxsize=1 << 16)
def _runs(
    at: int, bits: int, byte_order: str, bit_order: str
) -> tuple[tuple[int, int, int], ...]:
    """Return the runs of contiguous bits of a value: (bit of the frame, bit of the
    value, number of bits).
    """
    places = []
    for number in range(at, at + bits):
        byte, bit = divmod(number, 8)
        places.append((byte, bit if bit_order == "lsb0" else 7 - bit))
    # Sort by significance: first the byte with the least significant bits, and in it
    # the least significant bit.
    places.sort(
        key=lambda place: (place[0] if byte_order == "little" else -place[0], place[1])
    )
    runs: list[tuple[int, int, int]] = []
    for index, (byte, weight) in enumerate(places):
        start = 8 * byte + weight
        if runs and start == runs[-1][0] + runs[-1][2]:
            runs[-1] = (*runs[-1][:2], runs[-1][2] + 1)
        else:
            runs.append((start, index, 1))
    return tuple(runs)


def _read_field(field: FrameField, frame: int) -> RawValue:
    """Return the raw value of a field from a frame."""
    scalar = field.scalar
    if scalar.is_bytes:
        part = frame >> field.at // 8 * 8 & (1 << field.bits) - 1
        return part.to_bytes(field.bits // 8, "little")
    value = 0
    for start, index, count in _runs(
        field.at, field.bits, field.byte_order, field.bit_order
    ):
        value |= (frame >> start & (1 << count) - 1) << index
    if scalar.is_signed and value >> (field.bits - 1):
        value -= 1 << field.bits
    return value


def _bits_in_frame(field: FrameField, value: RawValue) -> int:
    """Return the bits of the frame that a value sets.

    Raises `CodecError` if the value is invalid.
    """
    check_raw(field, value)
    if not field.has_bits:
        return 0
    if isinstance(value, (bytes, bytearray)):
        return int.from_bytes(value, "little") << field.at // 8 * 8
    frame, value = 0, int(value)
    for start, index, count in _runs(
        field.at, field.bits, field.byte_order, field.bit_order
    ):
        frame |= (value >> index & (1 << count) - 1) << start
    return frame


# Runs of bits, and the value that a message has there.
_Place: TypeAlias = tuple[tuple[tuple[int, int, int], ...], int]


def _constants(node: Node, message: Message) -> dict[_Place, FrameField]:
    """Return the constants that every frame of a message has, by position and value."""
    constants: dict[_Place, FrameField] = {}
    for field in frame_fields(message.layout, node.orders):
        if (
            field.has_bits
            and field.const is not None
            and not field.conditions
            # Behind the fixed part a frame can lack the field.
            and field.at < 8 * message.layout.length
        ):
            constants[
                _runs(field.at, field.bits, field.byte_order, field.bit_order),
                field.const,
            ] = field
    return constants
