"""Base class of the lines of a simulated device: faults, and delayed transmission."""

from __future__ import annotations

import heapq

from icdgen.sim.computer import Computer
from icdgen.sim.faults import Faults


class DeviceLine:
    """A line with a queue of pieces to send. Times are in milliseconds."""

    keeps_packets = False  # whether each piece is a packet

    def __init__(self, computer: Computer, faults: Faults) -> None:
        self.computer, self.faults = computer, faults
        self._due: list[tuple[int, int, bytes]] = (
            []
        )  # heap of time, order of creation and bytes
        self._sent = 0

    def received(self, now: int, data: bytes) -> None:
        """Process bytes from the client, or a packet."""
        raise NotImplementedError

    def tick(self, now: int) -> None:
        """Process timeouts."""
        self.computer.tick(now)

    def log(self, now: int) -> None:
        """Send the unsolicited messages of the device."""
        raise NotImplementedError

    def pieces(self, now: int) -> list[bytes]:
        """Return the pieces that are due, for the port."""
        due = []
        while self._due and self._due[0][0] <= now:
            due.append(heapq.heappop(self._due)[2])
        return due

    @property
    def deadline(self) -> int | None:
        """Time at which `tick` and `pieces` must be called at the latest, or None."""
        times = [*(at for at, _, _ in self._due[:1]), self.next_tick]
        return min((at for at in times if at is not None), default=None)

    @property
    def next_tick(self) -> int | None:
        """Time at which `tick` must be called, or None."""
        return self.computer.deadline

    def queue(self, now: int, on: str, data: bytes) -> None:
        """Queue the bytes of a message, with the faults for messages of the kind
        ``on``.
        """
        for delay, piece in self.faults.apply(on, data):
            self._sent += 1
            heapq.heappush(self._due, (now + delay, self._sent, piece))
