"""Command ``icdgen send``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from icdgen.commands.common import format_option, icd_option, load_or_exit, say
from icdgen.errors import UserError
from icdgen.link.options import open_session, session_options
from icdgen.protocol import facts

if TYPE_CHECKING:
    from icdgen_runtime.wire.events import Refused, Timeout

    from icdgen.icd.model import Icd, Node
    from icdgen.link.line_statistics import LineStatistics
    from icdgen.protocol.facts import Facts
    from icdgen.values.frame import Frame


@click.command(
    epilog='Example: icdgen send wheels "Set Speed" x=100 --port tcp://host:4000'
)
@click.argument(
    "words", nargs=-1, required=True, metavar="[NODE] MESSAGE [FIELD=VALUE]..."
)
@session_options
@icd_option
@click.option(
    "--raw", is_flag=True, help="Values are raw values; limits are not checked."
)
@click.option(
    "--yes", "-y", is_flag=True, help="Send also what is dangerous, without asking."
)
@format_option("text", "json")
def send(
    words: tuple[str, ...],
    icds: tuple[Path, ...],
    raw: bool,
    yes: bool,
    form: str,
    **options: Any,
) -> None:
    """Send one telecommand and wait for its acknowledge or response.

    NODE can be omitted if there is only one. For a telecommand with a `hazard`, icdgen
    asks for confirmation; without a terminal, --yes is required. Exit status: 0
    acknowledged (or sent, if it has no acknowledge), 1 rejected, no response or not
    sent, 2 wrong usage.
    """
    from icdgen_runtime.wire.client import Request
    from icdgen_runtime.wire.events import Done

    from icdgen import tables
    from icdgen.link.line_statistics import LineStatistics
    from icdgen.values.encode import encode
    from icdgen.values.find import find_frame
    from icdgen.values.text import to_text

    icd = load_or_exit(icds).icd
    node, message, assignments = find_frame(icd, words)
    frame = encode(icd, node.name, message, assignments, raw=raw, kind="telecommand")
    assert frame.message.telecommand_id is not None
    # The check comes before the port is opened.
    if frame.message.hazard and not yes and not _is_confirmed(frame):
        say(f"{frame.message.name}: not sent", err=True)
        sys.exit(1)
    statistics, protocol_facts = LineStatistics(icd, node), facts.of(icd, node)
    with open_session(
        icd, protocol_facts, **options, on_event=statistics.event
    ) as session:
        outcome = session.start(
            Request("telecommand", frame.message.telecommand_id, frame.data)
        )
    ok = isinstance(outcome, Done)
    reply = (
        _reply(icd, node, protocol_facts, frame, statistics, outcome.data)
        if isinstance(outcome, Done)
        else None
    )
    if form == "json":
        response = {
            key: getattr(outcome, key, None) for key in ("code", "reason", "attempts")
        }
        response["reply"] = reply.to_json() if reply else None
        # JSON omits attributes that this kind of outcome does not have.
        known_values = {
            key: value for key, value in response.items() if value is not None
        }
        click.echo(
            json.dumps(
                {
                    "message": frame.message.name,
                    "event": type(outcome).__name__.lower(),
                    **known_values,
                }
            )
        )
    elif isinstance(outcome, Done):
        say(f"{_sent(frame)}: {_done(frame, protocol_facts, reply)}")
        if reply:
            say(to_text(reply, tables.width_of(sys.stdout)).rstrip())
    else:
        say(f"{_sent(frame)}: {_failed(icd, node, outcome)}", err=True)
    if what := statistics.text():
        say(f"icdgen: {what}", err=True)
    sys.exit(0 if ok else 1)


def _is_confirmed(frame: Frame) -> bool:
    """Show a dangerous telecommand and ask for confirmation.

    Raises `UserError` without a terminal.
    """
    from icdgen import tables
    from icdgen.values.text import to_text

    hazard = f"{frame.message.name} is dangerous: {frame.message.hazard}"
    if sys.stdin is None or not sys.stdin.isatty():
        raise UserError(hazard, "--yes sends it without asking")
    say(f"{to_text(frame, tables.width_of(sys.stderr))}\n{hazard}", err=True)
    return click.confirm("Send it?", err=True)


def _sent(frame: Frame) -> str:
    """Return the message with its constants, such as magic numbers, which the user did
    not enter.
    """
    from icdgen.describe.numbers import value_text

    constants = [
        (row.field, row.raw) for row in frame.rows if row.field.const is not None
    ]
    constant_texts = ", ".join(
        f"{field.name} {value_text(raw)}"
        for field, raw in constants
        if isinstance(raw, int)
    )
    return (
        f"{frame.message.name} with {constant_texts}"
        if constant_texts
        else frame.message.name
    )


def _reply(
    icd: Icd,
    node: Node,
    protocol_facts: Facts,
    sent: Frame,
    statistics: LineStatistics,
    data: bytes,
) -> Frame | None:
    """Return the telemetry that responds to the telecommand; None without a response."""
    from icdgen.values.frame import frame

    rows = protocol_facts.stream.telecommands if protocol_facts.stream else ()
    id = next(
        (row.reply for row in rows if row.id == sent.message.telecommand_id), None
    )
    message = statistics.message_of(id, data) if id is not None else None
    return frame(icd, node, message, data) if message else None


def _done(frame: Frame, protocol_facts: Facts, reply: Frame | None) -> str:
    message = frame.message
    if protocol_facts.stream:
        return (
            f"answered with {reply.message.name}"
            if reply
            else "sent; the ICD names no reply to it"
        )
    if message.acknowledge:
        return "acknowledged"
    if not message.expects_reset:
        return "sent; it is never acknowledged"
    if wrong := frame.wrong_constants:
        return f"sent; the device need not restart, for {wrong[0].field.name} {wrong[0].remarks[0]}"
    return "sent; the device restarts instead of acknowledging"


def _failed(icd: Icd, node: Node, outcome: Refused | Timeout) -> str:
    from icdgen_runtime.wire.events import Timeout

    if isinstance(outcome, Timeout):
        tries = outcome.attempts
        return f"no answer{f' to {tries} attempts' if tries > 1 else ''}; whether it was executed is not known"
    if outcome.code is None:
        return "refused"
    name = icd.protocol_of(node).get("errors", {}).get("enum")
    enums = {e.name: e for n in (*icd.included(node), node) for e in n.enums}
    member = enums[name].member_of(outcome.code) if name in enums else None
    return (
        f"refused: {member.name if member else 'unknown error'} (code {outcome.code})"
    )
