"""Base class of the lines of a simulated device: faults, and delayed transmission.

A line receives bytes (`DeviceLine.received`) and queues bytes to send, each with the
time at which it is due (`DeviceLine.pieces`).
"""

from __future__ import annotations

import heapq
from collections.abc import Callable

from icdgen.errors import UserError
from icdgen.sim.computer import Computer
from icdgen.sim.faults import Faults, InjectedFault, parse
from icdgen.wording import listing, quote

MOST_NAMES = 3  # of telecommands in a warning


class DeviceLine:
    """A line with a queue of pieces to send. Times are in milliseconds."""

    keeps_packets = False  # whether each piece is a packet
    # What the ICD lacks for a response that refuses a telecommand, or that says that the
    # device is busy; empty if it has one.
    no_refusal = ""
    no_busy_response = ""

    def __init__(self, computer: Computer, faults: Faults) -> None:
        self.computer, self.faults = computer, faults
        self.warn: Callable[[str], object] = lambda text: None
        # Heap of time, order of creation and bytes.
        self._due: list[tuple[int, int, bytes]] = []
        self._sent = 0

    def fault(self, text: str) -> InjectedFault:
        """Return the fault of a text; see `icdgen.sim.faults.parse`.

        Call `warn` if some telecommands cannot have the reason. Raise
        `icdgen.errors.UserError`, also for a fault that the link cannot have.
        """
        fault = parse(text)
        if fault.kind == "busy" and self.no_busy_response:
            raise UserError(
                f"`{text}`: the ICD describes no response of a busy device; {self.no_busy_response}",
                "drop=SHARE@telecommand loses the telecommand instead",
            )
        if fault.kind == "nak" and self.no_refusal:
            raise UserError(
                f"`{text}`: the ICD describes no response that refuses a telecommand; {self.no_refusal}",
                "silence=SHARE sends no response instead",
            )
        if fault.reason is not None and not self.is_reason(fault.reason):
            names = ", ".join(self.reasons)
            raise UserError(
                f"`{text}`: `{fault.reason}` is no reason of a refusal",
                f"reasons: {names}" if names else "a refusal has no reason here",
            )
        if fault.reason is not None and (names_without := self.without(fault.reason)):
            shown = [quote(name) for name in names_without[:MOST_NAMES]]
            if len(names_without) > MOST_NAMES:
                shown.append(f"{len(names_without) - MOST_NAMES} more")
            self.warn(
                f"`{text}`: refusals of {listing(shown)} do not have this reason, as their response has no field for it"
            )
        return fault

    @property
    def reasons(self) -> tuple[str, ...]:
        """Names of the reasons of a refusal."""
        raise NotImplementedError

    def is_reason(self, text: str) -> bool:
        """Return whether a refusal can have this reason: a name or a number."""
        raise NotImplementedError

    def without(self, reason: str) -> list[str]:
        """Return the names of telecommands that can be refused, but not with this
        reason.
        """
        return []

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
