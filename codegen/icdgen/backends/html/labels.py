"""Placement of names in the boxes of a drawing.

Names are set in one or more lines and in two sizes. There is no font file to measure,
so widths are estimated from the number of characters.
"""

from __future__ import annotations

from icdgen.frozen import NamedTuple

_SIZES = (13, 11)  # font sizes in order of preference, in units of the view box
_ADVANCE = 0.54  # average width of a letter, relative to the font size
_LEADING = 1.18  # distance of lines, relative to the font size


class BoxLabel(NamedTuple):
    """Line of text centered at ``x`` with baseline ``y``.

    ``key``: whether it is only the number of the field.
    """

    x: int
    y: float
    size: int
    text: str
    key: bool = False


Box = tuple[int, int, int, int]  # x, y, width, height


def fit_name(boxes: list[Box], name: str, number: int) -> list[BoxLabel]:
    """Return the name in each box that is large enough, in several lines if needed;
    otherwise the number in the largest box.
    """
    labels = [label for box in boxes for label in _in_box(box, name)]
    if labels or not boxes:
        return labels
    x, y, width, height = max(boxes, key=lambda box: (box[2] * box[3], -box[1]))
    # The baseline of 11 units is 4 below the middle.
    return [
        BoxLabel(x + width // 2, round(y + height / 2 + 4, 1), 11, str(number), True)
    ]


def _in_box(box: Box, name: str) -> list[BoxLabel]:
    x, y, width, height = box
    for size in _SIZES:
        # Margins: 3 units above and below, 4 on either side.
        most = max(int((height - 6) / (size * _LEADING)), 1)
        lines = _wrap(name, int((width - 8) / (size * _ADVANCE)), most)
        if lines:
            # The baseline is 0.36 of the font size below the middle of capital letters.
            top = y + height / 2 - (len(lines) - 1) * size * _LEADING / 2 + size * 0.36
            return [
                BoxLabel(
                    x + width // 2, round(top + index * size * _LEADING, 1), size, line
                )
                for index, line in enumerate(lines)
            ]
    return []


def _wrap(text: str, width: int, most: int) -> list[str]:
    """Return at most ``most`` lines of at most ``width`` characters; empty if
    impossible.
    """
    lines: list[str] = []
    # No box is large enough for more text.
    for word in text[:400].split():
        if len(word) > width:
            return []
        if lines and len(lines[-1]) + 1 + len(word) <= width:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return lines if len(lines) <= most else []
