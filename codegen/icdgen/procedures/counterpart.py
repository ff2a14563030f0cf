"""Device's half of all procedures of a node.

`Counterpart` gives each telecommand to all procedures, and lets them change the
telemetry that the client requests.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from icdgen.icd.model import Message
from icdgen.procedures.actions import Action, Listing
from icdgen.procedures.blocks import BlockPacket, BlockReading, BlockWriting
from icdgen.procedures.run import Device, ProcedureRun, Refused
from icdgen.protocol.procedures import Effect, Procedure

__all__ = ["BlockPacket", "Counterpart", "Device", "Refused"]


class Counterpart:
    """The procedures of a node in a device.

    Telecommands and telemetry that do not belong to any procedure are ignored.
    """

    def __init__(
        self, procedures: Iterable[tuple[Procedure, Effect]], device: Device
    ) -> None:
        procedures = list(procedures)
        # A list or a description has no names of its own for the key of an object: those
        # of the procedure that reads or writes such objects apply.
        names = {
            effect.kind: effect.names
            for _, effect in procedures
            if effect.verb in ("read", "write")
        }
        self.device = device
        self.runs: dict[str, ProcedureRun] = {}
        for procedure, effect in procedures:
            key_names = names.get(effect.kind, effect.names)
            run_class = _class_of(procedure)
            self.runs[procedure.name] = run_class(procedure, effect, device, key_names)

    def telecommand(self, now: int, message: Message, data: bytes) -> None:
        """Process a telecommand. Raise `Refused`."""
        self.device.telecommands += 1
        refusals, is_processed = [], False
        for run in self.runs.values():
            run.map_message(message, data)
            try:
                is_processed |= run.telecommand(now, message, data)
            except Refused as refusal:
                refusals.append(refusal)
        # A telecommand can belong to several procedures: it is refused only if none of
        # them takes it.
        if refusals and not is_processed:
            raise refusals[0]

    def frame(self, now: int, message: Message, data: bytes) -> bytes:
        """Return a frame with the numbers that procedures report in it.

        ``data``: the frame without them.
        """
        changes = [
            change for run in self.runs.values() for change in run.changes(now, message)
        ]
        # The change by the latest telecommand is the last one.
        for _, change in sorted(changes, key=lambda numbered: numbered[0]):
            data = change(data)
        return data

    def is_packet(self, message: Message) -> bool:
        """Return whether a telecommand has a packet of a block."""
        return any(run.is_packet(message) for run in self.runs.values())

    def packets(self, bus: str) -> Iterator[BlockPacket]:
        """Yield the packets that the device sends unasked on a bus, each once."""
        for run in self._reading():
            while bus not in run.receive.requested_on and run.waiting:
                yield run.packet(run.waiting.pop(0))

    def requested(self, message: Message, bus: str) -> bytes | None:
        """Return the next packet that the client requests on a bus; None if this
        telemetry has no such packets.
        """
        for run in self._reading():
            receive = run.receive
            if receive.message.name == message.name and bus in receive.requested_on:
                return run.requested().data
        return None

    def _reading(self) -> list[BlockReading]:
        return [run for run in self.runs.values() if isinstance(run, BlockReading)]


def _class_of(procedure: Procedure) -> type[ProcedureRun]:
    """Return the class of the state of a procedure."""
    if procedure.blocks:
        return BlockWriting if procedure.blocks.sends else BlockReading
    return Listing if procedure.entry else Action
