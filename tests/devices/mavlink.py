"""Dialects of MAVLink 2 as `icdgen import` reads their XML; pymavlink judges."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

from icdgen.definitions import mavlink, run
from tests.devices.definition import Definition, Definitions


def dialects(*names: str) -> Iterator[Definitions]:
    """The dialects of these names: `common`."""
    for name in names or ("common",):
        dialect = import_module(f"pymavlink.dialects.v20.{name}")
        (tree,) = run.read(Path(str(dialect.__file__)).with_suffix(".xml"), mavlink.MavLink2()).trees.values()
        tree["node"]["name"] = f"mavlink_{name.lower()}"
        held = {one["name"]: one for one in tree["messages"]}
        messages = [_definition(dialect, one, held.get(one.msgname)) for one in dialect.mavlink_map.values()]
        yield Definitions(tree["node"], messages, tree)


def _definition(dialect: Any, message: Any, held: dict | None) -> Definition:
    head = message.msgname, message.id, "telemetry", message.unpacker.size
    if held is None:
        return Definition(*head, [], cause="not imported")
    return Definition(*head, held["fields"], raw=lambda data: _read(dialect, message, data), may_end_early=True)


def _read(dialect: Any, message: Any, data: bytes) -> dict[str, object]:
    """What pymavlink makes of the frame, in the envelope that it wants."""
    head = bytes([len(data), 0, 0, 0, 1, 1]) + message.id.to_bytes(3, "little")
    crc = dialect.x25crc(head + data)
    crc.accumulate(bytes([message.crc_extra]))
    found = dialect.MAVLink(None).decode(bytearray(b"\xfd" + head + data + struct.pack("<H", crc.crc)))
    names = message.ordered_fieldnames
    return {
        name: getattr(found, f"_{name}_raw", getattr(found, name)) for name in names
    }  # of text its bytes, up to a NUL
