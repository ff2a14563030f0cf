"""The simulated device: which program runs, and when the next one starts."""

from __future__ import annotations

from icdgen.icd.model import Icd, Message, Node
from icdgen.sim.program import Outcome, Program
from icdgen.sim.settings import Settings
from icdgen.sim.storage import Storage


class Computer:
    """The device. ``node`` is the program that runs first; every call is given the time in milliseconds."""

    def __init__(self, icd: Icd, node: Node, settings: Settings, storage: Storage) -> None:
        self.icd, self.settings, self.storage = icd, settings, storage
        self.boot_at: int | None = None
        self.start(0, node)

    def start(self, now: int, node: Node) -> None:
        """Starts a program; one that starts another does so after the boot time."""
        self.program = Program(self.icd, node, self.storage, self.settings, now)
        self.boot_at = None
        if self._application(node):
            wait = self.settings.boot_ms if self.settings.boot_ms is not None else self.program.known.boot_ms
            self.boot_at = None if wait is None else now + wait

    def tick(self, now: int) -> None:
        """Lets time pass."""
        if self.boot_at is not None and now >= self.boot_at:
            application = self._application(self.program.node)
            assert application
            self.start(now, application)

    @property
    def deadline(self) -> int | None:
        """When `tick` or `Program.log_due` have something to do."""
        return min((at for at in (self.boot_at, self.program.log_at) if at is not None), default=None)

    def take(self, now: int, message: bytes, bus: str) -> Outcome | None:
        """A telecommand, id first."""
        outcome = self.program.take(now, message, bus)
        if outcome and outcome.reset:
            self._reset(now, outcome.reset)
        return outcome

    def frame(self, now: int, id: int) -> bytes | None:
        """The frame with that id; None if the program has none."""
        stop = self.icd.protocol_of(self.program.node).get("boot", {}).get("stop_request")
        message = self.program.known.telemetry.get(id)
        if message and message.name == stop:
            self.boot_at = None
        return self.program.frame(now, id)

    def restart(self, now: int) -> None:
        """As after a reset or at power-up."""
        running = self.program.node
        starters = (n for n in self.icd.nodes if self._application(n) is running)
        self.start(now, next(starters, running))

    def _reset(self, now: int, message: Message) -> None:
        application = self._application(self.program.node)
        start = self.icd.protocol_of(self.program.node).get("program_start", {})
        if application and start.get("message") == message.name:
            self.start(now, application)
        else:
            self.restart(now)

    def _application(self, node: Node) -> Node | None:
        """The program that this one starts."""
        name = node.protocol.get("program_start", {}).get("application")
        return next((n for n in self.icd.nodes if n.name == name), None)
