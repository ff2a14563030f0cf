"""The reference client and the reference procedures over a port: they judge the
simulator, which runs on the Python runtime.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

from icdgen import codec
from icdgen.icd.model import Icd, Message, Node
from icdgen.link.ports import Can, Port
from icdgen.protocol import facts
from icdgen.protocol.client import TELECOMMAND, TELEMETRY, Client, Request
from icdgen.protocol.sections import CAN, UART, Settings
from icdgen.protocol.transfer import OUTCOMES, Procedure

LONGEST_WAIT = 3600.0  # s


class Session:
    """One device on one port.

    ``on_event`` is told of what came unasked: packets, logs, stray messages, errors.
    """

    def __init__(
        self,
        icd: Icd,
        node: Node,
        port: Port | Can,
        crc: bool = False,
        address: int = 0,
        settings: Settings | None = None,
        on_event: Callable[[dict], None] | None = None,
    ) -> None:
        self.icd, self.node, self.port = icd, node, port
        self.known = facts.of(icd, node)
        self.bus = CAN if isinstance(port, Can) else UART
        self.client = Client(self.known, self.bus, crc, address, settings)
        self.on_event = on_event or (lambda event: None)

    def close(self) -> None:
        self.port.close()

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def now(self) -> int:
        """Milliseconds of a clock that never goes back."""
        return time.monotonic_ns() // 1_000_000

    def ask(self, request: Request) -> dict:
        """Sends a request and waits for its end: ``done``, ``refused`` or ``timeout``.

        Raises `PortError`.
        """
        events = self.client.start(self.now, request)
        try:
            while True:
                self._write()
                for event in events:
                    if event["event"] in OUTCOMES:
                        return event
                    self.on_event(event)
                events = self._wait(self.client.deadline)
        finally:
            self.client.cancel()  # else a port that fails leaves it busy

    def telemetry(self, message: Message) -> bytes | None:
        """The frame; None if there was no answer."""
        assert message.telemetry_id is not None
        outcome = self.ask(Request(TELEMETRY, message.telemetry_id))
        return bytes.fromhex(outcome["bytes"]) if outcome["event"] == "done" else None

    def telecommand(self, message: Message, data: bytes, repeat: bool = False) -> dict:
        """Sends a telecommand; its outcome."""
        assert message.telecommand_id is not None
        return self.ask(Request(TELECOMMAND, message.telecommand_id, data, repeat))

    def identify(self) -> tuple[dict[str, int], bool] | None:
        """What the node says it is, by role, and whether the ICD is that of it; None
        without an answer.
        """
        step = self.known.identification
        frame = self.telemetry(step.message) if step else None
        if step is None or frame is None:
            return None
        raw = codec.decode(self.icd.node(step.message.node), step.message, frame)
        found = {role: int(raw[name]) for role, name in step.fields.items()}
        expected = {
            "node_type": self.node.node_type,
            "interface_version": self.node.interface_version,
        }
        return found, all(
            expected.get(role) in (None, value) for role, value in found.items()
        )

    def run(
        self, procedure: Procedure, progress: Callable[[], None] | None = None
    ) -> str:
        """Runs a procedure to its end; its result. Raises `PortError`.

        A refusal with a code that the ICD does not have is a damaged acknowledge, which
        tells nothing: what may be repeated is asked again, and else it is as if none
        had come. ``on_event`` is told of each, with its code.
        """
        try:
            return self._driven(procedure, progress)
        finally:
            self.client.cancel()

    def _driven(self, procedure: Procedure, progress: Callable[[], None] | None) -> str:
        waiting: list[dict] = []
        asked: Request | None = None
        left, again = 0, False
        while procedure.result is None:
            request = asked if again else procedure.next(self.now)
            if request is not None and not again:
                asked, left = request, self.client.settings.retries
            again = False
            if progress:
                progress()
            if request is not None:
                waiting = self.client.start(self.now, request)
                self._write()
            elif procedure.result is None:
                times = [
                    at
                    for at in (procedure.deadline, self.client.deadline)
                    if at is not None
                ]
                waiting = self._wait(min(times, default=None))
                self._write()
            for event in waiting:
                damaged = _is_damaged(event)
                if damaged:
                    self.on_event(event)
                if damaged and asked is not None and asked.repeat and left > 0:
                    again, left = True, left - 1
                    continue
                procedure.event(
                    self.now, {**event, "event": "timeout"} if damaged else event
                )
                if event["event"] not in (*OUTCOMES, "packet"):
                    self.on_event(event)
        return procedure.result

    def listen(self, until: int) -> Iterator[dict]:
        """What comes unasked until then."""
        while self.now < until:
            yield from self._wait(until)

    def _wait(self, deadline: int | None) -> list[dict]:
        """Waits until something comes, or until then."""
        timeout = (
            LONGEST_WAIT if deadline is None else max(0.0, (deadline - self.now) / 1000)
        )
        if isinstance(self.port, Can):
            packet = self.port.receive(timeout)
            return (
                self.client.packet(self.now, packet)
                if packet
                else self.client.tick(self.now)
            )
        data = self.port.read(timeout)
        return (
            self.client.received(self.now, data) if data else self.client.tick(self.now)
        )

    def _write(self) -> None:
        out, self.client.out = self.client.out, []
        for one in out:
            if isinstance(self.port, Can):
                self.port.send(one)
            else:
                self.port.write(one)


def _is_damaged(event: dict) -> bool:
    """Whether it is a refusal with a code that the ICD does not have."""
    return (
        event["event"] == "refused"
        and event["code"] is not None
        and event["reason"] is None
    )
