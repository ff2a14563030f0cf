"""Command ``icdgen diff``: report the changes between two ICDs (`icdgen.diff`).

`diff` reads the two sides with `icdgen.diff.inputs`, compares them with
`icdgen.diff.report.make_report`, and writes the report to standard output or a file.
The exit status is 1 only for changes in a layer of ``--fail-on``. ICDs with errors are
compared only with ``--unchecked``.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import click

from icdgen.commands.common import (
    PATH,
    chosen,
    format_option,
    in_colour,
    print_findings,
    write_file,
)
from icdgen.diagnostics import Findings
from icdgen.diff import reports
from icdgen.errors import UserError

if TYPE_CHECKING:
    from icdgen.diff.accepted import Acceptance
    from icdgen.diff.report import DiffReport

_LAYERS = ("wire", "meaning", "source", "text", "additions")


def _layers(
    ctx: click.Context, param: click.Parameter, value: tuple[str, ...]
) -> tuple[str, ...]:
    """Return the layers of all options, which are separated by commas."""
    words: list[str] = []
    for item in value:
        words += filter(None, map(str.strip, item.split(",")))
    for word in words:
        if word not in _LAYERS:
            raise click.BadParameter(
                f"'{word}' is not one of {', '.join(_LAYERS)}", ctx, param
            )
    return tuple(words)


@click.command(epilog="Example: icdgen diff HEAD~1..HEAD icd/ --fail-on wire,meaning")
@click.argument("sides", nargs=-1, required=True, metavar="OLD [NEW]")
@format_option(*reports.FORMATS)
@click.option(
    "--out",
    "-o",
    type=PATH,
    help="File to write the report to (default: standard output).",
)
@click.option(
    "--fail-on",
    "layers",
    multiple=True,
    callback=_layers,
    metavar="LAYERS",
    help="Exit with 1 for changes of these layers: wire, meaning, source, text. Additions count only with `additions`.",
)
@click.option(
    "--accepted",
    type=PATH,
    help="List of accepted changes (default: the nearest .icdgen-accepted.yaml).",
)
@click.option(
    "--uses",
    "sources",
    multiple=True,
    type=PATH,
    help="Also list the lines of these C, Python or Rust sources that use changed names.",
)
@click.option(
    "--unchecked",
    is_flag=True,
    help="Compare ICDs even if `icdgen check` reports errors.",
)
@click.option(
    "--all", "everything", is_flag=True, help="Do not shorten the text report."
)
def diff(
    sides: tuple[str, ...],
    form: str,
    out: Path | None,
    layers: tuple[str, ...],
    accepted: Path | None,
    sources: tuple[Path, ...],
    unchecked: bool,
    everything: bool,
) -> None:
    """Report changes from OLD to NEW: on the wire, in meaning, in generated names, in
    text.

    A side is an ICD file or folder, a git revision (HEAD~1, or HEAD~1:icd/a.yaml), or
    the output of `icdgen show --format json` (a file, or - for standard input). A..B
    compares two revisions; a revision alone is compared with the working tree.

    Exit status: 0 no change in a layer of --fail-on, 1 changes, 2 wrong usage or an ICD
    that cannot be compared.
    """
    from icdgen.diff import inputs, report, uses

    try:
        old, new = inputs.sides(list(sides), chosen(())[0], unchecked)
    except Findings as error:
        print_findings(error.findings, {}, "text", err=True)
        sys.exit(2)
    # Findings are printed even with --unchecked.
    for side in (old, new):
        if not side.is_comparable():
            print_findings(side.findings, side.texts, "text", err=True)
    if not (old.is_comparable(unchecked) and new.is_comparable(unchecked)):
        help = "correct them; --unchecked passes over what can be read and only breaks a rule"
        raise UserError("ICDs with errors are not compared", help)
    comparison_report = report.make_report(old, new, _acceptances(accepted))
    if sources:
        comparison_report.uses = uses.uses(
            comparison_report.comparison, comparison_report.changes, sources
        )
    _write(comparison_report, form, out, everything)
    sys.exit(1 if comparison_report.fails(layers) else 0)


def _acceptances(path: Path | None) -> list[Acceptance]:
    from icdgen.diff import accepted

    file = path or accepted.find_file(Path.cwd())
    if file is None:
        return []
    # A file that was found is named relative to the current folder, a given one as the
    # user wrote it.
    name = os.path.relpath(file) if path is None else str(file)
    try:
        return accepted.read_file(file, name)[0]
    except Findings as error:
        texts = {}
        with suppress(OSError):
            texts[name] = file.read_text(encoding="utf-8", errors="replace")
        print_findings(error.findings, texts, "text", err=True)
        sys.exit(2)


def _write(
    comparison_report: DiffReport, form: str, out: Path | None, everything: bool
) -> None:
    from icdgen import tables

    # A file has neither colors nor a width.
    stream = sys.stdout if out is None else None
    colour = form == "text" and in_colour(stream)
    text = reports.get(form)(
        comparison_report, colour, tables.width_of(stream), everything
    )
    if out is None:
        click.echo(text, nl=False, color=colour or None)
    else:
        write_file(out, text, "name a file in a folder that is there")
