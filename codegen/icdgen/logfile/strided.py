"""Numbers at a fixed distance in bytes, as numpy arrays: a column of a log is the
number at the same byte of each entry.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np


def numbers_at(
    data: bytes,
    stride: int,
    at: int,
    size: int,
    little: bool,
    kind: str = "u",
    count: int | None = None,
) -> np.ndarray:
    """Return the number of ``size`` bytes at ``at`` and every ``stride`` bytes after
    it.

    By default, there is one number for each complete stride. The array is a view of
    ``data`` if numpy has a type of that size.
    """
    import numpy as np

    count = len(data) // stride if count is None else count
    if size in (1, 2, 4, 8):
        return np.ndarray(
            (count,), f"{'<' if little else '>'}{kind}{size}", data, at, (stride,)
        )
    # Only times have other sizes. They have no sign, so that `kind` is not used here.
    value = np.zeros(count, np.uint64)
    for number in range(size):
        byte = np.ndarray((count,), np.uint8, data, at + number, (stride,))
        shift = 8 * (number if little else size - 1 - number)
        value |= byte.astype(np.uint64) << np.uint64(shift)
    return value
