"""Order of the steps of a procedure: which step can follow which one.

The device sees telecommands only. From the last one, `until_next_send` tells which
telemetry the client may request next, and which telecommand may follow.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from icdgen.protocol.procedures import (
    Jump,
    NextBlock,
    NextPacket,
    NextRound,
    Procedure,
    Receive,
    Send,
    SkipUnless,
    Verify,
    VerifyChecksum,
)


def following(
    procedure: Procedure, index: int, registers: Mapping[int, int]
) -> Iterable[int]:
    """Return the steps that can follow a step directly.

    ``registers``: numbers that the client has given; they decide conditions.
    """
    step = procedure.steps[index]
    match step:
        case Jump(to):
            return (to,)
        case SkipUnless(test, to) if test.register in registers:
            wanted = test.value.number
            if test.value.in_register:
                wanted = registers.get(wanted, 0)
            return (index + 1 if registers[test.register] == wanted else to,)
        # The device does not know what these decide, so both ways are possible.
        case SkipUnless() | NextBlock() | NextRound() | NextPacket():
            return (index + 1, step.to)
        case Verify() | VerifyChecksum() if step.again and procedure.blocks:
            return (index + 1, procedure.blocks.begin)
    return (index + 1,)


def until_next_send(
    procedure: Procedure, index: int, registers: Mapping[int, int] | None = None
) -> list[int]:
    """Return the steps that can follow a step before the next telecommand, and the
    steps that send this next telecommand.
    """
    registers = registers or {}
    # A dict without values, because it keeps the order of the steps.
    reached: dict[int, None] = {}
    # -1: before the first step
    waiting = list(following(procedure, index, registers)) if index >= 0 else [0]
    while waiting:
        next_index = waiting.pop(0)
        if next_index in reached or next_index >= len(procedure.steps):
            continue
        reached[next_index] = None
        if not isinstance(procedure.steps[next_index], Send):
            waiting += following(procedure, next_index, registers)
    return list(reached)


def sends_packets(procedure: Procedure, index: int) -> bool:
    """Return whether a step sends the packets of a block."""
    step = procedure.steps[index]
    return isinstance(step, Send) and step.packet_at is not None


def leads_to_packets(procedure: Procedure, index: int) -> bool:
    """Return whether packets can follow a telecommand before the next one."""
    steps = until_next_send(procedure, index)
    return any(
        isinstance(procedure.steps[i], Receive) or sends_packets(procedure, i)
        for i in steps
    )
