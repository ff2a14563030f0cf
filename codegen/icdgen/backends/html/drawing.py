"""Drawing of the bit layout of a frame: rows of one, two or four bytes, with the bit
numbers of the ICD.

Within a byte the most significant bit is on the left for either bit numbering, so that
bytes read like their hexadecimal digits.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import groupby, islice, zip_longest

from icdgen import frame_bits
from icdgen.backends.html.labels import Box, BoxLabel, fit_name
from icdgen.backends.html.links import Links
from icdgen.backends.html.texts import clip
from icdgen.describe.numbers import bit_range
from icdgen.frame_bits import ReservedBits
from icdgen.icd.model import Message, Node
from icdgen.icd.places import NodePlace

WIDTH, LEFT, TOP = 1000, 64, 24
# Maximum rows of one field; of longer fields, the first and the last row are drawn
_FEW = 3


@dataclass
class Shape:
    """Drawn field, or reserved bits.

    ``key``: number of the field, from 1.
    """

    key: int
    kind: str
    title: str
    anchor: str = ""
    # x, y, width, height
    rects: list[Box] = field(default_factory=list)
    labels: list[BoxLabel] = field(default_factory=list)


@dataclass
class FrameDrawing:
    """Drawing; all coordinates are in units of the view box."""

    height: int
    columns: list[tuple[float, str]]  # x, bit number
    rows: list[tuple[int, str, str]]  # y, byte, bit
    shapes: list[Shape]
    reserved: list[Shape]
    lines: str  # path of all boundaries
    keyed: bool  # whether some fields show only their number
    skips: list[tuple[int, str]]
    plan: dict[str, object]
    width: int = WIDTH


def draw_frame(
    message: Message, node: Node, links: Links, first: int = 0, end: int | None = None
) -> FrameDrawing | None:
    """Return the drawing of the bytes from ``first`` to before ``end`` (default: all);
    None for an empty range.
    """
    end = message.length if end is None else end
    return _Canvas(message, node, links, first, end).drawing() if end > first else None


def hatch(x: int, y: int, width: int, height: int) -> str:
    """Return diagonal lines across a box, as an SVG path.

    A pattern fill would require an id that is unique in its page.
    """
    path, step = [], 9
    for start in range(x - height, x + width, step):
        left, right = max(start, x), min(start + height, x + width)
        if right > left:
            path.append(
                f"M{left} {y + height - (left - start)}L{right} {y + height - (right - start)}"
            )
    return "".join(path)


def bytes_a_row(length: int, fields: Sequence[NodePlace]) -> int:
    """Return the bytes in a row: 1 for short frames of small fields, up to 4 for long
    frames.
    """
    # Names of small fields need wide cells.
    small = any(f.bits < 8 for f in fields)
    if length == 1 or (small and length <= 12):
        return 1
    return 2 if length <= 48 else 4


class _Canvas:
    def __init__(
        self, message: Message, node: Node, links: Links, first: int, end: int
    ) -> None:
        self.node, self.first, self.length = node, first, end - first
        repeats = links.repeats(message)
        self.gaps = _within(repeats.gaps, 8 * first, 8 * end)
        self.fields = [
            field
            for field in repeats.fields
            if field.place.at < 8 * end
            and field.place.at + field.place.bits > 8 * first
        ]
        self.across = bytes_a_row(self.length, [field.place for field in self.fields])
        self.cell = (WIDTH - LEFT) / (8 * self.across)
        self.labels = self._labels()
        self.shapes = [
            Shape(
                field.key,
                field.place.type,
                f"{clip(self.labels[field.key], 200)}: {bit_range(field.place.at, field.place.bits)}",
                links.anchor(message, field.place.name),
            )
            for field in self.fields
        ]
        self.owner = self._owners()
        self.grid, self.rows = self._grid()
        self.row = 34  # height of a row
        if self.across == 4:
            self.row = 30
        # More fields than two per byte: names need a second line.
        elif any(len(set(row)) > 2 * self.across for _, row in self.grid):
            self.row = 46

    def _labels(self) -> dict[int, str]:
        """Return the name of each field by its key; for an optional field, also the
        names of its alternatives.
        """
        labels = {field.key: field.short for field in self.fields}
        optional = [field for field in self.fields if field.place.conditions]
        masks = [frame_bits.mask(field.place, self.node) for field in optional]
        for shown, own_mask in zip(optional, masks, strict=True):
            # At most three alternatives: more do not fit into a box.
            alternatives = (
                other.place.name
                for other, mask in zip(optional, masks, strict=True)
                if mask & own_mask and other is not shown
            )
            labels[shown.key] = " / ".join([shown.short, *islice(alternatives, 3)])
        return labels

    def _owners(self) -> list[int]:
        """Return the key of the field of each bit, in the order of drawing; 0 for
        reserved bits.
        """
        begin, end = 8 * self.first, 8 * (self.first + self.length)
        owner = [0] * (end - begin)
        for shown in self.fields:
            place = shown.place
            # Overlays share their bits with other fields; a counter of the rest has
            # none.
            if place.is_read_only or place.is_count:
                continue
            # Byte strings have no bit order, and can have thousands of bits: fill their
            # range at once.
            if place.is_bytes:
                bits = range(max(place.at, begin), min(place.at + place.bits, end))
                owner[bits.start - begin : bits.stop - begin] = [shown.key] * len(bits)
                continue
            for piece in frame_bits.pieces(place, self.node):
                # Columns count from the left: bit w of byte b (0 is the least
                # significant) is in column 8 * b + 7 - w.
                right = 8 * piece.byte + 8 - piece.shift
                for bit in range(right - piece.bits, right):
                    # The first one of alternative fields
                    if begin <= bit < end and not owner[bit - begin]:
                        owner[bit - begin] = shown.key
        return owner

    def _grid(self) -> tuple[list[tuple[int, list[int]]], list[int]]:
        """Return the first byte of each drawn row with the owners of its bits; -1 for
        omitted rows.
        """
        step = 8 * self.across
        every = [
            (at // 8, self.owner[at : at + step])
            for at in range(0, len(self.owner), step)
        ]
        grid: list[tuple[int, list[int]]] = []
        # Rows with a single owner are equal to their neighbors; other rows have unique
        # keys.
        for _, group in groupby(
            every, key=lambda row: row[1][0] if len(set(row[1])) == 1 else -1 - row[0]
        ):
            run = list(group)
            grid += run if len(run) <= _FEW else [run[0], (-1, run[0][1]), run[-1]]
        return grid, [first for first, _ in grid]

    def drawing(self) -> FrameDrawing:
        rects = self._rects()
        for shape in self.shapes:
            shape.rects = rects[shape.key]
            shape.labels = fit_name(shape.rects, self.labels[shape.key], shape.key)
        msb0 = self.node.bit_order == "msb0"
        # Column numbers follow the bit numbering of the ICD.
        columns = [
            (
                LEFT + (column + 0.5) * self.cell,
                str(column if msb0 else column // 8 * 8 + 7 - column % 8),
            )
            for column in range(8 * min(self.across, self.length))
        ]
        reserved = Shape(
            0,
            "reserved",
            "Reserved: " + ", ".join(bit_range(g.at, g.bits) for g in self.gaps[:20]),
        )
        reserved.rects = rects[0]
        rows = [
            (self._y(i), str(self.first + at), str(8 * (self.first + at)))
            for i, at in enumerate(self.rows)
            if at >= 0
        ]
        plan = {
            "across": self.across, "cell": self.cell, "left": LEFT, "top": TOP, "row": self.row, "rows": self.rows,
            "first": self.first,
        }  # fmt: skip
        return FrameDrawing(
            height=self._y(len(self.grid)) + 2,
            columns=columns,
            rows=rows,
            shapes=[shape for shape in self.shapes if shape.rects],
            reserved=[reserved] if reserved.rects else [],
            lines=self._lines(),
            # The page explains the numbers only if the drawing contains some.
            keyed=any(label.key for shape in self.shapes for label in shape.labels),
            skips=self._skips(),
            plan=plan,
        )

    def _y(self, index: int) -> int:
        return TOP + index * self.row

    def _x(self, column: int) -> int:
        return round(LEFT + column * self.cell)

    def _rects(self) -> dict[int, list[Box]]:
        """Return the rectangles of each owner.

        Adjacent rows of equal extent form one rectangle, so that they show one name
        instead of one per row.
        """
        rectangles: dict[int, list[Box]] = defaultdict(list)
        # Index of the last rectangle of an owner with the same extent
        lowest: dict[tuple[int, int, int], int] = {}
        for index, (_, owners) in enumerate(self.grid):
            top = self._y(index)
            for owner, start, end in _runs(owners):
                x, width = self._x(start), self._x(end) - self._x(start)
                boxes = rectangles[owner]
                above = lowest.get((owner, x, width))
                # The rectangle ends where this row begins.
                if above is not None and boxes[above][1] + boxes[above][3] == top:
                    _, y, _, height = boxes[above]
                    boxes[above] = (x, y, width, height + self.row)
                else:
                    lowest[owner, x, width] = len(boxes)
                    boxes.append((x, top, width, self.row))
        return rectangles

    def _lines(self) -> str:
        """Return the boundaries between different owners, and the outline, as an SVG
        path.
        """
        path: list[str] = []
        above: list[int] = []
        for index, (_, owners) in enumerate(self.grid):
            y = self._y(index)
            path += (
                f"M{self._x(start)} {y}v{self.row}"
                for _, start, _ in _runs(owners)
                if start
            )
            path.append(f"M{LEFT} {y}v{self.row}M{self._x(len(owners))} {y}v{self.row}")
            # A horizontal line only where a bit has another owner than the bit above
            # it, so that no line crosses a field.
            differs = _runs(
                owner != owner_above
                for owner, owner_above in zip_longest(owners, above)
            )
            path += (
                f"M{self._x(start)} {y}H{self._x(end)}"
                for is_other, start, end in differs
                if is_other
            )
            above = owners
        path.append(f"M{LEFT} {self._y(len(self.grid))}H{self._x(len(above))}")
        return "".join(path)

    def _skips(self) -> list[tuple[int, str]]:
        """Return the positions of omitted rows with their texts."""
        skips = []
        for index, first in enumerate(self.rows):
            if first < 0:
                left_out = self.rows[index + 1] - self.rows[index - 1] - self.across
                skips.append((self._y(index), f"{left_out} more bytes"))
        return skips


def _within(gaps: Iterable[ReservedBits], first: int, end: int) -> list[ReservedBits]:
    """Return the parts of runs of reserved bits from bit ``first`` to before ``end``."""
    clipped = ((max(gap.at, first), min(gap.at + gap.bits, end)) for gap in gaps)
    return [ReservedBits(at, stop - at) for at, stop in clipped if at < stop]


def _runs(row: Iterable[int]) -> Iterator[tuple[int, int, int]]:
    """Yield runs of equal values: value, start and end."""
    end = 0
    for value, group in groupby(row):
        start, end = end, end + len(list(group))
        yield value, start, end
