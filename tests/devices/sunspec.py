"""Models of SunSpec (Modbus) as pysunspec2 has them: blocks of 16-bit registers, the most significant first."""

from __future__ import annotations

import importlib.resources
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.devices.definition import Definition, Definitions, NotHeld, node, unit

TYPES = {
    "int16": ("int", 1), "int32": ("int", 2), "int64": ("int", 4), "sunssf": ("int", 1),
    "uint16": ("uint", 1), "uint32": ("uint", 2), "uint64": ("uint", 4), "count": ("uint", 1), "pad": ("uint", 1),
    "acc16": ("uint", 1), "acc32": ("uint", 2), "acc64": ("uint", 4), "enum16": ("uint", 1), "enum32": ("uint", 2),
    "bitfield16": ("uint", 1), "bitfield32": ("uint", 2), "float32": ("float", 2), "string": ("text", 0),
    "eui48": ("bytes", 4), "ipaddr": ("bytes", 2), "ipv6addr": ("bytes", 8),
}  # fmt: skip
COMPARED = ("int", "uint", "float")
NOT_COMPARED = ("ID", "L", "Pad")


def models() -> Iterator[Definitions]:
    """All models of the package."""
    import sunspec2

    folder = importlib.resources.files(sunspec2) / "models" / "json"
    assert isinstance(folder, Path)
    trees = [json.loads(path.read_text(encoding="utf-8")) for path in folder.glob("model_*.json")]
    messages = [_definition(tree) for tree in sorted(trees, key=lambda tree: int(tree["id"]))]
    yield Definitions(node("sunspec", "SunSpec", id_bits=16, byte_order="big", bit_order="msb0"), messages)


def _definition(tree: dict) -> Definition:
    name = f"Model {tree['id']}"
    try:
        fields, length = _fields(tree["group"])
    except NotHeld as error:
        return Definition(name, tree["id"], "telemetry", 0, [], cause=str(error))
    return Definition(name, tree["id"], "telemetry", length, fields, raw=lambda data: _read(tree["id"], fields, data))


def _fields(group: dict) -> tuple[list[dict], int]:
    if group.get("groups"):
        raise NotHeld("a repeated block")
    fields, at = [], 0
    for point in group["points"]:
        if isinstance(point.get("sf"), str):
            raise NotHeld("a factor that stands in another register")
        type_, registers = TYPES[point["type"]]
        bits = 16 * (registers or point["size"])
        one = {"at": at, "bits": bits, "name": point["name"], "type": type_, **unit(point.get("units"))}
        if point["type"] in ("enum16", "enum32", "bitfield16", "bitfield32", "pad", "count", "sunssf"):
            one.pop("unit", None)
        if point["name"] not in NOT_COMPARED:
            one |= _special(point["type"])
        if point.get("sf"):
            one["formula"] = f"raw*1e{point['sf']}"
        fields.append(one)
        at += bits
    return fields, at // 8


def _special(kind: str) -> dict:
    """The key of what the library takes for 'not implemented'; of floats every NaN."""
    from sunspec2 import mb

    if TYPES[kind][0] not in COMPARED:
        return {}
    value = getattr(mb, f"SUNS_UNIMPL_{'UINT16' if kind == 'count' else kind.upper()}")
    return {"special": [{"value": "nan" if kind == "float32" else value, "meaning": "not implemented"}]}


def _read(number: int, fields: list[dict], data: bytes) -> dict[str, object]:
    """What pysunspec2 makes of the block; None is 'not implemented'."""
    from sunspec2.device import Model

    data = number.to_bytes(2, "big") + data[2:]
    points: Any = Model(model_id=number, data=data).points
    return {
        one["name"]: points[one["name"]].value
        for one in fields
        if one["type"] in COMPARED and one["name"] not in NOT_COMPARED
    }
