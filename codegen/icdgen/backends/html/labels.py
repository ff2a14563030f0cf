"""Names that fit into the boxes of a drawing."""

from __future__ import annotations

from typing import NamedTuple

_SIZES = (13, 11)  # font sizes that are tried, in units of the view box
_ADVANCE = 0.54  # width of an average letter, by font size
_LEADING = 1.18


class Label(NamedTuple):
    """A line of text around ``x``, its baseline at ``y``; ``key``: it is only the field's number."""

    x: int
    y: float
    size: int
    text: str
    key: bool = False


def fit(shape, name: str, row: int) -> list[Label]:
    """The name in the largest box of the shape, in as many lines as fit; the shape's number where it does not fit."""
    if not shape.rects:
        return []
    x, y, width, height = max(shape.rects, key=lambda r: (r[2] * r[3], -r[1]))
    for size in _SIZES:
        most = max(int((height - 6) / (size * _LEADING)), 1)
        lines = _wrap(name, int((width - 8) / (size * _ADVANCE)), most)
        if lines:
            top = y + height / 2 - (len(lines) - 1) * size * _LEADING / 2 + size * 0.36
            return [
                Label(x + width // 2, round(top + index * size * _LEADING, 1), size, line)
                for index, line in enumerate(lines)
            ]
    return [Label(x + width // 2, round(y + height / 2 + 4, 1), 11, str(shape.key), True)]


def _wrap(text: str, width: int, most: int) -> list[str]:
    """At most ``most`` lines of at most ``width`` characters; empty where that cannot be."""
    lines: list[str] = []
    for word in text[:400].split():
        if len(word) > width:
            return []
        if lines and len(lines[-1]) + 1 + len(word) <= width:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return lines if len(lines) <= most else []
