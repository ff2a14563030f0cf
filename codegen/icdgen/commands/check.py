"""Command ``icdgen check``: report findings about ICDs."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from icdgen import backends, reports
from icdgen.backends.packages import of_project
from icdgen.commands.common import (
    chosen,
    format_option,
    icd_arguments,
    print_findings,
    say_default,
)


@click.command(epilog="Example: icdgen check icd/")
@icd_arguments
@format_option(*reports.FORMATS)
def check(icds: tuple[Path, ...], form: str) -> None:
    """Check ICDs and report every finding. Exit status: 0 clean, 1 findings.

    Without arguments, these are the ICDs of icdgen.toml; else the ICD files in the
    current folder, and its folder icd; else the ICDs that come with icdgen.
    """
    from icdgen.loading import load

    paths, config = chosen(icds, prefers_folder=True)
    of_project(config)  # raises an error for names that cannot be used
    loaded = load(paths, plug_ins=backends.not_ours(config.lang))
    print_findings(loaded.findings, loaded.texts, form)
    say_default(paths, "checked")
    # Warnings fail too, so that CI notices them.
    sys.exit(1 if loaded.findings else 0)
