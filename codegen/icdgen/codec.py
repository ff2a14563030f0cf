"""The reference codec: slow, obvious, exact. The judge of all generated code, so it shares nothing with ``layout``.

Raw values are int (uint, int, enum, bool as 0 or 1), bytes (bytes and text fields) and, for floats, the int of their
IEEE 754 bits, so that every NaN survives. Physical values are exact `fractions.Fraction`s, those of curves doubles.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import lru_cache

from icdgen.icd.curve import Curve
from icdgen.icd.model import Field, Icd, Message, Node, Special, Tail
from icdgen.icd.places import AnyField


class CodecError(ValueError):
    """The value or the frame does not fit the message; the message says what was expected and what was given."""


class LengthError(CodecError):
    def __init__(self, message: Message, expected: int, actual: int) -> None:
        super().__init__(f"{message.name} has {expected} bytes, {actual} given")
        self.expected, self.actual = expected, actual


def decode(node: Node, message: Message, frame: bytes) -> dict[str, int | bytes]:
    """Raw value of every field that is there, by name; elements that are not in the frame are 0. Raises `LengthError`."""
    actual, frame = len(frame), spread(node, message, frame) if message.inner else frame
    lacking, bits = len(frame) - actual, int.from_bytes(frame, "little")  # what a frame leaves out reads as 0
    if len(frame) not in _whole_lengths(message):
        raise LengthError(message, _next_length(message, len(frame)) - lacking, actual)
    raw = {one.name: _read(node, one, bits) for one in message.fields if not one.when and one.derived is None}
    if message.has_conditions:
        raw |= {one.name: _read(node, one, bits) for one in message.fields if one.when and is_present(one, raw)}
    tail, counter = message.tail, message.counter
    if tail is not None and counter is not None:
        count = (len(frame) - message.begin) // tail.step
        if counter.implied:
            raw[counter.name] = count
        elif _number(raw[counter.name]) + tail.plus != count:
            told = message.begin + (_number(raw[counter.name]) + tail.plus) * tail.step
            raise LengthError(message, max(0, told - lacking), actual)
    return raw | derived(message, raw) if message.views else raw


def derived(message: Message, raw: Mapping[str, int | bytes]) -> dict[str, int | bytes]:
    """The values that are derived from raw ones of the fields, each the bits of a double; none of what is not there."""
    fields = {field.name: field for field in message.fields}
    values = dict(raw)
    found: dict[str, int | bytes] = {}
    for field in message.views:
        if field.derived is not None and values.keys() >= set(field.derived.fields):
            doubles = [value_double(fields[name], _number(values[name])) for name in field.derived.fields]
            values[field.name] = found[field.name] = float_bits(field, field.derived.double(doubles))
    return found


def _next_length(message: Message, actual: int) -> int:
    """The length that a frame of no possible length should have had: the longest possible one below, or the least."""
    lengths = _whole_lengths(message)
    return max((one for one in lengths if one < actual), default=lengths[0])


def _whole_lengths(message: Message) -> range:
    """The lengths that frames have with all elements of `Message.inner`."""
    tail = message.tail
    if tail is None or not message.inner:
        return message.lengths
    return range(message.begin + tail.fewest * tail.step, message.length + 1, tail.step)


def spread(node: Node, message: Message, frame: bytes) -> bytes:
    """The frame with zeros for the elements of `Message.inner` that it does not have: the beginning of the longest one.

    Raises `LengthError` if it is shorter than any, or says that it has more elements than there can be.
    """
    if len(frame) < message.least:
        raise LengthError(message, message.least, len(frame))
    try:
        for place, lacking in _gaps(message, _counts(node, message, frame)):
            frame = frame[:place] + bytes(lacking) + frame[place:]
    except CodecError:
        begin, longest = message.inner[0].begin, message.length  # another length than it has, whatever its count says
        raise LengthError(message, begin if len(frame) == longest else longest, len(frame)) from None
    return frame


def squeezed(node: Node, message: Message, frame: bytes) -> bytes:
    """Of the beginning of the longest frame the bytes that it has: see `spread`. Raises `CodecError` for a count that cannot be."""
    return _without(frame, _gaps(message, _counts(node, message, frame)))


def _without(frame: bytes, gaps: list[tuple[int, int]]) -> bytes:
    for place, lacking in reversed(gaps):
        frame = frame[:place] + frame[place + lacking :]
    return frame


def _counts(node: Node, message: Message, frame: bytes) -> dict[str, int | bytes]:
    """What the fields say that count the elements of `Message.inner`."""
    names, bits = {one.counter for one in message.inner}, int.from_bytes(frame, "little")
    return {one.name: _read(node, one, bits) for one in message.fields if one.name in names}


def _gaps(message: Message, raw: Mapping[str, int | bytes]) -> list[tuple[int, int]]:
    """Where the longest frame has bytes that one with these counts has not, and how many. Raises `CodecError`."""
    found = []
    for one in message.inner:
        count = elements_of(one, raw)
        found.append((one.begin + count * one.step, (one.most - count) * one.step))
    return found


def _number(raw: int | bytes) -> int:
    assert isinstance(raw, int)
    return raw


def count_of(message: Message, raw: Mapping[str, int | bytes]) -> int:
    """How many elements the open end has. Raises `CodecError` if it cannot have so many."""
    return 0 if message.tail is None else elements_of(message.tail, raw)


def elements_of(part: Tail, raw: Mapping[str, int | bytes]) -> int:
    """How many elements an open part has. Raises `CodecError` if it cannot have so many."""
    told = _number(raw.get(part.counter, part.low))
    if not part.low <= told <= part.high:
        raise CodecError(f"{part.counter!r} takes {part.low} to {part.high}, not {told}")
    return told + part.plus


def counted(node: Node, message: Message, frame: bytes, count: int) -> bytes:
    """The frame with another count in the field that counts the elements of its open end, if it has such a field."""
    tail, counter = message.tail, message.counter
    if tail is None or counter is None or counter.implied:
        return frame
    return frame_of(node, frame, {counter: count - tail.plus})


def frame_of(node: Node, frame: bytes, values: Mapping[Field, int]) -> bytes:
    """The frame with other values in some of its fields, which are numbers."""
    bits = int.from_bytes(frame, "little")
    for field, value in values.items():
        mine = _written(node, field, -1 if field.signed else (1 << field.bits) - 1)
        bits = bits & ~mine | _written(node, field, value)
    return bits.to_bytes(len(frame), "little")


def is_present(field: Field, raw: Mapping[str, int | bytes]) -> bool:
    """Whether a field is there in a message of these raw values: what it depends on has one of the values for it."""
    return all(raw.get(one.field, 0) in one.values for one in field.when)


def is_there(message: Message, field: Field, count: int) -> bool:
    """Whether a frame holds a field, if its open end has ``count`` elements; bytes and text that are cut off are there."""
    return not field.path or message.tail is None or field.at < 8 * (message.begin + count * message.tail.step)


def is_sent(message: Message, field: Field, raw: Mapping[str, int | bytes]) -> bool:
    """Whether the frame of these raw values holds a field: no element beyond those that are counted."""
    part = next((one for one in message.inner if field.path and one.name == field.path[0].name), None)
    if part is not None:
        return field.at < 8 * (part.begin + elements_of(part, raw) * part.step)
    return is_there(message, field, count_of(message, raw))


def which(icd: Icd, known: Sequence[Message], frame: bytes) -> Message | None:
    """Of messages that share an id the one that a frame is of; None if it is of none of them.

    It is of a length and has the constants of that message, but for those that all of them have alike and for those in an
    open end; of several that of the most constants. Raises `LengthError` if no message has that length and all have the same.
    """
    fitting = []
    for message in known:
        if len(frame) not in message.lengths:
            continue
        node, bits = icd.node(message.node), int.from_bytes(frame, "little")
        constants = _in_every_frame(message)
        telling = [one for one in constants if not all(_has_alike(icd, other, one, node) for other in known)]
        if all(_read(node, one, bits) == one.const for one in telling):
            fitting.append((len(constants), message))
    if fitting:
        return max(fitting, key=lambda one: one[0])[1]
    if all(message.least == message.length == known[0].length != len(frame) for message in known):
        raise LengthError(known[0], known[0].length, len(frame))
    return None


def which_if_any(icd: Icd, known: Sequence[Message], frame: bytes) -> Message | None:
    """`which`, and None also if no message has that length."""
    try:
        return which(icd, known, frame)
    except LengthError:
        return None


def _in_every_frame(message: Message) -> list[Field]:
    """The constants of a message, without those of elements and fields that not every frame has."""
    fixed = [one for one in message.owners if one.const is not None and not one.when and one.at < 8 * message.fixed]
    return [one for one in fixed if is_there(message, one, 0)]


def _has_alike(icd: Icd, message: Message, constant: Field, node: Node) -> bool:
    """Whether a message has the constant that a field of another one, declared by ``node``, is."""
    place = _runs(constant.at, constant.bits, *constant.orders(node))
    owner = icd.node(message.node)
    same = (one for one in _in_every_frame(message) if one.const == constant.const)
    return any(_runs(one.at, one.bits, *one.orders(owner)) == place for one in same)


def encode(node: Node, message: Message, raw: Mapping[str, int | bytes]) -> bytes:
    """The frame, reserved bits 0. Values of views, and of what is not in the frame, are not looked at.

    Raises `CodecError` for a missing, unknown or unfit value.
    """
    known = {field.name for field in message.fields}
    for name in raw:
        if name not in known:
            raise CodecError(f"{message.name} has no field {name!r}")
    for field in message.owners:
        if field.name not in raw and is_present(field, raw):
            raise CodecError(f"no value for {field.name!r}")
    return frame_with(node, message, raw)


def new(node: Node, message: Message) -> dict[str, int | bytes]:
    """The raw values of a new message; constants are in all elements of inner open parts, which a frame of it does not have."""
    inner = {part.name for part in message.inner}
    elements = {one.name: one.fresh for one in message.owners if one.path and one.path[0].name in inner}
    return decode(node, message, encode(node, message, message.fresh)) | elements


def frame_with(node: Node, message: Message, raw: Mapping[str, int | bytes]) -> bytes:
    """The frame in which these fields have these values and all other bits are 0. Raises `CodecError` for an unfit value."""
    bits, gaps, count = 0, _gaps(message, raw), count_of(message, raw)
    for field in message.owners:
        if field.name in raw and is_there(message, field, count) and is_present(field, raw):
            bits |= _written(node, field, raw[field.name])
    frame = bits.to_bytes(message.length, "little")
    return frame if message.tail is None else _without(frame[: message.begin + count * message.tail.step], gaps)


def check_raw(field: AnyField, value: int | bytes) -> None:
    """Raises `CodecError` unless the field can hold the raw value."""
    if field.is_bytes:
        if not isinstance(value, (bytes, bytearray)) or len(value) != field.bits // 8:
            raise CodecError(f"{field.name!r} takes {field.bits // 8} bytes")
        return
    if type(value) is not int and (isinstance(value, (bytes, bytearray, str)) or value != int(value)):
        raise CodecError(f"{field.name!r} takes an integer")
    low, high = field.raw_min, field.raw_max
    if not low <= value <= high:
        raise CodecError(f"{field.name!r} takes {low} to {high}, not {value}")


def physical(field: AnyField, raw: int) -> Fraction | None:
    """Exact physical value of an integer field with a scale, else None."""
    return field.scale.physical(raw) if field.scale else None


def physical_double(field: AnyField, raw: int) -> float | None:
    """The correctly rounded double of the physical value; of a curve, what its definition gives."""
    if field.curve is not None:
        return field.curve.double(float_value(field, raw) if field.type == "float" else raw)
    exact = physical(field, raw)
    return None if exact is None else to_double(exact)


def value_double(field: AnyField, raw: int) -> float:
    """The physical value of a number, of one without a formula its raw value, as a double."""
    physical = physical_double(field, raw)
    if physical is not None:
        return physical
    return float_value(field, raw) if field.type == "float" else float(raw)


def raw_from_physical(field: AnyField, value: Fraction | int | float) -> int:
    """Nearest raw value, ties to even. Raises `CodecError` if it is not finite or does not fit."""
    if isinstance(value, float) and not math.isfinite(value):
        raise CodecError(f"{field.name!r} takes a finite number, not {value}")
    if field.curve is not None:
        return _raw_on_curve(field, field.curve, value if isinstance(value, float) else to_double(Fraction(value)))
    exact = Fraction(value)
    raw = round(field.scale.raw(exact) if field.scale else exact)  # Fraction rounds ties to even
    if not field.raw_min <= raw <= field.raw_max:
        low, high = sorted(float(field.scale.physical(r)) if field.scale else r for r in (field.raw_min, field.raw_max))
        raise CodecError(f"{field.name!r} takes {low:g} to {high:g}, not {float(exact):g}")
    return raw


def _raw_on_curve(field: AnyField, curve: Curve, value: float) -> int:
    if not field.leads_back:
        raise CodecError(f"the physical value of {field.name!r} does not lead back to a raw value")
    if field.type == "float":
        inverse = curve.inverse(value)
        if not math.isfinite(inverse):
            raise CodecError(f"{field.name!r} cannot hold {value:g}")
        return float_bits(field, inverse)
    raw = curve.nearest(value, *field.ends)
    if raw is None:
        low, high = sorted(map(curve.double, field.ends))
        raise CodecError(f"{field.name!r} takes {low:g} to {high:g}, not {value:g}")
    return raw


def text(raw: bytes) -> str:
    """What a text field says: its characters up to the first NUL, or to its end; U+FFFD for each that is not ASCII."""
    return raw.split(b"\0", 1)[0].decode("ascii", "replace")


def raw_from_text(field: AnyField, value: str) -> bytes:
    """The bytes of a text, filled with NUL. Raises `CodecError` if it is too long, not ASCII or has a NUL in it."""
    size = field.bits // 8
    if not value.isascii() or "\0" in value or len(value) > size:
        raise CodecError(f"{field.name!r} takes up to {size} ASCII characters, none of them NUL")
    return value.encode("ascii").ljust(size, b"\0")


def special_of(field: AnyField, raw: int) -> Special | None:
    """The meaning that a raw value has, of floats the number: each NaN is the same, and so are both zeros."""
    if field.type != "float":
        return next((one for one in field.special if one.value == raw), None)
    for one in field.special:
        value, number = float_value(field, one.value), float_value(field, raw)
        if value == number or (value != value and number != number):
            return one
    return None


def float_value(field: AnyField, bits: int) -> float:
    """The number that the bits of a float field stand for."""
    packed = bits.to_bytes(field.bits // 8, "little")
    value: float = struct.unpack("<f" if field.bits == 32 else "<d", packed)[0]
    return value


def float_bits(field: AnyField, value: float) -> int:
    """The bits of the nearest float of the field's width. Raises `CodecError` on overflow."""
    try:
        packed = struct.pack("<f" if field.bits == 32 else "<d", value)
    except OverflowError:
        raise CodecError(f"{field.name!r} is a {field.bits}-bit float and cannot hold {value:g}") from None
    return int.from_bytes(packed, "little")


def to_double(exact: Fraction) -> float:
    """The nearest double, ties to even."""
    return exact.numerator / exact.denominator  # int / int rounds correctly, once


# A frame is handled as one number: bit w (0: least significant) of byte b is bit 8 * b + w of it.


@lru_cache(maxsize=1 << 16)
def _runs(at: int, bits: int, byte_order: str, bit_order: str) -> tuple[tuple[int, int, int], ...]:
    """Where the value's bits lie: (bit of the frame, bit of the value, how many in a row), together all of them."""
    places = []
    for number in range(at, at + bits):
        byte, bit = divmod(number, 8)
        places.append((byte, bit if bit_order == "lsb0" else 7 - bit))
    # the byte with the least significant bits first, and within a byte the least significant bit
    places.sort(key=lambda place: (place[0] if byte_order == "little" else -place[0], place[1]))
    runs: list[tuple[int, int, int]] = []
    for index, (byte, weight) in enumerate(places):
        here = 8 * byte + weight
        if runs and here == runs[-1][0] + runs[-1][2]:
            runs[-1] = (*runs[-1][:2], runs[-1][2] + 1)
        else:
            runs.append((here, index, 1))
    return tuple(runs)


def _read(node: Node, field: Field, frame: int) -> int | bytes:
    if field.is_bytes:
        part = frame >> field.at // 8 * 8 & (1 << field.bits) - 1
        return part.to_bytes(field.bits // 8, "little")
    value = 0
    for here, index, count in _runs(field.at, field.bits, *field.orders(node)):
        value |= (frame >> here & (1 << count) - 1) << index
    if field.signed and value >> (field.bits - 1):
        value -= 1 << field.bits
    return value


def _written(node: Node, field: Field, value: int | bytes) -> int:
    """The frame's bits that the value sets."""
    check_raw(field, value)
    if field.implied:
        return 0
    if isinstance(value, (bytes, bytearray)):
        return int.from_bytes(value, "little") << field.at // 8 * 8
    frame, value = 0, int(value)
    for here, index, count in _runs(field.at, field.bits, *field.orders(node)):
        frame |= (value >> index & (1 << count) - 1) << here
    return frame
