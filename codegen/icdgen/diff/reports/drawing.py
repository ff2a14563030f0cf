"""Drawing of the old and new bit layout of a frame, as rectangles for an SVG.

`draw` returns coordinates in pixels; the template ``templates/html/layouts.html.j2``
writes the SVG.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import groupby

from icdgen.diff.change import Change
from icdgen.diff.layers import MEANING, SOURCE
from icdgen.diff.pairs import FieldPair, MessagePair, kind
from icdgen.diff.wording import formula, span, type_of
from icdgen.frozen import NamedTuple
from icdgen.icd.lines import Line

BITS = 64  # bits of a row
CELL = 14  # width of a bit in pixels
HEIGHT = 26  # of a strip
GAP = 16  # between the old strip and the new one
LEFT = 44  # room for the words on the left
TOP = 16  # room for the byte numbers
LETTER = 6.1  # width of a letter, about

OLD_Y, NEW_Y = TOP, TOP + HEIGHT + GAP
ROW_HEIGHT = NEW_Y + HEIGHT + 10
WIDTH = LEFT + BITS * CELL + 1


class FieldBox(NamedTuple):
    """Part of a field within a row, or the frame behind the fields."""

    x: float
    y: int
    width: float
    kind: str
    label: str
    title: str
    key: str  # the same for the field's boxes in old and new


class FieldLink(NamedTuple):
    """Connection between the positions of a field in the old and in the new frame."""

    points: str
    kind: str
    key: str


@dataclass
class BitRow:
    """Row with ``BITS`` bits of both frames."""

    frames: list[FieldBox] = field(default_factory=list)
    boxes: list[FieldBox] = field(default_factory=list)
    links: list[FieldLink] = field(default_factory=list)
    ticks: list[tuple[int, int]] = field(default_factory=list)  # x, byte

    @property
    def is_new(self) -> bool:
        """Whether anything differs in this row, including the end of the frame."""
        ends = {box.y: box.width for box in self.frames}
        return any(box.kind != "same" for box in self.boxes) or ends.get(
            OLD_Y
        ) != ends.get(NEW_Y)


class ComparedDrawing(NamedTuple):
    """Drawing of two layouts.

    ``parts``: rows, and texts in place of unchanged rows.
    """

    parts: list[BitRow | str]
    title: str
    width: int = WIDTH
    height: int = ROW_HEIGHT
    old_y: int = OLD_Y + HEIGHT // 2
    new_y: int = NEW_Y + HEIGHT // 2
    middle: int = HEIGHT


def draw(pair: MessagePair, changes: list[Change]) -> ComparedDrawing | None:
    """Return the layouts of a message; None if no bit changed its position or meaning.

    The frame is empty on a side without the message.
    """
    sides = tuple(
        message.length * 8 if message is not None else 0
        for message in (pair.before, pair.after)
    )
    rows = [BitRow() for _ in range((max(*sides, 1) + BITS - 1) // BITS)]
    for size, y in zip(sides, (OLD_Y, NEW_Y), strict=True):
        _frame(rows, size, y)
    # A link connects both boxes only where they are in the same row.
    for number, part in enumerate(sorted(pair.parts, key=lambda p: p.any.at)):
        kind, key = _kind(part, changes), f"f{number}"
        before, after = {}, {}
        if part.before is not None:
            before = _boxes(rows, part.old, OLD_Y, kind, key)
        if part.after is not None:
            after = _boxes(rows, part.new, NEW_Y, kind, key)
        for index in before.keys() & after.keys():
            if kind != "same" or before[index].x != after[index].x:
                rows[index].links.append(_link(before[index], after[index]))
    for number, row in enumerate(rows):
        row.ticks = [
            (LEFT + byte * 8 * CELL, number * BITS // 8 + byte)
            for byte in range(BITS // 8)
        ]
    if not any(row.is_new for row in rows):
        return None
    return ComparedDrawing(
        _folded(rows), f"Bit layouts of {pair.any.name}, old above new"
    )


def _kind(pair: FieldPair, changes: list[Change]) -> str:
    if not pair.both:
        return "gone" if pair.after is None else "come"
    if kind(pair.old) != kind(pair.new) or pair.old.width != pair.new.width:
        return "wire"
    if not pair.same_bits:
        return "moved"
    layers = {change.layer for change in changes if change.pair is pair}
    if MEANING in layers:
        return "meaning"
    return "name" if SOURCE in layers else "same"


def _frame(rows: list[BitRow], size: int, y: int) -> None:
    for number, row in enumerate(rows):
        bits = min(BITS, size - number * BITS)
        if bits > 0:
            row.frames.append(
                FieldBox(LEFT, y, bits * CELL, "frame", "", "reserved", "")
            )


def _boxes(
    rows: list[BitRow], line: Line, y: int, kind: str, key: str
) -> dict[int, FieldBox]:
    """Return the boxes of a field by row; a field can reach into several rows."""
    boxes_by_row = {}
    end = line.at + line.width
    for number in range(line.at // BITS, min(-(-end // BITS), len(rows))):
        start = max(line.at, number * BITS)
        width = (min(end, (number + 1) * BITS) - start) * CELL
        box = FieldBox(
            LEFT + start % BITS * CELL,
            y,
            width,
            kind,
            _label(line.name, width),
            _title(line),
            key,
        )
        rows[number].boxes.append(box)
        boxes_by_row[number] = box
    return boxes_by_row


def _label(name: str, width: float) -> str:
    room = int((width - 4) / LETTER)
    if len(name) <= room:
        return name
    return f"{name[: room - 1]}…" if room >= 4 else ""


def _title(line: Line) -> str:
    words = [line.name, span(line), type_of(line)]
    if line.has_formula:
        words.append(formula(line.curve or line.scale))
    if line.unit is not None:
        words.append(line.unit.symbol)
    return ", ".join(words)


def _link(old: FieldBox, new: FieldBox) -> FieldLink:
    """Return the quadrilateral that connects a field with the same field of the other
    release.
    """
    top, bottom = OLD_Y + HEIGHT, NEW_Y
    corners = (
        (old.x, top),
        (old.x + old.width, top),
        (new.x + new.width, bottom),
        (new.x, bottom),
    )
    return FieldLink(" ".join(f"{x:g},{y}" for x, y in corners), new.kind, new.key)


def _folded(rows: list[BitRow]) -> list[BitRow | str]:
    """Return the rows with two or more unchanged rows in sequence replaced by a text."""
    parts: list[BitRow | str] = []
    for is_new, group in groupby(
        enumerate(rows), key=lambda numbered_row: numbered_row[1].is_new
    ):
        run = list(group)
        if is_new or len(run) == 1:
            parts += [row for _, row in run]
        else:
            first, last = run[0][0] * BITS // 8, (run[-1][0] + 1) * BITS // 8 - 1
            parts.append(f"bytes {first} to {last} are as before")
    return parts
