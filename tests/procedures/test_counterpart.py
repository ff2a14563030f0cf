"""A device gives each telecommand to all its procedures."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from icdgen.procedures.actions import Action, Listing
from icdgen.procedures.blocks import BlockReading, BlockWriting
from icdgen.procedures.counterpart import Counterpart, _class_of
from icdgen.procedures.run import Refused


class Run:
    """A procedure that records telecommands, and answers as the test wants."""

    def __init__(self, answer: bool | Refused = False, changes: Any = ()) -> None:
        self.answer, self.numbered = answer, list(changes)
        self.mapped: list[bytes] = []
        self.taken: list[tuple[int, bytes]] = []

    def map_message(self, message: Any, data: bytes) -> None:
        self.mapped.append(data)

    def telecommand(self, now: int, message: Any, data: bytes) -> bool:
        self.taken.append((now, data))
        if isinstance(self.answer, Refused):
            raise self.answer
        return self.answer

    def changes(self, now: int, message: Any) -> Any:
        return iter(self.numbered)

    def is_packet(self, message: Any) -> bool:
        return message == "packet" and bool(self.answer)


def counterpart(*runs: Any) -> Counterpart:
    device = Counterpart([], SimpleNamespace(telecommands=0))
    device.runs = {str(number): run for number, run in enumerate(runs)}
    return device


def test_every_procedure_sees_every_telecommand():
    runs = [Run(True), Run(False), Run(True)]
    device = counterpart(*runs)
    device.telecommand(5, None, b"a")
    device.telecommand(6, None, b"b")
    assert device.device.telecommands == 2
    for run in runs:
        assert (run.mapped, run.taken) == ([b"a", b"b"], [(5, b"a"), (6, b"b")])


def test_a_telecommand_is_refused_if_no_procedure_takes_it():
    first, second = Refused(), Refused()
    with pytest.raises(Refused) as refusal:
        counterpart(Run(), Run(first), Run(second)).telecommand(0, None, b"")
    assert refusal.value is first
    for runs in ((Run(first), Run(True)), (Run(True), Run(first)), (Run(), Run())):
        counterpart(*runs).telecommand(0, None, b"")
    last = Run()
    with pytest.raises(Refused):
        counterpart(Run(first), last).telecommand(0, None, b"x")
    assert last.taken == [(0, b"x")]


def test_the_change_by_the_latest_telecommand_of_all_procedures_is_the_last():
    def append(text: bytes) -> Any:
        return lambda data: data + text

    device = counterpart(
        Run(changes=[(3, append(b"c")), (1, append(b"a"))]),
        Run(changes=[(2, append(b"b")), (3, append(b"d"))]),
        Run(),
    )
    assert device.frame(0, None, b"_") == b"_abcd"
    assert counterpart(Run()).frame(0, None, b"_") == b"_"


def test_a_packet_belongs_to_any_procedure():
    assert counterpart(Run(), Run(True)).is_packet("packet")
    assert not counterpart(Run(True)).is_packet("other")
    assert not counterpart(Run(), Run()).is_packet("packet")


class Reading(BlockReading):
    """A procedure that sends packets of a block."""

    def __init__(self, name: str, requested_on: tuple[str, ...], count: int) -> None:
        message = SimpleNamespace(name=name)
        self.receive = SimpleNamespace(message=message, requested_on=requested_on)
        self.waiting = list(range(count))

    def packet(self, number: int) -> Any:
        return self.receive.message.name, number

    def requested(self) -> Any:
        return SimpleNamespace(data=f"next of {self.receive.message.name}".encode())


def test_packets_are_sent_unasked_once_on_buses_where_they_are_not_requested():
    device = counterpart(Reading("A", ("i2c",), 2), Run(), Reading("B", (), 1))
    assert list(device.packets("i2c")) == [("B", 0)]
    assert list(device.packets("uart")) == [("A", 0), ("A", 1)]
    assert list(device.packets("uart")) == []


def test_the_next_packet_is_requested_by_its_message_and_bus():
    device = counterpart(Reading("A", ("i2c",), 2), Reading("B", ("can", "uart"), 2))
    messages = {name: SimpleNamespace(name=name) for name in "ABC"}
    assert device.requested(messages["A"], "i2c") == b"next of A"
    assert device.requested(messages["B"], "uart") == b"next of B"
    for name, bus in (("A", "uart"), ("B", "i2c"), ("C", "i2c")):
        assert device.requested(messages[name], bus) is None


@pytest.mark.parametrize(
    ("sends", "entry", "expected"),
    [
        (True, None, BlockWriting),
        (True, "entry", BlockWriting),
        (False, "entry", BlockReading),
        (None, "entry", Listing),
        (None, None, Action),
    ],
)
def test_the_class_of_a_procedure_follows_from_its_blocks_and_entries(
    sends, entry, expected
):
    blocks = None if sends is None else SimpleNamespace(sends=sends)
    assert _class_of(SimpleNamespace(blocks=blocks, entry=entry)) is expected
