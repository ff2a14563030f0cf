"""Command ``icdgen decode``, for frames in any notation.

`icdgen.recognize` does the work; this module separates node, message and frame in the
arguments, and prints the result.
"""

from __future__ import annotations

import csv
import io
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import click

from icdgen.commands.common import (
    format_option,
    icd_option,
    kind_option,
    load_or_exit,
    print_frame,
    say,
)
from icdgen.errors import UserError, unreadable

if TYPE_CHECKING:
    from icdgen.icd.model import Icd, Message
    from icdgen.recognize import FrameReading

# Digits of a 32-bit id, and of a byte in hexadecimal or decimal notation
_LONGEST_ID, _OF_BYTE = 10, (1, 2, 3)
_MOST = 1_000_000  # maximum size of an input in bytes
_CSV = (
    "frame",
    "node",
    "message",
    "direction",
    "id",
    "field",
    "raw",
    "value",
    "unit",
    "remarks",
    "time",
)


@click.command(epilog='Example: icdgen decode wheels 146 "2efb 0a00 0000"')
@click.argument(
    "arguments", nargs=-1, required=True, metavar="[NODE [MESSAGE]] FRAME..."
)
@icd_option
@kind_option
@format_option("text", "json", "csv")
def decode(
    arguments: tuple[str, ...], icds: tuple[Path, ...], kind: str | None, form: str
) -> None:
    """Decode frames: hex in any spelling, base64, C arrays, dumps, candump and slcan
    lines.

    FRAME can include its framing, id and checksum. It can also be - for standard input,
    @FILE, or the name of a file with text or received bytes, with any number of frames.
    NODE (a name) and MESSAGE (an id or a name) are only needed if the frame does not
    identify them; ambiguous frames are reported. JSON output is an object, or an array
    for several frames. Exit status: 1 if a constant field has another value or if a
    packet between the frames cannot be decoded, 2 if no frame can be decoded.
    """
    from icdgen import recognize

    icd = load_or_exit(icds).icd
    node, message, frame = _split_arguments(icd, list(arguments), kind)
    readings = recognize.recognize(icd, frame, node, message, kind)
    # The user may have meant an id that the node does not have.
    if (
        node is not None
        and message is None
        and arguments[0].lower() == node
        and arguments[1].isdecimal()
    ):
        note = f"{node} has no message {arguments[1]}: it is taken for the first byte of the frame"
        readings = [
            reading if reading.id is not None else reading.with_remarks(note)
            for reading in readings
        ]
    {"text": _print_text, "json": _print_json, "csv": _print_csv}[form](readings)
    left_out = [text for reading in readings for text in reading.left_out]
    if form == "csv":  # the other forms have it among the remarks
        for text in left_out:
            say(f"left out: {text}", err=True)
    has_wrong_constant = any(reading.has_wrong_constant for reading in readings)
    sys.exit(1 if left_out or has_wrong_constant else 0)


def _split_arguments(
    icd: Icd, words: list[str], kind: str | None
) -> tuple[str | None, str | None, str | bytes]:
    """Return node, message and frame.

    A word is a node or a message if one of that name exists.
    """
    from icdgen.values.errors import Ambiguous, NotFound
    from icdgen.values.find import find_message, find_node, find_sharing, only_node

    node = message = None
    # With a single node, its name may be omitted.
    only = only_node(icd)
    if len(words) == 1 and words[0].lower() in {n.name for n in icd.nodes}:
        raise UserError(
            f"there is no frame for {words[0]}",
            "give it after the node, or - for standard input",
        )
    # The first word is a node, a message of the only node, or the start of the frame.
    if len(words) > 1:
        if words[0].lower() in {n.name for n in icd.nodes}:
            node = find_node(icd, words.pop(0)).name
        elif only and _is_message(icd.messages_of(only), words, only.vocabulary):
            node = only.name
        elif not _is_frame(words):
            node = only.name if only else find_node(icd, words.pop(0)).name
    # The last word can be a message, whose frame was forgotten.
    if node is not None and len(words) == 1 and not _is_bytes(words[0]):
        _refuse_lack(icd, node, words, kind)
    if node is not None and len(words) > 1:
        try:
            find_message(icd, node, words[0], kind)
        except NotFound as error:
            if not _is_frame(words):
                raise
            # A hexadecimal word such as 146 can be an unknown id or the first byte of
            # the frame.
            if _is_id(words):
                raise NotFound(
                    str(error),
                    f"{error.help}; a frame that begins so is given as one word",
                ) from None
        # Several messages share the id; the frame decides which one it is.
        except Ambiguous:
            if not find_sharing(icd, node, words[0], kind):
                raise
            message = words.pop(0)
        else:
            message = words.pop(0)
    return node, message, _content(words)


def _is_message(
    messages: Sequence[Message], words: list[str], vocabulary: tuple[str, ...]
) -> bool:
    """Return whether the first word is the name or id of a message, and not part of the
    frame.
    """
    from icdgen.values.find import items_by_name

    if not _is_bytes(words[0]) and items_by_name(messages, words[0], vocabulary):
        return True
    return _is_id(words) and any(int(words[0]) in message.ids for message in messages)


def _refuse_lack(icd: Icd, node: str, words: list[str], kind: str | None) -> None:
    """Raise `UserError` for a missing frame, if the last word names a message or is no
    frame.
    """
    from icdgen.values.errors import NotFound
    from icdgen.values.find import find_message

    try:
        message = find_message(icd, node, words[0], kind)
    except NotFound:
        if _is_frame(words):
            return
        raise
    what = f"there is no frame for {message.name} of {node}"
    raise UserError(what, "give it after the message, or - for standard input")


def _is_id(words: list[str]) -> bool:
    """Return whether the first word is an id and not part of the frame: the other words
    are no single bytes of equal notation.
    """
    first, *following_words = words
    may_be_id = first.isdecimal() and len(first) <= _LONGEST_ID
    # Words of equal length, or of one to three digits, are the bytes of one dump: `10
    # 12 255`.
    return may_be_id and any(
        len(word) not in (len(first), *_OF_BYTE) for word in following_words
    )


def _is_frame(words: list[str]) -> bool:
    """Return whether the words are a frame in any notation, or name a file."""
    from icdgen.recognize import read_pasted
    from icdgen.values.errors import BadHex

    if words[0] == "-" or words[0].startswith("@") or _is_file(words[0]):
        return True
    try:
        read_pasted(" ".join(words))
    except BadHex:
        return False
    return True


def _content(words: list[str]) -> str | bytes:
    """Return the frame itself, or the content of the named file."""
    name = words[0]
    is_named_file = name == "-" or name.startswith("@")
    # A file named like hex digits needs the prefix @.
    if not is_named_file:
        is_named_file = _is_file(name) and not _is_bytes(name)
    if len(words) > 1 or not is_named_file:
        return " ".join(words)
    if name == "-":
        if sys.stdin is None:
            raise UserError(
                "standard input is closed",
                "pipe the frame in, or give it as an argument",
            )
        return _frames_in(sys.stdin.buffer, "standard input")
    path = name.removeprefix("@")
    try:
        with open(path, "rb") as file:
            return _frames_in(file, path)
    except OSError as error:
        raise unreadable(path, error, "check the path after the @") from None


def _is_bytes(text: str) -> bool:
    """Return whether a word is one or more bytes in hexadecimal."""
    from icdgen.values.errors import BadHex
    from icdgen.values.hexadecimal import parse_hex

    try:
        return bool(parse_hex(text))
    except BadHex:
        return False


def _is_file(name: str) -> bool:
    try:
        # A long frame is no valid path: its name is too long.
        return Path(name).is_file()
    except (OSError, ValueError):
        return False


def _frames_in(file: BinaryIO, name: str) -> str | bytes:
    """Return the content of a file as text if it is ASCII, otherwise as bytes."""
    # One byte more shows whether the file is too long.
    data = file.read(_MOST + 1)
    if len(data) > _MOST:
        help = "give fewer frames; `icdgen log` takes recordings of any size"
        raise UserError(f"{name} holds more than {_MOST:,} bytes", help)
    # Received bytes may be ASCII by chance; then they are read as hex or base64.
    if all(byte in b"\t\n\r" or 32 <= byte < 127 for byte in data):
        return data.decode("ascii")
    return data


def _print_text(readings: Sequence[FrameReading]) -> None:
    for number, reading in enumerate(readings):
        if number:
            click.echo("")
        if reading.time:
            say(f"time {reading.time}")
        if reading.frame is not None:
            print_frame(reading.frame)
        else:
            say("\n\nnote: ".join((reading.title, *reading.remarks)))


def _print_json(readings: Sequence[FrameReading]) -> None:
    objects = [reading.to_json() for reading in readings]
    click.echo(json.dumps(objects if len(objects) > 1 else objects[0], indent=1))


def _print_csv(readings: Sequence[FrameReading]) -> None:
    """Print one line per field; a frame without fields has one line."""
    out = io.StringIO()
    # RFC 4180 has CRLF, but tools on a pipe expect lines that end with LF.
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(_CSV)
    for number, reading in enumerate(readings):
        start = (
            number,
            reading.endpoint.node.name,
            reading.message.name,
            reading.what,
            "" if reading.id is None else reading.id,
        )
        if reading.frame is None or not reading.frame.rows:
            writer.writerow(
                (*start, "", "", "", "", "; ".join(reading.remarks), reading.time)
            )
        for row in reading.frame.rows if reading.frame else ():
            unit = row.field.unit_symbol
            writer.writerow(
                (
                    *start,
                    row.field.name,
                    row.raw_text,
                    row.text,
                    unit,
                    "; ".join(row.remarks),
                    reading.time,
                )
            )
    click.echo(out.getvalue(), nl=False)
