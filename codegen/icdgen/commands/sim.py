"""Command ``icdgen sim``: a simulated device (`icdgen.sim`) on ports.

`sim` converts its options to `icdgen.sim.run.Options` and a list of transports, then
`icdgen.sim.run.run` serves the device until it is interrupted. The default transport is
a pseudo-terminal, or a free TCP port on Windows. The address of each port is printed
and flushed, as a parent process may wait for it.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from icdgen.commands.common import PATH, SECONDS, icd_option, load_or_exit, say
from icdgen.errors import UserError

_PORT = click.IntRange(0, 65535)


class _Sim(click.Command):
    """Command line of ``icdgen sim``, in which ``--set MESSAGE A=1 B=2`` stands for
    ``--set MESSAGE A=1 --set MESSAGE B=2``.

    Options of click have a fixed number of values.
    """

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        expanded: list[str] = []
        message = ""
        # A word after `--set MESSAGE VALUE` belongs to the same message until the next
        # option.
        for index, word in enumerate(args):
            if index > 1 and args[index - 2] == "--set":
                message = args[index - 1]
            elif word.startswith("-"):
                message = ""
            elif message:
                expanded += ["--set", message]
            expanded.append(word)
        return super().parse_args(ctx, expanded)


@click.command(cls=_Sim, epilog="Example: icdgen sim --node wheels --tcp 4000")
@click.option(
    "--node",
    "name",
    help="Node to simulate; a boot program starts the next program after the boot time.",
)
@click.option(
    "--pty", is_flag=True, help="Serve on a pseudo-terminal, whose path is printed."
)
@click.option(
    "--tcp",
    type=_PORT,
    metavar="PORT",
    help="Serve on a TCP port; 0 takes a free one, which is printed.",
)
@click.option(
    "--udp",
    type=_PORT,
    metavar="PORT",
    help="Serve on a UDP port: each datagram is a part of the stream.",
)
@click.option(
    "--connect",
    metavar="PORT",
    help="Connect to tcp://HOST:PORT or udp://HOST:PORT as a client.",
)
@click.option(
    "--host", default="127.0.0.1", show_default=True, help="Address to listen on."
)
@click.option(
    "--set",
    "values",
    nargs=2,
    multiple=True,
    metavar="MESSAGE FIELD=VALUE...",
    help="Values of a frame, as encode takes them. Repeatable.",
)
@click.option(
    "--script",
    type=PATH,
    metavar="FILE",
    help="Values, waves, faults and logs over time, as YAML.",
)
@click.option(
    "--file",
    "files",
    multiple=True,
    metavar="TYPE:COUNTER=PATH",
    help="A file of the device. Repeatable.",
)
@click.option(
    "--uploads",
    type=PATH,
    metavar="FOLDER",
    help="Folder for uploaded programs, DESTINATION.bin.",
)
@click.option(
    "--fault",
    "faults",
    multiple=True,
    metavar="KIND=SHARE...",
    help="A fault, KIND=SHARE[:DETAIL][@WHAT]: drop=10%@acknowledge, nak=1:REASON, busy=50%, late=1:300. Repeatable.",
)
@click.option(
    "--loss",
    metavar="SHARE",
    help="Short for --fault drop=SHARE@packet,upload: packets of files are lost.",
)
@click.option(
    "--late",
    type=click.IntRange(1),
    default=1500,
    show_default=True,
    help="Largest delay of the fault late without DETAIL, in ms.",
)
@click.option(
    "--seed",
    type=int,
    default=0,
    show_default=True,
    help="Seed of the random faults; the same seed gives the same faults.",
)
@click.option(
    "--boot", type=click.IntRange(0), help="Boot time in ms (default: the ICD's)."
)
@click.option(
    "--busy",
    type=click.IntRange(0),
    default=20,
    show_default=True,
    help="Duration of loading, erasing and similar operations, in ms.",
)
@click.option(
    "--processing",
    type=click.IntRange(0),
    default=0,
    show_default=True,
    help="Processing time of a telecommand, in ms.",
)
@click.option(
    "--strict",
    is_flag=True,
    help="Also reject unknown enumeration values and values out of range.",
)
@click.option(
    "--every",
    type=SECONDS,
    help="Period of telemetry on framed links, in s; 0: none (default: the ICD's, otherwise 1).",
)
@click.option(
    "--header",
    "chosen",
    multiple=True,
    metavar="ROLE=NUMBER",
    help="Value of a header field, e.g. source=3.",
)
@click.option(
    "--orders",
    is_flag=True,
    help="Read orders from standard input: set, fault, log, restart.",
)
@icd_option
def sim(
    name: str,
    pty: bool,
    tcp: int | None,
    udp: int | None,
    host: str,
    icds: tuple[Path, ...],
    **options: Any,
) -> None:
    """Simulate a device on a pseudo-terminal (the default), a TCP or a UDP port.

    Prints the address of each port, and runs until it is interrupted or, with --orders,
    until its input ends.
    """
    from icdgen.sim import run

    ways: list[tuple[Any, ...]] = [("pty",)] if pty else []
    ways += [
        (way, host, port)
        for way, port in (("tcp", tcp), ("udp", udp))
        if port is not None
    ]
    if (to := options.pop("connect")) is not None:
        ways.append(("connect", *_place(to)))
    # Windows has no pseudo-terminals.
    if not ways:
        ways = [("tcp", host, 0)] if sys.platform == "win32" else [("pty",)]
    if pty and sys.platform == "win32":
        raise UserError("there are no pseudo-terminals here", "use --tcp PORT")
    loss = options.pop("loss")
    if loss is not None:
        options["faults"] = (*options["faults"], f"drop={loss}@packet,upload")
    # The other options have the names of the attributes of `Options`.
    icd, settings = load_or_exit(icds).icd, run.Options(**options)
    run.run(icd, name, ways, settings, _print, _warn)


def _place(text: str) -> tuple[str, str, int]:
    """Return kind, host and port.

    Raises `UserError`.
    """
    from icdgen.link.ports import address

    kind = text.partition("://")[0]
    if kind not in ("tcp", "udp"):
        raise UserError(
            f"`{text}` is nothing to connect to",
            "--connect tcp://HOST:PORT or udp://HOST:PORT",
        )
    return kind, *address(text)


def _print(text: str) -> None:
    say(text)
    if sys.stdout is not None:
        sys.stdout.flush()  # a parent process may wait for this line


def _warn(text: str) -> None:
    say(f"icdgen: {text}", err=True)
