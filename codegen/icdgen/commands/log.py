"""Command ``icdgen log``: list or convert logs and recordings (`icdgen.logfile`).

`log` splits the arguments into node, file and messages and opens the file with
`icdgen.logfile.log.open_log`. Without a format it prints a listing, otherwise it writes
CSV, JSON lines or Parquet. An output file appears only when it is complete. The exit
status is 1 if parts of the log are damaged, although the other parts are converted.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from icdgen.commands import progress
from icdgen.commands.common import PATH, icd_option, load_or_exit
from icdgen.errors import UserError

if TYPE_CHECKING:
    from icdgen.icd.model import Icd, Message, Node
    from icdgen.logfile.log import Log

_SUFFIXES = {
    ".csv": "csv",
    ".jsonl": "jsonl",
    ".ndjson": "jsonl",
    ".parquet": "parquet",
    ".pq": "parquet",
}


@click.command(epilog="Example: icdgen log wheels telemetry.bin --out telemetry.csv")
@click.argument("words", nargs=-1, required=True, metavar="[NODE] FILE [MESSAGE]...")
@click.option("--node", "name", help="Node, instead of the argument NODE.")
@click.option(
    "--out",
    "-o",
    type=PATH,
    metavar="FILE",
    help="Convert to this file; its extension determines the format.",
)
@click.option(
    "--format",
    "form",
    type=click.Choice(["csv", "jsonl", "parquet"]),
    help="Convert to this format.",
)
@click.option(
    "--head", type=click.IntRange(0), metavar="N", help="Only the first N rows."
)
@click.option(
    "--direction",
    type=click.Choice(["telemetry", "telecommand"]),
    default="telemetry",
    show_default=True,
    help="Direction of a recorded framed link.",
)
@icd_option
def log(
    words: tuple[str, ...],
    name: str | None,
    out: Path | None,
    form: str | None,
    head: int | None,
    direction: Literal["telemetry", "telecommand"],
    icds: tuple[Path, ...],
) -> None:
    """List the contents of a telemetry log or a recorded link, or convert it to CSV,
    JSON lines or Parquet.

    FILE is a log file of NODE, or, for a framed link, a recording of the received
    bytes. A row is an entry of the log or a message of the recording. A column is a
    field, `frame__field_unit`, with physical values and names of members. MESSAGEs, by
    id or name, limit the output to these. Without --out the conversion goes to standard
    output (except Parquet). Truncated, damaged and unknown entries are omitted and
    reported.

    Times of the entries show damage: damaged ranges are omitted with the entry before
    them. Time jumps, such as a restart of the device, remain. Exit status: 0 converted
    or listed, 1 also, but part of a log is damaged, 2 wrong usage.
    """
    from icdgen.logfile.log import open_log

    form = form or _form_of(out)
    icd = load_or_exit(icds).icd
    node, file, messages = _split_arguments(icd, words, name)
    recording = open_log(icd, node, file, direction, messages)
    if form is None:
        from icdgen import tables

        if head is not None:
            raise click.UsageError("--head needs --format or --out")
        with progress.bytes_of(file.name, recording.steps(None)) as done:
            text = recording.listing(tables.width_of(sys.stdout), done)
        click.echo(text, nl=False)
        sys.exit(recording.is_damaged(None))  # a bool: status 1 if it is damaged
    with progress.bytes_of(file.name, recording.steps(head)) as done:
        for note in recording.prepare(head, done):
            click.echo(f"icdgen: {file}: {note}", err=True)
        _convert(recording, form, out, head, done)
    # Damage is no failure of the command, but scripts must notice it.
    sys.exit(recording.is_damaged(head))


def _split_arguments(
    icd: Icd, words: Sequence[str], name: str | None
) -> tuple[Node, Path, list[Message]]:
    """Return node, file and messages."""
    from icdgen.logfile.source import node_of
    from icdgen.values.find import find_message

    names = {node.name for node in icd.nodes}
    # With a single word, it is the file; the ICD then has only one node.
    first = words[0].strip().lower() if name is None and len(words) > 1 else ""
    if first in names:
        name, words = first, words[1:]
    node = node_of(icd, name)
    return (
        node,
        Path(words[0]),
        [find_message(icd, node.name, word) for word in words[1:]],
    )


def _form_of(out: Path | None) -> str | None:
    """Return the format of a file by its extension. Raises `UserError`."""
    if out is None:
        return None
    if out.suffix.lower() not in _SUFFIXES:
        raise UserError(
            f"the extension of {out} is not a known format",
            f"{', '.join(_SUFFIXES)}, or --format",
        )
    return _SUFFIXES[out.suffix.lower()]


def _convert(
    recording: Log,
    form: str,
    out: Path | None,
    head: int | None,
    done: Callable[[int], None],
) -> None:
    from icdgen.logfile import text

    if form == "parquet":
        if out is None:
            raise UserError(
                "Parquet does not go to standard output", "--out FILE.parquet"
            )
        with _written_completely(out) as partial:
            recording.to_parquet(partial, head, done)
        return
    convert = {"csv": text.to_csv, "jsonl": text.to_json_lines}[form]
    if out is None:
        if sys.stdout is None:
            raise UserError("standard output is closed", "--out FILE")
        convert(recording.names, recording.rows(head, done), sys.stdout)
        return
    with (
        _written_completely(out) as partial,
        # Writers end lines themselves; a large buffer saves calls for millions of rows.
        open(partial, "w", encoding="utf-8", newline="", buffering=1 << 20) as stream,
    ):
        convert(recording.names, recording.rows(head, done), stream)


@contextmanager
def _written_completely(out: Path) -> Iterator[Path]:
    """Context with a temporary file, which replaces ``out`` when it is complete and is
    deleted on an error.
    """
    # In the same folder: a file can only be replaced at once within a file system.
    partial = out.with_name(f".{out.name}.partial")
    try:
        yield partial
        partial.replace(out)
    except OSError as error:
        raise UserError(
            f"cannot write {out}: {error.strerror or error}",
            "check the path, or the disk",
        ) from None
    finally:
        with suppress(OSError):
            partial.unlink(missing_ok=True)
