"""Random frames decoded by space-packet-parser, as the file that is generated tells it,
and by the reference codec.
"""

from __future__ import annotations

import math
import random
import warnings
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from pathlib import Path

from icdgen import codec
from icdgen.icd.frames import frame_fields
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.places import raw_fields_in
from tests.xtce.readback import SPACE


def differences(
    icd: Icd, node: Node, file: Path, frames: int, seed: int
) -> Iterator[tuple[int, str]]:
    """Of each frame how many values were compared, and what is not alike of them;
    nothing if all is.
    """
    from space_packet_parser.xtce.definitions import XtcePacketDefinition

    judge, chance = XtcePacketDefinition.from_xtce(file), random.Random(seed)
    for type_ in judge.parameter_types.values():
        if hasattr(type_, "enumeration"):
            type_.enumeration = _Any(type_.enumeration)
    names = {
        one.get("name"): alias(one)
        for one in ElementTree.parse(file).iterfind(f".//{SPACE}Parameter")
    }
    width = (
        next(
            one for one in judge.parameters.values() if one.name == "Id"
        ).parameter_type.encoding.size_in_bits
        // 8
    )
    for message in icd.messages_of(node):
        if message.telemetry_id is None:
            continue
        declared = icd.node(message.node)
        for _ in range(frames):
            frame = chance.randbytes(message.length)
            fixed = {
                one: one.const
                for one in frame_fields(message.layout, declared.orders)
                if one.const is not None
            }
            frame = codec.frame_of(frame, fixed)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                data = message.telemetry_id.to_bytes(width, "big") + frame
                found = judge.parse_bytes(data, root_container_name="TelemetryFrame")
            theirs = {names[name]: value for name, value in found.items()}
            yield _compare(declared, message, frame, theirs)


class _Any(dict):
    """Labels; every other value has one, too."""

    def __missing__(self, value: object) -> str:
        return f"value {value}"


def alias(parameter: ElementTree.Element) -> str:
    found = parameter.find(f"{SPACE}AliasSet/{SPACE}Alias")
    return parameter.get("name", "") if found is None else found.get("alias", "")


def _compare(
    node: Node, message: Message, frame: bytes, theirs: dict
) -> tuple[int, str]:
    raw = codec.decode(node, message, frame)
    for field in raw_fields_in(message.layout):
        ours, its = raw[field.name], theirs[field.name].raw_value
        if field.type == "float":
            ours = codec.float_value(field, int(ours))
        if field.is_bytes:
            its = its.encode("latin-1") if isinstance(its, str) else bytes(its)
        if its != ours and not (its != its and ours != ours):
            return 0, f"{message.name}: {field.name} is {ours!r}, theirs {its!r}"
        if field.has_formula and not isinstance(ours, bytes):
            exact, read = (
                codec.physical_double(field, int(raw[field.name])),
                float(theirs[field.name]),
            )
            if exact == exact and not math.isclose(
                exact or 0.0, read, rel_tol=1e-9, abs_tol=1e-12
            ):
                return 0, f"{message.name}: {field.name} is {exact}, theirs {read}"
    return len(raw_fields_in(message.layout)), ""
