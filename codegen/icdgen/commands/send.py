"""``icdgen send``"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from icdgen.commands.common import icd_option, load_or_exit, say
from icdgen.link.options import session_options

if TYPE_CHECKING:
    from icdgen_runtime.wire.events import Refused, Timeout

    from icdgen.icd.model import Icd, Message, Node


@click.command()
@click.argument("node")
@click.argument("message")
@click.argument("assignments", nargs=-1, metavar="[FIELD=VALUE]...")
@session_options
@icd_option
@click.option("--raw", is_flag=True, help="Values are raw values, and are not held against limits.")
@click.option("--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True)
def send(
    node: str, message: str, assignments: tuple[str, ...], icds: tuple[Path, ...], raw: bool, form: str, **options: Any
) -> None:
    """Send one telecommand to NODE and wait for its acknowledge: icdgen send wheels "Set Speed" x=100 --port tcp://host:4000

    Exit status: 0 acknowledged (or sent, if it is never acknowledged), 1 refused or no answer, 2 misuse.
    """
    from icdgen_runtime.wire.client import Request
    from icdgen_runtime.wire.events import Done

    from icdgen import values
    from icdgen.link.options import open_session
    from icdgen.protocol import facts

    icd = load_or_exit(icds).icd
    found = values.find_node(icd, node)
    frame = values.encode(icd, node, message, list(assignments), raw=raw, kind="telecommand")
    assert frame.message.telecommand_id is not None
    with open_session(icd, facts.of(icd, found), **options) as session:
        outcome = session.start(Request("telecommand", frame.message.telecommand_id, frame.data))
    ok = isinstance(outcome, Done)
    if form == "json":
        known = {key: getattr(outcome, key, None) for key in ("code", "reason", "attempts")}
        answer = {key: value for key, value in known.items() if value is not None}
        click.echo(json.dumps({"message": frame.message.name, "event": type(outcome).__name__.lower(), **answer}))
    elif isinstance(outcome, Done):
        say(f"{frame.message.name}: {_done(frame.message)}")
    else:
        say(f"{frame.message.name}: {_failed(icd, found, outcome)}", err=True)
    sys.exit(0 if ok else 1)


def _done(message: Message) -> str:
    if message.expects_reset:
        return "sent; the device restarts instead of acknowledging"
    return "acknowledged" if message.acknowledge else "sent; it is never acknowledged"


def _failed(icd: Icd, node: Node, outcome: Refused | Timeout) -> str:
    from icdgen_runtime.wire.events import Timeout

    if isinstance(outcome, Timeout):
        tries = outcome.attempts
        return f"no answer{f' to {tries} attempts' if tries > 1 else ''}; whether it was executed is not known"
    if outcome.code is None:
        return "refused"
    name = icd.protocol_of(node).get("errors", {}).get("enum")
    enums = {e.name: e for n in (*icd.included(node), node) for e in n.enums}
    members = {m.value: m.name for m in enums[name].members} if name in enums else {}
    return f"refused: {members.get(outcome.code, 'unknown error')} (code {outcome.code})"
