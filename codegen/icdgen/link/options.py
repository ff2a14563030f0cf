"""Options that `icdgen monitor` and `icdgen send` share, and the session that they mean."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import click

from icdgen.errors import UserError
from icdgen.icd.model import Icd, Node


def session_options(command: Callable) -> Callable:
    """--port, --crc, --address, --timeout, --retries."""
    options = [
        click.option(
            "--port",
            "-p",
            required=True,
            metavar="PORT",
            help="tcp://HOST:PORT, udp://HOST:PORT, a terminal or serial port (/dev/ttyUSB0, COM3), can://INTERFACE/CHANNEL.",
        ),
        click.option("--crc", is_flag=True, help="Send checksums, where the ICD has them."),
        click.option("--address", type=click.IntRange(0), default=0, help="Our address, on CAN."),
        click.option("--timeout", type=click.IntRange(1), metavar="MS", help="How long a reply is waited for."),
        click.option("--retries", type=click.IntRange(0, 255), help="How often a request is sent again."),
    ]
    for option in reversed(options):
        command = option(command)
    return command


def open_session(
    icd: Icd, node: Node, port: str, crc: bool, address: int, timeout: int | None, retries: int | None, on_event=None
):
    """The session. Raises `icdgen.errors.UserError`."""
    from icdgen.link.ports import Can, open_port
    from icdgen.link.session import Session
    from icdgen.protocol import facts

    known = facts.of(icd, node)
    is_can = port.startswith("can://")
    if (known.can if is_can else known.framing) is None:
        what = "CAN" if is_can else "a stream of bytes"
        raise UserError(f"the ICD does not say how to talk to {node.name} over {what}", "see docs/icd-format.md")
    if known.can and not 0 <= address < 1 << known.can.parts["source"].bits:
        raise UserError(f"--address {address} does not fit", f"{known.can.parts['source'].bits} bits hold it")
    settings = replace(
        known.client,
        reply_timeout=known.client.reply_timeout if timeout is None else timeout,
        retries=known.client.retries if retries is None else retries,
    )
    opened = open_port(port, icd.protocol_of(node))
    assert isinstance(opened, Can) == is_can
    return Session(icd, node, opened, crc, address, settings, on_event)


def stranger(session) -> str | None:
    """What is to be said if the node is another one than the ICD describes, or does not answer."""
    if session.known.identification is None:
        return None
    found = session.identify()
    if found is None:
        return "the device does not answer"
    values, same = found
    if same:
        return None
    told = ", ".join(f"{role.replace('_', ' ')} {value}" for role, value in values.items())
    node = session.node
    return f"the device says {told}; the ICD is that of node type {node.node_type}, interface version {node.interface_version}"
