"""Order of the steps of a procedure: which step can follow which one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

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
    return _reachable(
        procedure, index, registers or {}, lambda i: not _sends(procedure, i)
    )


def _sends(procedure: Procedure, index: int) -> bool:
    return isinstance(procedure.steps[index], Send)


def _reachable(
    procedure: Procedure,
    start: int,
    registers: Mapping[int, int],
    is_passed: Callable[[int], bool],
) -> list[int]:
    reached: dict[int, None] = {}
    waiting = list(following(procedure, start, registers)) if start >= 0 else [0]
    while waiting:
        index = waiting.pop(0)
        if index in reached or index >= len(procedure.steps):
            continue
        reached[index] = None
        if is_passed(index):
            waiting += following(procedure, index, registers)
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
