"""Both bit layouts of a frame, the old above the new, as rectangles for an SVG."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

from icdgen.diff.change import Change
from icdgen.diff.layers import MEANING, SOURCE
from icdgen.diff.pairs import FieldPair, MessagePair, kind
from icdgen.diff.wording import formula, span, type_of
from icdgen.icd.model import Field

BITS = 64  # a row
CELL = 14  # width of a bit
HEIGHT = 26  # of a strip
GAP = 16  # between the old strip and the new one
LEFT = 44  # room for the words on the left
TOP = 16  # room for the byte numbers
LETTER = 6.1  # width of a letter, about

OLD_Y, NEW_Y = TOP, TOP + HEIGHT + GAP
ROW_HEIGHT = NEW_Y + HEIGHT + 10
WIDTH = LEFT + BITS * CELL + 1


class Box(NamedTuple):
    """A run of a field within a row, or the frame behind the fields."""

    x: float
    y: int
    width: float
    kind: str
    label: str
    title: str
    key: str  # the same for the field's boxes in old and new


class Tick(NamedTuple):
    x: int
    text: str


class Link(NamedTuple):
    """From a field in the old strip to where it lies in the new one."""

    points: str
    kind: str
    key: str


@dataclass
class Row:
    """``BITS`` bits of both frames."""

    frames: list[Box] = field(default_factory=list)
    boxes: list[Box] = field(default_factory=list)
    links: list[Link] = field(default_factory=list)
    ticks: list[Tick] = field(default_factory=list)

    @property
    def is_new(self) -> bool:
        """Whether anything differs, be it only where the frame ends."""
        ends = {box.y: box.width for box in self.frames}
        return any(box.kind != "same" for box in self.boxes) or ends.get(OLD_Y) != ends.get(NEW_Y)


class Rest(NamedTuple):
    """Rows in which nothing changed."""

    text: str


class Drawing(NamedTuple):
    """``parts`` are rows, and what stands for rows that are as before."""

    width: int
    height: int
    old_y: int
    new_y: int
    middle: int
    parts: list[Row | Rest]
    title: str


def draw(pair: MessagePair, changes: list[Change]) -> Drawing:
    """The layouts of a message; one strip is empty where it is only in one ICD."""
    kinds = {id(one): _kind(one, changes) for one in pair.parts}
    sides = tuple(message.length * 8 if message is not None else 0 for message in (pair.before, pair.after))
    rows = [Row() for _ in range((max(*sides, 1) + BITS - 1) // BITS)]
    for size, y in zip(sides, (OLD_Y, NEW_Y), strict=True):
        _frame(rows, size, y)
    for number, one in enumerate(sorted(pair.parts, key=lambda p: p.any.at)):
        before = _boxes(rows, one.old, OLD_Y, kinds[id(one)], f"f{number}") if one.before is not None else {}
        after = _boxes(rows, one.new, NEW_Y, kinds[id(one)], f"f{number}") if one.after is not None else {}
        for index in before.keys() & after.keys():
            if kinds[id(one)] != "same" or before[index].x != after[index].x:
                rows[index].links.append(_link(before[index], after[index], kinds[id(one)], f"f{number}"))
    for number, row in enumerate(rows):
        row.ticks = [Tick(LEFT + byte * 8 * CELL, str(number * BITS // 8 + byte)) for byte in range(BITS // 8)]
    title = f"Bit layouts of {pair.any.name}, old above new"
    return Drawing(WIDTH, ROW_HEIGHT, OLD_Y + HEIGHT // 2, NEW_Y + HEIGHT // 2, HEIGHT, _folded(rows), title)


def _kind(one: FieldPair, changes: list[Change]) -> str:
    if not one.both:
        return "gone" if one.after is None else "come"
    if kind(one.old) != kind(one.new) or one.old.bits != one.new.bits:
        return "wire"
    if not one.same_bits:
        return "moved"
    layers = {change.layer for change in changes if change.pair is one}
    return "meaning" if MEANING in layers else "name" if SOURCE in layers else "same"


def _frame(rows: list[Row], size: int, y: int) -> None:
    for number, row in enumerate(rows):
        bits = min(BITS, size - number * BITS)
        if bits > 0:
            row.frames.append(Box(LEFT, y, bits * CELL, "frame", "", "reserved", ""))


def _boxes(rows: list[Row], one: Field, y: int, kind: str, key: str) -> dict[int, Box]:
    """A box for each row that the field reaches into."""
    found = {}
    start, end = one.at, one.at + one.bits
    while start < end and start // BITS < len(rows):
        number = start // BITS
        stop = min(end, (number + 1) * BITS)
        width = (stop - start) * CELL
        box = Box(LEFT + start % BITS * CELL, y, width, kind, _label(one.name, width), _title(one), key)
        rows[number].boxes.append(box)
        found[number] = box
        start = stop
    return found


def _label(name: str, width: float) -> str:
    room = int((width - 4) / LETTER)
    if len(name) <= room:
        return name
    return f"{name[: room - 1]}…" if room >= 4 else ""


def _title(one: Field) -> str:
    words = [one.name, span(one), type_of(one)]
    if one.scale is not None:
        words.append(formula(one.scale))
    if one.unit is not None:
        words.append(one.unit.symbol)
    return ", ".join(words)


def _link(old: Box, new: Box, kind: str, key: str) -> Link:
    top, bottom = OLD_Y + HEIGHT, NEW_Y
    corners = ((old.x, top), (old.x + old.width, top), (new.x + new.width, bottom), (new.x, bottom))
    return Link(" ".join(f"{x:g},{y}" for x, y in corners), kind, key)


def _folded(rows: list[Row]) -> list[Row | Rest]:
    parts: list[Row | Rest] = []
    first = None
    for number in range(len(rows) + 1):
        plain = number < len(rows) and not rows[number].is_new
        if plain and first is None:
            first = number
        if not plain and first is not None:
            if number - first > 1:
                parts.append(Rest(f"bytes {first * BITS // 8} to {number * BITS // 8 - 1} are as before"))
            else:
                parts.append(rows[first])
            first = None
        if number < len(rows) and not plain:
            parts.append(rows[number])
    return parts
