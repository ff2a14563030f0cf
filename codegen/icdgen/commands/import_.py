"""Command ``icdgen import``: manuals and definitions of other tools to ICDs.

`icdgen.importer` reads manuals, `icdgen.definitions` files such as DBC and XTCE.
"""

from __future__ import annotations

import re
import sys
from collections import Counter
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import click

from icdgen.commands import progress
from icdgen.commands.common import (
    PATH,
    format_option,
    in_colour,
    print_findings,
    say,
    write_file,
)
from icdgen.diagnostics import Finding, Findings, has_errors
from icdgen.errors import UserError
from icdgen.wording import count

if TYPE_CHECKING:
    from icdgen.definitions.model import DefinitionReader
    from icdgen.import_results.targets import Target
    from icdgen.importer.document import Document, SourceTable
    from icdgen.importer.run import Result


class _Pages(click.ParamType):  # type: ignore[type-arg]  # older versions of click know no argument
    """Range of pages: ``12`` or ``20-35``."""

    name = "pages"

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[int, int]:
        match = re.fullmatch(r"([0-9]{1,6})(?:-([0-9]{1,6}))?", str(value))
        first, last = (int(match[1]), int(match[2] or match[1])) if match else (0, 0)
        if not 0 < first <= last:
            self.fail(f"`{value}` names no pages: write 12 or 20-35", param, ctx)
        return first, last


PAGES = _Pages()
# Findings about a whole file, such as one that is no PDF: they have no line to quote.
ABOUT_FILES = frozenset({"IMP002", "IMP003", "IMP005"})


@click.command("import", epilog="Example: icdgen import network.dbc --out icd")
@click.argument("files", metavar="FILE|FOLDER...", type=PATH, nargs=-1, required=True)
@click.option(
    "--out",
    type=PATH,
    default=Path("icd"),
    show_default=True,
    help="Folder for the ICDs, one file a node.",
)
@click.option(
    "--kind",
    help="Kind of a definition that is not recognized by its beginning: xtce, dbc, ksy ...",
)
@click.option(
    "--profile",
    "words",
    metavar="PROFILE",
    help="Profile with rules for the tables: a YAML file, or the name of a shipped profile.",
)
@click.option(
    "--update",
    is_flag=True,
    help="Update existing ICDs; errata, identifiers, summaries and comments are kept.",
)
@click.option(
    "--dry-run",
    is_flag=True,
    help="Write no ICD; print what would be written or changed.",
)
@click.option(
    "--report",
    "page",
    type=PATH,
    help="Write a page (HTML) with a picture of each doubtful table and its result.",
)
@click.option(
    "--descriptions",
    is_flag=True,
    help="Import the manual's descriptions as summaries.",
)
@click.option(
    "--explore",
    is_flag=True,
    help="Print the kinds of tables, and for each a rule to be completed; import nothing.",
)
@click.option(
    "--tables",
    "folder",
    type=PATH,
    metavar="DIR",
    help="Write each table as a YAML file that can be corrected and imported.",
)
@click.option(
    "--explain",
    "table",
    type=int,
    metavar="TABLE",
    help="Print which rule read a table and why others did not.",
)
@click.option(
    "--workbench",
    is_flag=True,
    help="Serve a local page for writing the rules of --profile.",
)
@click.option(
    "--pages", type=PAGES, help="Read these pages of a PDF only: 12 or 20-35."
)
@format_option("text", "json")
@click.option(
    "--jobs",
    type=click.IntRange(1, 64),
    help="Processes that read pages (default: one a core).",
)
def import_(
    files: tuple[Path, ...],
    out: Path,
    kind: str | None,
    words: str | None,
    update: bool,
    dry_run: bool,
    page: Path | None,
    descriptions: bool,
    explore: bool,
    folder: Path | None,
    table: int | None,
    workbench: bool,
    pages: tuple[int, int] | None,
    form: str,
    jobs: int | None,
) -> None:
    """Read a manual (PDF, text with tab-separated tables, folder of table files) or
    definitions into reviewable ICDs.

    Definitions are CAN databases (dbc, kcd, sym, arxml), MAVLink dialects (mavlink,
    mavlink1), XTCE (xtce), electronic data sheets of CCSDS SOIS (eds), Kaitai Struct
    (ksy) and models of SunSpec (sunspec). Files that refer to each other are given
    together, or as the folder that contains them:

    \b
      icdgen import mdb/pus.xml mdb/types.xml
      icdgen import cfs/modules

    --profile, --report, --descriptions, --explore, --tables, --explain, --pages and --jobs are for manuals.

    Exit status: 0 if the ICDs contain everything that was found and `icdgen check` has
    no errors for them, else 1.
    """
    from icdgen.import_results import targets
    from icdgen.importer import console, profile, run, table_files

    has_tables = len(files) == 1 and table_files.is_folder_of_tables(files[0])
    # A folder can contain corrected tables of a manual or definition files.
    definitions = [] if has_tables else _definitions(files, kind)
    if definitions:
        _define(definitions, out, update, dry_run, form)
        return
    (manual,) = files
    if workbench:
        _workbench(manual, words, out, pages, jobs, form)
        return
    try:
        vocabulary = profile.load(profile.find(words))
        with progress.pages("reading") as show:
            result, trees = run.run(manual, vocabulary, show, jobs, descriptions, pages)
        if folder is not None:
            paths = table_files.write_tables(result.tables, folder, result.document)
            say(
                f"{folder}: {count(len(paths), 'table')} written; correct them, then `icdgen import {folder}`",
                err=form == "json",
            )
        if table is not None:
            say(_explanation(result, table))
            sys.exit(0)
        if not explore and (folder is None or vocabulary.rules):
            result.targets = targets.prepare(trees, out, update, dry_run)
    except Findings as error:
        _refuse(error, manual, form)
        sys.exit(1)
    invalid = False
    if folder is not None and not vocabulary.rules and not explore:
        sys.exit(0)  # only the tables were requested
    if explore:
        _explore(result, form)
    else:
        checked = targets.check(result.targets)
        invalid = has_errors(checked)
        if not dry_run:
            targets.write(result.targets)
        if form == "json":
            click.echo(console.as_json(result, checked))
        else:
            _say(result, checked, dry_run)
    if page is not None:
        from icdgen.importer import html

        write_file(page, html.report(result), "choose another place with --report")
    sys.exit(1 if (result.failed and not explore) or invalid else 0)


def _definitions(
    files: tuple[Path, ...], kind: str | None
) -> list[tuple[Path, DefinitionReader]]:
    """Return the definitions in files and folders with their readers; empty for a
    manual.

    Raises `UserError` for files that cannot be imported together.
    """
    from icdgen.definitions import kinds

    requested = kinds.reader_of_kind(kind) if kind is not None else None
    definitions: dict[Path, tuple[Path, DefinitionReader]] = {}
    for path in files:
        if path.is_dir():
            inside = kinds.within(path)
            if requested is not None:
                inside = [each for each in inside if each[1].name == requested.name]
            if not inside:
                of_kind = f" of the kind {requested.name}" if requested else ""
                help = f"kinds are {', '.join(kinds.names())}; import a manual, or a file that --kind names, by its own name"
                raise UserError(
                    f"there is no definition{of_kind} in the folder {path}", help
                )
        else:
            reader = requested or kinds.reader_of_file(path)
            if reader is None and len(files) == 1:
                return []
            if reader is None:
                reason = "does not exist"
                if path.exists():
                    reason = "is not a known definition"
                raise UserError(
                    f"{path} {reason}",
                    "import manuals one by one; --kind names the kind of definitions",
                )
            inside = [(path, reader)]
        for definition in inside:
            # A file can be given by itself and be in a given folder, too.
            definitions.setdefault(definition[0].resolve(), definition)
    return list(definitions.values())


def _define(
    files: list[tuple[Path, DefinitionReader]],
    out: Path,
    update: bool,
    dry_run: bool,
    form: str,
) -> None:
    """Import one definition, or several that may refer to each other."""
    from icdgen.definitions import console, run
    from icdgen.import_results import targets

    try:
        what = files[0][0] if len(files) == 1 else f"{len(files)} definitions"
        with progress.working(f"reading {what}"):
            reads = [run.read(*files[0])] if len(files) == 1 else run.read_set(files)
        trees = {name: tree for read in reads for name, tree in read.trees.items()}
        aimed = targets.prepare(trees, out, update, dry_run, run.TOLD)
    except Findings as error:
        _refuse(error, files[0][0], form)
        sys.exit(1)
    if not dry_run:
        targets.write(aimed)
    checked = targets.check(aimed)
    if form == "json":
        click.echo(console.as_json(reads, aimed, checked))
    else:
        colour = in_colour(sys.stdout)
        click.echo(console.report(reads, colour), color=colour or None)
        _say_files(aimed, checked, dry_run)
        if not trees:
            say("no ICD is written: no message can be imported")
    sys.exit(
        1
        if not trees or any(read.failed for read in reads) or has_errors(checked)
        else 0
    )


def _workbench(
    manual: Path,
    words: str | None,
    out: Path,
    pages: tuple[int, int] | None,
    jobs: int | None,
    form: str,
) -> None:
    """Serve the workbench until it is interrupted.

    Raises `UserError` for a shipped profile or a profile without rules.
    """
    from icdgen.importer import profile, sources
    from icdgen.importer.workbench import server
    from icdgen.importer.workbench.session import Session

    path = Path(words or "profile.yaml")
    try:
        # A profile that does not exist yet begins with the built-in words.
        vocabulary = profile.load(path if path.exists() else None)
        with progress.pages("reading") as show:
            document, tables = sources.read(manual, vocabulary, show, jobs, pages)
    except Findings as error:
        _refuse(error, manual, form)
        sys.exit(1)

    def reader(words: profile.Profile) -> tuple[Document, list[SourceTable]]:
        return sources.read(manual, words, None, jobs, pages)

    with server.serve(Session(document, tables, path, out, reader)) as running:
        say(
            f"{manual}: {len(tables)} tables; open http://{server.HOST}:{running.server_port}/ (Ctrl-C ends it)"
        )
        with suppress(KeyboardInterrupt):
            running.serve_forever()


def _explanation(result: Result, number: int) -> str:
    """Return the output of `--explain`.

    Raises `UserError` if the table does not exist.
    """
    from icdgen.importer.rules import explain

    if not 1 <= number <= len(result.tables):
        raise UserError(
            f"there is no table {number}",
            f"tables are numbered from 1 to {len(result.tables)}, see --tables",
        )
    return explain.explain(result.interpretation, number)


def _explore(result: Result, form: str) -> None:
    """Print the output of `--tables`."""
    from icdgen.importer.rules import explore

    report = explore.as_json if form == "json" else explore.report
    say(report(result.tables, result.document.file).rstrip("\n"))


def _say(result: Result, checked: list[Finding], dry_run: bool) -> None:
    from icdgen.importer import console

    if in_colour(sys.stdout):
        click.echo(console.report(result, True), color=True)
    else:
        say(console.report(result))
    _say_files(result.targets, checked, dry_run)


def _say_files(targets: list[Target], checked: list[Finding], dry_run: bool) -> None:
    from icdgen.import_results import report

    if targets:
        say("\n".join(report.files(targets, dry_run)))
        say(_next_step(targets, checked, dry_run))


def _refuse(error: Findings, manual: Path, form: str) -> None:
    """Report why nothing can be imported.

    Findings about a whole file have no excerpt; findings about lines of a profile or an
    ICD do.
    """
    if form == "json":
        from icdgen.importer import console

        click.echo(console.refused_as_json(str(manual), error.findings))
        return
    about_lines = [
        finding for finding in error.findings if finding.code not in ABOUT_FILES
    ]
    for finding in error.findings:
        if finding.code in ABOUT_FILES:
            place = finding.place.file
            if finding.place.line > 1:
                place += f":{finding.place.line}"
            remedy = f"\n  = help: {finding.help}" if finding.help else ""
            say(f"{place}: error[{finding.code}]: {finding.message}{remedy}", err=True)
    if about_lines:
        texts = {}
        # An excerpt is helpful but not essential, so unreadable files are skipped.
        for name in {finding.place.file for finding in about_lines}:
            with suppress(OSError, UnicodeDecodeError):
                texts[name] = Path(name).read_text(encoding="utf-8")
        print_findings(about_lines, texts, "text", err=True)


def _next_step(targets: list[Target], checked: list[Finding], dry_run: bool) -> str:
    """Return the next step: the `icdgen check` command with the number of its errors
    and warnings.
    """
    command = f"`icdgen check {' '.join(str(target.path) for target in targets)}`"
    counts = Counter(finding.severity for finding in checked)
    shown = " and ".join(
        count(number, severity) for severity, number in sorted(counts.items())
    )
    if dry_run:
        return f"{command} would have {shown or 'no findings'}"
    return f"next: {command} has {shown}" if shown else f"{command}: no findings"
