"""Bounds of procedures, computed from the limits of an ICD.

`docs/reference/wire-procedures.md` describes the bounds in words.
"""

from __future__ import annotations

from typing import NamedTuple

from icdgen_runtime.wire.procedure_forms import (
    BLOCK_OFFSET,
    Get,
    GetMap,
    Jump,
    NextBlock,
    NextPacket,
    NextRound,
    Poll,
    ProcedureStep,
    Receive,
    Send,
    SendMap,
)
from icdgen_runtime.wire.procedures import Procedure


class Bound(NamedTuple):
    """Maximum number of requests, time spent waiting between them in ms, and number of
    bytes or entries that the procedure stores.
    """

    requests: int
    waiting: int = 0
    stored: int = 0

    def __add__(self, other: object) -> Bound:
        assert isinstance(other, Bound)
        return Bound(*(a + b for a, b in zip(self, other, strict=True)))

    def __mul__(self, times: object) -> Bound:
        assert isinstance(times, int)
        return Bound(*(times * each for each in self))


def poll(timeout: int, interval: int) -> Bound:
    """Bound of a poll: the last request begins at the end of its time at the latest."""
    return Bound((timeout - 1) // interval + 2, timeout + interval)


def most_of(procedure: Procedure) -> Bound:
    """Return the bound of a procedure.

    It is the sum of the bounds of each step as often as it can be reached, within the
    limit of requests. Each request can be damaged as often as it can be repeated.
    """
    form, retries = procedure.form, procedure.link.settings.retries
    most = Bound(0, 0, _stored(procedure))
    for index, step in enumerate(form.steps):
        most += _bound_of(procedure, step) * _times(procedure, index)
    requests = min(most.requests * (1 + retries), form.requests)
    return most._replace(requests=requests)


def _stored(procedure: Procedure) -> int:
    """Return the most bytes or entries that a procedure stores."""
    blocks, total = procedure.form.blocks, procedure.progress[1]
    if blocks is None or blocks.sends:
        return procedure.form.most_entries
    return blocks.most if total is None else total


def _bound_of(procedure: Procedure, step: ProcedureStep) -> Bound:
    """Return the bound of a step that is reached once."""
    packets = _packets(procedure)
    if isinstance(step, (Send, Get)):
        return Bound(1)
    if isinstance(step, Poll):
        return poll(step.timeout, step.interval)
    if isinstance(step, (SendMap, GetMap)):
        blocks = procedure.form.blocks
        assert blocks and blocks.map
        return Bound(-(-packets // (8 * blocks.map.bytes)))
    if isinstance(step, Receive):
        # Each new packet prolongs a round.
        return Bound(packets, (packets + 1) * step.silence)
    return Bound(0)


def _packets(procedure: Procedure) -> int:
    """Return the most packets of a block."""
    blocks = procedure.form.blocks
    return -(-procedure.block_bytes // blocks.packet_bytes) if blocks else 0


def _times(procedure: Procedure, index: int) -> int:
    """Return how often a step can be reached: the product of its loops."""
    form, times, rounds = procedure.form, 1, 0
    for end, jump in enumerate(form.steps):
        if not isinstance(jump, Jump) or not jump.to <= index <= end:
            continue
        first = form.steps[jump.to]
        if isinstance(first, NextPacket):
            times *= _packets(procedure)
        elif isinstance(first, NextRound):
            rounds = 1
        elif isinstance(first, NextBlock):
            assert form.blocks
            most, total = form.blocks.most, procedure.progress[1]
            most = most if total is None else total
            times *= most // procedure.block_bytes + 1
            # The block is transferred once, and again after each round.
            times *= form.blocks.rounds + 1 - rounds
        else:
            # Each entry, its repetitions because the advance was lost, and the end.
            repetitions = 1 + procedure.link.settings.retries
            times *= form.most_entries * repetitions + 1
    return times


def begin_at(procedure: Procedure, offset: int) -> None:
    """Let the first block of a procedure begin at this offset."""
    procedure._registers[BLOCK_OFFSET] = offset
