"""Bytes of a simulated device leave at their time, in their order."""

from __future__ import annotations

from random import Random
from types import SimpleNamespace

from icdgen.sim.device_line import DeviceLine
from icdgen.sim.faults import Faults, InjectedFault


def line(*faults: InjectedFault, boot_at: int | None = None) -> DeviceLine:
    computer = SimpleNamespace(deadline=boot_at)
    return DeviceLine(computer, Faults(Random(1), list(faults)))


def test_pieces_are_sent_in_the_order_of_their_times_then_of_their_creation():
    device = line()
    for at, data in ((20, b"b"), (10, b"z"), (20, b"a"), (30, b"c")):
        device.queue(at, "reply", data)
    assert device.deadline == 10
    assert device.pieces(9) == []
    assert device.pieces(10) == [b"z"]
    assert device.deadline == 20
    assert device.pieces(25) == [b"b", b"a"]
    assert device.pieces(30) == [b"c"]
    assert device.deadline is None


def test_the_deadline_is_the_earlier_one_of_computer_and_queue():
    assert line(boot_at=5).deadline == 5
    for boot_at, expected in ((0, 0), (5, 5), (7, 7), (9, 7)):
        device = line(boot_at=boot_at)
        device.queue(7, "reply", b"a")
        assert device.deadline == expected


def test_a_late_piece_is_sent_after_its_delay():
    device = line(InjectedFault("late", 1, ("reply",), delay_ms=300))
    device.queue(100, "reply", b"late")
    device.queue(100, "log", b"now")
    assert device.pieces(399) == [b"now"]
    assert device.pieces(400) == [b"late"]
