"""Functions that read and write elements of arrays: structs, and numbers that are not
whole words.

A large array is read by one function that is called for each element; see
`icdgen.describe.arrays`. The templates write the functions from the values of
`array_functions`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from icdgen.backends.lines import STEP
from icdgen.backends.rust import bits
from icdgen.backends.rust.names import own_name, reader, writer
from icdgen.backends.rust.types import one_type, struct_path
from icdgen.describe import FieldDescription, StructDescription
from icdgen.describe.arrays import ArrayLoop, loop_of, looped_arrays
from icdgen.describe.description import Composite, Into
from icdgen.describe.groups import bytes_of_flags

DEPTH = 2
"""Steps of indentation of the body of a function."""


def array_functions(composite: Composite[Any]) -> Iterator[dict[str, object]]:
    """List the functions of a message, for an element of each array, or for a group of
    elements.
    """
    for field, name in looped_arrays(composite):
        shared = {
            "reader": reader(name),
            "writer": writer(name),
            "of": field.model.name,
        }
        loop = loop_of(field)
        if field.element_struct is not None:
            yield {**shared, **_struct_functions(field.element_struct, f"{name}_")}
        elif loop is not None:
            yield {**shared, **_number_functions(field, loop)}


def _struct_functions(struct: StructDescription, within: str) -> dict[str, object]:
    tables = bytes_of_flags(struct, bits.FLAGS_FROM)
    type = struct_path(struct, struct.using_node)
    value = struct_literal(
        struct.members,
        [
            bits.read_expression(member, tables, within=within)
            for member in struct.members
        ],
        type,
    )
    writings = [
        line
        for member in struct.walk(Into.STRUCTS)
        for line in bits.write_field(member, "part", within)
    ]
    step = struct.model.length
    return {
        "step": step,
        "type": type,
        "tables": sorted(tables),
        "value": value,
        "writings": writings,
    }


def _number_functions(field: FieldDescription, loop: ArrayLoop) -> dict[str, object]:
    type, pad, many = one_type(field), STEP * DEPTH, loop.per_iteration > 1
    members = loop.members(
        field, lambda element: f"part[{element}]" if many else "part"
    )
    if many:
        type = f"[{type}; {loop.per_iteration}]"
        rows = "".join(
            f"{pad}{STEP}{bits.read_expression(element, set(), DEPTH + 1)},\n"
            for element in members
        )
        value = f"{pad}[\n{rows}{pad}]"
    else:
        # A block is the body of the function.
        value = bits.read_expression(members[0], set(), DEPTH - 1)
        value = value[2:-2].rstrip() if value.startswith("{\n") else pad + value
    writings = [line for element in members for line in bits.write_field(element, "")]
    return {
        "step": loop.step,
        "type": type,
        "tables": (),
        "value": value,
        "writings": writings,
    }


def struct_literal(
    fields: tuple[FieldDescription, ...], values: list[str], type: str = "Self"
) -> str:
    """Return ``Self { ... }`` in the body of a function."""
    lines = "".join(
        f"            {own_name(field)}: {value},\n"
        for field, value in zip(fields, values, strict=True)
    )
    return f"        {type} {{\n{lines}        }}" if fields else f"        {type} {{}}"
