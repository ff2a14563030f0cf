"""The table of `icdgen monitor` keeps the values of a device that stops answering, and
scrolls on a small terminal.
"""

from __future__ import annotations

import fcntl
import io
import os
import pty
import select
import struct
import subprocess
import sys
import termios
import time

import pytest
from icdgen_runtime.wire.events import Arrived, Done, Timeout
from rich.console import Console

from icdgen.link import live
from icdgen.link.screen import Screen
from icdgen.loading import load
from tests.conftest import ROOT
from tests.sim.device import ICD, simulator


def test_a_message_with_a_period_may_be_absent_for_as_long(monkeypatch, tmp_path):
    now = 100.0
    monkeypatch.setattr(live.time, "monotonic", lambda: now)
    text = (ROOT / "examples" / "links" / "tfmini.yaml").read_text()
    path = tmp_path / "tfmini.yaml"
    path.write_text(text.replace("period_ms: 10\n", "period_ms: 10000\n"))
    monitor = live.Monitor(load([path]).icd, "tfmini", ["Measurement"])

    def remarks_after_a_round() -> str:
        monitor.begin()
        monitor.end()
        *_, text = next(monitor.rows())
        return text

    assert remarks_after_a_round() == "nothing came"
    monitor.event(Arrived(0, bytes(6), {}))
    assert remarks_after_a_round() == ""
    now = 119.0
    assert remarks_after_a_round() == ""
    now = 121.0
    assert remarks_after_a_round() == "nothing came; last value, 21 s old"


def watched(*names: str) -> live.Monitor:
    return live.Monitor(ICD, "cubeacp", names)


def test_a_device_that_stops_answering_leaves_its_last_values_and_their_age(
    monkeypatch,
):
    now = 100.0
    monkeypatch.setattr(live.time, "monotonic", lambda: now)
    monitor = watched("146")
    (message,) = monitor.messages
    monitor.record(message, Timeout(message.telemetry_id, 3))
    assert [row[4] for row in monitor.rows()] == ["no answer"]
    monitor.record(
        message,
        Done(
            id=message.telemetry_id,
            attempts=1,
            data=bytes((1, 0)) + bytes(message.length - 2),
        ),
    )
    fresh = [row[:4] for row in monitor.rows()]
    assert not any(row[4] for row in monitor.rows()) and not monitor.failed
    for seconds, age in ((12, "12 s"), (200, "3 min 20 s"), (7500, "2 h 5 min")):
        now = 100.0 + seconds
        monitor.record(message, Timeout(message.telemetry_id, 3))
        rows = list(monitor.rows())
        assert [row[:4] for row in rows] == fresh and rows[0][
            4
        ] == f"no answer; last value, {age} old"
    assert monitor.failed and not list(monitor.frames())
    monitor.disconnected()
    assert [row[:4] for row in monitor.rows()] == fresh


def screen_of(columns: int, lines: int, place: str, keys: bytes) -> str:
    """Return the output of the monitor to a terminal of that size after keys were
    typed.
    """
    terminal, end = pty.openpty()
    fcntl.ioctl(end, termios.TIOCSWINSZ, struct.pack("HHHH", lines, columns, 0, 0))
    words = [
        "monitor",
        "cubeacp",
        "128",
        "146",
        "150",
        "Communication Status",
        "--port",
        place,
        "--every",
        "0.2",
    ]
    environment = {
        **os.environ,
        "TERM": "xterm",
        "COLUMNS": str(columns),
        "LINES": str(lines),
    }
    command = [sys.executable, "-m", "icdgen", *words]
    # A session of its own whose controlling terminal is this one.
    code = "import fcntl, os, sys, termios; os.setsid(); fcntl.ioctl(0, termios.TIOCSCTTY, 0); os.execv(sys.argv[1], sys.argv[1:])"
    program = subprocess.Popen(
        [sys.executable, "-c", code, *command],
        stdin=end,
        stdout=end,
        stderr=subprocess.PIPE,
        env=environment,
    )
    os.close(end)
    try:
        text = _read_until(
            terminal, "of 20" if lines < 20 else "Communication Status", 30
        )
        os.write(terminal, keys)
        return text + _read_until(terminal, "", 2)
    finally:
        program.kill()
        program.communicate()
        os.close(terminal)


def _read_until(terminal: int, words: str, seconds: float) -> str:
    text, end = "", time.monotonic() + seconds
    while time.monotonic() < end and not (words and words in text):
        if select.select([terminal], [], [], 0.1)[0]:
            text += os.read(terminal, 65536).decode(errors="replace")
    return text


class Table:
    """A screen without a terminal: what it shows of a monitor, and keys for it."""

    def __init__(self, lines: int) -> None:
        monitor = watched("128", "146", "150", "Communication Status")
        for message in monitor.messages:
            data = bytes(message.length)
            monitor.record(message, Done(message.telemetry_id, 1, data))
        self.screen = Screen(monitor, False)
        self.screen.keyboard.is_open = True
        self.lines = lines

    def typed(self, *keys: str) -> str:
        """Return the line with the visible part of the table after these keys."""
        for key in keys:
            self.screen.keyboard.on_key(key)
        return self.shown()[-1].partition(";")[0]

    def shown(self) -> list[str]:
        console = Console(width=120, height=self.lines, file=io.StringIO())
        console.print(self.screen)
        return console.file.getvalue().splitlines()


UP, DOWN, PAGE_UP, PAGE_DOWN = "\x1b[A", "\x1b[B", "\x1b[5~", "\x1b[6~"
HOME, END = "\x1b[H", "\x1b[F"


def test_keys_move_through_a_table_and_stop_at_its_ends():
    table = Table(12)
    rows = len(Table(200).shown()) - 1
    assert rows > 18, "the table is longer than two pages"
    assert table.typed() == f"lines 1 to 9 of {rows}"
    assert table.typed(UP) == f"lines 1 to 9 of {rows}"
    assert table.typed(DOWN) == f"lines 2 to 10 of {rows}"
    assert table.typed(DOWN, UP) == f"lines 2 to 10 of {rows}"
    assert table.typed(PAGE_DOWN) == f"lines 11 to 19 of {rows}"
    assert table.typed("x") == f"lines 11 to 19 of {rows}"
    assert table.typed(PAGE_UP, UP) == f"lines 1 to 9 of {rows}"
    assert table.typed(END) == f"lines {rows - 8} to {rows} of {rows}"
    assert table.typed(DOWN) == f"lines {rows - 8} to {rows} of {rows}"
    assert table.typed(HOME) == f"lines 1 to 9 of {rows}"


def test_a_table_is_whole_on_a_terminal_that_has_room_for_it():
    rows = len(Table(200).shown()) - 1
    # The titles, the lines of the table and that of the cursor.
    assert len(Table(rows + 2).shown()) == rows + 1
    assert Table(rows + 1).typed() == f"lines 1 to {rows - 2} of {rows}"


@pytest.mark.pty
def test_a_table_longer_than_the_terminal_scrolls_to_its_end():
    with simulator("--node", "cubeacp", "--tcp", "0") as (place, _):
        top = screen_of(80, 12, place, b"")
        assert "lines 1 to 9 of 20" in top and "CAN telecommand buffer error" not in top
        assert "lines 2 to 10 of 20" in screen_of(80, 12, place, b"\x1b[B")
        end = screen_of(80, 12, place, b"\x1b[F")
        assert "lines 12 to 20 of 20" in end and "CAN telecommand buffer error" in end
        full = screen_of(100, 40, place, b"")
        assert " of 20" not in full and "CAN telecommand buffer error" in full
