"""Telemetry packets that XTCE files define, as `icdgen import` reads them, compared
with space-packet-parser.
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
# Environment variable: a folder with further files, such as the tests of
# space-packet-parser.
OTHERS = "XTCE_FILES"


def packets() -> Iterator[Definitions]:
    """Yield a node for each file of the tests and of the folder in the environment."""
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
            finding.message
            for finding in read.definitions.import_findings
            if finding.code == xtce_parts.OPEN
        )
        # With random sizes the library does not decode all bytes of a frame.
        for message in tree["messages"]:
            if f"message `{message['name']}`" in open_:
                fields = message["fields"]
                message["fields"] = [part for part in fields if "size" not in part]
        missing = [
            finding.message
            for finding in read.definitions.import_findings
            if finding.severity == "error"
        ]
        # A message whose last fields are imported as bytes counts as missing.
        tree["messages"] = [
            message
            for message in tree["messages"]
            if not any(_is_cut(message, text) for text in missing)
        ]
        try:
            yield _definitions(path, tree, missing)
        except NotImplementedError:
            continue  # not supported by the library, such as arrays


def _is_cut(message: dict, finding: str) -> bool:
    """Return whether a finding reports that the end of a message is imported as bytes."""
    return finding.startswith(f"message `{message['name']}`: from ")


class _Any(dict):
    """Labels; values without a label get one."""

    def __missing__(self, value: object) -> str:
        return f"value {value}"


def _definitions(path: Path, tree: dict, missing: list[str]) -> Definitions:
    from space_packet_parser.xtce.definitions import XtcePacketDefinition

    reference = XtcePacketDefinition.from_xtce(path)
    # Without these changes the library would reject random values.
    for type_ in reference.parameter_types.values():
        if hasattr(type_, "enumeration"):
            type_.enumeration = _Any(type_.enumeration)
        if hasattr(type_.encoding, "leading_length_size"):
            type_.encoding.encoding = "latin-1"
        if hasattr(getattr(type_.encoding, "default_calibrator", None), "extrapolate"):
            type_.encoding.default_calibrator.extrapolate = True
    tree["messages"] = [
        message for message in tree["messages"] if message["kind"] == "telemetry"
    ]
    used = {
        field.get("enum")
        for message in tree["messages"]
        for field in message.get("fields", ())
    }
    tree["enums"] = [enum for enum in tree.get("enums", ()) if enum["name"] in used]
    messages = [_definition(reference, message, tree) for message in tree["messages"]]
    messages += [
        Definition(finding, 0, "telemetry", 0, [], cause=finding.split(": ", 1)[1])
        for finding in missing
    ]
    return Definitions(tree["node"], messages, tree)


def _definition(reference: Any, message: dict, tree: dict) -> Definition:
    orders = {"byte_order": "big", "bit_order": "msb0"}
    fields = [{**orders, **field} for field in message.get("fields", ())]
    read = _reader(reference, message, "protocol" in tree)
    return Definition(
        message["name"], message["id"], "telemetry", message["length"], fields,
        raw=lambda data: read(data, True), physical=lambda data: read(data, False),
    )  # fmt: skip


def _reader(
    reference: Any, message: dict, is_packet: bool
) -> Callable[[bytes, bool], Values]:
    """Return the library's decoder of a frame, which it needs in a complete packet.

    It starts with the outermost container. The library keeps only the last value of a
    parameter that occurs more than once; such parameters are left out.
    """
    from space_packet_parser.exceptions import UnrecognizedPacketTypeError

    root = reference.containers[message["name"]]
    while root.base_container_name:
        root = reference.containers[root.base_container_name]
    parts = {field["name"]: field for field in message.get("fields", ())}
    parts = {name: field for name, field in parts.items() if f"{name} 2" not in parts}

    def read(data: bytes, raw: bool) -> Values:
        head = (
            struct.pack(">HHH", message["id"], 0xC000, len(data) - 1 & 0xFFFF)
            if is_packet
            else b""
        )
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of bits behind the last field
            try:
                packet = reference.parse_bytes(
                    head + data, root_container_name=root.name
                )
            except (
                UnrecognizedPacketTypeError,
                ValueError,
            ) as error:  # a frame that ends before those of its constants
                raise NotSupported(str(error)) from None
        if raw:
            return {
                name: _raw(packet[name].raw_value) for name in parts if name in packet
            }
        return {
            name: float(packet[name])
            for name, part in parts.items()
            if name in packet and "formula" in part
        }

    return read


def _raw(value: Any) -> object:
    if isinstance(value, str):
        return value.encode("latin-1")
    if isinstance(value, bytes):
        return bytes(value)
    return float(value) if isinstance(value, float) else int(value)
