"""A node's vectors as data."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from icdgen import codec
from icdgen.icd.frames import FrameField, frame_fields
from icdgen.icd.layout import VariablePart
from icdgen.icd.model import CONFIGURATION, TELECOMMAND, TELEMETRY, Enum, Icd, Message, Node
from icdgen.vectors import patterns, shared
from icdgen.vectors.settings import Settings, bits_of, settings

FORMAT = 1

Raw = dict[str, "int | bytes"]


@dataclass(frozen=True, slots=True)
class Row:
    """One frame: ``frame`` is decoded to ``raw``, which is encoded to ``encoded`` (reserved bits 0)."""

    why: str
    frame: bytes
    raw: Raw
    encoded: bytes
    physical: dict[str, Fraction]  # exact, of the scaled fields
    texts: dict[str, str | None]  # of the text fields; None where the bytes are not ASCII
    doubles: dict[str, str]  # the physical values as doubles, those of curves, too; as 16 hex digits


@dataclass(frozen=True, slots=True)
class MessageVectors:
    """All that is demanded of the code of one message."""

    message: Message
    fields: tuple[FrameField, ...]  # of the longest frame
    # of a fresh message: 0, empty, or what ``const`` says; of views, what they read; without what is not there
    default: Raw
    rows: tuple[Row, ...]
    lengths: tuple[int, ...]  # frames of these lengths are refused
    miscounted: tuple[bytes, ...]  # and these, which do not have as many elements as they say
    unfit: dict[str, list[int]]  # raw values that encoding refuses, by field
    settings: dict[str, Settings]  # doubles and texts set as physical values, by field


@dataclass(frozen=True, slots=True)
class NodeVectors:
    """The vectors of what a node declares; those of included nodes are in files of their own."""

    node: Node
    ids: dict[str, dict[int, list[str]]]  # direction -> id -> the messages of it; every other id is unknown
    shared: tuple[shared.SharedRow, ...]  # frames of ids that several messages have
    enums: tuple[tuple[Enum, int | None], ...]  # with a value that has no member, where 64 bits leave one
    messages: tuple[MessageVectors, ...]


def make(icd: Icd, node: Node) -> NodeVectors:
    """All vectors of a node. Deterministic."""
    return NodeVectors(
        node=node,
        ids=_ids(icd, node),
        shared=tuple(shared.rows(icd, node)),
        enums=tuple((enum, enum.unnamed) for enum in node.enums),
        messages=tuple(message_vectors(node, message) for message in node.messages),
    )


def message_vectors(node: Node, message: Message) -> MessageVectors:
    """The vectors of one message that ``node`` declares."""
    frames = dict.fromkeys(frame for _, frame in patterns.frames(message, node))
    whys = {frame: why for why, frame in reversed(list(patterns.frames(message, node)))}
    rows = [frame_row(node, message, whys[frame], frame) for frame in frames]
    for number, raw in enumerate(patterns.raw_columns(message, node)):
        frame = codec.encode(node, message, raw)
        if frame not in frames:
            frames[frame] = None
            rows.append(frame_row(node, message, f"chosen values {number}", frame))
    fields = frame_fields(message.layout, node.orders)
    raw_fields = [field for field in fields if field.is_raw]
    settable = [field for field in raw_fields if (field.has_formula and field.is_invertible) or field.type == "text"]
    return MessageVectors(
        message=message,
        fields=fields,
        default=codec.new(node, message),
        rows=tuple(rows),
        lengths=_refused(message),
        miscounted=tuple(_miscounted(node, message)),
        unfit={field.name: unfit for field in raw_fields if (unfit := patterns.unfit(message, field))},
        settings={field.name: settings(field) for field in settable},
    )


def _refused(message: Message) -> tuple[int, ...]:
    """Lengths that no frame has: none at all, and one byte less or more than one that frames have."""
    layout = message.layout
    least = layout.shortest if len(layout.parts) > 1 else layout.length
    ends = {end + step for end in (least, layout.shortest, layout.shortest + 1, layout.longest) for step in (-1, 1)}
    if not layout.parts:
        ends = {layout.longest - 1, layout.longest + 1}
    return tuple(sorted({0, *(max(end, 0) for end in ends)} - set(layout.lengths)))


def _miscounted(node: Node, message: Message) -> Iterator[bytes]:
    """Frames that say one element more or less than they have, or more than there can be."""
    if not message.layout.parts:
        return
    last = message.layout.parts[-1]
    if len(message.layout.parts) > 1:
        for count in (last.fewest, last.most):
            yield from _miscounted_inside(node, message, count)
        return
    if last.is_rest:
        return
    frame = patterns.random_frame(message, "miscounted")
    counter = _counter(message, node, last)
    few, most, low, high = last.fewest, last.most, counter.raw_min + last.plus, counter.raw_max + last.plus
    top = 1 << counter.bits - 1  # which a narrower field does not see
    pairs = [(few, few + 1), (most, most - 1), (most - 1, most), (most, high), (few, few + top), (most, most + top)]
    for count, stated in (*pairs, *([(few, few - 1), (most, low)] if last.plus else ())):
        if stated != count >= few and low <= stated <= high:
            wrong = patterns.with_counts(message, node, frame, {last.name: stated})
            yield wrong[: last.begin + count * last.step]


def _miscounted_inside(node: Node, message: Message, count: int) -> Iterator[bytes]:
    """Frames of so many elements at the end that count others wrongly, and such as are cut."""
    longest = patterns.random_frame(message, "miscounted inside")
    frame = patterns.cut(message, node, longest, count)
    sizes = codec.sizes_of_frame(node, message, frame)
    wrong = [frame[:-1], frame[: message.layout.length]]
    highest: dict[FrameField, int] = {}
    for part in message.layout.parts:
        if part.is_rest:
            continue
        counter = _counter(message, node, part)
        highest[counter] = part.high
        for step in (-1, 1, part.most, 1 << counter.bits - 1):
            stated = sizes[part.name] - part.plus + step
            if counter.raw_min <= stated <= counter.raw_max:
                wrong.append(codec.frame_of(frame, {counter: stated}))
    for counter, high in highest.items():
        if high < counter.raw_max:  # more than there can be, in a frame that is as long as any
            wrong.append(codec.frame_of(longest, highest | {counter: high + 1}))
    yield from (one for one in dict.fromkeys(wrong) if not _is_frame(node, message, one))


def _counter(message: Message, node: Node, part: VariablePart) -> FrameField:
    """Return the field that counts the elements of a variable-length node."""
    return next(field for field in frame_fields(message.layout, node.orders) if field.name == part.counter)


def _is_frame(node: Node, message: Message, frame: bytes) -> bool:
    with suppress(codec.LengthError):
        return bool(codec.decode(node, message, frame))
    return False


def frame_row(node: Node, message: Message, why: str, frame: bytes) -> Row:
    """What the reference codec makes of a frame."""
    raw: dict[str, Any] = codec.decode(node, message, frame)
    present = [field for field in frame_fields(message.layout, node.orders) if field.name in raw]
    exact = ((field.name, codec.physical(field, raw[field.name])) for field in present)
    physical = {name: value for name, value in exact if value is not None}
    scaled = (field for field in present if field.has_formula)
    doubles = {field.name: bits_of(codec.physical_double(field, raw[field.name]) or 0.0) for field in scaled}
    texts = {field.name: known_text(raw[field.name]) for field in present if field.type == "text"}
    return Row(why, frame, raw, codec.encode(node, message, raw), physical, texts, doubles)


def known_text(raw: bytes) -> str | None:
    """What a text field says, if that is ASCII."""
    said = codec.text(raw)
    return None if "\ufffd" in said else said


def _ids(icd: Icd, node: Node) -> dict[str, dict[int, list[str]]]:
    found = {direction: shared.ids(icd, node, direction) for direction in (TELECOMMAND, TELEMETRY)}
    settings: dict[int, list[Message]] = {}
    for pick in ("set_id", "get_id"):  # a set_id wins over an equal get_id
        known = set(settings)
        for message in icd.messages_of(node):
            id = getattr(message, pick)
            if id is not None and id not in known:
                settings.setdefault(id, []).append(message)
    found[CONFIGURATION] = dict(sorted(settings.items()))
    return {
        direction: {id: [message.name for message in messages] for id, messages in ids.items()}
        for direction, ids in found.items()
    }
