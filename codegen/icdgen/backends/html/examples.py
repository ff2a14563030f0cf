"""Selection of golden vectors that a page shows."""

from __future__ import annotations

from typing import NamedTuple

from icdgen import codec
from icdgen.backends.html.texts import MINUS, number
from icdgen.describe.display import base_of, digits_of, integer_text, number_text
from icdgen.icd import floats
from icdgen.icd.model import Message, Node
from icdgen.icd.places import NodePlace, scalars_in
from icdgen.tables import clean
from icdgen.vectors import patterns

_MOST = 60  # maximum number of fields of a message whose values are shown


class Cell(NamedTuple):
    raw: str
    value: str


class Example(NamedTuple):
    """Frame with the values of its fields."""

    why: str
    hex: str
    frame: bytes
    cells: list[Cell]


def frames(message: Message, node: Node) -> list[tuple[str, str]]:
    """Return purpose and bytes of each frame of the golden vectors of a message, in
    order.
    """
    if not message.length:
        return []
    purposes: dict[bytes, str] = {}
    for why, frame in patterns.frames(message, node):
        purposes.setdefault(frame, why)
    for index, raw in enumerate(patterns.raw_columns(message, node)):
        purposes.setdefault(codec.encode(node, message, raw), f"chosen values {index}")
    return [(why, frame.hex(" ").upper()) for frame, why in purposes.items()]


def examples(message: Message, node: Node) -> list[Example]:
    """Return a pseudo-random frame and a frame of ones, both from the golden vectors;
    empty for a message without bytes.
    """
    if not message.length:
        return []
    # Random bits show each field; a frame of ones shows the extreme values.
    rows = [
        ("random 0", patterns.random_frame(message, "vector 0")),
        ("all ones", b"\xff" * message.length),
    ]
    results = []
    for why, frame in rows:
        # The frame has all elements, so that each field has a value.
        if message.layout.parts:
            frame = patterns.cut(message, node, frame, message.layout.parts[-1].most)
        raw = (
            codec.decode(node, message, frame)
            if len(scalars_in(message.layout)) <= _MOST
            else {}
        )
        cells = (
            [_cell(field, raw.get(field.name)) for field in scalars_in(message.layout)]
            if raw
            else []
        )
        results.append(Example(why, frame.hex(" ").upper(), frame, cells))
    return results


def _cell(field: NodePlace, raw: int | bytes | None) -> Cell:
    if raw is None:
        return Cell("", "not there")
    if isinstance(raw, bytes):
        shown = raw.hex(" ").upper()
        content = codec.text(raw) if field.type == "text" else ""
        return Cell(shown if len(raw) <= 16 else f"{shown[:47]} …", clean(content))
    if field.type == "float":
        value = floats.text_of(codec.float_value(field, raw), field.bits)
        if digits_of(field) is not None:
            value = number_text(field, codec.value_double(field, raw))
        return Cell(f"0x{raw:0{field.bits // 4}X}", value.replace("-", MINUS))
    if field.enum is not None:
        member = field.enum.member_of(raw)
        name = member.name if member else "no member"
        return Cell(_raw(field, raw), name)
    if field.type == "bool":
        return Cell(str(raw), "true" if raw else "false")
    physical = (
        codec.physical(field, raw)
        if field.curve is None
        else codec.value_double(field, raw)
    )
    return Cell(
        _raw(field, raw),
        "" if physical is None else number_text(field, physical).replace("-", MINUS),
    )


def _raw(field: NodePlace, raw: int) -> str:
    """Return the raw value of an integer field in its display format."""
    return integer_text(field, raw) if base_of(field) else number(raw)
