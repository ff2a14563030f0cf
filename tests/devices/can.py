"""CAN databases of the opendbc package: read as `icdgen import` reads them; cantools
judges.
"""

from __future__ import annotations

import contextlib
import importlib.resources
import re
from collections.abc import Callable, Iterator
from copy import copy
from pathlib import Path
from typing import Any

from icdgen.definitions import can, model, run
from icdgen.diagnostics import Findings
from tests.devices.definition import Definition, Definitions, Values


def databases(words: str = "") -> Iterator[Definitions]:
    """Every DBC file of the package whose name contains these words. cantools judges
    what is left without the faults for which it would refuse all of it.
    """
    reader = can.Dbc()
    for number, path in enumerate(files()):
        if words not in path.name:
            continue
        try:
            read = run.read(path, reader)
        except Findings:
            continue  # parts of databases, without a message
        judge = reader.database(
            str(path), path.read_bytes(), model.Definitions(str(path))
        )
        (tree,) = read.trees.values()
        tree["node"]["name"] = f"{tree['node']['name'][:35].rstrip('_')}_{number}"
        held = {one["name"]: one for one in tree["messages"]}
        messages = [
            _definition(one, held.get(one.name), tree["node"], read.definitions)
            for one in judge.messages
        ]
        yield Definitions(tree["node"], messages, tree)


def files() -> list[Path]:
    """The DBC files of the package, by name."""
    import opendbc

    folder = importlib.resources.files(opendbc)
    assert isinstance(folder, Path)
    return sorted(folder.rglob("*.dbc"), key=lambda path: path.name)


def _definition(
    message: Any, held: dict | None, node: dict, read: model.Definitions
) -> Definition:
    head = (
        message.name,
        message.frame_id if held is None else int(held["id"]),
        "telemetry",
        message.length,
    )
    if held is None:
        said = [
            one.message
            for one in read.import_findings
            if f"message `{message.name}` is not imported" in one.message
        ]
        code = re.search(r"ICD\d{3}", said[0])
        return Definition(
            *head, [], cause=code[0] if code else said[0].split(": ", 1)[1]
        )
    orders = {key: held.get(key, node[key]) for key in ("byte_order", "bit_order")}
    fields = [{**orders, **one, **_when(one)} for one in held.get("fields", ())]
    decode, encode = _reader(message, fields)
    return Definition(
        *head,
        fields,
        raw=lambda data: decode(data, False),
        physical=lambda data: decode(data, True),
        encoded=encode,
    )


def _when(field: dict) -> dict:
    """The key of a condition, with a list of numbers each."""
    said = field.get("when", {})
    listed = {
        name: [int(one) for one in (value if isinstance(value, list) else [value])]
        for name, value in said.items()
    }
    return {"when": listed} if listed else {}


def _said_of(signal: Any, is_multiplexer: bool) -> Any:
    """The same signal of the library, but for what it is said to be."""
    found = copy(signal)
    found.is_multiplexer = is_multiplexer
    return found


def _reader(
    message: Any, fields: list[dict]
) -> tuple[Callable[[bytes, bool], Values], Callable[[bytes], bytes]]:
    """The library's reading, raw or scaled, and its frame of these values; signals that
    overlap, or that no selector has, it knows only one by one.
    """
    from cantools.database import Message
    from cantools.database.errors import DecodeError

    parts, head = [message], (message.frame_id, message.name, message.length)
    names = {one["name"] for one in fields}
    known = [one for one in message.signals if one.name in names]
    selecting = {one.multiplexer_signal for one in known} - {
        None
    }  # a file may not mark them
    if (
        selecting
        or any("view" in one for one in fields)
        or len(known) < len(message.signals)
    ):
        selectors = {
            one.name: _said_of(one, is_multiplexer=True)
            for one in known
            if one.name in selecting
        }
        alone = [_said_of(one, is_multiplexer=False) for one in known]
        groups = [
            [*filter(None, [selectors.get(one.multiplexer_signal)]), one]
            for one in alone
        ]
        parts = [
            Message(*head, group, is_extended_frame=True, strict=False)
            for group in groups
        ]

    def read(data: bytes, scaled: bool) -> Iterator[tuple[Any, Values]]:
        for part in parts:
            with contextlib.suppress(
                DecodeError
            ):  # of a value of the selector that no signal has
                yield part, part.decode(data, False, scaled)

    def decode(data: bytes, scaled: bool) -> Values:
        return {
            name: value
            for _, values in read(data, scaled)
            for name, value in values.items()
        }

    def encode(data: bytes) -> bytes:
        bits = 0
        for part, values in read(data, False):
            bits |= int.from_bytes(
                part.encode(values, scaling=False, strict=False), "little"
            )
        return bits.to_bytes(message.length, "little")

    return decode, encode
