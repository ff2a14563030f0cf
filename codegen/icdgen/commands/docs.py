"""Command ``icdgen docs``: write or serve the documentation site (`icdgen.site`)."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from icdgen.backends.packages import of_project
from icdgen.commands import progress
from icdgen.commands.common import PATH, chosen, icd_arguments, print_findings, say


@click.command(epilog="Example: icdgen docs --out site")
@icd_arguments
@click.option("--out", "-o", type=PATH, help="Folder to write to (default: site).")
@click.option(
    "--previous",
    metavar="OLD",
    help="Older release to compare with: a file, a folder, a git revision. Adds a page of changes.",
)
@click.option(
    "--serve",
    is_flag=True,
    help="Write nothing; serve the site and update it when an ICD changes.",
)
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=8000,
    show_default=True,
    help="For --serve; 0: any.",
)
@click.option(
    "--check", is_flag=True, help="Write nothing; exit 1 if the site is not current."
)
def docs(
    icds: tuple[Path, ...],
    out: Path,
    previous: str | None,
    serve: bool,
    port: int,
    check: bool,
) -> None:
    """Generate the documentation site: static pages that open from the folder, without
    a server.
    """
    from icdgen import site

    paths, config = chosen(icds)
    packages = of_project(config)
    if serve:
        if out is not None or check:
            raise click.UsageError(
                "--serve writes nothing: leave --out and --check out"
            )
        site.serve(paths, previous, config.templates, packages, port, say)
        return
    with progress.items("documentation", "files") as watch:
        built_site = site.make_site(paths, previous, config.templates, packages, watch)
    if built_site.findings:
        print_findings(built_site.findings, built_site.texts, "text", err=True)
    # Findings with errors: the site would be incomplete.
    if not built_site.ok:
        sys.exit(1)
    out = out or Path("site")
    plan = site.write_site(built_site, out, check)
    if check and plan.changes:
        say(
            f"{out}: {len(plan.write)} files are not current, {len(plan.remove)} are stale"
        )
        sys.exit(1)
    if plan.changes:
        removed = f", {len(plan.remove)} removed" if plan.remove else ""
        say(
            f"{out}: {len(plan.write)} of {len(plan.files)} files written{removed}. Open {out / 'index.html'}"
        )
    else:
        say(f"{out}: all {len(plan.files)} files are current")
