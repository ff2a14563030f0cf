"""Command ``icdgen encode``: physical values to a frame, with the reference codec."""

from __future__ import annotations

import json
from pathlib import Path

import click

from icdgen.commands.common import (
    format_option,
    icd_option,
    kind_option,
    load_or_exit,
    print_frame,
)


@click.command(epilog='Example: icdgen encode wheels "Set Speed" x=100 y=-100 z=0')
@click.argument(
    "words", nargs=-1, required=True, metavar="[NODE] MESSAGE [FIELD=VALUE]..."
)
@icd_option
@kind_option
@format_option("text", "json")
@click.option(
    "--raw", is_flag=True, help="Values are raw values; limits are not checked."
)
def encode(
    words: tuple[str, ...],
    icds: tuple[Path, ...],
    kind: str | None,
    form: str,
    raw: bool,
) -> None:
    """Encode a message from physical values.

    NODE can be omitted if there is only one.
    """
    from icdgen.values.encode import encode
    from icdgen.values.find import find_frame

    icd = load_or_exit(icds).icd
    node, message, assignments = find_frame(icd, words)
    # Values out of the limits of the ICD are errors, unless --raw is given.
    frame = encode(icd, node.name, message, assignments, raw=raw, kind=kind)
    if form == "json":
        click.echo(json.dumps(frame.to_json(), indent=1))
    else:
        print_frame(frame)
