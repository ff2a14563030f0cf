"""What is on its way, until it is due."""

from __future__ import annotations

import heapq


class Due:
    """Messages with the times at which they leave, in milliseconds; of the same time the first comes first."""

    def __init__(self) -> None:
        self._queue: list[tuple[int, int, bytes]] = []
        self._sent = 0

    def push(self, at: int, data: bytes) -> None:
        self._sent += 1
        heapq.heappush(self._queue, (at, self._sent, data))

    def pop(self, now: int) -> list[bytes]:
        """Those that are due."""
        due = []
        while self._queue and self._queue[0][0] <= now:
            due.append(heapq.heappop(self._queue)[2])
        return due

    @property
    def times(self) -> list[int]:
        """When the next one is due; nothing if there is none."""
        return [self._queue[0][0]] if self._queue else []
