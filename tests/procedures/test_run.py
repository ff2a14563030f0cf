"""The device follows the steps that its numbers lead to, in each run of a procedure."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from icdgen.procedures.effects import Objects
from icdgen.procedures.run import Device, ProcedureRun
from icdgen.protocol import procedures
from icdgen.protocol.exchange import NumberPlace
from icdgen.protocol.procedures import Get, Put, Send, SkipUnless, Value

START, END, STATE = (SimpleNamespace(name=name) for name in ("Start", "End", "State"))
FIRST, SECOND = 6, 7  # registers of the two bytes of the telecommand `Start`


def run_of(test: procedures.Test) -> ProcedureRun:
    """Return a procedure that requests `State` after `Start` if the test holds."""
    puts = tuple(
        Put(NumberPlace(at, 1, 0, 8, True), Value(register, in_register=True))
        for at, register in enumerate((FIRST, SECOND))
    )
    steps = (
        Send(START, b"", puts, None, True, False),
        SkipUnless(test, 3),
        Get(STATE, ()),
        Send(END, b"", (), None, True, False),
    )
    procedure: Any = SimpleNamespace(
        steps=steps, blocks=None, numbers=(), first_input=FIRST
    )
    effect: Any = SimpleNamespace(key=(), fields=(), kind="file")
    return ProcedureRun(procedure, effect, Device(Objects()), ())


@pytest.mark.parametrize(
    ("value", "is_requested"),
    [
        (Value(3, in_register=False), {b"\x03\x03": True, b"\x04\x03": False}),
        (
            Value(SECOND, in_register=True),
            {b"\x03\x03": True, b"\x03\x04": False, b"\x04\x04": True},
        ),
    ],
)
@pytest.mark.parametrize("reverse", [False, True])
def test_each_run_goes_by_its_own_numbers(value, is_requested, reverse):
    run = run_of(procedures.Test(FIRST, value))
    for number, data in enumerate(sorted(is_requested, reverse=reverse), 1):
        run.device.telecommands = number
        assert run.telecommand(0, START, data)
        # What earlier telecommands have changed remains.
        changed_by = {latest for latest, _ in run.changes(0, STATE)}
        assert (number in changed_by) == is_requested[data], data
