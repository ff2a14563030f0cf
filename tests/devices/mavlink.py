"""Dialects of MAVLink 2 as pymavlink has them."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from tests.devices.definition import Definition, Definitions, node, unit

SIZES = {"int8_t": 8, "uint8_t": 8, "char": 8, "int16_t": 16, "uint16_t": 16, "int32_t": 32, "uint32_t": 32,
         "int64_t": 64, "uint64_t": 64, "float": 32, "double": 64}  # fmt: skip


def dialects(*names: str) -> Iterator[Definitions]:
    """The dialects of these names: `common`."""
    for name in names or ("common",):
        dialect = import_module(f"pymavlink.dialects.v20.{name}")
        unknown = _not_known(Path(str(dialect.__file__)).with_suffix(".xml"))
        messages = [_definition(dialect, message, unknown) for message in dialect.mavlink_map.values()]
        yield Definitions(node(f"mavlink_{name}", f"MAVLink {name}", id_bits=24), messages)


def _not_known(file: Path) -> dict[tuple[str, str], str]:
    """What the dialect says stands for 'not known', by message and field."""
    if not file.is_file():
        return {}
    found = (
        (message.get("name", ""), one)
        for message in ElementTree.parse(file).iter("message")
        for one in message.iter("field")
    )
    return {(name, one.get("name", "")): one.get("invalid", "") for name, one in found if "invalid" in one.attrib}


def _special(text: str, one: dict) -> dict:
    """The key of it, where the field can have it: `NaN`, of each element `[NaN]`, `UINT16_MAX`, `-1000`."""
    text = text.strip("[]:,")
    if one["type"] == "float" and text.lower() == "nan":
        return {"special": [{"value": "nan", "meaning": "not known"}]}
    most = re.fullmatch(r"(U?)INT(8|16|32|64)_MAX", text)
    if most is None and not re.fullmatch(r"-?[0-9]+|0x[0-9A-Fa-f]+", text):
        return {}
    value = (1 << int(most[2]) - (not most[1])) - 1 if most else int(text, 0)
    low, high = (
        (-(1 << one["bits"] - 1), (1 << one["bits"] - 1) - 1) if one["type"] == "int" else (0, (1 << one["bits"]) - 1)
    )
    fits = one["type"] == "float" or low <= value <= high
    return {"special": [{"value": value, "meaning": "not known"}]} if fits else {}


def _definition(dialect: Any, message: Any, unknown: dict[tuple[str, str], str]) -> Definition:
    fields, at = [], 0
    types = dict(zip(message.fieldnames, message.fieldtypes, strict=True))
    for name, count in zip(message.ordered_fieldnames, message.array_lengths, strict=True):
        kind = types[name]
        one = {"at": at, "name": name, "bits": SIZES[kind], **unit(message.fieldunits_by_name.get(name, ""))}
        if kind == "char":
            one |= {"type": "text", "bits": 8 * max(count, 1)}
            at += 8 * max(count, 1)
        else:
            one |= {"type": "float" if kind in ("float", "double") else "uint" if kind[0] == "u" else "int"}
            one |= {"count": count} if count else {}
            one |= _special(unknown.get((message.msgname, name), ""), one)
            at += SIZES[kind] * max(count, 1)
        fields.append(one)
    return Definition(
        message.msgname, message.id, "telemetry", at // 8, fields, raw=lambda data: _read(dialect, message, data)
    )


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
