"""Command ``icdgen schema``: the JSON Schema of ICDs."""

from __future__ import annotations

from pathlib import Path

import click

from icdgen.commands.common import PATH, say, write_file


@click.command(epilog="Example: icdgen schema")
@click.option(
    "--out",
    "-o",
    type=PATH,
    help="File to write to, for instance icd/icdgen.schema.json.",
)
def schema(out: Path | None) -> None:
    """Print the JSON Schema of ICDs and errata overlays, by which editors complete and
    check them.

    `icdgen init` and `icdgen import` write a copy next to the ICDs, which name it in
    their first line. After an update of icdgen, --out renews the copy.
    """
    from icdgen.icd.schema import PATH as FILE

    text = FILE.read_text(encoding="utf-8")
    if out is None:
        click.echo(text, nl=False)
        return
    write_file(out, text, "choose another place with --out")
    say(f"{out} written")
