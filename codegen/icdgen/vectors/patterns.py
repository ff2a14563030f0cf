"""Which frames and which values are worth a vector."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator
from contextlib import suppress
from functools import lru_cache
from itertools import pairwise

from icdgen import codec
from icdgen.icd.model import Field, Message, Node, Tail
from icdgen.icd.places import AnyField

RANDOM_FRAMES = 4

# Every byte and every nibble differs from its neighbours; the first has the top bit clear, the second set.
_DISTINCT = (0x123456789ABCDEF0, 0xFEDCBA9876543210)

_FLOATS = {
    32: (
        0x00000000, 0x80000000, 0x3F800000, 0xC2F6E979, 0x7F800000, 0xFF800000, 0x7FC00000, 0x7F800001, 0xFFA55A3C,
        0x00000001, 0x807FFFFF, 0x7F7FFFFF, 0x00800000, 0x12345678,
    ),
    64: (
        0x0000000000000000, 0x8000000000000000, 0x3FF0000000000000, 0xC05EDD2F1A9FBE77, 0x7FF0000000000000,
        0xFFF0000000000000, 0x7FF8000000000000, 0x7FF0000000000001, 0xFFF5A55A3CC31E87, 0x0000000000000001,
        0x800FFFFFFFFFFFFF, 0x7FEFFFFFFFFFFFFF, 0x0010000000000000, 0x123456789ABCDEF0,
    ),
}  # fmt: skip


def frames(message: Message, node: Node) -> Iterator[tuple[str, bytes]]:
    """Frames given as bytes, reserved bits and all: what they are for, and the bytes.

    Where frames differ in length, the longest is cut to different numbers of elements, and says so.
    """
    yield from _alternatives(message, node)
    if message.may_end_early:
        yield from _ended_early(message)
    if message.tail is None:
        yield from _longest(message)
        return
    counts = _counts(message.tail)
    few = message.tail.fewest
    yield f"all zeros, {few or 'no'} element{'s' * (few > 1)}", cut(message, node, bytes(message.length), few)
    for number, (why, frame) in enumerate(_longest(message)):
        yield why, cut(message, node, frame, message.tail.most)
        count = counts[number % len(counts)]
        yield f"{why}, elements: {count}", cut(message, node, frame, count)


def _alternatives(message: Message, node: Node) -> Iterator[tuple[str, bytes]]:
    """Frames for every value on which it depends whether a field is there, and for those beside it."""
    known, told = {field.name: field for field in message.fields}, set()
    for field in message.fields:
        chosen = {known[one.field]: one.values[0] for one in field.when}
        for one in field.when:
            selector = known[one.field]
            near = sorted({value + step for value in one.values for step in (-1, 0, 1)})
            for value in (number for number in near if selector.raw_min <= number <= selector.raw_max):
                values = {**chosen, selector: value}
                why = ", ".join(f"{on.name} {number}" for on, number in values.items())
                if why not in told:
                    told.add(why)
                    yield why, codec.frame_of(node, random_frame(message, f"alternative {why}"), values)
                    yield f"{why}, all others ones", codec.frame_of(node, b"\xff" * message.length, values)


def _ended_early(message: Message) -> Iterator[tuple[str, bytes]]:
    """Frames without the zeros of their end: of every number of bytes up to some, of the most, and of a few between."""
    longest = message.length
    sizes = {*range(1, min(longest, 10)), *(longest * part // 8 for part in range(1, 8)), longest - 1}
    for size in sorted(sizes - {0}):
        yield f"ended early, bytes: {size}", random_frame(message, f"ended early {size}")[:size]
    yield "ended early, zeros", bytes(longest - 1)


def _counts(tail: Tail) -> list[int]:
    """Numbers of elements that are worth a frame."""
    few, most = tail.fewest, tail.most
    found = (few + 1, most - 1, few, (few + most + 1) // 2, few + 2, most)
    return list(dict.fromkeys(max(few, min(one, most)) for one in found))


def cut(message: Message, node: Node, frame: bytes, count: int) -> bytes:
    """The longest frame as one of so many elements."""
    assert message.tail is not None
    frame = _chosen_counts(message, node, frame, count)
    frame = codec.counted(node, message, frame, count)[: message.begin + count * message.tail.step]
    return codec.squeezed(node, message, frame) if message.inner else frame


def _chosen_counts(message: Message, node: Node, frame: bytes, count: int) -> bytes:
    """The longest frame with a number of elements of each inner open part: all where its end has all, else any."""
    fields, chosen = {field.name: field for field in message.fields}, {}
    for place, part in enumerate(message.inner):
        counts = _counts(part)
        is_whole = message.tail is not None and count == message.tail.most
        there = part.most if is_whole else counts[(sum(frame) + place) % len(counts)]
        chosen[fields[part.counter]] = there - part.plus
    return codec.frame_of(node, frame, chosen) if chosen else frame


def _longest(message: Message) -> Iterator[tuple[str, bytes]]:
    length = message.length
    yield "all zeros", bytes(length)
    if not length:
        return
    yield "all ones", b"\xff" * length
    for number in range((length * 8 - 1).bit_length()):
        code = _position_code(length, number)
        yield f"bit {number} of each bit's position", code
        yield f"bit {number} of each bit's position, inverted", bytes(byte ^ 0xFF for byte in code)
    for number in range(RANDOM_FRAMES):
        yield f"random {number}", random_frame(message, f"vector {number}")


@lru_cache(maxsize=1 << 12)
def _position_code(length: int, number: int) -> bytes:
    """Bit p is bit ``number`` of p: over all numbers, no two bits of the frame hold the same code."""
    return bytes(sum(((byte * 8 + bit) >> number & 1) << bit for bit in range(8)) for byte in range(length))


def random_frame(message: Message, seed: str) -> bytes:
    """Bytes that look random and are the same on every run; ``seed`` tells frames of one message apart."""
    return hashlib.shake_128(f"{message.node}/{message.name}/{seed}".encode()).digest(message.length)


def values(field: AnyField) -> list[int | bytes]:
    """The raw values of a field that are worth a frame each, without repetition."""
    if field.is_bytes:
        size = field.bits // 8
        ascending = bytes(number & 0xFF for number in range(1, size + 1))
        if field.type == "text":
            ended, last = ascending[: size // 2].ljust(size, b"\0"), bytes(size - 1) + b"x"
            return list(dict.fromkeys((ascending, ended, last, bytes(size), b"\x7f" * size, b"\x80" * size)))
        return [ascending, bytes(size), bytes(byte ^ 0xFF for byte in ascending)]
    if field.type == "float":
        named = (special.value for special in field.special)
        return list(dict.fromkeys((*_FLOATS[field.bits], *named, *_near_bits(field))))
    if field.type == "bool":
        return [0, 1]
    return list(dict.fromkeys(v for v in _numbers(field) if field.raw_min <= v <= field.raw_max))


def _numbers(field: AnyField) -> Iterator[int]:
    low, high = field.raw_min, field.raw_max
    yield from (0, low, high)
    if field.signed:
        yield from (-1, 1, low + 1)
    for pattern in _DISTINCT:
        value = pattern >> (64 - field.bits)
        yield value - (1 << field.bits) if value > high else value
    yield high - 1
    if field.type == "enum" and field.enum is not None:
        yield from (value for one in field.enum.members for value in dict.fromkeys((one.value, one.last)))
        yield from (value for one in field.enum.members if one.to is not None for value in (one.value + 1, one.to + 1))
        if field.enum.unnamed is not None:
            yield field.enum.unnamed
    if field.const is not None:
        yield from (field.const, field.const + 1)
    for special in field.special:
        yield special.value
    yield from (number for near in _near(field) for number in (math.floor(near), math.ceil(near)))


def _near_bits(field: AnyField) -> Iterator[int]:
    for number in _near(field):
        with suppress(codec.CodecError):
            yield codec.float_bits(field, number)


def _near(field: AnyField) -> Iterator[float]:
    """The points of a table, and what lies between them and beyond."""
    points = [raw for raw, _ in field.curve.points] if field.curve is not None else []
    if points:
        yield from (*points, points[0] - 1, points[-1] + 1)
        yield from ((one + other) / 2 for one, other in pairwise(points))


def raw_columns(message: Message) -> Iterator[dict[str, int | bytes]]:
    """Raw values of all fields but views, so that each takes each of its values; neighbours are out of step."""
    counted = {part.counter: _counted(part) for part in message.open_parts}
    columns = [counted.get(field.name) or values(field) for field in message.owners]
    alternatives = dict.fromkeys(tuple((one.field, one.values[0]) for one in field.when) for field in message.owners)
    for row in range(max(map(len, columns), default=0)):
        raw = {
            field.name: column[(row + index) % len(column)]
            for index, (field, column) in enumerate(zip(message.owners, columns, strict=True))
        }
        yield raw
        for chosen in filter(None, alternatives):
            yield {**raw, **dict(chosen)}


def _counted(tail: Tail) -> list[int | bytes]:
    """Values of the field that counts: every second time all elements are there."""
    return [one - tail.plus for count in _counts(tail) for one in (tail.most, count)]


def unfit(message: Message, field: Field) -> list[int]:
    """Raw values that encoding must refuse."""
    for part in message.open_parts:
        if field.name == part.counter:
            return list(dict.fromkeys((part.high + 1, part.low - 1, field.raw_max + 1, field.raw_min - 1)))
    if field.type not in ("uint", "int", "enum"):
        return []
    return [field.raw_max + 1, field.raw_min - 1]
