"""Dialects of MAVLink 2 and 1 as `icdgen import` reads their XML; pymavlink judges."""

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
    """All dialects that pymavlink ships, for links of version 2."""
    yield from _all("v20", mavlink.MavLink2())


def dialects_of_version_1() -> Iterator[Definitions]:
    """Those for links of version 1."""
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
        held = {one["name"]: one for one in tree["messages"]}
        messages = [
            _definition(dialect, one, held.get(one.msgname))
            for one in dialect.mavlink_map.values()
        ]
        yield Definitions(tree["node"], messages, tree)


def _definition(dialect: Any, message: Any, held: dict | None) -> Definition:
    head = message.msgname, message.id, "telemetry", message.unpacker.size
    if held is None:
        return Definition(*head, [], cause="not imported")
    is_cut = "may_end_early" in held
    return Definition(
        *head,
        held["fields"],
        raw=lambda data: _read(dialect, message, data),
        may_end_early=is_cut,
    )


def _read(dialect: Any, message: Any, data: bytes) -> dict[str, object]:
    """What pymavlink makes of the frame, in the packet format that it wants."""
    if dialect.WIRE_PROTOCOL_VERSION == "1.0":
        start, head = b"\xfe", bytes([len(data), 0, 1, 1, message.id])
    else:
        start, head = (
            b"\xfd",
            bytes([len(data), 0, 0, 0, 1, 1]) + message.id.to_bytes(3, "little"),
        )
    crc = dialect.x25crc(head + data)
    crc.accumulate(bytes([message.crc_extra]))
    found = dialect.MAVLink(None).decode(
        bytearray(start + head + data + struct.pack("<H", crc.crc))
    )
    names = message.ordered_fieldnames
    return {
        name: getattr(found, f"_{name}_raw", getattr(found, name)) for name in names
    }  # of text its bytes, up to a NUL
