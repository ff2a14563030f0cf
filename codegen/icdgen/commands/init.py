"""``icdgen init``"""

from __future__ import annotations

from pathlib import Path

import click

from icdgen.commands.common import say


@click.command()
@click.argument("name")
def init(name: str) -> None:
    """Write a commented first ICD of a device NAME: icd/NAME.yaml, its errata file, and icdgen.toml.

    It has UART framing, a checksum, acknowledges, telemetry, telecommands and a configuration message, and is ready for
    icdgen check, icdgen --lang c, icdgen docs and icdgen sim. Nothing that is there already is touched.
    """
    from icdgen import starter

    for path in starter.write(Path.cwd(), name):
        say(f"{path} written")
    say("next: icdgen check, icdgen --lang c, icdgen sim")
