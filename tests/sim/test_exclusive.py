"""A serial line serves one program at a time. A second program reports which one uses
it and sends nothing.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time

import pytest

from icdgen.link.exclusive import users_of
from icdgen.link.ports import PortError, PseudoTerminal, Serial
from tests.sim.device import simulator

pytestmark = pytest.mark.pty


def icdgen(*words: str) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "icdgen", *words]
    return subprocess.run(command, capture_output=True, text=True, timeout=60)


@pytest.fixture
def line():
    """Return both ends of a silent line: the file of the device, and the path of the
    terminal.
    """
    device, terminal = os.openpty()
    path = os.ttyname(terminal)
    os.close(terminal)
    yield device, path
    os.close(device)


def test_send_during_a_monitor_names_the_program_and_sends_nothing():
    with simulator("--node", "cubeacp", "--pty") as (place, _):
        watching = subprocess.Popen(
            [
                sys.executable,
                "-m",
                "icdgen",
                "monitor",
                "cubeacp",
                "--port",
                place,
                "--every",
                "0.2",
            ],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        try:
            assert watching.stdout is not None
            watching.stdout.readline()
            for _ in range(3):
                sent = icdgen(
                    "send",
                    "cubeacp",
                    "Set Wheel Speed",
                    "x=1",
                    "y=1",
                    "z=1",
                    "--port",
                    place,
                )
                assert sent.returncode == 2 and "not known" not in sent.stderr
                assert (
                    f"{place} is in use by icdgen monitor (process {watching.pid})"
                    in sent.stderr.replace("\n", " ")
                )
                assert (
                    "nothing was sent" in sent.stderr
                    and "end that program" in sent.stderr
                )
        finally:
            watching.terminate()
            watching.communicate()
        assert (
            icdgen(
                "send",
                "cubeacp",
                "Set Wheel Speed",
                "x=1",
                "y=1",
                "z=1",
                "--port",
                place,
            ).returncode
            == 0
        )


@pytest.mark.parametrize("second", ["terminal", "serial"])
@pytest.mark.parametrize("first", ["terminal", "serial"])
def test_a_port_is_opened_once(line, first, second):
    makers = {"terminal": PseudoTerminal, "serial": lambda path: Serial(path, {})}
    device, path = line
    port = makers[first](path)
    with pytest.raises(PortError, match="is in use") as error:
        makers[second](path)
    assert error.value.help
    port.write(b"a")
    assert os.read(device, 10) == b"a"
    port.close()
    makers[second](path).close()


def test_the_program_that_has_a_port_is_named(line):
    _, path = line
    code = "import fcntl, os, sys, time; f = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY); fcntl.flock(f, 2); time.sleep(60)"
    other = subprocess.Popen([sys.executable, "-c", code, path])
    try:
        end = time.monotonic() + 20
        while other.pid not in dict(users_of(path)) and time.monotonic() < end:
            time.sleep(0.05)
        time.sleep(0.2)
        with pytest.raises(PortError, match=rf"process {other.pid}\)"):
            PseudoTerminal(path)
    finally:
        other.kill()
        other.wait()
