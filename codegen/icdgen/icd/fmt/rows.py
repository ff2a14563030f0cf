"""Tables: mappings on one line each, their columns aligned."""

from __future__ import annotations

from itertools import takewhile

WIDEST = 40  # a wider cell takes no part in the alignment of its column


def aligned(rows: list[dict[str, str]]) -> list[str]:
    """``{at: 0,  bits: 16, ...}`` of each row. The columns of the keys that all rows begin with are padded."""
    columns = _common_keys(rows)
    widths = [_width(rows, key, position) for position, key in enumerate(columns)]
    lines = []
    for row in rows:
        cells = [cell + "," for cell in row.values()]
        cells[-1] = cells[-1][:-1] + "}"
        for index, width in enumerate(widths[: len(cells) - 1]):
            cells[index] = cells[index].ljust(width + 1)
        lines.append("{" + " ".join(cells))
    return lines


def _width(rows: list[dict[str, str]], key: str, position: int) -> int:
    """Width of the column, as far as it matters: where another cell follows."""
    widths = (len(row[key]) for row in rows if len(row) > position + 1)
    return max((width for width in widths if width <= WIDEST), default=0)


def _common_keys(rows: list[dict[str, str]]) -> list[str]:
    columns = zip(*rows, strict=False)  # as far as the shortest row goes
    return [keys[0] for keys in takewhile(lambda keys: len(set(keys)) == 1, columns)]
