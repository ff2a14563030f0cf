"""The simulated device: the running program, and the start of the next one.

A device without a boot program has one program only. Time comes from the caller.
"""

from __future__ import annotations

from icdgen.icd.model import Icd, Message, Node
from icdgen.sim.program import Program, TelecommandOutcome
from icdgen.sim.settings import SimulationSettings
from icdgen.sim.storage import DeviceStorage


class Computer:
    """The device. ``node`` is the first program. Times are in milliseconds."""

    def __init__(
        self, icd: Icd, node: Node, settings: SimulationSettings, storage: DeviceStorage
    ) -> None:
        self.icd, self.settings, self.storage = icd, settings, storage
        self.start(0, node)

    def start(self, now: int, node: Node) -> None:
        """Start a program.

        A boot program starts its application after the boot time.
        """
        self.program = Program(self.icd, node, self.storage, self.settings, now)
        wait = self.settings.boot_ms
        if wait is None:
            wait = self.program.facts.boot_ms
        # Time at which a boot program starts its application.
        self.boot_at: int | None = None
        if wait is not None and self._application(node):
            self.boot_at = now + wait

    def tick(self, now: int) -> None:
        """Process timeouts."""
        if self.boot_at is not None and now >= self.boot_at:
            application = self._application(self.program.node)
            assert application
            self.start(now, application)

    @property
    def deadline(self) -> int | None:
        """Time at which `tick` or `Program.take_due_log` must be called, or None."""
        times = [at for at in (self.boot_at, self.program.log_at) if at is not None]
        return min(times, default=None)

    def take(self, now: int, message: bytes, bus: str) -> TelecommandOutcome | None:
        """Process a telecommand, which begins with its id."""
        outcome = self.program.take(now, message, bus)
        if outcome and outcome.reset:
            self._reset(now, outcome.reset)
        return outcome

    def frame(self, now: int, id: int) -> bytes | None:
        """Return the frame with this id, or None if the program has none."""
        boot = self.icd.protocol_of(self.program.node).get("boot", {})
        stop = boot.get("stop_request")
        message = self.program.facts.telemetry.get(id)
        # A request of this telemetry keeps the device in its boot program.
        if message and message.name == stop:
            self.boot_at = None
        return self.program.requested_frame(now, id)

    def restart(self, now: int) -> None:
        """Restart with the boot program, as after a reset or at power-up."""
        running = self.program.node
        boot_nodes = (n for n in self.icd.nodes if self._application(n) is running)
        self.start(now, next(boot_nodes, running))

    def _reset(self, now: int, message: Message) -> None:
        application = self._application(self.program.node)
        start = self.icd.protocol_of(self.program.node).get("program_start", {})
        if application and start.get("message") == message.name:
            self.start(now, application)
        else:
            self.restart(now)

    def _application(self, node: Node) -> Node | None:
        """Return the program that this one starts, or None."""
        name = node.protocol.get("program_start", {}).get("application")
        return next((n for n in self.icd.nodes if n.name == name), None)
