"""The program that asks of the golden vectors what only C has: see ``rest.c.j2``.

What it expects is the reference's.
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
    """The program."""
    known = describe(icd)
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE), trim_blocks=True, lstrip_blocks=True
    )
    return environment.get_template("rest.c.j2").render(
        nodes=[_node(known, node) for node in known.nodes],
        messages=[
            _message(message) for node in known.nodes for message in node.messages
        ],
        longest=max(
            1, *(message.length for node in icd.nodes for message in node.messages)
        ),
    )


def _message(message: MessageDescription) -> dict[str, Any]:
    wholes = {
        field.model.name: (accessor.name, accessor.integers)
        for field in message.fields
        for accessor in accessors_of(field, "integer")
    }
    beyond = []
    for field in message.fields:
        if field.model.name in wholes:
            name, whole = wholes[field.model.name]
            limit = 1 << (whole.bits - 1)
            steps = (field.model.raw_min - 1, field.model.raw_max + 1)
            values = (
                int(field.model.scale.physical(raw) * whole.scale.per) for raw in steps
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
        "rows": [_row(message, row, wholes) for row in (rows if wholes else rows[:2])],
        "fields": [literal(field.model.name) for field in message.members],
    }


def _parts(message: MessageDescription, frame: bytes) -> Iterator[dict[str, Any]]:
    """Each part: the call that gives it, and its bytes where these are whole ones of
    the frame.

    What the part reserves may hold something of the whole message: encoding the part
    leaves it out.
    """
    for part in contained_messages(message):
        for index, begin in enumerate(part.positions):
            which = f"{index}u, " if len(part.positions) > 1 else ""
            call = f"{stem(message)}_{part_name(part.message)}(&message, {which}&part)"
            yield {
                "stem": stem(part.message),
                "call": call,
                "bytes": _part(part.message, frame, begin),
            }
            if which and begin == part.positions[-1]:
                beyond = call.replace(which, f"{len(part.positions)}u, ")
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
    message: MessageDescription, row: FrameVector, wholes: dict[str, Any]
) -> dict[str, Any]:
    values = []
    for name, (accessor, whole) in wholes.items():
        exact: Fraction = row.physical[name] * whole.scale.per
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


def _node(known: Description, node: NodeDescription) -> dict[str, Any]:
    link = links_of(known).get(node.name)
    buses = []
    if link is not None:
        found = (
            ("uart", link.facts.framing),
            ("i2c", link.facts.i2c_address),
            ("can", link.can),
        )
        buses = [bus for bus, there in found if there is not None]
    directions = []
    for direction in node.directions:
        ids = [
            (getattr(one.model, name), one.model.length)
            for one, name in direction.messages
        ]
        unknown = next(id for id in range(256) if id not in dict(ids))
        directions.append({"kind": direction.kind, "ids": ids, "unknown": unknown})
    return {
        "name": node.name,
        "buses": buses,
        "directions": directions,
        "telecommands": [_sent(one) for one in node.telecommands],
        "telemetry": [
            {
                "stem": stem(one),
                "name": one.name,
                "id": one.model.telemetry_id,
                "length": one.model.length,
            }
            for one in node.telemetry
        ],
    }


def _sent(message: MessageDescription) -> dict[str, Any]:
    narrow = next((field for field in message.fields if field.is_narrow), None)
    unfit = (narrow.name, _unfit(narrow)) if narrow is not None else None
    return {
        "stem": stem(message),
        "name": message.name,
        "has_fields": bool(message.fields),
        "unfit": unfit,
    }


def _unfit(field: FieldDescription) -> int:
    value = field.model.raw_max + 1
    try:
        codec.check_raw(field.model, value)
    except codec.CodecError:
        return value
    raise AssertionError("it fits")
