"""Command ``icdgen send``: send a telecommand over a port and show its outcome.

`send` encodes the fields in the arguments with the reference codec, opens a session
(`icdgen.link.options`) and waits for the outcome: acknowledge, refusal, busy or
time-out. It prints text or one JSON object, and the exit status shows the outcome. A
telecommand with a `hazard` needs a confirmation before the port is opened.
"""

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
    from icdgen_runtime.wire.events import Outcome

    from icdgen.icd.model import Icd, Node
    from icdgen.protocol.facts import Facts
    from icdgen.values.frame import DecodedFrame

# Exit status of each outcome. 2 is wrong usage, as of all commands. The classes are
# named, because importing the runtime takes time that `--help` does not need.
_STATUSES = {"Done": 0, "Sent": 0, "Refused": 1, "Timeout": 3, "Busy": 4}


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
    """Send one telecommand and wait for its outcome.

    NODE can be omitted if there is only one. For a telecommand with a `hazard`, icdgen
    asks for confirmation; without a terminal, --yes is required. Exit status: 0
    acknowledged, or sent if nothing responds to it; 1 refused by the device, or not
    sent; 2 wrong usage; 3 no response; 4 the device is busy.
    """
    from icdgen_runtime.wire.awaited import Request

    from icdgen import tables
    from icdgen.link.line_statistics import LineStatistics
    from icdgen.link.outcomes import has_further_fields, outcome_report
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
    response = _response(icd, node, outcome)
    status = _STATUSES[type(outcome).__name__]
    if form == "json":
        report = outcome_report(frame.message.name, outcome, response)
        click.echo(json.dumps(report))
    else:
        text = _outcome_text(icd, node, protocol_facts, frame, outcome, response)
        say(f"{_sent(frame)}: {text}", err=status != 0)
        if response and has_further_fields(icd, node, frame.message, response.message):
            say(
                to_text(response, tables.width_of(sys.stdout)).rstrip(),
                err=status != 0,
            )
    if what := statistics.text():
        say(f"icdgen: {what}", err=True)
    sys.exit(status)


def _is_confirmed(frame: DecodedFrame) -> bool:
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


def _sent(frame: DecodedFrame) -> str:
    """Return the message with its constants, such as magic numbers, which the user did
    not enter.
    """
    from icdgen.describe.numbers import value_text

    constants = [
        f"{row.field.name} {value_text(row.raw)}"
        for row in frame.rows
        if row.field.const is not None and isinstance(row.raw, int)
    ]
    if not constants:
        return frame.message.name
    return f"{frame.message.name} with {', '.join(constants)}"


def _response(icd: Icd, node: Node, outcome: Outcome) -> DecodedFrame | None:
    """Return the telemetry that completed or refused a telecommand on a framed link;
    None without one.
    """
    from icdgen_runtime.wire.events import Done, Refused

    from icdgen.values.frame import decoded_frame

    if not isinstance(outcome, Done | Refused) or outcome.type is None:
        return None
    name = outcome.type.NAME
    message = next(each for each in icd.messages_of(node) if each.name == name)
    return decoded_frame(icd, node, message, outcome.data)


def _outcome_text(
    icd: Icd,
    node: Node,
    protocol_facts: Facts,
    frame: DecodedFrame,
    outcome: Outcome,
    response: DecodedFrame | None,
) -> str:
    """Return the outcome of a telecommand in words."""
    from icdgen_runtime.wire.events import Busy, Done, Refused, Timeout

    from icdgen.link.outcomes import attempts_text, failure_text

    if isinstance(outcome, Refused):
        return failure_text(outcome)
    if isinstance(outcome, Busy):
        attempts = attempts_text(outcome)
        return f"{failure_text(outcome)}{attempts}"
    if isinstance(outcome, Timeout):
        attempts = attempts_text(outcome)
        return f"no answer{attempts}; whether it was executed is not known"
    message = frame.message
    if protocol_facts.stream:
        if not isinstance(outcome, Done):
            return "sent; the ICD describes no response to it"
        if outcome.reply is None:
            return "acknowledged"
        name = response.message.name if response else "an unknown message"
        is_confirmed = outcome.reply in protocol_facts.stream.confirming
        return f"{'acknowledged' if is_confirmed else 'answered'} with {name}"
    if message.acknowledge:
        return "acknowledged"
    if not message.expects_reset:
        return "sent; it is never acknowledged"
    # With another magic number than the ICD states, the device can ignore the command.
    if wrong := frame.wrong_constants:
        return f"sent; the device need not restart, for {wrong[0].field.name} {wrong[0].remarks[0]}"
    return "sent; the device restarts instead of acknowledging"
