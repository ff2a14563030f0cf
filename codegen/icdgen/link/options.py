"""Options of `icdgen monitor` and `icdgen send`, and the session that they define.

Modules of the runtime are imported in functions, so that the help of the commands needs
no runtime.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

from icdgen.errors import UserError
from icdgen.icd.model import Icd
from icdgen.values.chosen import chosen_values

if TYPE_CHECKING:
    from icdgen_runtime.wire.session import BusSession

    from icdgen.link.session import OnEvent
    from icdgen.protocol.facts import Facts


def session_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options --port, --crc, --address, --header, --timeout and --retries."""
    options = [
        click.option(
            "--port",
            "-p",
            required=True,
            metavar="PORT",
            help="tcp://HOST:PORT, udp://HOST:PORT, a terminal or serial port (/dev/ttyUSB0, COM3), can://INTERFACE/CHANNEL.",
        ),
        click.option(
            "--crc", is_flag=True, help="Use checksums that are optional in the ICD."
        ),
        click.option(
            "--address",
            type=click.IntRange(0),
            default=0,
            help="Address of the client on CAN.",
        ),
        click.option(
            "--header",
            "chosen",
            multiple=True,
            metavar="ROLE=NUMBER",
            help="Value of a header field, such as source=3. Repeatable.",
        ),
        click.option(
            "--timeout",
            type=click.IntRange(1),
            metavar="MS",
            help="Time-out of every response in milliseconds (default: the ICD's).",
        ),
        click.option(
            "--retries",
            type=click.IntRange(0, 255),
            help="Number of repetitions of a request.",
        ),
    ]
    # Decorators apply from the inside out: the last one is the first in the help.
    for option in reversed(options):
        command = option(command)
    return command


@contextmanager
def open_session(
    icd: Icd,
    facts: Facts,
    port: str,
    crc: bool,
    address: int,
    timeout: int | None,
    retries: int | None,
    chosen: Sequence[str] = (),
    on_event: OnEvent | None = None,
) -> Iterator[BusSession]:
    """Open a session with the node that ``facts`` describe.

    Raise `icdgen.errors.UserError`.
    """
    from icdgen.link.ports import open_port
    from icdgen.link.session import session
    from icdgen.runtime_objects.links import link_of

    node, is_can = facts.node, port.startswith("can://")
    if (facts.can if is_can else facts.framing or facts.stream) is None:
        what = "CAN" if is_can else "a stream of bytes"
        raise UserError(
            f"the ICD does not say how to talk to {node.name} over {what}",
            "see docs/reference/protocol.md",
        )
    if facts.can and not 0 <= address < 1 << facts.can.parts["source"].bits:
        raise UserError(
            f"--address {address} does not fit",
            f"{facts.can.parts['source'].bits} bits hold it",
        )
    link = link_of(icd, facts)
    if timeout is not None and link.stream:
        # The option also replaces the time-outs that telecommands have of their own.
        exchanges = tuple(row._replace(timeout=0) for row in link.stream.exchanges)
        link = link._replace(stream=link.stream._replace(exchanges=exchanges))
    options = {"reply_timeout": timeout, "retries": retries}
    settings = link.settings._replace(
        **{key: value for key, value in options.items() if value is not None}
    )
    values = chosen_values(facts, chosen)
    with session(
        link,
        open_port(port, icd.protocol_of(node)),
        crc,
        address,
        settings,
        on_event,
        values,
    ) as opened_session:
        yield opened_session


def identity_problem(session: BusSession, faults: Mapping[int, str]) -> str | None:
    """Return a message if the node does not respond, or does not match the ICD.

    ``faults`` are the errors of received messages by id.
    """
    from icdgen_runtime.wire.awaited import Request
    from icdgen_runtime.wire.events import Done
    from icdgen_runtime.wire.identity import identify

    link = session.client.link
    if link.identification is None or link.identification.telemetry is None:
        return None
    outcome = session.start(Request("telemetry", link.identification.telemetry))
    if not isinstance(outcome, Done):
        fault = faults.get(link.identification.telemetry)
        if fault:
            return f"the device answers, but: {fault}"
        return "the device does not answer"
    identity = identify(link, outcome.data)
    if identity.matches:
        return None
    return (
        f"the device says node type {identity.node_type}, interface version {identity.interface_version}; "
        f"the ICD is that of node type {link.node_type}, interface version {link.interface_version}"
    )
