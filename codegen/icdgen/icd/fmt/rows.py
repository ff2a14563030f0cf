"""Tables: mappings on one line each, with aligned columns."""

from __future__ import annotations

WIDEST = 40  # wider cells are ignored in the alignment of their column


def aligned(rows: list[dict[str, str]]) -> list[str]:
    """Return each row in flow style: ``{at: 0,  bits: 16, ...}``.

    The leading columns that all rows have are padded.
    """
    widths: list[int] = []
    # zip() ends with the shortest row, so these are the keys at the same position of
    # all rows.
    for position, keys in enumerate(zip(*rows, strict=False)):
        if len(set(keys)) > 1:
            break
        # In a row that ends with this column, nothing needs to be aligned after it.
        sizes = (len(row[keys[0]]) for row in rows if len(row) > position + 1)
        widths.append(max((size for size in sizes if size <= WIDEST), default=0))
    lines = []
    for row in rows:
        cells = [cell + "," for cell in row.values()]
        cells[-1] = cells[-1][:-1] + "}"
        for index, width in enumerate(widths[: len(cells) - 1]):
            cells[index] = cells[index].ljust(width + 1)
        lines.append("{" + " ".join(cells))
    return lines
