"""Each simulated fault changes the bytes of a message as its name says, and nothing
more.
"""

from __future__ import annotations

from collections.abc import Iterator
from random import Random

import pytest

from icdgen.errors import UserError
from icdgen.sim.faults import OUT, Faults, parse
from tests.limits import assert_limits

DATA = bytes(range(20))
"""No byte twice, so that a lost or repeated one can be found."""


def applied(
    *texts: str, on: str = "reply", data: bytes = DATA, times: int = 2000
) -> Iterator[list[tuple[int, bytes]]]:
    """Apply faults to a message many times; return the chunks and their delays."""
    faults = Faults(Random(1), [parse(text) for text in texts])
    return (faults.apply(on, data) for _ in range(times))


def test_without_a_fault_a_message_arrives_at_once_and_unchanged():
    assert all(pieces == [(0, DATA)] for pieces in applied(times=10))
    assert all(pieces == [(0, DATA)] for pieces in applied("corrupt=0", "drop=0%"))


def test_a_lost_message_has_no_bytes():
    assert all(pieces == [] for pieces in applied("drop=100%"))


def test_corruption_always_changes_exactly_one_byte():
    changed = set()
    for ((_, data),) in applied("corrupt=1"):
        assert len(data) == len(DATA)
        places = [place for place, byte in enumerate(data) if byte != DATA[place]]
        assert len(places) == 1, "a corrupt message differs from the original"
        changed.add(places[0])
    assert changed == set(range(len(DATA)))


def test_a_cut_message_lacks_one_byte_anywhere():
    cuts = {data for ((_, data),) in applied("cut=1")}
    assert cuts == {DATA[:place] + DATA[place + 1 :] for place in range(len(DATA))}


def test_one_byte_at_any_position_comes_twice():
    repeats = {data for ((_, data),) in applied("repeat=1")}
    places = range(len(DATA))
    assert repeats == {DATA[: place + 1] + DATA[place:] for place in places}


def test_noise_comes_before_the_complete_message():
    lengths = set()
    for ((_, data),) in applied("noise=1"):
        assert data.endswith(DATA)
        lengths.add(len(data) - len(DATA))
    assert lengths == set(range(1, 32))


def test_a_message_comes_twice():
    assert all(pieces == [(0, DATA)] * 2 for pieces in applied("duplicate=1"))


def test_a_late_message_has_the_delay_of_the_fault_or_a_random_one():
    assert all(pieces == [(300, DATA)] for pieces in applied("late=1:300"))
    delays = {delay for ((delay, _),) in applied("late=1", times=20_000)}
    assert delays == set(range(1, 1501))


@pytest.mark.parametrize("kind", ["corrupt", "cut", "repeat"])
def test_a_message_without_bytes_stays_so(kind):
    assert all(pieces == [(0, b"")] for pieces in applied(f"{kind}=1", data=b""))


@pytest.mark.parametrize(("share", "expected"), [("25%", 0.25), ("0.25", 0.25)])
def test_the_share_of_messages_is_that_of_the_fault(share, expected):
    lost = sum(not pieces for pieces in applied(f"drop={share}", times=10_000))
    assert lost / 10_000 == pytest.approx(expected, abs=0.02)


def test_a_fault_is_on_the_messages_that_it_names():
    for on in (*OUT, "telecommand", "request", "upload"):
        (named,) = applied("drop=1@acknowledge,request", on=on, times=1)
        assert (named == []) == (on in ("acknowledge", "request")), on
        (default,) = applied("drop=1", on=on, times=1)
        assert (default == []) == (on in OUT), f"{on}: by default what is sent"


def is_fault(text: str) -> bool:
    try:
        parse(text)
    except UserError:
        return False
    return True


def test_a_share_is_at_most_all_messages():
    assert_limits(lambda percent: is_fault(f"drop={percent}%"), most=100)
    assert_limits(lambda hundredth: is_fault(f"drop={hundredth / 100}"), most=100)
    assert is_fault("drop=0") and not is_fault("drop=1.0.0")


def test_a_delay_has_at_least_a_millisecond_and_fits_31_bits():
    assert_limits(
        lambda delay: is_fault(f"late=1:{delay}"), least=1, most=(1 << 31) - 1
    )


def test_only_refusals_and_late_messages_have_a_detail():
    assert parse("nak=1:Bad length").reason == "Bad length"
    assert parse("nack=1").kind == "nak"
    for text in ("drop=1:3", "busy=1:3", "late=1:soon"):
        assert not is_fault(text), text
    assert not is_fault("late=1@telecommand"), "only what the device sends can be late"
    assert not is_fault("nak=1@reply"), "only telecommands can be refused"
