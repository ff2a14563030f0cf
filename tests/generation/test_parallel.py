"""Backends run side by side: what comes out, and which errors, are those of one after the other."""

from __future__ import annotations

import os
import signal
import time

import pytest

from icdgen.generation import parallel


@pytest.fixture(autouse=True)
def three_cores(monkeypatch):
    """As on a machine with three; the test runner's own threads are no concern here."""
    monkeypatch.setattr(parallel, "_cores", lambda: 3)


def slowly(value):
    time.sleep(0.05)
    return value, os.getpid()


def test_results_come_in_the_order_of_the_tasks():
    found = parallel.results([lambda n=n: slowly(n) for n in range(7)])
    assert [value for value, _ in found] == list(range(7))


def test_other_processes_take_their_share():
    assert len({pid for _, pid in parallel.results([lambda: slowly(0)] * 6)}) > 1


def test_the_error_is_that_of_the_first_task_that_fails():
    def fails(text):
        raise ValueError(text)

    with pytest.raises(ValueError, match="second"):
        parallel.results([lambda: slowly(1), lambda: fails("second"), lambda: fails("third"), lambda: slowly(4)])


def test_what_a_killed_process_owed_is_done_again():
    here = os.getpid()

    def dies():
        if os.getpid() != here:
            os.kill(os.getpid(), signal.SIGKILL)
        return slowly(1)

    assert {pid for _, pid in parallel.results([dies] * 6)} == {here}


def test_no_process_and_no_pipe_is_left_behind():
    before = set(os.listdir("/proc/self/fd"))
    parallel.results([lambda: slowly(1)] * 4)

    def interrupted():
        raise KeyboardInterrupt

    here = os.getpid()
    with pytest.raises(KeyboardInterrupt):
        parallel.results([lambda: interrupted() if os.getpid() == here else time.sleep(60)] * 4)
    assert set(os.listdir("/proc/self/fd")) == before
    with pytest.raises(ChildProcessError):
        os.waitpid(-1, os.WNOHANG)
