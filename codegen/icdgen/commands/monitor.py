"""Command ``icdgen monitor``: live telemetry (`icdgen.link.live`) in rounds.

`monitor` opens a session on a port and requests each message once per round. On a
framed link it collects received messages until the round ends, and requests only
messages for which the ICD has a request. The output is a table that stays in place on a
terminal, a table per round in a pipe, or JSON lines. A lost connection is opened again.
"""

from __future__ import annotations

import json
import sys
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from icdgen.commands.common import SECONDS, format_option, icd_option, load_or_exit, say
from icdgen.link.options import identity_problem, open_session, session_options

if TYPE_CHECKING:
    from icdgen_runtime.wire.session import BusSession

    from icdgen.link.live import Monitor
    from icdgen.link.screen import Screen

# With `--every 0`, a lost connection would otherwise be reopened without any pause.
_SHORTEST_PAUSE = 0.1  # seconds between two attempts to reopen a lost connection


@click.command(epilog="Example: icdgen monitor wheels 146 --port tcp://127.0.0.1:4000")
@click.argument("words", nargs=-1, metavar="[NODE] [MESSAGE]...")
@session_options
@icd_option
@click.option(
    "--every",
    type=SECONDS,
    default=1.0,
    show_default=True,
    help="Seconds between two rounds.",
)
@click.option(
    "--count", type=click.IntRange(1), metavar="N", help="End after N rounds."
)
@click.option("--once", is_flag=True, help="Short for --count 1.")
@format_option("text", "json")
def monitor(
    words: tuple[str, ...],
    icds: tuple[Path, ...],
    every: float,
    count: int | None,
    once: bool,
    form: str,
    **options: Any,
) -> None:
    """Show live telemetry of NODE as a table: MESSAGEs by id or name, default the
    identification.

    NODE can be omitted if there is only one. Frames that the device sends without a
    request (logs) are shown as well. On a framed link, all received messages or the
    given MESSAGEs are shown, and only responses to telecommands are requested. A
    message without a response keeps its last values and shows their age. On a terminal
    the table stays in place and scrolls if it is longer (arrows, PgUp, PgDn, Home,
    End). In a pipe each round is printed; --format json prints an object per frame,
    and one with the key `event` per refusal, busy device, and late or stray response. A
    lost connection is opened again when possible. Exit status: 1 if a frame had no
    response in the last round.
    """
    from icdgen.link.live import Monitor
    from icdgen.link.ports import PortError
    from icdgen.link.screen import Screen
    from icdgen.values.find import find_named

    icd = load_or_exit(icds).icd
    node, messages = find_named(icd, words)
    watched = Monitor(icd, node.name, messages)
    if watched.hint:
        say(f"icdgen: {watched.hint}", err=True)
    rounds = _Rounds(watched, 1 if once else count, every, form)
    # A table that stays in place needs a terminal, and more than one round.
    live = (
        form == "text"
        and sys.stdout is not None
        and sys.stdout.isatty()
        and rounds.last != 1
    )
    reached = lost = False
    with Screen(watched, live) as screen:
        while not rounds.over:
            try:
                with open_session(
                    icd, watched.facts, **options, on_event=watched.event
                ) as session:
                    reached = True
                    if problem := identity_problem(session, watched.faults):
                        say(f"icdgen: {problem}", err=True)
                    elif lost:
                        say("icdgen: the line is back", err=True)
                    lost = False
                    while not rounds.over:
                        rounds.run(session, screen)
            except PortError as error:
                # A connection that never worked is an error; a lost one is reopened.
                if not reached or rounds.last == 1:
                    raise
                if not lost:
                    say(f"icdgen: {error}; trying again", err=True)
                lost = True
                rounds.disconnected(screen)
    sys.exit(1 if watched.failed else 0)


class _Rounds:
    """Rounds of a monitor. Each round is printed at its end."""

    def __init__(
        self, watched: Monitor, last: int | None, every: float, form: str
    ) -> None:
        self.watched, self.last, self.every, self.form = watched, last, every, form
        self.number = 0

    @property
    def over(self) -> bool:
        return self.number == self.last

    def run(self, session: BusSession, screen: Screen) -> None:
        """Request all messages, then wait for the next round.

        Raises `icdgen.link.ports.PortError`.
        """
        from icdgen_runtime.wire.awaited import Request

        # The wall clock can jump; rounds must not.
        end = time.monotonic() + self.every
        self.watched.begin()
        for message in self.watched.requested():
            assert message.telemetry_id is not None
            self.watched.record(
                message, session.start(Request("telemetry", message.telemetry_id))
            )
            screen.show()
        # A monitor that requests has all responses now. One that listens collects
        # messages until the end of the round.
        if not self.watched.listens:
            self._print(screen)
        # After the last round there is nothing to wait for.
        while (self.watched.listens or not self.over) and time.monotonic() < end:
            if session.wait(end * 1000):
                screen.show()
        if self.watched.listens:
            self.watched.end()
            screen.show()
            self._print(screen)

    def disconnected(self, screen: Screen) -> None:
        """Process a round without connection, and wait for the next one."""
        self.watched.disconnected()
        screen.show()
        self._print(screen)
        if not self.over:
            time.sleep(max(self.every, _SHORTEST_PAUSE))

    def _print(self, screen: Screen) -> None:
        self.number += 1
        reports = self.watched.take_reports()
        if self.form == "json":
            frames = [frame.to_json() for frame in self.watched.frames()]
            _print_json([*frames, *reports])
        elif not screen.live:
            say("\n" * (self.number > 1) + self.watched.text())
            sys.stdout.flush()


def _print_json(objects: list[dict[str, Any]]) -> None:
    # RFC 3339 with Z instead of +00:00.
    now = datetime.now(UTC).isoformat(timespec="milliseconds")[:-6] + "Z"
    for each in objects:
        click.echo(json.dumps({"time": now, **each}))
    sys.stdout.flush()
