"""Order of the steps of a procedure, as far as the device can know it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from icdgen.procedures.flow import (
    following,
    leads_to_packets,
    sends_packets,
    until_next_send,
)
from icdgen.protocol import procedures
from icdgen.protocol.procedures import (
    Get,
    Jump,
    NextBlock,
    NextPacket,
    NextRound,
    PacketDone,
    Receive,
    Send,
    SetLength,
    SkipUnless,
    Value,
    Verify,
    VerifyChecksum,
)

EQUALS = procedures.Test(6, Value(3, in_register=False))
EQUALS_REGISTER = procedures.Test(6, Value(7, in_register=True))


def procedure(*steps: Any, begin: int | None = None) -> Any:
    """Return a procedure; with ``begin`` it has blocks, which begin at this step."""
    blocks = None if begin is None else SimpleNamespace(begin=begin)
    return SimpleNamespace(steps=steps, blocks=blocks)


def send(packet_at: int | None = None) -> Send:
    return Send(None, b"", (), packet_at, True, False)


def receive() -> Receive:
    return Receive(None, None, 2, 100, ())


@pytest.mark.parametrize("step", [NextBlock(9), NextRound(9), NextPacket(9)])
def test_a_step_that_the_device_cannot_predict_leads_both_ways(step):
    assert list(following(procedure(send(), step), 1, {})) == [2, 9]


def test_a_jump_leads_to_its_step_and_other_steps_to_the_next_one():
    assert list(following(procedure(Jump(5)), 0, {})) == [5]
    for step in (send(), Get(None, ()), PacketDone(), SetLength(Value(1, False))):
        assert list(following(procedure(step), 0, {})) == [1]


@pytest.mark.parametrize(
    ("test", "registers", "expected"),
    [
        (EQUALS, {}, [1, 9]),
        (EQUALS, {5: 3}, [1, 9]),
        (EQUALS, {6: 3}, [1]),
        (EQUALS, {6: 4}, [9]),
        (EQUALS, {6: 0}, [9]),
        (EQUALS_REGISTER, {6: 8, 7: 8}, [1]),
        (EQUALS_REGISTER, {6: 7, 7: 8}, [9]),
        # A number that the client has not given is 0.
        (EQUALS_REGISTER, {6: 0}, [1]),
        (EQUALS_REGISTER, {6: 7}, [9]),
        (EQUALS_REGISTER, {7: 8}, [1, 9]),
    ],
)
def test_a_condition_on_a_given_number_is_decided(test, registers, expected):
    steps = procedure(SkipUnless(test, 9))
    assert list(following(steps, 0, registers)) == expected


@pytest.mark.parametrize(
    ("again", "begin", "expected"),
    [(True, 4, [1, 4]), (False, 4, [1]), (True, None, [1]), (False, None, [1])],
)
def test_a_failed_check_can_repeat_the_block(again, begin, expected):
    checks = (
        Verify(EQUALS, again),
        VerifyChecksum(None, True, False, Value(1, False), again),
    )
    for check in checks:
        assert list(following(procedure(check, begin=begin), 0, {})) == expected


def test_steps_are_reached_up_to_the_next_telecommand_and_each_once():
    steps = procedure(
        send(),  # 0
        NextBlock(8),
        Get(None, ()),
        SkipUnless(EQUALS, 6),
        send(),  # 4
        Get(None, ()),
        send(),  # 6
        Jump(1),
        Get(None, ()),  # 8
    )
    assert until_next_send(steps, -1) == [0]
    assert until_next_send(steps, 0) == [1, 2, 8, 3, 4, 6]
    assert until_next_send(steps, 0, {6: 3}) == [1, 2, 8, 3, 4]
    assert until_next_send(steps, 4) == [5, 6]
    assert until_next_send(steps, 6) == [7, 1, 2, 8, 3, 4, 6]
    assert until_next_send(steps, 8) == []


def test_packets_follow_a_telecommand_if_none_is_between():
    steps = procedure(
        send(), Get(None, ()), receive(), send(), Get(None, ()), send(), send(3)
    )
    assert [leads_to_packets(steps, i) for i in (0, 3, 5, 6)] == [
        True,
        False,
        True,
        False,
    ]
    assert [sends_packets(steps, i) for i in range(7)] == [False] * 6 + [True]
    assert sends_packets(procedure(send(0)), 0)
