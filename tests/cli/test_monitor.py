"""`icdgen monitor`: rounds, formats, lost connections and exit status, without a port."""

from __future__ import annotations

import json
import re
from contextlib import contextmanager

import pytest
from icdgen_runtime.wire.events import Arrived, Done, Timeout

from icdgen.commands import monitor as command
from icdgen.link.ports import PortError
from tests.conftest import ROOT

ANSWER = Done(146, 1, b"\xe8\x03\1")
NO_ANSWER = Timeout(146, 3)


class Sessions:
    """Sessions with a device; each outcome is that of one request."""

    def __init__(self, *outcomes: object) -> None:
        self.outcomes = list(outcomes)
        self.opened = 0
        self.requested: list[int] = []
        self.problem: str | None = None

    @contextmanager
    def open_session(self, icd, facts, **options):
        self.opened += 1
        if self.outcomes and self.outcomes[0] == "closed":
            self.outcomes.pop(0)
            raise PortError("cannot open it")
        yield self

    def start(self, request):
        self.requested.append(request.id)
        outcome = self.outcomes.pop(0)
        if outcome == "lost":
            raise PortError("the line is down")
        return outcome

    def wait(self, until: float) -> bool:
        return False

    def identity_problem(self, session, faults) -> str | None:
        return self.problem


@pytest.fixture
def monitor(icdgen, demo, monkeypatch):
    """Return a function that monitors a device with these outcomes of requests."""
    sleeps: list[float] = []

    def run(sessions: Sessions, *words: object):
        monkeypatch.setattr(command, "open_session", sessions.open_session)
        monkeypatch.setattr(command, "identity_problem", sessions.identity_problem)
        monkeypatch.setattr(command.time, "sleep", sleeps.append)
        arguments = ("demo", "146", "--icd", demo, "--port", "tcp://x:1")
        return icdgen("monitor", *arguments, *words)

    run.sleeps = sleeps
    return run


def test_a_round_is_a_table_with_the_values(monitor):
    sessions = Sessions(ANSWER)
    result = monitor(sessions, "--once")
    assert (result.status, result.err) == (0, "")
    rows = [line.split() for line in result.out.splitlines() if line]
    assert rows[-2:] == [
        ["Estimated", "Roll", "Roll", "Angle", "10", "deg"],
        ["Mode", "Run"],
    ]
    assert sessions.requested == [146]


@pytest.mark.parametrize(
    ("words", "count"), [(("--once",), 1), (("--count", "1"), 1), (("--count", "3"), 3)]
)
def test_the_monitor_ends_after_its_rounds(monitor, words, count):
    sessions = Sessions(*[ANSWER] * 5)
    result = monitor(sessions, *words, "--every", "0")
    assert len(sessions.requested) == count
    assert result.out.count("Roll Angle") == count
    # A blank line separates the rounds.
    assert len(result.out.split("\n\n")) == count
    assert not result.out.startswith("\n")


@pytest.mark.parametrize(
    ("outcomes", "status"),
    [
        ([ANSWER, NO_ANSWER], 1),
        ([NO_ANSWER, ANSWER], 0),
        ([NO_ANSWER, NO_ANSWER], 1),
        ([ANSWER, ANSWER], 0),
    ],
)
def test_the_last_round_decides_the_exit_status(monitor, outcomes, status):
    result = monitor(Sessions(*outcomes), "--count", "2", "--every", "0")
    assert result.status == status
    assert result.out.count("no answer") == outcomes.count(NO_ANSWER)


def test_json_is_one_object_for_each_frame_with_the_time_in_utc(monitor):
    outcomes = (ANSWER, NO_ANSWER, ANSWER)
    result = monitor(
        Sessions(*outcomes), "--count", "3", "--every", "0", "--format", "json"
    )
    objects = [json.loads(line) for line in result.out.splitlines()]
    assert [each["message"] for each in objects] == ["Estimated Roll"] * 2
    for each in objects:
        assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z", each["time"])
        assert next(iter(each)) == "time"


def test_a_lost_connection_is_opened_again_with_a_pause(monitor):
    sessions = Sessions(ANSWER, "lost", "closed", ANSWER, ANSWER)
    result = monitor(sessions, "--count", "5", "--every", "0")
    assert (result.status, sessions.opened) == (0, 3)
    assert result.err == (
        "icdgen: the line is down; trying again\nicdgen: the line is back\n"
    )
    assert monitor.sleeps == [0.1, 0.1]
    assert result.out.count("no answer") == 2
    monitor.sleeps.clear()
    monitor(Sessions("lost", ANSWER), "--count", "2", "--every", "0.25")
    assert monitor.sleeps == [0.25]


def test_after_the_last_round_there_is_no_pause(monitor):
    result = monitor(Sessions(ANSWER, "lost"), "--count", "2", "--every", "0")
    assert (result.status, monitor.sleeps) == (1, [])


@pytest.mark.parametrize(
    ("outcomes", "words", "text"),
    [
        (["closed"], (), "cannot open it"),
        (["closed"], ("--count", "5"), "cannot open it"),
        (["lost"], ("--once",), "the line is down"),
        (["lost"], ("--count", "1"), "the line is down"),
    ],
)
def test_a_connection_that_never_worked_is_an_error(monitor, outcomes, words, text):
    sessions = Sessions(*outcomes)
    result = monitor(sessions, *words)
    assert (result.status, sessions.opened) == (2, 1)
    assert text in result.err


def test_another_device_than_that_of_the_icd_is_reported(monitor):
    sessions = Sessions(ANSWER)
    sessions.problem = "the device says something else"
    result = monitor(sessions, "--once")
    assert (result.status, result.err) == (
        0,
        "icdgen: the device says something else\n",
    )
    assert "Roll Angle" in result.out


def test_rounds_have_the_given_period(monitor, monkeypatch):
    now = [100.0]
    monkeypatch.setattr(command.time, "monotonic", lambda: now[0])
    waits: list[float] = []

    class Timed(Sessions):
        def wait(self, until: float) -> bool:
            waits.append(until)
            now[0] = until / 1000
            return False

    monitor(Timed(ANSWER, ANSWER, ANSWER), "--count", "3", "--every", "2.5")
    # After the last round there is nothing to wait for.
    assert waits == [102_500.0, 105_000.0]
    waits.clear()
    now[0] = 7.0
    monitor(Timed(ANSWER, ANSWER), "--count", "2")
    assert waits == [8000.0]


@pytest.mark.parametrize(
    ("words", "is_accepted"),
    [
        (("--count", "0"), False),
        (("--every", "-1"), False),
        (("--every", "86400"), True),
        (("--every", "86401"), False),
        (("--format", "csv"), False),
    ],
)
def test_options_have_limits(monitor, words, is_accepted):
    result = monitor(Sessions(ANSWER), "--once", *words)
    assert result.status == (0 if is_accepted else 2)


@pytest.mark.parametrize(
    ("arrives", "status", "text"),
    [
        ([True, True], 0, "Uptime"),
        ([True, False], 1, "last value"),
        ([False, False], 1, "nothing came"),
    ],
)
def test_on_a_framed_link_a_round_collects_what_arrives(
    icdgen, monkeypatch, arrives, status, text
):
    now = [100.0]
    monkeypatch.setattr(command.time, "monotonic", lambda: now[0])
    due = list(arrives)

    class Listening(Sessions):
        @contextmanager
        def open_session(self, icd, facts, **options):
            self.on_event = options["on_event"]
            yield self

        def wait(self, until: float) -> bool:
            now[0] = until / 1000
            if not due.pop(0):
                return False
            self.on_event(Arrived(0x80, b"\1\2\3", {}))
            return True

    sessions = Listening()
    monkeypatch.setattr(command, "open_session", sessions.open_session)
    monkeypatch.setattr(command, "identity_problem", sessions.identity_problem)
    wheel = ROOT / "examples" / "links" / "wheel.yaml"
    words = ("wheel", "Status", "--icd", wheel, "--port", "tcp://x:1", "--count", "2")
    result = icdgen("monitor", *words)
    assert (result.status, due, sessions.requested) == (status, [], [])
    assert text in result.out.split("\n\n")[-1]
