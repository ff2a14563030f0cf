"""SunSpec models (Modbus) that pysunspec2 contains, as `icdgen import` reads them,
compared with pysunspec2.
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

NOT_COMPARED = ("ID", "L", "Pad")  # points that the library does not return as values
ORDERS = {"byte_order": "big", "bit_order": "msb0"}


def models() -> Iterator[Definitions]:
    """Yield all models of the package, as models of one device."""
    yield imported(trees())


def trees() -> list[dict]:
    """Return the JSON of all models of the package."""
    import sunspec2

    folder = importlib.resources.files(sunspec2) / "models" / "json"
    assert isinstance(folder, Path)
    return [
        json.loads(path.read_text(encoding="utf-8"))
        for path in sorted(folder.glob("model_*.json"))
    ]


def with_fixed_count(tree: dict, counter: str, count: int) -> dict:
    """Return a copy of a model in which the groups that a point counts have a fixed
    count.
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
    """Return models as `icdgen import` reads them from one file."""
    with tempfile.TemporaryDirectory() as name:
        file = Path(name, "sunspec.json")
        file.write_text(json.dumps(trees), encoding="utf-8")
        read = run.read(file, SunSpec())
    (tree,) = read.trees.values()
    structs = [
        {**struct, "fields": [{**ORDERS, **part} for part in struct["fields"]]}
        for struct in tree["structs"]
    ]
    messages = {message["id"]: message for message in tree["messages"]}
    causes = {
        finding.message.split("`")[1]: finding.message.split(": ", 1)[1]
        for finding in read.definitions.import_findings
        if finding.severity == "error"
    }
    return Definitions(
        tree["node"],
        [
            _definition(model, messages.get(model["id"]), structs, causes)
            for model in trees
        ],
        tree,
    )


def _definition(
    tree: dict, message: dict | None, structs: list[dict], causes: dict[str, str]
) -> Definition:
    if message is None:
        return Definition(
            f"Model {tree['id']}",
            tree["id"],
            "telemetry",
            0,
            [],
            cause=causes[tree["group"]["name"]],
        )
    fields = [{**ORDERS, **field} for field in message["fields"]]
    has_scale_factors = any(
        isinstance(point.get("sf"), str)
        for group in _groups(tree["group"])
        for point in group["points"]
    )
    return Definition(
        message["name"], message["id"], "telemetry", message["length"], fields, structs=structs,
        raw=lambda data: _read(tree, data, False),
        physical=lambda data: _read(tree, data, True),
        raw_only="scale factors in another register" if has_scale_factors else "",
    )  # fmt: skip


def _groups(group: dict) -> Iterator[dict]:
    """Yield a group and all groups within it."""
    yield group
    for inner in group.get("groups", ()):
        yield from _groups(inner)


def _read(tree: dict, data: bytes, scaled: bool) -> dict[str, object]:
    """Return what pysunspec2 decodes from the block: raw values, or the scaled values
    of points with a constant factor.

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
        # A scale factor that is a number is constant; a name refers to another
        # register.
        elif type(point.pdef.get("sf")) is int and point.value is not None:
            yield before + name, point.cvalue
    for name, inner in group.groups.items():
        if isinstance(inner, list):
            for number, element in enumerate(inner):
                yield from _values(element, f"{before}{name}[{number}].", scaled)
        else:
            yield from _values(inner, f"{before}{name} ", scaled)
