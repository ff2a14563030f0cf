"""CAN databases of the opendbc package as `icdgen import` reads them, compared with
cantools.
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
    """Yield every DBC file of the package whose name contains ``words``.

    Messages that cantools would reject because of a fault elsewhere in the file are
    decoded without these faults.
    """
    reader = can.Dbc()
    for number, path in enumerate(files()):
        if words not in path.name:
            continue
        try:
            read = run.read(path, reader)
        except Findings:
            continue  # parts of databases, without a message
        reference = reader.database(
            str(path), path.read_bytes(), model.Definitions(str(path))
        )
        (tree,) = read.trees.values()
        tree["node"]["name"] = f"{tree['node']['name'][:35].rstrip('_')}_{number}"
        imported = {message["name"]: message for message in tree["messages"]}
        messages = [
            _definition(
                message, imported.get(message.name), tree["node"], read.definitions
            )
            for message in reference.messages
        ]
        yield Definitions(tree["node"], messages, tree)


def files() -> list[Path]:
    """Return the DBC files of the package, sorted by name."""
    import opendbc

    folder = importlib.resources.files(opendbc)
    assert isinstance(folder, Path)
    return sorted(folder.rglob("*.dbc"), key=lambda path: path.name)


def _definition(
    message: Any, imported: dict | None, node: dict, read: model.Definitions
) -> Definition:
    head = (
        message.name,
        message.frame_id if imported is None else int(imported["id"]),
        "telemetry",
        message.length,
    )
    if imported is None:
        findings = [
            finding.message
            for finding in read.import_findings
            if f"message `{message.name}` is not imported" in finding.message
        ]
        code = re.search(r"ICD\d{3}", findings[0])
        return Definition(
            *head, [], cause=code[0] if code else findings[0].split(": ", 1)[1]
        )
    orders = {key: imported.get(key, node[key]) for key in ("byte_order", "bit_order")}
    fields = [
        {**orders, **field, **_when(field)} for field in imported.get("fields", ())
    ]
    decode, encode = _reader(message, fields)
    return Definition(
        *head,
        fields,
        raw=lambda data: decode(data, False),
        physical=lambda data: decode(data, True),
        encoded=encode,
    )


def _when(field: dict) -> dict:
    """Return the key of the condition of a field, with a list of numbers for each name."""
    condition = field.get("when", {})
    listed = {
        name: [
            int(number) for number in (value if isinstance(value, list) else [value])
        ]
        for name, value in condition.items()
    }
    return {"when": listed} if listed else {}


def _with_role(signal: Any, is_multiplexer: bool) -> Any:
    """Return a copy of the library's signal that is, or is not, a multiplexer."""
    changed = copy(signal)
    changed.is_multiplexer = is_multiplexer
    return changed


def _reader(
    message: Any, fields: list[dict]
) -> tuple[Callable[[bytes, bool], Values], Callable[[bytes], bytes]]:
    """Return the library's decoder and its encoder of the raw values of a frame.

    The decoder takes the frame and whether to return physical values. cantools cannot
    decode overlapping signals, or signals of no selector value, together. They are
    decoded one by one.
    """
    from cantools.database import Message
    from cantools.database.errors import DecodeError

    parts, head = [message], (message.frame_id, message.name, message.length)
    names = {signal["name"] for signal in fields}
    signals = [signal for signal in message.signals if signal.name in names]
    selecting = {signal.multiplexer_signal for signal in signals} - {
        None
    }  # a file may not mark them
    if (
        selecting
        or any("view" in signal for signal in fields)
        or len(signals) < len(message.signals)
    ):
        selectors = {
            signal.name: _with_role(signal, is_multiplexer=True)
            for signal in signals
            if signal.name in selecting
        }
        unmultiplexed = [_with_role(signal, is_multiplexer=False) for signal in signals]
        groups = [
            [*filter(None, [selectors.get(signal.multiplexer_signal)]), signal]
            for signal in unmultiplexed
        ]
        parts = [
            # Without `strict`, cantools accepts signals that exceed the message.
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
