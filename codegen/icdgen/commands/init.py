"""Command ``icdgen init``: the first ICD of a project (`icdgen.starter`)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from icdgen import shipped
from icdgen.commands.common import chosen, icd_option, right_or_exit, say
from icdgen.errors import UserError

if TYPE_CHECKING:
    from icdgen.starter.style import Style


@click.command(epilog="Example: icdgen init battery")
@click.argument("name")
@click.option(
    "--link",
    type=click.Choice(["uart", "framed"]),
    default="uart",
    show_default=True,
    help="uart: escape characters around a message; framed: sync bytes, length, id, CRC, ACK and NAK.",
)
@click.option(
    "--from",
    "origin",
    metavar="NODE",
    help="Copy the protocol section, the byte order and the bit order of this node.",
)
@icd_option
def init(name: str, link: str, origin: str | None, icds: tuple[Path, ...]) -> None:
    """Write a commented first ICD of a device NAME: icd/NAME.yaml, its errata file,
    icdgen.toml.

    The ICD has a serial link with a checksum and acknowledges, telemetry and
    telecommands. It is ready for icdgen check, icdgen --lang c, icdgen docs
    and icdgen sim. --from copies the protocol of a node of your ICDs or of the shipped
    ones. Editors use the schema next to the ICD to complete and check it. Existing
    files are not changed.
    """
    from icdgen import starter

    if origin is not None and link != "uart":
        raise UserError(
            "--from copies the link of another node, and --link names one",
            "leave out one of the two",
        )
    style = _style(origin, icds) if origin is not None else None
    for path in starter.write(Path.cwd(), name, style, origin or "", link):
        say(f"{path} written")
    if style is not None and style.lacks_responses:
        say("`commands` is not copied, as its responses are messages of that node")
    say("next: icdgen check, icdgen --lang c, icdgen sim")


def _style(origin: str, icds: tuple[Path, ...]) -> Style:
    from icdgen.loading import load
    from icdgen.starter import style
    from icdgen.values.errors import NotFound
    from icdgen.values.find import find_node

    paths = chosen(icds)[0]
    # `icdgen init` may run in a project whose ICDs are still to be written.
    if not icds and not all(path.exists() for path in paths):
        paths = [shipped.icds()]  # icdgen.toml exists before its ICDs
    loaded = right_or_exit(load(paths))
    try:
        node = find_node(loaded.icd, origin)
    except NotFound:
        if icds:
            raise
        # The node may be a shipped one that icdgen.toml does not name.
        loaded = load([*paths, shipped.icds()])
        node = find_node(loaded.icd, origin)
    return style.style_of(loaded.icd, node, loaded.texts)
