"""Packets that XTCE defines, as `icdgen import` reads it; space-packet-parser judges,
which reads telemetry.
"""

from __future__ import annotations

import os
import struct
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from icdgen.definitions import run, xtce, xtce_parts
from icdgen.diagnostics import Findings
from tests.conftest import ROOT
from tests.devices.definition import Definition, Definitions, NotSupported, Values

OWN = ROOT / "tests" / "definitions" / "files"
# In the environment: a folder with files of others, such as the tests of
# space-packet-parser.
OTHERS = "XTCE_FILES"


def packets() -> Iterator[Definitions]:
    """A node for each file of ours, and of the folder that the environment names."""
    folders = [OWN, *map(Path, filter(None, [os.environ.get(OTHERS)]))]
    reader = xtce.Xtce()
    for path in (path for folder in folders for path in sorted(folder.rglob("*.xml"))):
        if not reader.knows(path.read_text("utf-8")):
            continue
        try:
            read = run.read(path, reader)
        except Findings:
            continue
        (tree,) = read.trees.values()
        open_ = "".join(
            one.message
            for one in read.definitions.import_findings
            if one.code == xtce_parts.OPEN
        )
        for one in tree[
            "messages"
        ]:  # of random sizes the library reads something else than all that is there
            if f"message `{one['name']}`" in open_:
                one["fields"] = [part for part in one["fields"] if "size" not in part]
        missing = [
            one.message
            for one in read.definitions.import_findings
            if one.severity == "error"
        ]
        # a message that ends in bytes for fields which are not imported counts as one
        # that is missing
        tree["messages"] = [
            one
            for one in tree["messages"]
            if not any(_is_cut(one, text) for text in missing)
        ]
        try:
            yield _definitions(path, tree, missing)
        except NotImplementedError:
            continue  # of what the library does not know, such as arrays


def _is_cut(message: dict, finding: str) -> bool:
    """Whether a finding says that only bytes are held of the end of a message."""
    return finding.startswith(f"message `{message['name']}`: from ")


class _Any(dict):
    """Labels; every other value has one, too."""

    def __missing__(self, value: object) -> str:
        return f"value {value}"


def _definitions(path: Path, tree: dict, missing: list[str]) -> Definitions:
    from space_packet_parser.xtce.definitions import XtcePacketDefinition

    judge = XtcePacketDefinition.from_xtce(path)
    for (
        type_
    ) in judge.parameter_types.values():  # of which it would refuse random values
        if hasattr(type_, "enumeration"):
            type_.enumeration = _Any(type_.enumeration)
        if hasattr(type_.encoding, "leading_length_size"):
            type_.encoding.encoding = "latin-1"
        if hasattr(getattr(type_.encoding, "default_calibrator", None), "extrapolate"):
            type_.encoding.default_calibrator.extrapolate = True
    tree["messages"] = [one for one in tree["messages"] if one["kind"] == "telemetry"]
    used = {
        one.get("enum")
        for message in tree["messages"]
        for one in message.get("fields", ())
    }
    tree["enums"] = [one for one in tree.get("enums", ()) if one["name"] in used]
    messages = [_definition(judge, one, tree) for one in tree["messages"]]
    messages += [
        Definition(said, 0, "telemetry", 0, [], cause=said.split(": ", 1)[1])
        for said in missing
    ]
    return Definitions(tree["node"], messages, tree)


def _definition(judge: Any, held: dict, tree: dict) -> Definition:
    orders = {"byte_order": "big", "bit_order": "msb0"}
    fields = [{**orders, **one} for one in held.get("fields", ())]
    read = _reader(judge, held, "protocol" in tree)
    return Definition(
        held["name"], held["id"], "telemetry", held["length"], fields,
        raw=lambda data: read(data, True), physical=lambda data: read(data, False),
    )  # fmt: skip


def _reader(judge: Any, held: dict, is_packet: bool) -> Callable[[bytes, bool], Values]:
    """The library's reading of a frame, in the packet that it wants, from the outermost
    container on; of a parameter that stands there more than once it keeps only the last
    value.
    """
    from space_packet_parser.exceptions import UnrecognizedPacketTypeError

    root = judge.containers[held["name"]]
    while root.base_container_name:
        root = judge.containers[root.base_container_name]
    parts = {one["name"]: one for one in held.get("fields", ())}
    parts = {name: one for name, one in parts.items() if f"{name} 2" not in parts}

    def read(data: bytes, raw: bool) -> Values:
        head = (
            struct.pack(">HHH", held["id"], 0xC000, len(data) - 1 & 0xFFFF)
            if is_packet
            else b""
        )
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of bits behind the last field
            try:
                found = judge.parse_bytes(head + data, root_container_name=root.name)
            except (
                UnrecognizedPacketTypeError,
                ValueError,
            ) as error:  # a frame that ends before those of its constants
                raise NotSupported(str(error)) from None
        if raw:
            return {
                name: _raw(found[name].raw_value) for name in parts if name in found
            }
        return {
            name: float(found[name])
            for name, part in parts.items()
            if name in found and "formula" in part
        }

    return read


def _raw(value: Any) -> object:
    if isinstance(value, str):
        return value.encode("latin-1")
    return (
        bytes(value)
        if isinstance(value, bytes)
        else float(value)
        if isinstance(value, float)
        else int(value)
    )
