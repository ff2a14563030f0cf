"""The live table of `icdgen monitor` on a terminal. It scrolls if it does not fit.

`Screen` draws the rows of `icdgen.link.live.Monitor` with rich; a thread reads the
keys.
"""

from __future__ import annotations

import os
import re
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from icdgen.link.live import COLUMNS, Monitor
from icdgen.tables import printable_text

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions
    from rich.segment import Segment
    from rich.table import Table

PAGE_SECONDS = 5.0  # duration of a page without a keyboard
KEY_SECONDS = 0.2  # interval for checking whether the screen is closed
# Escape sequences of the keys, in the forms of xterm (`ESC [`, and `ESC O` for
# application cursor keys), and the letters of `less`.
_LINES = {"\x1b[A": -1, "k": -1, "\x1bOA": -1, "\x1b[B": 1, "\x1bOB": 1, "j": 1}
_PAGES = {"\x1b[5~": -1, "b": -1, "\x1b[6~": 1, " ": 1}
_ENDS = {
    "\x1b[H": 0,
    "\x1b[1~": 0,
    "\x1bOH": 0,
    "g": 0,
    "\x1b[F": 1 << 30,
    "\x1b[4~": 1 << 30,
    "\x1bOF": 1 << 30,
    "G": 1 << 30,
}


class Screen:
    """A table at a fixed position of the terminal.

    Without ``live``, it does nothing.
    """

    def __init__(self, monitor: Monitor, live: bool) -> None:
        self.monitor, self.live = monitor, None
        self.top = 0  # line of the table that is shown first
        self.page = 1  # lines of the table that are shown at once
        self.keyboard = _Keyboard(self._key)
        self.begin = time.monotonic()
        if live:
            from rich.live import Live

            self.live = Live(get_renderable=lambda: self, auto_refresh=False)

    def __enter__(self) -> Screen:
        if self.live:
            self.keyboard.open()
            self.live.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self.live:
            self.keyboard.close()
            self.live.stop()

    def show(self) -> None:
        """Draw the table."""
        if self.live:
            self.live.refresh()

    def _key(self, key: str) -> None:
        if key in _LINES:
            self.top += _LINES[key]
        elif key in _PAGES:
            self.top += _PAGES[key] * self.page
        elif key in _ENDS:
            self.top = _ENDS[key]
        else:
            return
        self.show()

    def __rich_console__(
        self, console: Console, options: ConsoleOptions
    ) -> Iterator[Segment]:
        from rich.segment import Segment

        lines = console.render_lines(
            self._table(), options.update(height=None), pad=False
        )
        head, body = lines[:1], lines[1:]
        if len(lines) < console.size.height:
            self.top, footer = 0, ""
        else:
            # The titles, the footer, and the line of the cursor.
            self.page = max(1, console.size.height - 3)
            if not self.keyboard.is_open:
                # Without keys, the pages follow each other.
                pages = -(-len(body) // self.page)
                turns = int((time.monotonic() - self.begin) / PAGE_SECONDS)
                self.top = turns % pages * self.page
            self.top = max(0, min(self.top, len(body) - self.page))
            last = min(self.top + self.page, len(body))
            keys = "; up, down, PgUp, PgDn, Home, End" if self.keyboard.is_open else ""
            footer = f"lines {self.top + 1} to {last} of {len(body)}{keys}"
            body = body[self.top : last]
        for line in [*head, *body]:
            yield from line
            yield Segment.line()
        if footer:
            yield Segment(footer[: console.size.width])

    def _table(self) -> Table:
        from rich.table import Table
        from rich.text import Text

        table = Table(box=None, padding=(0, 2, 0, 0), pad_edge=False)
        for title in COLUMNS:
            table.add_column(title, justify="right" if title == "value" else "left")
        name = ""
        for row in list(self.monitor.rows()):
            name = row[0] or name
            style = "red" if name in self.monitor.silent else ""
            table.add_row(*(Text(printable_text(cell), style=style) for cell in row))
        return table


class _Keyboard:
    """Keyboard of the terminal. A thread passes the keys to ``on_key``.

    It is not open if standard input is not a terminal.
    """

    def __init__(self, on_key: Any) -> None:
        self.on_key, self.is_open = on_key, False
        self.closing = threading.Event()
        self.thread: threading.Thread | None = None
        self.before: Any = None

    def open(self) -> None:
        """Read single keys from now on, if this is the program in the foreground."""
        with suppress(ImportError, OSError, ValueError, AttributeError):
            import termios
            import tty

            self.file = sys.stdin.fileno()
            # A program in the background would be stopped for changing the terminal.
            if not os.isatty(self.file) or os.tcgetpgrp(self.file) != os.getpgrp():
                return
            self.before = termios.tcgetattr(self.file)
            tty.setcbreak(self.file)
            self.is_open = True
            self.thread = threading.Thread(target=self._run, daemon=True)
            self.thread.start()

    def close(self) -> None:
        """Restore the settings of the terminal."""
        if self.is_open:
            import termios

            self.closing.set()
            if self.thread is not None:
                self.thread.join()
            termios.tcsetattr(self.file, termios.TCSADRAIN, self.before)
            self.is_open = False

    def _run(self) -> None:
        import select

        while not self.closing.is_set():
            try:
                if not select.select([self.file], [], [], KEY_SECONDS)[0]:
                    continue
                text = os.read(self.file, 64).decode("ascii", "replace")
            except OSError:
                return
            if not text:
                return
            for key in _keys(text):
                self.on_key(key)


def _keys(text: str) -> Iterator[str]:
    """Split the input of a terminal into characters and escape sequences such as ``ESC
    [ 5 ~``.
    """
    yield from re.findall(r"\x1b\[[0-9;]*[A-Za-z~]|\x1bO[A-Z]|.", text, re.DOTALL)
