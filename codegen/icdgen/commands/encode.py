"""``icdgen encode``, by the reference codec."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from icdgen.commands.common import icd_option, load_or_exit

if TYPE_CHECKING:
    from icdgen.values.frame import Frame

_KIND = click.option(
    "--kind", type=click.Choice(["telecommand", "telemetry", "configuration"]), help="Where an id alone is ambiguous."
)
_FORMAT = click.option("--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True)


@click.command()
@click.argument("words", nargs=-1, required=True, metavar="[NODE] MESSAGE [FIELD=VALUE]...")
@icd_option
@_KIND
@_FORMAT
@click.option("--raw", is_flag=True, help="Values are raw values, and are not held against limits.")
def encode(
    words: tuple[str, ...],
    icds: tuple[Path, ...],
    kind: str | None,
    form: str,
    raw: bool,
) -> None:
    """Encode a message from physical values.

    For instance: icdgen encode wheels "Set Speed" x=100 y=-100 z=0

    NODE may be left out where there is one only.
    """
    from icdgen.values.encode import encode
    from icdgen.values.find import find_frame

    icd = load_or_exit(icds).icd
    node, message, assignments = find_frame(icd, words)
    _print(encode(icd, node.name, message, assignments, raw=raw, kind=kind), form)


def _print(frame: Frame, form: str) -> None:
    from icdgen import tables
    from icdgen.values.text import to_text

    if form == "json":
        click.echo(json.dumps(frame.to_json(), indent=1))
    else:
        click.echo(to_text(frame, tables.width_of(sys.stdout)), nl=False)
