"""Source of the program that tests the functions of the generated Rust that other
languages do not have: see ``rust_only.rs.j2``.

Frames and names come from the description.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jinja2

from icdgen.backends.rust.accessors import accessors
from icdgen.backends.rust.names import field_name
from icdgen.backends.rust.parts import parts_of
from icdgen.backends.rust.text import string
from icdgen.describe import (
    EnumDescription,
    MessageDescription,
    NodeDescription,
    describe,
)
from icdgen.icd.model import Icd

HERE = Path(__file__).parent


def source(icd: Icd) -> str:
    """Return the source of the program."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE), trim_blocks=True, lstrip_blocks=True
    )
    nodes = {node.name: _node(node) for node in describe(icd).nodes}
    return environment.get_template("rust_only.rs.j2").render(nodes=nodes)


def _node(node: NodeDescription) -> dict[str, Any]:
    return {
        "name": node.name,
        "enums": [
            {"type": enum.camel_name, "numbers": _values(enum)} for enum in node.enums
        ],
        "messages": [
            {
                "path": _path(message),
                "frame": ", ".join(["0"] * message.model.length),
                "lines": list(_lines(message)),
            }
            for message in node.messages
        ],
        "directions": [
            _direction(node, direction.kind) for direction in node.directions
        ],
    }


def _direction(node: NodeDescription, kind: str) -> dict[str, Any]:
    direction = next(each for each in node.directions if each.kind == kind)
    messages = [
        (_path(message), getattr(message.model, id), message.model.length)
        for message, id in direction.messages
    ]
    free = (
        {*range(2**node.id_bits)} - {id for _, id, _ in messages}
        if node.id_bits <= 16
        else {0}
    )
    return {
        "name": kind.capitalize(),
        "messages": messages,
        "unknown": max(free, default=None),
    }


def _values(enum: EnumDescription) -> list[tuple[int, str]]:
    """Return each value with its name, and one value without a name."""
    low = -(2 ** (enum.storage.bits - 1)) if enum.storage.signed else 0
    named = {}
    for member in enum.members:
        named.setdefault(member.model.value, f"Some({string(member.model.name)})")
    free = next(
        (
            value
            for value in range(low, low + 2**enum.storage.bits)
            if value not in named
        ),
        None,
    )
    return [*named.items(), *([(free, "None")] if free is not None else [])]


def _path(message: MessageDescription) -> str:
    return f"icd::{message.node.name}::{message.camel_name}"


def _lines(message: MessageDescription) -> Iterator[str]:
    """Yield the statements that use a message: accessors, texts, overlay fields and
    parts.
    """
    for field in message.declared_members:
        if field.model.is_read_only:
            yield f"let _ = decoded.{field_name(field)}();"
        index, option = ("0", ".unwrap()") if field.count else ("", "")
        for accessor in accessors(field) if field.steps else ():
            value = f"decoded.{accessor.name}({index}){option}"
            if accessor.raw:
                given = ", ".join(filter(None, (index, "value")))
                setter = f"decoded.set_{accessor.name}"
                yield f"let value = {value}; {setter}({given}).unwrap();"
            else:
                yield f"let _ = {value};"
        if field.is_text and not field.model.is_read_only:
            yield f'decoded.set_{field.physical_name}("").unwrap();'
            yield f'assert_eq!(decoded.{field.physical_name}(), Some(""));'
    for part in parts_of(message):
        kind = part.type.replace("super::", f"icd::{message.node.name}::").replace(
            "crate::", "icd::"
        )
        yield f"let _ = <{kind}>::from(&decoded);"
