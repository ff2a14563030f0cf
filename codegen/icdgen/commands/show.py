"""Command ``icdgen show``: ICDs as text or JSON (`icdgen.show`)."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import click

from icdgen.commands.common import format_option, icd_option, kind_option, load_or_exit


@click.command(epilog="Example: icdgen show wheels 146")
@click.argument("node", required=False)
@click.argument("item", required=False)
@icd_option
@kind_option
@format_option("text", "json")
def show(
    node: str | None,
    item: str | None,
    icds: tuple[Path, ...],
    kind: str | None,
    form: str,
) -> None:
    """Show the nodes, the messages of NODE, or one ITEM of it: a message by id or name,
    an enumeration, a struct, an erratum.

    NODE can be omitted if there is only one.

    --format json prints everything, in a stable form for programs (schema: show.schema.json in the package).
    """
    from icdgen import tables
    from icdgen.show.machine import to_json
    from icdgen.show.people import to_text

    icd = load_or_exit(icds).icd
    if form == "json":
        if node is not None:
            raise click.UsageError("--format json shows everything: leave NODE out")
        click.echo(json.dumps(to_json(icd), indent=1))
        return
    selection = [word for word in (node, item) if word is not None]
    click.echo(to_text(icd, selection, tables.width_of(sys.stdout), kind), nl=False)
