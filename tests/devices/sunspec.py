"""Models of SunSpec (Modbus) as `icdgen import` reads those that pysunspec2 ships;
pysunspec2 judges.
"""

from __future__ import annotations

import copy
import importlib.resources
import json
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from icdgen.definitions import run
from icdgen.definitions.sunspec import SunSpec
from tests.devices.definition import Definition, Definitions

NOT_COMPARED = ("ID", "L", "Pad")  # what the library keeps for itself
ORDERS = {"byte_order": "big", "bit_order": "msb0"}


def models() -> Iterator[Definitions]:
    """All models of the package, as those of one device."""
    yield imported(trees())


def trees() -> list[dict]:
    """The JSON of all models of the package."""
    import sunspec2

    folder = importlib.resources.files(sunspec2) / "models" / "json"
    assert isinstance(folder, Path)
    return [
        json.loads(path.read_text(encoding="utf-8"))
        for path in sorted(folder.glob("model_*.json"))
    ]


def with_fixed_count(tree: dict, counter: str, count: int) -> dict:
    """A copy of a model for a device that has always so many of the groups that a point
    counts.
    """
    tree = copy.deepcopy(tree)
    for group in _groups(tree["group"]):
        if group.get("count") == counter:
            group["count"] = count
    next(point for point in tree["group"]["points"] if point["name"] == counter)[
        "value"
    ] = count
    return tree


def imported(trees: list[dict]) -> Definitions:
    """Models as `icdgen import` reads them from one file."""
    with tempfile.TemporaryDirectory() as name:
        file = Path(name, "sunspec.json")
        file.write_text(json.dumps(trees), encoding="utf-8")
        read = run.read(file, SunSpec())
    (tree,) = read.trees.values()
    structs = [
        {**one, "fields": [{**ORDERS, **part} for part in one["fields"]]}
        for one in tree["structs"]
    ]
    held = {one["id"]: one for one in tree["messages"]}
    why = {
        one.message.split("`")[1]: one.message.split(": ", 1)[1]
        for one in read.definitions.import_findings
        if one.severity == "error"
    }
    return Definitions(
        tree["node"],
        [_definition(one, held.get(one["id"]), structs, why) for one in trees],
        tree,
    )


def _definition(
    tree: dict, held: dict | None, structs: list[dict], why: dict[str, str]
) -> Definition:
    if held is None:
        return Definition(
            f"Model {tree['id']}",
            tree["id"],
            "telemetry",
            0,
            [],
            cause=why[tree["group"]["name"]],
        )
    fields = [{**ORDERS, **one} for one in held["fields"]]
    scaled = any(
        isinstance(point.get("sf"), str)
        for one in _groups(tree["group"])
        for point in one["points"]
    )
    return Definition(
        held["name"], held["id"], "telemetry", held["length"], fields, structs=structs,
        raw=lambda data: _read(tree, data, False),
        physical=lambda data: _read(tree, data, True),
        raw_only="factors that stand in another register" if scaled else "",
    )  # fmt: skip


def _groups(group: dict) -> Iterator[dict]:
    """A group and all in it."""
    yield group
    for one in group.get("groups", ()):
        yield from _groups(one)


def _read(tree: dict, data: bytes, scaled: bool) -> dict[str, object]:
    """What pysunspec2 makes of the block, raw or those that have a factor of their own;
    None is 'not implemented'.
    """
    from sunspec2.device import Model

    model: Any = Model(model_id=tree["id"], model_len=len(data) // 2 - 2, data=data)
    return dict(_values(model, "", scaled))


def _values(group: Any, before: str, scaled: bool) -> Iterator[tuple[str, object]]:
    for name, point in group.points.items():
        kind = point.pdef["type"]
        if name in NOT_COMPARED or kind in (
            "string",
            "pad",
            "ipaddr",
            "ipv6addr",
            "eui48",
        ):
            continue
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
