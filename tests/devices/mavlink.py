"""Dialects of MAVLink 2 and 1 as `icdgen import` reads their XML, compared with
pymavlink.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

from icdgen.definitions import mavlink, run
from tests.devices.definition import Definition, Definitions

FIRST = "common"


def dialects() -> Iterator[Definitions]:
    """Yield all dialects that pymavlink ships, for links of version 2."""
    yield from _all("v20", mavlink.MavLink2())


def dialects_of_version_1() -> Iterator[Definitions]:
    """Yield all dialects that have messages for links of version 1."""
    yield from _all("v10", mavlink.MavLink1())


def _all(version: str, reader: mavlink.MavLink2) -> Iterator[Definitions]:
    package = import_module(f"pymavlink.dialects.{version}")
    files = sorted(
        Path(str(package.__path__[0])).glob("*.xml"),
        key=lambda path: (path.stem != FIRST, path.stem),
    )
    for file in files:
        dialect = import_module(f"{package.__name__}.{file.stem}")
        if not dialect.mavlink_map:
            continue  # all its ids are too large for version 1
        (tree,) = run.read(file, reader).trees.values()
        tree["node"]["name"] = f"{reader.name}_{file.stem.lower()}"
        imported = {message["name"]: message for message in tree["messages"]}
        messages = [
            _definition(dialect, message, imported.get(message.msgname))
            for message in dialect.mavlink_map.values()
        ]
        yield Definitions(tree["node"], messages, tree)


def _definition(dialect: Any, message: Any, imported: dict | None) -> Definition:
    head = message.msgname, message.id, "telemetry", message.unpacker.size
    if imported is None:
        return Definition(*head, [], cause="not imported")
    is_cut = "may_end_early" in imported
    return Definition(
        *head,
        imported["fields"],
        raw=lambda data: _read(dialect, message, data),
        may_end_early=is_cut,
    )


def _read(dialect: Any, message: Any, data: bytes) -> dict[str, object]:
    """Return what pymavlink decodes from the frame, which is put into its packet
    format.
    """
    if dialect.WIRE_PROTOCOL_VERSION == "1.0":
        # Length, sequence number, system, component, id; version 2 also has two bytes
        # of flags.
        start, head = b"\xfe", bytes([len(data), 0, 1, 1, message.id])
    else:
        start, head = (
            b"\xfd",
            bytes([len(data), 0, 0, 0, 1, 1]) + message.id.to_bytes(3, "little"),
        )
    crc = dialect.x25crc(head + data)
    crc.accumulate(bytes([message.crc_extra]))
    decoded = dialect.MAVLink(None).decode(
        bytearray(start + head + data + struct.pack("<H", crc.crc))
    )
    names = message.ordered_fieldnames
    return {
        name: getattr(decoded, f"_{name}_raw", getattr(decoded, name)) for name in names
    }  # the bytes of text, up to a NUL
