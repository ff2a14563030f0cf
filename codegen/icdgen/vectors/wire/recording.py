"""Scripts of procedures, recorded with the device's half of the same steps.

`record` runs a procedure of the Python runtime against a `RecordedDevice` and writes
down every event with its time; other languages must reach the same result.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable
from random import Random
from typing import Any

from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.procedures import Procedure

from icdgen.frozen import NamedTuple
from icdgen.procedures.counterpart import BlockPacket, Counterpart, Device, Refused
from icdgen.procedures.effects import Objects, default_effect
from icdgen.protocol.facts import Facts
from icdgen.runtime_objects.operations import AnyLink
from icdgen.runtime_objects.procedures import event_of, procedure_of
from icdgen.vectors.wire import Row, Script

STEPS = 100_000  # limit above the steps of any procedure
BUSY = 60  # duration of a slow step of the device, in milliseconds
ATTEMPTS = 8  # attempts of a client
DONE: Row = {"event": "done", "bytes": ""}
SENT: Row = {"event": "sent"}
REFUSED: Row = {"event": "refused", "code": 3}
TIMEOUT: Row = {"event": "timeout"}


class ClientReport(NamedTuple):
    """Event that a client reports, and the time since the event before, or since the
    request, in milliseconds.
    """

    event: Row
    after: int = 1


Respond = Callable[[int, Request], list[ClientReport]]
"""Function that returns the reports of a client for a request; its outcome is the last
one, or stands before packets that arrive later.
"""


class RecordedDevice:
    """Device behind a client on a bus.

    ``loss``: probability that a telecommand or its acknowledge is lost. ``packet_loss``:
    that of packets.
    """

    def __init__(
        self, facts: Facts, bus: str, source: Random, loss: float = 0.0
    ) -> None:
        self.facts, self.bus, self.source = facts, bus, source
        self.loss = self.packet_loss = loss
        self.requests = 0  # of telemetry
        # The fill is not that of the ICD, because no client may rely on it.
        self.device = Device(Objects(), BUSY, facts.checksum_of_files, filler=0xEE)
        # An object is all that its procedure reads or writes, and has no other effect.
        procedures = [(each, default_effect(each)) for each in facts.procedures]
        self.counterpart = Counterpart(procedures, self.device)

    def respond(self, now: int, request: Request) -> list[ClientReport]:
        """Return the reports of a client for a request."""
        if request.kind == "telecommand":
            return self._telecommand(now, request)
        return [
            ClientReport(
                {"event": "done", "bytes": self.telemetry(now, request.id).hex()}
            )
        ]

    def telemetry(self, now: int, id: int) -> bytes:
        """Return a frame, or the next packet that the client does not miss."""
        self.requests += 1
        message = self.facts.telemetry[id]
        data = self.counterpart.requested(message, self.bus)
        tries = 0
        while data is not None and self._is_lost(self.packet_loss) and tries < ATTEMPTS:
            data = self.counterpart.requested(message, self.bus)
            tries += 1
        if data is None:
            # Numbers that the procedures do not use may have any value.
            other = self.source.randbytes(message.length)
            data = self.counterpart.frame(now, message, other)
        return data

    def _is_lost(self, probability: float) -> bool:
        return self.source.random() < probability

    def _telecommand(self, now: int, request: Request) -> list[ClientReport]:
        message, is_framed = self.facts.telecommands[request.id], self.facts.stream
        outcome = DONE if message.acknowledge or not is_framed else SENT
        is_packet = self.counterpart.is_packet(message)
        loss = self.packet_loss if is_packet else self.loss
        packets: Iterable[BlockPacket] = ()
        is_lost = self._is_lost(loss)
        # Either the telecommand or its acknowledge is lost, unless all are lost.
        is_acknowledge_lost = message.acknowledge and loss < 1 and self._is_lost(0.5)
        if not is_lost or is_acknowledge_lost:
            try:
                self.counterpart.telecommand(now, message, request.data)
            except Refused:
                outcome = REFUSED
            packets = self.counterpart.packets(self.bus)
        # A telecommand without acknowledge always succeeds, even if it is lost.
        if is_lost and message.acknowledge:
            outcome = TIMEOUT
        arrived = [each for each in packets if not self._is_lost(self.packet_loss)]
        return [ClientReport(event) for event in (*map(arrival, arrived), outcome)]


def arrival(packet: BlockPacket) -> Row:
    """Return the event of a packet that arrives unasked."""
    id = packet.message.telemetry_id
    return {"event": "arrived", "id": id, "bytes": packet.data.hex()}


def record(
    link: AnyLink, request: dict[str, Any], respond: Respond, early: bool = False
) -> tuple[Script, Procedure]:
    """Return the script of a procedure, and the procedure at its end.

    Requests that may be repeated are repeated as by a client. ``early``: also a moment
    one millisecond before each deadline.
    """
    procedure, now = procedure_of(link, request), 0
    script: Script = [{"at": 0}]
    pending = procedure.next(now)
    reports: list[tuple[int, int, Row]] = []  # heap of time, order and event
    count = 0
    while procedure.result is None and len(script) < STEPS:
        if pending is not None:
            at = now
            client_reports, tries = respond(now, pending), 1
            # A client repeats a request after a time-out.
            while (
                pending.repeat
                and client_reports[-1].event == TIMEOUT
                and tries < ATTEMPTS
            ):
                # Packets that arrived before the time-out stay.
                client_reports = client_reports[:-1] + respond(now, pending)
                tries += 1
            for event, after in client_reports:
                at, count = at + after, count + 1
                # The order makes entries comparable, because events are mappings.
                heapq.heappush(reports, (at, count, event))
        deadline = None if procedure.deadline is None else int(procedure.deadline)
        next_report = reports[0][0] if reports else None
        if deadline is not None and (next_report is None or deadline < next_report):
            if early and deadline - 1 > now:
                script.append({"at": deadline - 1})
                procedure.next(deadline - 1)
            now = deadline
            script.append({"at": now})
        elif reports:
            now, _, event = heapq.heappop(reports)
            script.append({"at": now, "event": event})
            procedure.event(now, event_of(event))
        else:
            break
        pending = procedure.next(now)
    return script, procedure
