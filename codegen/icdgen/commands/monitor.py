"""``icdgen monitor``"""

from __future__ import annotations

import json
import sys
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from icdgen.commands.common import icd_option, load_or_exit, say
from icdgen.link.options import session_options

if TYPE_CHECKING:
    from icdgen.link.live import Monitor


@click.command()
@click.argument("node")
@click.argument("messages", nargs=-1, metavar="[MESSAGE]...")
@session_options
@icd_option
@click.option("--every", type=click.FloatRange(0), default=1.0, show_default=True, help="Seconds between two rounds.")
@click.option("--count", type=click.IntRange(1), metavar="N", help="End after N rounds.")
@click.option("--once", is_flag=True, help="Short for --count 1.")
@click.option("--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True)
def monitor(
    node: str,
    messages: tuple[str, ...],
    icds: tuple[Path, ...],
    every: float,
    count: int | None,
    once: bool,
    form: str,
    **options: Any,
) -> None:
    """Show live telemetry of NODE as a table: MESSAGEs by id or name, default the identification.

    Frames that the device sends of its own accord (logs) are shown as well. On a terminal the table stays in its place; in a
    pipe each round is printed; --format json prints an object for each frame. Exit status: 1 if a frame was not answered in
    the last round.
    """
    from icdgen_runtime.wire.client import Request

    from icdgen.link.live import Monitor, Screen
    from icdgen.link.options import open_session, stranger

    icd = load_or_exit(icds).icd
    watched = Monitor(icd, node, messages)
    rounds = 1 if once else count
    with open_session(icd, watched.known, **options, on_event=watched.event) as session:
        strange = stranger(session)
        if strange:
            say(f"icdgen: {strange}", err=True)
        live = form == "text" and sys.stdout is not None and sys.stdout.isatty() and rounds != 1
        with Screen(watched, live) as screen:
            number = 0
            while True:
                number += 1
                begin = time.monotonic()
                for message in watched.messages:
                    assert message.telemetry_id is not None
                    watched.took(message, session.start(Request("telemetry", message.telemetry_id)))
                    screen.show()
                if form == "json":
                    _print_json(watched)
                elif not live:
                    _print(watched, number)
                if number == rounds:
                    break
                while time.monotonic() < begin + every:
                    if session.wait((begin + every) * 1000):
                        screen.show()
    sys.exit(1 if watched.silent else 0)


def _print(watched: Monitor, number: int) -> None:
    if number > 1:
        say("")
    say(watched.text())
    sys.stdout.flush()


def _print_json(watched: Monitor) -> None:
    now = datetime.now(UTC).isoformat(timespec="milliseconds")[:-6] + "Z"
    for frame in watched.frames():
        click.echo(json.dumps({"time": now, **frame.to_json()}))
    sys.stdout.flush()
