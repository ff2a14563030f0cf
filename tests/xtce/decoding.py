"""Compares how space-packet-parser, with the generated file, and the reference codec
decode random frames.
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
    """Yield for each frame the number of compared values, and the first difference or
    an empty text.
    """
    from space_packet_parser.xtce.definitions import XtcePacketDefinition

    library, chance = XtcePacketDefinition.from_xtce(file), random.Random(seed)
    # Random frames have values without a label, which the library would reject.
    for type_ in library.parameter_types.values():
        if hasattr(type_, "enumeration"):
            type_.enumeration = _Any(type_.enumeration)
    names = {
        parameter.get("name"): alias(parameter)
        for parameter in ElementTree.parse(file).iterfind(f".//{SPACE}Parameter")
    }
    (id_type,) = (
        parameter.parameter_type
        for parameter in library.parameters.values()
        if parameter.name == "Id"
    )
    width = id_type.encoding.size_in_bits // 8
    for message in icd.messages_of(node):
        if message.telemetry_id is None:
            continue
        declared = icd.node(message.node)
        for _ in range(frames):
            frame = chance.randbytes(message.length)
            fixed = {
                field: field.const
                for field in frame_fields(message.layout, declared.orders)
                if field.const is not None
            }
            # Random bytes would violate the constants of the message.
            frame = codec.with_numbers(frame, fixed)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                data = message.telemetry_id.to_bytes(width, "big") + frame
                packet = library.parse_bytes(data, root_container_name="TelemetryFrame")
            theirs = {names[name]: value for name, value in packet.items()}
            yield _compare(declared, message, frame, theirs)


class _Any(dict):
    """Labels; values without a label get one, because the library rejects unknown
    values.
    """

    def __missing__(self, value: object) -> str:
        return f"value {value}"


def alias(parameter: ElementTree.Element) -> str:
    element = parameter.find(f"{SPACE}AliasSet/{SPACE}Alias")
    return parameter.get("name", "") if element is None else element.get("alias", "")


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
