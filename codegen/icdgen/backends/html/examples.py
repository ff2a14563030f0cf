"""Selection of golden vectors that a page shows.

`page_vectors` returns the frames of a message; `example_frames` returns two of them
with decoded values. The frames are those of `icdgen.vectors`, with which the generated
code of all languages is tested.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen import codec
from icdgen.backends.html.texts import MINUS, number
from icdgen.describe.display import base_of, digits_of, integer_text, number_text
from icdgen.frozen import NamedTuple
from icdgen.icd import floats
from icdgen.icd.model import Message, Node
from icdgen.icd.places import NodePlace, scalar_count
from icdgen.tables import printable_text
from icdgen.vectors import patterns

# Limits of the size of a page.
_MOST = 60  # maximum number of fields of a message whose values are shown
_MOST_BYTES = 1 << 16  # maximum length of all frames of a page together


class ExampleCell(NamedTuple):
    raw: str
    value: str


class ExampleFrame(NamedTuple):
    """Frame with the values of its fields."""

    why: str
    hex: str
    frame: bytes
    cells: list[ExampleCell]


class PageVectors(NamedTuple):
    """Golden vectors on a page: purpose and bytes of each frame, in order.

    ``are_all``: whether they are all frames of the message.
    """

    rows: list[tuple[str, str]]
    are_all: bool


def page_vectors(message: Message, node: Node) -> PageVectors:
    """Return the frames of the golden vectors of a message; of a message with very long
    frames, the first ones.
    """
    purposes: dict[bytes, str] = {}
    are_all = True
    size = 0
    for why, frame in _all_frames(message, node):
        if frame not in purposes:
            size += len(frame)
            if purposes and size > _MOST_BYTES:
                are_all = False
                break
            purposes[frame] = why
    rows = [(why, frame.hex(" ").upper()) for frame, why in purposes.items()]
    return PageVectors(rows, are_all)


def _all_frames(message: Message, node: Node) -> Iterator[tuple[str, bytes]]:
    """Yield purpose and bytes of each frame; none of a message without bytes."""
    if message.length:
        yield from patterns.frames(message, node)
        for index, raw in enumerate(patterns.value_sets(message, node)):
            yield f"chosen values {index}", codec.encode(node, message, raw)


def example_frames(message: Message, node: Node) -> list[ExampleFrame]:
    """Return a pseudo-random frame and a frame of ones, both from the golden vectors;
    empty for a message without bytes.
    """
    if not message.length:
        return []
    # Random bits show each field; a frame of ones shows the extreme values.
    rows = [
        # The seed of the first random frame of the vectors, so that the page shows a
        # frame that the tests of all languages use.
        ("random 0", patterns.random_frame(message, "vector 0")),
        ("all ones", b"\xff" * message.length),
    ]
    results = []
    for why, frame in rows:
        # The frame has all elements, so that each field has a value.
        if message.layout.parts:
            frame = patterns.cut(message, node, frame, message.layout.parts[-1].most)
        cells = []
        if scalar_count(message.layout) <= _MOST:
            raw = codec.decode(node, message, frame)
            cells = [_cell(field, raw.get(field.name)) for field in message.fields]
        results.append(ExampleFrame(why, frame.hex(" ").upper(), frame, cells))
    return results


def _cell(field: NodePlace, raw: int | bytes | None) -> ExampleCell:
    if raw is None:
        return ExampleCell("", "not there")
    if isinstance(raw, bytes):
        # 47 characters are the 16 bytes that are shown, with spaces between them.
        shown = raw.hex(" ").upper()
        content = codec.text(raw) if field.type == "text" else ""
        return ExampleCell(
            shown if len(raw) <= 16 else f"{shown[:47]} …", printable_text(content)
        )
    if field.type == "float":
        value = floats.text_of(codec.float_value(field, raw), field.bits)
        if digits_of(field) is not None:
            value = number_text(field, codec.value_double(field, raw))
        return ExampleCell(f"0x{raw:0{field.bits // 4}X}", value.replace("-", MINUS))
    if field.enum is not None:
        member = field.enum.member_of(raw)
        name = member.name if member else "no member"
        return ExampleCell(_raw_text(field, raw), name)
    if field.type == "bool":
        return ExampleCell(str(raw), "true" if raw else "false")
    physical = (
        codec.physical(field, raw)
        if field.curve is None
        else codec.value_double(field, raw)
    )
    return ExampleCell(
        _raw_text(field, raw),
        "" if physical is None else number_text(field, physical).replace("-", MINUS),
    )


def _raw_text(field: NodePlace, raw: int) -> str:
    """Return the raw value of an integer field in its display format."""
    return integer_text(field, raw) if base_of(field) else number(raw)
