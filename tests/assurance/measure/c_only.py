"""Source of the program that tests the functions of the generated C that other
languages do not have: see ``c_only.c.j2``.

The reference codec computes the expected values.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import jinja2

from icdgen import codec
from icdgen.backends.c import physical
from icdgen.backends.c.names import part_name, stem
from icdgen.backends.c.text import literal
from icdgen.describe import (
    Description,
    FieldDescription,
    MessageDescription,
    NodeDescription,
    describe,
)
from icdgen.describe.accessors import accessors_of
from icdgen.describe.contained import contained_messages
from icdgen.describe.links import links_of
from icdgen.icd.model import Icd
from icdgen.vectors.make import FrameVector, message_vectors

HERE = Path(__file__).parent


def source(icd: Icd) -> str:
    """Return the source of the program."""
    description = describe(icd)
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE), trim_blocks=True, lstrip_blocks=True
    )
    return environment.get_template("c_only.c.j2").render(
        nodes=[_node(description, node) for node in description.nodes],
        messages=[
            _message(message) for node in description.nodes for message in node.messages
        ],
        longest=max(
            1, *(message.length for node in icd.nodes for message in node.messages)
        ),
    )


def _message(message: MessageDescription) -> dict[str, Any]:
    integers = {
        field.model.name: (accessor.name, accessor.integer_access)
        for field in message.fields
        for accessor in accessors_of(field, "integer")
    }
    beyond = []
    for field in message.fields:
        if field.model.name in integers:
            name, integer = integers[field.model.name]
            limit = 1 << (integer.bits - 1)
            steps = (field.model.raw_min - 1, field.model.raw_max + 1)
            values = (
                int(field.model.scale.physical(raw) * integer.scale.per)
                for raw in steps
            )
            beyond += [
                (name, physical.int64(value))
                for value in values
                if -limit <= value < limit
            ]
    rows = (
        message_vectors(message.node, message.model).rows
        if message.model.length
        else ()
    )
    return {
        "stem": stem(message),
        "length": message.model.length,
        "beyond": beyond,
        "rows": [
            _row(message, row, integers) for row in (rows if integers else rows[:2])
        ],
        "fields": [literal(field.model.name) for field in message.members],
    }


def _parts(message: MessageDescription, frame: bytes) -> Iterator[dict[str, Any]]:
    """Yield each part of a message: the call that returns it, and its bytes.

    The bytes are empty if the part does not begin at a byte. The part is decoded and
    encoded again, because its reserved bits can have values of other fields of the
    message.
    """
    for part in contained_messages(message):
        for index, begin in enumerate(part.positions):
            index_argument = f"{index}u, " if len(part.positions) > 1 else ""
            call = f"{stem(message)}_{part_name(part.message)}(&message, {index_argument}&part)"
            yield {
                "stem": stem(part.message),
                "call": call,
                "bytes": _part(part.message, frame, begin),
            }
            if index_argument and begin == part.positions[-1]:
                beyond = call.replace(index_argument, f"{len(part.positions)}u, ")
                yield {
                    "stem": stem(part.message),
                    "call": f"CHECK({beyond} == ICD_ERROR_RANGE)",
                    "bytes": "",
                }


def _part(part: MessageDescription, frame: bytes, begin: int) -> str:
    if begin % 8:
        return ""
    own = frame[begin // 8 :][: part.model.length]
    return _bytes(
        codec.encode(part.node, part.model, codec.decode(part.node, part.model, own))
    )


def _row(
    message: MessageDescription, row: FrameVector, integers: dict[str, Any]
) -> dict[str, Any]:
    values = []
    for name, (accessor, integer) in integers.items():
        exact: Fraction = row.physical[name] * integer.scale.per
        assert exact.denominator == 1
        values.append((accessor, physical.int64(int(exact))))
    encoded = "" if row.encoded == row.frame else _bytes(row.encoded)
    return {
        "bytes": _bytes(row.frame),
        "encoded": encoded,
        "wholes": values,
        "parts": list(_parts(message, row.encoded)),
    }


def _bytes(data: bytes) -> str:
    return ", ".join(f"{byte}u" for byte in data)


def _node(description: Description, node: NodeDescription) -> dict[str, Any]:
    link = links_of(description).get(node.name)
    buses = []
    if link is not None:
        supported = (
            ("uart", link.facts.framing),
            ("i2c", link.facts.i2c_address),
            ("can", link.can),
        )
        buses = [bus for bus, form in supported if form is not None]
    directions = []
    for direction in node.directions:
        ids = [
            (getattr(message.model, name), message.model.length)
            for message, name in direction.messages
        ]
        unknown = next(id for id in range(256) if id not in dict(ids))
        directions.append({"kind": direction.kind, "ids": ids, "unknown": unknown})
    return {
        "name": node.name,
        "buses": buses,
        "directions": directions,
        "telecommands": [_sent(message) for message in node.telecommands],
        "telemetry": [
            {
                "stem": stem(message),
                "name": message.name,
                "id": message.model.telemetry_id,
                "length": message.model.length,
            }
            for message in node.telemetry
        ],
    }


def _sent(message: MessageDescription) -> dict[str, Any]:
    narrow = next((field for field in message.fields if field.is_narrow), None)
    unfit = (narrow.name, _value_out_of_range(narrow)) if narrow is not None else None
    return {
        "stem": stem(message),
        "name": message.name,
        "has_fields": bool(message.fields),
        "unfit": unfit,
    }


def _value_out_of_range(field: FieldDescription) -> int:
    value = field.model.raw_max + 1
    try:
        codec.check_raw(field.model, value)
    except codec.CodecError:
        return value
    raise AssertionError("it fits")
