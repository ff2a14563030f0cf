"""``icdgen decode`` and ``icdgen encode``, by the reference codec."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import click

from icdgen.commands.common import icd_option, load_or_exit
from icdgen.errors import UserError

if TYPE_CHECKING:
    from icdgen.values.frame import Frame

_KIND = click.option(
    "--kind", type=click.Choice(["telecommand", "telemetry", "configuration"]), help="Where an id alone is ambiguous."
)
_MOST = 1_000_000  # bytes that are read for a frame
_FORMAT = click.option("--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True)


@click.command()
@click.argument("node")
@click.argument("message")
@click.argument("frame")
@icd_option
@_KIND
@_FORMAT
def decode(node: str, message: str, frame: str, icds: tuple[Path, ...], kind: str | None, form: str) -> None:
    """Decode a frame of NODE. MESSAGE is an id or a name; FRAME is hex in any usual spelling, - for standard input, or @FILE."""
    from icdgen import values

    data = _bytes(frame)
    _print(values.decode(load_or_exit(icds).icd, node, message, data, kind), form)


@click.command()
@click.argument("node")
@click.argument("message")
@click.argument("assignments", nargs=-1, metavar="[FIELD=VALUE]...")
@icd_option
@_KIND
@_FORMAT
@click.option("--raw", is_flag=True, help="Values are raw values, and are not held against limits.")
def encode(
    node: str,
    message: str,
    assignments: tuple[str, ...],
    icds: tuple[Path, ...],
    kind: str | None,
    form: str,
    raw: bool,
) -> None:
    """Encode a message of NODE from physical values: icdgen encode wheels "Set Speed" x=100 y=-100 z=0."""
    from icdgen import values

    _print(values.encode(load_or_exit(icds).icd, node, message, list(assignments), raw=raw, kind=kind), form)


def _bytes(frame: str) -> bytes:
    from icdgen import values

    if frame == "-":
        if sys.stdin is None:
            raise UserError("standard input is closed", "pipe the frame in, or give it as an argument")
        return _frame_in(sys.stdin.buffer, "standard input")
    if frame.startswith("@"):
        try:
            with open(frame[1:], "rb") as file:
                return _frame_in(file, frame[1:])
        except OSError as error:
            raise UserError(f"cannot read {frame[1:]}: {error.strerror}", "check the path after the @") from None
    return values.parse_hex(frame)


def _frame_in(file: BinaryIO, name: str) -> bytes:
    """Hex if it is text; a file that is no text is the frame itself."""
    from icdgen import values

    data = file.read(_MOST + 1)
    if len(data) > _MOST:
        raise UserError(f"{name} holds more than {_MOST:,} bytes", "give one frame, as hex or as it is")
    if all(byte in b"\t\n\r" or 32 <= byte < 127 for byte in data):
        return values.parse_hex(data.decode("ascii"))
    return data


def _print(frame: Frame, form: str) -> None:
    from icdgen import tables, values

    if form == "json":
        click.echo(json.dumps(frame.to_json(), indent=1))
    else:
        click.echo(values.to_text(frame, tables.width_of(sys.stdout)), nl=False)
