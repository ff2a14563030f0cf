"""CAN databases of the opendbc package: read as `icdgen import` reads them; cantools judges."""

from __future__ import annotations

import importlib.resources
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from icdgen.definitions import can, model, run
from tests.devices.definition import Definition, Definitions, NotHeld, Values


def databases() -> Iterator[Definitions]:
    """Every DBC file of the package. cantools judges the text without the faults for which it would refuse all of it."""
    for number, path in enumerate(files()):
        reader = can.Dbc()
        read = run.read(path, reader)
        judge = reader.database(str(path), path.read_bytes(), model.Definitions(str(path)))
        for tree in read.trees.values():
            tree["node"]["name"] = f"{tree['node']['name'][:35].rstrip('_')}_{number}"
            held = {one["name"]: one for one in tree["messages"]}
            messages = [
                _definition(message, held.get(message.name), tree, read.definitions) for message in judge.messages
            ]
            yield Definitions(tree["node"], messages, tree)


def files() -> list[Path]:
    """The DBC files of the package, by name."""
    import opendbc

    folder = importlib.resources.files(opendbc)
    assert isinstance(folder, Path)
    return sorted(folder.rglob("*.dbc"), key=lambda path: path.name)


def _definition(message: Any, held: dict | None, tree: dict, read: model.Definitions) -> Definition:
    if held is None:
        said = next(
            (one.message for one in read.troubles if f"message `{message.name}` is not held" in one.message), "lost"
        )
        cause = re.search(r"ICD\d{3}", said)
        return Definition(
            message.name, message.frame_id, "telemetry", message.length, [], cause=cause[0] if cause else said
        )
    orders = {key: held.get(key, tree["node"][key]) for key in ("byte_order", "bit_order")}
    fields = [{**orders, **one} for one in held.get("fields", ())]
    decode, encode = _reader(message, fields)
    return Definition(
        message.name, message.frame_id, "telemetry", message.length, fields,
        raw=lambda data: decode(data, False), physical=lambda data: decode(data, True), encoded=encode,
    )  # fmt: skip


def _reader(message: Any, fields: list[dict]) -> tuple[Callable[[bytes, bool], Values], Callable[[bytes], bytes]]:
    """The library's reading, raw or scaled, and its own frame of these values; signals that overlap it knows only one by one."""
    from cantools.database import DecodeError, Message

    parts, names = [message], {one["name"] for one in fields}
    if any("view" in one for one in fields) or any(signal.name not in names for signal in message.signals):
        head = message.frame_id, message.name, message.length
        known = [signal for signal in message.signals if signal.name in names]
        parts = [Message(*head, [signal], is_extended_frame=True, strict=False) for signal in known]

    def decode(data: bytes, scaled: bool) -> Values:
        try:
            return {name: value for part in parts for name, value in part.decode(data, False, scaled).items()}
        except DecodeError as error:  # a multiplexer has a value without signals
            raise NotHeld(str(error)) from None

    def encode(data: bytes) -> bytes:
        bits = 0
        for part in parts:
            values = part.decode(data, False, False)
            bits |= int.from_bytes(part.encode(values, scaling=False, strict=False), "little")
        return bits.to_bytes(message.length, "little")

    return decode, encode
