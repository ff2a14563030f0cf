"""``icdgen log``"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

import click

from icdgen.commands.common import PATH, icd_option, load_or_exit
from icdgen.errors import UserError

if TYPE_CHECKING:
    from icdgen.logfile.source import Source

_SUFFIXES = {".csv": "csv", ".jsonl": "jsonl", ".ndjson": "jsonl", ".parquet": "parquet", ".pq": "parquet"}


@click.command()
@click.argument("file", type=PATH)
@click.option("--node", "name", help="Whose log it is, if several nodes of the ICDs have logs.")
@click.option("--out", "-o", type=PATH, metavar="FILE", help="Convert to this file, whose ending tells the format.")
@click.option("--format", "form", type=click.Choice(["csv", "jsonl", "parquet"]), help="Convert to this format.")
@click.option("--head", type=click.IntRange(0), metavar="N", help="Only the first N entries.")
@icd_option
def log(
    file: Path, name: str | None, out: Path | None, form: str | None, head: int | None, icds: tuple[Path, ...]
) -> None:
    """List what a telemetry log holds, or convert it to CSV, JSON lines or Parquet.

    A row is an entry, a column a field: `frame__field_unit`, holding physical values and names of members. Without --out the
    conversion goes to standard output (not that to Parquet). A last entry that was cut off is left out, and reported.
    """
    from icdgen import tables
    from icdgen.logfile import listing, source

    form = form or _form_of(out)
    icd = load_or_exit(icds).icd
    found = source.open_log(icd, source.node_of(icd, name), file)
    if form is None:
        if head is not None:
            raise click.UsageError("--head needs --format or --out")
        click.echo(listing.to_text(found, tables.width_of(sys.stdout)), nl=False)
        return
    for doubt in found.doubts():
        click.echo(f"icdgen: {file}: {doubt}", err=True)
    if found.truncated:
        click.echo(f"icdgen: {file}: the last {found.truncated} bytes belong to no whole entry", err=True)
    entries = found.entries if head is None else min(head, found.entries)
    with _progress(file.name, entries * found.plan.entry_bytes) as done:
        _convert(found, form, out, head, done)


def _form_of(out: Path | None) -> str | None:
    if out is None:
        return None
    if out.suffix.lower() not in _SUFFIXES:
        raise UserError(f"the ending of {out} tells no format", f"{', '.join(_SUFFIXES)}, or --format")
    return _SUFFIXES[out.suffix.lower()]


def _convert(found: Source, form: str, out: Path | None, head: int | None, done: Callable[[int], None]) -> None:
    from icdgen.logfile import parquet, text

    if form == "parquet":
        if out is None:
            raise UserError("Parquet does not go to standard output", "--out FILE.parquet")
        with _whole(out) as partial:
            parquet.to_parquet(found, partial, head, done)
        return
    convert = {"csv": text.to_csv, "jsonl": text.to_json_lines}[form]
    if out is None:
        if sys.stdout is None:
            raise UserError("standard output is closed", "--out FILE")
        convert(found, sys.stdout, head, done)
        return
    with _whole(out) as partial, open(partial, "w", encoding="utf-8", newline="", buffering=1 << 20) as stream:
        convert(found, stream, head, done)


@contextmanager
def _whole(out: Path) -> Iterator[Path]:
    """A file beside it that takes its place when it is complete, and is gone if it never is."""
    partial = out.with_name(f".{out.name}.partial")
    try:
        yield partial
        partial.replace(out)
    except OSError as error:
        raise UserError(f"cannot write {out}: {error.strerror or error}", "check the path, or the disk") from None
    finally:
        with suppress(OSError):
            partial.unlink(missing_ok=True)


@contextmanager
def _progress(name: str, total: int) -> Iterator[Callable[[int], None]]:
    """A bar on a terminal, if it takes long enough to be seen."""
    if sys.stderr is None or not sys.stderr.isatty() or total < 10_000_000:
        yield lambda size: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, DownloadColumn, Progress, TextColumn, TimeRemainingColumn, TransferSpeedColumn

    columns = (TextColumn("{task.description}", markup=False), BarColumn(), DownloadColumn(), TransferSpeedColumn())
    with Progress(*columns, TimeRemainingColumn(), console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(name, total=total)
        yield lambda size: bar.advance(task, size)
