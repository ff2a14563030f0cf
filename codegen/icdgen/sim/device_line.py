"""What the lines of a simulated device have in common: faults happen on them, and what is sent leaves when it is due."""

from __future__ import annotations

import heapq

from icdgen.sim.computer import Computer
from icdgen.sim.faults import Faults


class DeviceLine:
    """Every call is given the time in milliseconds; `pieces` gives what is due."""

    keeps_packets = False  # whether each piece is a packet of its own

    def __init__(self, computer: Computer, faults: Faults) -> None:
        self.computer, self.faults = computer, faults
        self._due: list[tuple[int, int, bytes]] = []  # when it leaves; of the same time the first comes first
        self._sent = 0

    def received(self, now: int, data: bytes) -> None:
        """The next bytes from the client, or a packet."""
        raise NotImplementedError

    def tick(self, now: int) -> None:
        """Lets time pass."""
        self.computer.tick(now)

    def log(self, now: int) -> None:
        """Sends at once what the device sends of its own accord."""
        raise NotImplementedError

    def pieces(self, now: int) -> list[bytes]:
        """What is due, as it goes to the port."""
        due = []
        while self._due and self._due[0][0] <= now:
            due.append(heapq.heappop(self._due)[2])
        return due

    @property
    def deadline(self) -> int | None:
        """When `tick` and `pieces` want to be called at the latest."""
        times = [*(at for at, _, _ in self._due[:1]), self.next_tick]
        return min((at for at in times if at is not None), default=None)

    @property
    def next_tick(self) -> int | None:
        """When `tick` has something to do."""
        return self.computer.deadline

    def leave(self, now: int, on: str, data: bytes) -> None:
        """The bytes of a message leave, as the faults ``on`` such messages have them."""
        for delay, piece in self.faults.spoil(on, data):
            self._sent += 1
            heapq.heappush(self._due, (now + delay, self._sent, piece))
