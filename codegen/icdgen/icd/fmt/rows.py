"""Tables: mappings on one line each, with aligned columns."""

from __future__ import annotations

from itertools import takewhile

WIDEST = 40  # wider cells are ignored in the alignment of their column


def aligned(rows: list[dict[str, str]]) -> list[str]:
    """Return each row in flow style: ``{at: 0,  bits: 16, ...}``. The leading columns that all rows have are padded."""
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
    """Return the width of a column, of the rows in which another cell follows."""
    widths = (len(row[key]) for row in rows if len(row) > position + 1)
    return max((width for width in widths if width <= WIDEST), default=0)


def _common_keys(rows: list[dict[str, str]]) -> list[str]:
    """Return the leading keys that all rows have in common."""
    columns = zip(*rows, strict=False)  # ends with the shortest row
    return [keys[0] for keys in takewhile(lambda keys: len(set(keys)) == 1, columns)]
