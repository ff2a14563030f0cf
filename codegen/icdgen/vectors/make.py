"""Golden vectors of a node as data.

`make_vectors` decodes and encodes the frames of `icdgen.vectors.patterns` with the
reference codec (`icdgen.codec`). `icdgen.vectors.write` writes the result as JSON.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from icdgen import codec
from icdgen.icd.frames import FrameField, frame_fields
from icdgen.icd.layout import VariablePart
from icdgen.icd.model import (
    CONFIGURATION,
    TELECOMMAND,
    TELEMETRY,
    Enum,
    Icd,
    Message,
    Node,
)
from icdgen.vectors import patterns, shared
from icdgen.vectors.settings import Assignments, assignments_of_field, bits_of

FORMAT = 1

RawValues = dict[str, "int | bytes"]


@dataclass(frozen=True, slots=True)
class FrameVector:
    """Vector of one frame: ``frame`` decodes to ``raw``, which encodes to ``encoded``
    (reserved bits 0).
    """

    why: str
    frame: bytes
    raw: RawValues
    encoded: bytes
    physical: dict[str, Fraction]  # exact physical values of scaled fields
    texts: dict[str, str | None]  # of text fields; None if the bytes are not ASCII
    # Physical values as doubles (all formulas), 16 hex digits each
    doubles: dict[str, str]


@dataclass(frozen=True, slots=True)
class MessageVectors:
    """Vectors of one message."""

    message: Message
    fields: tuple[FrameField, ...]  # fields of the longest frame
    # Initial values: 0, empty, ``const`` or the minimum of a counter; overlays have the
    # value that they read.
    # Absent optional fields are missing.
    default: RawValues
    rows: tuple[FrameVector, ...]
    refused_lengths: tuple[int, ...]
    # Frames of permitted lengths whose counters contradict the length
    refused_frames: tuple[bytes, ...]
    refused_raws: dict[str, list[int]]  # raw values by field
    # Assignments of physical values and texts, by field
    assignments: dict[str, Assignments]


@dataclass(frozen=True, slots=True)
class NodeVectors:
    """Vectors of the declarations of one node.

    Included nodes have their own vector files.
    """

    node: Node
    # Direction -> id -> messages; all other ids are unknown
    ids: dict[str, dict[int, list[str]]]
    shared: tuple[shared.SharedRow, ...]  # frames of ids that several messages share
    # With a value that has no member; None if members cover all values
    enums: tuple[tuple[Enum, int | None], ...]
    messages: tuple[MessageVectors, ...]


def make_vectors(icd: Icd, node: Node) -> NodeVectors:
    """Return all vectors of a node. The result is deterministic."""
    return NodeVectors(
        node=node,
        ids=_ids(icd, node),
        shared=tuple(shared.shared_rows(icd, node)),
        enums=tuple((enum, enum.unnamed) for enum in node.enums),
        messages=tuple(message_vectors(node, message) for message in node.messages),
    )


def message_vectors(node: Node, message: Message) -> MessageVectors:
    """Return the vectors of one message that ``node`` declares."""
    # A frame can result from several patterns; the first one names it.
    frames = dict.fromkeys(frame for _, frame in patterns.frames(message, node))
    whys = {frame: why for why, frame in reversed(list(patterns.frames(message, node)))}
    vectors = [frame_vector(node, message, whys[frame], frame) for frame in frames]
    for number, raw in enumerate(patterns.value_sets(message, node)):
        frame = codec.encode(node, message, raw)
        if frame not in frames:
            frames[frame] = None
            why = f"chosen values {number}"
            vectors.append(frame_vector(node, message, why, frame))
    fields = frame_fields(message.layout, node.orders)
    raw_fields = [field for field in fields if field.is_raw]
    assignable = [
        field
        for field in raw_fields
        if (field.has_formula and field.is_invertible) or field.type == "text"
    ]
    refused_raws = {
        field.name: patterns.refused_raws(message, field) for field in raw_fields
    }
    return MessageVectors(
        message=message,
        fields=fields,
        default=codec.initial_object_values(node, message),
        rows=tuple(vectors),
        refused_lengths=_refused_lengths(message),
        refused_frames=tuple(_miscounted(node, message)),
        refused_raws={name: raws for name, raws in refused_raws.items() if raws},
        assignments={field.name: assignments_of_field(field) for field in assignable},
    )


def _refused_lengths(message: Message) -> tuple[int, ...]:
    """Return refused lengths: 0, and the neighbors of the permitted lengths."""
    layout = message.layout
    if not layout.parts:
        ends = [layout.longest]
    elif layout.has_inner_gaps:
        # Any length from the shortest to the longest may be permitted.
        ends = [layout.shortest, layout.shortest + 1, layout.longest]
    else:
        # The fixed part alone is the shortest frame whose counter can be read.
        ends = [layout.length, layout.shortest, layout.shortest + 1, layout.longest]
    neighbors = {max(end + step, 0) for end in ends for step in (-1, 1)}
    return tuple(sorted({0, *neighbors} - set(layout.lengths)))


def _miscounted(node: Node, message: Message) -> Iterator[bytes]:
    """Yield frames with one element more or less than their counter, or with a counter
    that is beyond its maximum or that is wrong in its highest bit only.
    """
    if not message.layout.parts:
        return
    # The last part takes the remaining bytes, so its count determines the length.
    last = message.layout.parts[-1]
    if message.layout.has_inner_gaps:
        for count in (last.fewest, last.most):
            yield from _miscounted_with_gaps(node, message, count)
        return
    # Without a counter, nothing can contradict the length.
    if last.is_rest:
        return
    frame = patterns.random_frame(message, "miscounted")
    counter = _counter(message, node, last)
    few, most = last.fewest, last.most
    # The smallest and largest number of elements that the counter can state
    least_stated = counter.raw_min + last.plus
    most_stated = counter.raw_max + last.plus
    # Highest bit of the counter, which a narrower implementation would ignore
    top = 1 << counter.bits - 1
    # (elements in the frame, elements that its counter states)
    pairs = [
        (few, few + 1),
        (most, most - 1),
        (most - 1, most),
        (most, most_stated),
        (few, few + top),
        (most, most + top),
    ]
    if last.plus:
        pairs += [(few, few - 1), (most, least_stated)]
    for actual, stated in pairs:
        # Fewer elements than the minimum are a wrong length (`_refused_lengths`).
        if actual < few or actual == stated:
            continue
        if least_stated <= stated <= most_stated:
            invalid = patterns.with_counts(message, node, frame, {last.name: stated})
            yield invalid[: last.begin + actual * last.step]


def _miscounted_with_gaps(node: Node, message: Message, count: int) -> Iterator[bytes]:
    """Yield invalid frames of a message with several variable parts, whose last part
    has ``count`` elements: with a wrong counter, or with missing bytes.
    """
    longest = patterns.random_frame(message, "miscounted inside")
    frame = patterns.cut(message, node, longest, count)
    sizes = codec.sizes_of_frame(node, message, frame)
    invalid = [frame[:-1], frame[: message.layout.length]]
    highest: dict[FrameField, int] = {}
    for name, part in message.layout.parts_by_size.items():
        if part.is_rest:
            continue
        counter = _counter(message, node, part)
        highest[counter] = message.layout.largest_raw_of_counter(part.counter)
        # One less or more, far too many, and another highest bit
        for step in (-1, 1, part.most, 1 << counter.bits - 1):
            stated = sizes[name] - part.plus + step
            if counter.raw_min <= stated <= counter.raw_max:
                invalid.append(codec.with_numbers(frame, {counter: stated}))
    for counter, high in highest.items():
        # Above the maximum, in a frame of the maximum length
        if high < counter.raw_max:
            invalid.append(codec.with_numbers(longest, highest | {counter: high + 1}))
    # The last part takes the remaining bytes and can make up for a wrong counter, so
    # some of these frames are valid.
    for candidate in dict.fromkeys(invalid):
        if not _can_decode(node, message, candidate):
            yield candidate


def _counter(message: Message, node: Node, part: VariablePart) -> FrameField:
    """Return the field that counts the elements of a variable part."""
    return next(
        field
        for field in frame_fields(message.layout, node.orders)
        if field.name == part.counter
    )


def _can_decode(node: Node, message: Message, frame: bytes) -> bool:
    with suppress(codec.LengthError):
        return bool(codec.decode(node, message, frame))
    return False


def frame_vector(node: Node, message: Message, why: str, frame: bytes) -> FrameVector:
    """Return the vector of a frame, decoded and encoded by the reference codec."""
    raw: dict[str, Any] = codec.decode(node, message, frame)
    physical: dict[str, Fraction] = {}
    doubles: dict[str, str] = {}
    texts: dict[str, str | None] = {}
    for field in frame_fields(message.layout, node.orders):
        if field.name not in raw:
            continue  # an absent optional field
        value = raw[field.name]
        # Lookup tables and polynomials have no exact fraction; `doubles` covers them.
        exact = codec.physical(field, value)
        if exact is not None:
            physical[field.name] = exact
        if field.has_formula:
            double = codec.physical_double(field, value)
            assert double is not None
            # A negative zero is written as 0.
            doubles[field.name] = bits_of(double or 0.0)
        if field.type == "text":
            texts[field.name] = ascii_text(value)
    return FrameVector(
        why, frame, raw, codec.encode(node, message, raw), physical, texts, doubles
    )


def ascii_text(raw: bytes) -> str | None:
    """Return the content of a text field; None if it is not ASCII."""
    content = codec.text(raw)
    return None if "\ufffd" in content else content


def _ids(icd: Icd, node: Node) -> dict[str, dict[int, list[str]]]:
    """Return the names of messages by direction and id.

    For the direction ``configuration``, messages by ``set_id`` and ``get_id``.
    """
    ids_by_direction = {
        direction: shared.messages_by_id(icd, node, direction)
        for direction in (TELECOMMAND, TELEMETRY)
    }
    configurations: dict[int, list[Message]] = {}
    for pick in ("set_id", "get_id"):  # a set_id has precedence over an equal get_id
        taken = set(configurations)
        for message in icd.messages_of(node):
            id = getattr(message, pick)
            if id is not None and id not in taken:
                configurations.setdefault(id, []).append(message)
    ids_by_direction[CONFIGURATION] = dict(sorted(configurations.items()))
    return {
        direction: {
            id: [message.name for message in messages] for id, messages in ids.items()
        }
        for direction, ids in ids_by_direction.items()
    }
