"""Models of SunSpec (Modbus) as pysunspec2 has them: blocks of 16-bit registers, the most significant first."""

from __future__ import annotations

import importlib.resources
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.devices.definition import Definition, Definitions, NotHeld, node, open_structs, unit

TYPES = {
    "int16": ("int", 1), "int32": ("int", 2), "int64": ("int", 4), "sunssf": ("int", 1),
    "uint16": ("uint", 1), "uint32": ("uint", 2), "uint64": ("uint", 4), "count": ("uint", 1), "pad": ("uint", 1),
    "acc16": ("uint", 1), "acc32": ("uint", 2), "acc64": ("uint", 4), "enum16": ("uint", 1), "enum32": ("uint", 2),
    "bitfield16": ("uint", 1), "bitfield32": ("uint", 2), "float32": ("float", 2), "string": ("text", 0),
    "eui48": ("bytes", 4), "ipaddr": ("bytes", 2), "ipv6addr": ("bytes", 8),
}  # fmt: skip
COMPARED = ("int", "uint", "float")
NOT_COMPARED = ("ID", "L", "Pad")
LONGEST = 2048  # bytes of a model, where only its length says how often a block is there


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
    fields, structs, group = [], [], tree["group"]
    scaled = [point for one in _groups(group) for point in one["points"] if isinstance(point.get("sf"), str)]
    counters = {one["count"] for one in _groups(group) if "count" in one}
    try:
        length = _fields(group, fields, 0, "", counters)
        for one in group.get("groups", ()):
            if fields and "up_to" in fields[-1]:
                raise NotHeld("more behind a repeated block")
            if "count" in one:
                end, struct = _open_end(name, one, fields, length)
                fields.append(end)
                structs.append(struct)
            else:
                length = _fields(one, fields, length, f"{one['name']} ", counters)
    except NotHeld as error:
        return Definition(name, tree["id"], "telemetry", 0, [], cause=str(error))
    return Definition(
        name, tree["id"], "telemetry", length // 8, fields, structs=structs,
        raw=lambda data: _read(tree, data, False),
        physical=lambda data: _read(tree, data, True),
        raw_only="factors that stand in another register" if scaled else "",
    )  # fmt: skip


def _groups(group: dict) -> Iterator[dict]:
    """A group and all in it."""
    yield group
    for one in group.get("groups", ()):
        yield from _groups(one)


def _open_end(owner: str, group: dict, fields: list[dict], at: int) -> tuple[dict, dict]:
    """A block that a register counts, or that is repeated up to the end. Raises `NotHeld`."""
    if group.get("groups"):
        raise NotHeld("a repeated block in another")
    parts: list[dict] = []
    bits = _fields(group, parts, 0, "", set())
    counter = group["count"] or "rest"
    return open_structs(owner, group["name"], at, parts, bits, counter, (8 * LONGEST - at) // bits)


def _fields(group: dict, fields: list[dict], at: int, before: str, counters: set[str]) -> int:
    """Appends the points of a group; where they end."""
    for point in group["points"]:
        type_, registers = TYPES[point["type"]]
        bits = 16 * (registers or point["size"])
        one = {"at": at, "bits": bits, "name": before + point["name"], "type": type_, **unit(point.get("units"))}
        if point["type"] in ("enum16", "enum32", "bitfield16", "bitfield32", "pad", "count", "sunssf"):
            one.pop("unit", None)
        if point["name"] in counters:
            one["bit_order"] = "msb0"  # for who makes frames
        elif point["name"] not in NOT_COMPARED:
            one |= _special(point["type"])
        if type(point.get("sf")) is int:
            one["formula"] = f"raw*1e{point['sf']}"
        fields.append(one)
        at += bits
    return at


def _special(kind: str) -> dict:
    """The key of what the library takes for 'not implemented'; of floats every NaN."""
    from sunspec2 import mb

    if TYPES[kind][0] not in COMPARED:
        return {}
    value = getattr(mb, f"SUNS_UNIMPL_{'UINT16' if kind == 'count' else kind.upper()}")
    return {"special": [{"value": "nan" if kind == "float32" else value, "meaning": "not implemented"}]}


def _read(tree: dict, data: bytes, scaled: bool) -> dict[str, object]:
    """What pysunspec2 makes of the block, raw or those that have a factor of their own; None is 'not implemented'."""
    from sunspec2.device import Model

    data = int(tree["id"]).to_bytes(2, "big") + data[2:]
    model: Any = Model(model_id=tree["id"], model_len=len(data) // 2 - 2, data=data)
    return dict(_values(model, "", scaled))


def _values(group: Any, before: str, scaled: bool) -> Iterator[tuple[str, object]]:
    for name, point in group.points.items():
        if TYPES[point.pdef["type"]][0] in COMPARED and name not in NOT_COMPARED:
            if not scaled:
                yield before + name, point.value
            elif type(point.pdef.get("sf")) is int and point.value is not None:
                yield before + name, point.cvalue
    for name, inner in group.groups.items():
        if isinstance(inner, list):
            for number, one in enumerate(inner):
                yield from _values(one, f"{before}{name}[{number}].", scaled)
        else:
            yield from _values(inner, f"{before}{name} ", scaled)
