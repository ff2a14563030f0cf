"""Test patterns: frames and raw values that become vectors.

`frames` yields frames of a message (decoded by each language), `value_sets` yields raw
values (encoded by each language), `refused_raws` returns raw values that encoders must refuse.
The choice of patterns decides which faults of generated code the vectors detect.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import lru_cache
from itertools import pairwise

from icdgen import codec
from icdgen.icd.frames import FrameField, fixed_fields, frame_fields
from icdgen.icd.layout import VariablePart
from icdgen.icd.model import Message, Node
from icdgen.icd.places import AnyScalar

RANDOM_FRAMES = 4

# Every byte and every nibble differs from its neighbours; the first has the top bit
# clear, the second set.
_DISTINCT = (0x123456789ABCDEF0, 0xFEDCBA9876543210)

# Zeros, ones, common values, infinities, quiet and signaling NaNs with payloads,
# subnormal and extreme values.
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
    """Yield frames as bytes, reserved bits included, each with its purpose.

    For messages of variable length, the longest frame is shortened to several numbers
    of elements.
    """
    yield from _alternatives(message, node)
    if message.may_end_early:
        yield from _ended_early(message)
    if not message.layout.parts:
        yield from _longest(message)
        return
    last = message.layout.parts[-1]
    counts, few = _counts(last), last.fewest
    yield (
        f"all zeros, {few or 'no'} element{'s' * (few > 1)}",
        cut(message, node, bytes(message.length), few),
    )
    for number, (why, frame) in enumerate(_longest(message)):
        yield why, cut(message, node, frame, last.most)
        count = counts[number % len(counts)]
        yield f"{why}, elements: {count}", cut(message, node, frame, count)


def _alternatives(message: Message, node: Node) -> Iterator[tuple[str, bytes]]:
    """Yield frames for each value that decides on the presence of an optional field,
    and for the neighbors of that value.
    """
    fields = {field.name: field for field in fixed_fields(message.layout, node.orders)}
    yielded = set()
    for field in fields.values():
        # The other conditions of a field hold while one is tested.
        chosen = {
            fields[condition.field]: condition.values[0]
            for condition in field.conditions
        }
        for condition in field.conditions:
            selector = fields[condition.field]
            near = sorted(
                {value + step for value in condition.values for step in (-1, 0, 1)}
            )
            for value in (
                number
                for number in near
                if selector.raw_min <= number <= selector.raw_max
            ):
                values = {**chosen, selector: value}
                why = ", ".join(
                    f"{field.name} {number}" for field, number in values.items()
                )
                # Several fields can depend on the same value.
                if why not in yielded:
                    yielded.add(why)
                    yield (
                        why,
                        codec.with_numbers(
                            random_frame(message, f"alternative {why}"), values
                        ),
                    )
                    yield (
                        f"{why}, all others ones",
                        codec.with_numbers(b"\xff" * message.length, values),
                    )


def _ended_early(message: Message) -> Iterator[tuple[str, bytes]]:
    """Yield frames with omitted trailing zeros: several short lengths, eighths of the
    maximum, and all but one byte.
    """
    longest = message.length
    sizes = {
        *range(1, min(longest, 10)),
        *(longest * part // 8 for part in range(1, 8)),
        longest - 1,
    }
    # The first byte is always sent.
    for size in sorted(sizes - {0}):
        yield (
            f"ended early, bytes: {size}",
            random_frame(message, f"ended early {size}")[:size],
        )
    yield "ended early, zeros", bytes(longest - 1)


def _counts(part: VariablePart) -> list[int]:
    """Return numbers of elements to test: around both limits and in the middle."""
    few, most = part.fewest, part.most
    counts = (few + 1, most - 1, few, (few + most + 1) // 2, few + 2, most)
    return list(dict.fromkeys(max(few, min(count, most)) for count in counts))


def cut(message: Message, node: Node, frame: bytes, count: int) -> bytes:
    """Return the longest frame shortened to ``count`` elements of the last variable
    part.

    If ``count`` is the maximum, other variable parts are complete; otherwise their
    number of elements varies.
    """
    *earlier, last = message.layout.parts
    counts: dict[str, int] = {}

    def choose(part: VariablePart) -> int:
        choices = _counts(part)
        is_longest = count == last.most
        # Derived from the frame, so that the choice is deterministic but differs
        # between frames.
        if is_longest:
            return part.most
        return choices[(sum(frame) + len(counts)) % len(choices)]

    for part in earlier:
        counts[part.name] = choose(part)
    counts[last.name] = count
    # Arrays in elements can have the same counter.
    counters: dict[str, int] = {}
    for part in message.layout.parts:
        for inner in part.inner:
            low = message.layout.smallest_raw_of_counter(inner.counter)
            high = message.layout.largest_raw_of_counter(inner.counter)
            value = counters.setdefault(
                inner.counter, max(low, min(choose(inner) - inner.plus, high))
            )
            counts[part.inner_name(inner)] = value + inner.plus
    return shortened(message, with_counts(message, node, frame, counts), counts)


def with_counts(
    message: Message, node: Node, frame: bytes, counts: Mapping[str, int]
) -> bytes:
    """Return the longest frame with these numbers of elements in the counters."""
    fields = {field.name: field for field in fixed_fields(message.layout, node.orders)}
    values = {}
    for name, part in message.layout.parts_by_size.items():
        if name in counts and not part.is_rest:
            values[fields[part.counter]] = counts[name] - part.plus
    return codec.with_numbers(frame, values)


def shortened(message: Message, frame: bytes, sizes: Mapping[str, int]) -> bytes:
    """Return the longest frame without the elements beyond these sizes."""
    # From the end, because a cut moves all bytes behind it.
    for gap in reversed(list(message.layout.gaps(sizes))):
        frame = frame[: gap.begin] + frame[gap.end :]
    return frame


def _longest(message: Message) -> Iterator[tuple[str, bytes]]:
    length = message.length
    yield "all zeros", bytes(length)
    if not length:
        return
    yield "all ones", b"\xff" * length
    # Together, these frames give each bit of the message a unique pattern of values.
    for number in range((length * 8 - 1).bit_length()):
        code = _position_code(length, number)
        yield f"bit {number} of each bit's position", code
        yield (
            f"bit {number} of each bit's position, inverted",
            bytes(byte ^ 0xFF for byte in code),
        )
    for number in range(RANDOM_FRAMES):
        yield f"random {number}", random_frame(message, f"vector {number}")


@lru_cache(maxsize=1 << 12)
def _position_code(length: int, number: int) -> bytes:
    """Return a frame in which bit p has the value of bit ``number`` of p.

    Over all numbers, each bit of the frame has a different code, so that any mix-up of
    bits is detected.
    """
    # The lowest three bits of a position are the position in the byte.
    if number < 3:
        return bytes((0b10101010, 0b11001100, 0b11110000)[number : number + 1]) * length
    return bytes(0xFF * (byte >> number - 3 & 1) for byte in range(length))


def random_frame(message: Message, seed: str) -> bytes:
    """Return pseudo-random bytes, the same on every run.

    ``seed`` distinguishes frames of one message.
    """
    # A hash, so that the bytes do not depend on the frames that were made before.
    return hashlib.shake_128(f"{message.node}/{message.name}/{seed}".encode()).digest(
        message.length
    )


def values(field: AnyScalar) -> list[int | bytes]:
    """Return the raw values of a field to test, without duplicates."""
    if field.is_bytes:
        size = field.bits // 8
        ascending = bytes(number & 0xFF for number in range(1, size + 1))
        if field.type == "text":
            texts = (
                ascending,
                ascending[: size // 2].ljust(size, b"\0"),  # ends early
                bytes(size - 1) + b"x",  # a character in the last byte only
                bytes(size),
                b"\x7f" * size,  # the last ASCII character
                b"\x80" * size,  # no ASCII
            )
            return list(dict.fromkeys(texts))
        return [ascending, bytes(size), bytes(byte ^ 0xFF for byte in ascending)]
    if field.type == "float":
        bits_of_values = [*_FLOATS[field.bits]]
        bits_of_values += [special.value for special in field.special]
        for number in _near(field):
            # A single cannot represent every number of a lookup table.
            with suppress(codec.CodecError):
                bits_of_values.append(codec.float_bits(field, number))
        return list(dict.fromkeys(bits_of_values))
    if field.type == "bool":
        return [0, 1]
    return list(
        dict.fromkeys(v for v in _numbers(field) if field.raw_min <= v <= field.raw_max)
    )


def _numbers(field: AnyScalar) -> Iterator[int]:
    low, high = field.raw_min, field.raw_max
    yield from (0, low, high)
    if field.is_signed:
        yield from (-1, 1, low + 1)
    for pattern in _DISTINCT:
        value = pattern >> (64 - field.bits)
        # In two's complement, a signed field has the same bits.
        yield value - (1 << field.bits) if value > high else value
    # Off-by-one errors at the upper end, which the maximum alone would not show.
    yield high - 1
    if field.type == "enum" and field.enum is not None:
        for member in field.enum.members:
            yield from dict.fromkeys((member.value, member.last))
        for member in field.enum.members:
            if member.to is not None:
                yield from (member.value + 1, member.to + 1)
        if field.enum.unnamed is not None:
            yield field.enum.unnamed
    if field.const is not None:
        yield from (field.const, field.const + 1)
    for special in field.special:
        yield special.value
    for near in _near(field):
        yield from (math.floor(near), math.ceil(near))


def _near(field: AnyScalar) -> Iterator[float]:
    """Yield the points of a lookup table, their midpoints, and values beyond both ends."""
    points = [raw for raw, _ in field.curve.points] if field.curve is not None else []
    if points:
        yield from (*points, points[0] - 1, points[-1] + 1)
        yield from ((left + right) / 2 for left, right in pairwise(points))


def value_sets(message: Message, node: Node) -> Iterator[dict[str, int | bytes]]:
    """Yield raw values of the longest frame, so that each field takes each of its
    values.

    Neighboring fields advance out of step.
    """
    fields = [
        field for field in frame_fields(message.layout, node.orders) if field.is_raw
    ]
    counters = {
        part.counter: _counter_values(message, part)
        for part in message.layout.counted_parts
    }
    columns = [counters.get(field.name) or values(field) for field in fields]
    alternatives = dict.fromkeys(
        tuple((condition.field, condition.values[0]) for condition in field.conditions)
        for field in fields
    )
    # A shift by the index prevents that equal fields always have equal values.
    for row in range(max(map(len, columns), default=0)):
        raw = {
            field.name: column[(row + index) % len(column)]
            for index, (field, column) in enumerate(zip(fields, columns, strict=True))
        }
        yield raw
        # Without these rows, a field is absent unless its selector has the right value
        # by chance.
        for chosen in filter(None, alternatives):
            yield {**raw, **dict(chosen)}


def _counter_values(message: Message, part: VariablePart) -> list[int | bytes]:
    """Return values of a counter.

    Every second value is the maximum, so that all elements are tested.
    """
    low = message.layout.smallest_raw_of_counter(part.counter)
    high = message.layout.largest_raw_of_counter(part.counter)
    return [
        max(low, min(number - part.plus, high))
        for count in _counts(part)
        for number in (part.most, count)
    ]


def refused_raws(message: Message, field: FrameField) -> list[int]:
    """Return raw values that encoding must refuse."""
    if any(field.name == part.counter for part in message.layout.counted_parts):
        low = message.layout.smallest_raw_of_counter(field.name)
        high = message.layout.largest_raw_of_counter(field.name)
        return list(
            dict.fromkeys((high + 1, low - 1, field.raw_max + 1, field.raw_min - 1))
        )
    # Languages represent other types by values of exactly their range.
    if field.type not in ("uint", "int", "enum"):
        return []
    return [field.raw_max + 1, field.raw_min - 1]
