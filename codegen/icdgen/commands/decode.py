"""``icdgen decode``: any frame that a person can copy."""

from __future__ import annotations

import csv
import io
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import click

from icdgen.commands.common import format_option, icd_option, kind_option, load_or_exit, print_frame, say
from icdgen.errors import UserError, unreadable

if TYPE_CHECKING:
    from icdgen.icd.model import Icd, Message
    from icdgen.recognize import Reading

_LONGEST_ID, _OF_BYTE = 10, (1, 2, 3)  # digits: of an id of 32 bits; of a byte, in decimals or not
_MOST = 1_000_000  # bytes that are read for frames
_CSV = ("frame", "node", "message", "direction", "id", "field", "raw", "value", "unit", "remarks", "time")


@click.command(epilog='Example: icdgen decode wheels 146 "2efb 0a00 0000"')
@click.argument("arguments", nargs=-1, required=True, metavar="[NODE [MESSAGE]] FRAME...")
@icd_option
@kind_option
@format_option("text", "json", "csv")
def decode(arguments: tuple[str, ...], icds: tuple[Path, ...], kind: str | None, form: str) -> None:
    """Decode frames: hex in any spelling, base64, C arrays, dumps, candump and slcan lines.

    FRAME can include its framing, id and checksum. It can also be - for standard input, @FILE, or the name of a file with text
    or received bytes, with any number of frames. NODE (a name) and MESSAGE (an id or a name) are only needed if the frame does
    not identify them; ambiguous frames are reported. JSON output is an object, or an array for several frames. Exit status: 1
    if a constant field has another value or if a packet between the frames cannot be decoded, 2 if no frame can be decoded.
    """
    from icdgen import recognize

    icd = load_or_exit(icds).icd
    node, message, frame = _taken_apart(icd, list(arguments), kind)
    found = recognize.recognize(icd, frame, node, message, kind)
    if node is not None and message is None and arguments[0].lower() == node and arguments[1].isdecimal():
        found = [one if one.id is not None else one.noted(_no_id(arguments[1], node)) for one in found]
    {"text": _print_text, "json": _print_json, "csv": _print_csv}[form](found)
    left = [text for one in found for text in one.left_out]
    if form == "csv":  # the other forms have it among the remarks
        for text in left:
            say(f"left out: {text}", err=True)
    sys.exit(1 if left or any(one.has_wrong_constant for one in found) else 0)


def _no_id(word: str, node: str) -> str:
    return f"{node} has no message {word}: it is taken for the first byte of the frame"


def _taken_apart(icd: Icd, words: list[str], kind: str | None) -> tuple[str | None, str | None, str | bytes]:
    """Node, message and frame: a word is the node or the message if there is one of that name."""
    from icdgen.values.errors import Ambiguous, NotFound
    from icdgen.values.find import find_message, find_node, find_sharing, only_node

    node = message = None
    only = only_node(icd)
    if len(words) == 1 and words[0].lower() in {n.name for n in icd.nodes}:
        raise UserError(f"there is no frame for {words[0]}", "give it after the node, or - for standard input")
    if len(words) > 1:
        if words[0].lower() in {n.name for n in icd.nodes}:
            node = find_node(icd, words.pop(0)).name
        elif only and _is_message(icd.messages_of(only), words, only.vocabulary):
            node = only.name
        elif not _is_frame(words):
            node = only.name if only else find_node(icd, words.pop(0)).name
    if node is not None and len(words) == 1 and not _is_bytes(words[0]):
        _refuse_lack(icd, node, words, kind)
    if node is not None and len(words) > 1:
        try:
            find_message(icd, node, words[0], kind)
        except NotFound as error:
            if not _is_frame(words):
                raise
            if _is_id(words):
                raise NotFound(str(error), f"{error.help}; a frame that begins so is given as one word") from None
        except Ambiguous:
            if not find_sharing(icd, node, words[0], kind):
                raise
            message = words.pop(0)
        else:
            message = words.pop(0)
    return node, message, _content(words)


def _is_message(messages: Sequence[Message], words: list[str], vocabulary: tuple[str, ...]) -> bool:
    """Whether the first word is the name of a message or its id, and no part of the frame."""
    from icdgen.values.find import by_name

    if not _is_bytes(words[0]) and by_name(messages, words[0], vocabulary):
        return True
    return _is_id(words) and any(int(words[0]) in message.ids for message in messages)


def _refuse_lack(icd: Icd, node: str, words: list[str], kind: str | None) -> None:
    """A last word that names a message, or is no frame, is one for which a frame is lacking. Raises `UserError`."""
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
    """Whether the first word is a number as ids are, and no part of the frame, for the others are no single bytes."""
    first, *others = words
    may_be_one = first.isdecimal() and len(first) <= _LONGEST_ID
    return may_be_one and any(len(one) not in (len(first), *_OF_BYTE) for one in others)


def _is_frame(words: list[str]) -> bool:
    from icdgen.recognize import read
    from icdgen.values.errors import BadHex

    if words[0] == "-" or words[0].startswith("@") or _is_file(words[0]):
        return True
    try:
        read(" ".join(words))
    except BadHex:
        return False
    return True


def _content(words: list[str]) -> str | bytes:
    """The frame itself, or what stands in the file that is named."""
    name = words[0]
    if len(words) > 1 or (name != "-" and not name.startswith("@") and (_is_bytes(name) or not _is_file(name))):
        return " ".join(words)
    if name == "-":
        if sys.stdin is None:
            raise UserError("standard input is closed", "pipe the frame in, or give it as an argument")
        return _frames_in(sys.stdin.buffer, "standard input")
    path = name.removeprefix("@")
    try:
        with open(path, "rb") as file:
            return _frames_in(file, path)
    except OSError as error:
        raise unreadable(path, error, "check the path after the @") from None


def _is_bytes(text: str) -> bool:
    from icdgen.values.errors import BadHex
    from icdgen.values.hexadecimal import parse_hex

    try:
        return bool(parse_hex(text))
    except BadHex:
        return False


def _is_file(name: str) -> bool:
    try:
        return Path(name).is_file()
    except (OSError, ValueError):
        return False


def _frames_in(file: BinaryIO, name: str) -> str | bytes:
    """Text if it is that; a file that is no text holds the bytes themselves."""
    data = file.read(_MOST + 1)
    if len(data) > _MOST:
        help = "give fewer frames; `icdgen log` takes recordings of any size"
        raise UserError(f"{name} holds more than {_MOST:,} bytes", help)
    if all(byte in b"\t\n\r" or 32 <= byte < 127 for byte in data):
        return data.decode("ascii")
    return data


def _print_text(found: Sequence[Reading]) -> None:
    for number, one in enumerate(found):
        if number:
            click.echo("")
        if one.time:
            say(f"time {one.time}")
        if one.frame is not None:
            print_frame(one.frame)
        else:
            say("\n\nnote: ".join((one.title, *one.remarks)))


def _print_json(found: Sequence[Reading]) -> None:
    objects = [one.to_json() for one in found]
    click.echo(json.dumps(objects if len(objects) > 1 else objects[0], indent=1))


def _print_csv(found: Sequence[Reading]) -> None:
    """A line a field; a frame without fields has one line."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(_CSV)
    for number, one in enumerate(found):
        start = (number, one.speaker.node.name, one.message.name, one.what, "" if one.id is None else one.id)
        if one.frame is None or not one.frame.rows:
            writer.writerow((*start, "", "", "", "", "; ".join(one.remarks), one.time))
        for row in one.frame.rows if one.frame else ():
            unit = row.field.unit_symbol
            writer.writerow((*start, row.field.name, row.raw_text, row.text, unit, "; ".join(row.remarks), one.time))
    click.echo(out.getvalue(), nl=False)
