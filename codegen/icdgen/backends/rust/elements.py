"""The functions of a message that read and write elements of arrays: of structs, and of numbers that are no words."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from icdgen.backends.lines import STEP
from icdgen.backends.rust import arrays, bits
from icdgen.backends.rust.names import one_type, own_name, struct_path
from icdgen.describe import FieldDescription, StructDescription
from icdgen.describe.arrays import Rounds
from icdgen.describe.description import Composite

DEPTH = 2  # steps of the body of a function


class Functions(NamedTuple):
    """What reads an element of an array, or as many as are whole bytes, and what writes it."""

    reader: str
    writer: str
    of: str  # the array, as the ICD calls it
    step: int  # bytes
    type: str
    tables: list[int]
    value: str
    writings: list[str]


def functions(one: Composite[Any]) -> Iterator[Functions]:
    """All of a message."""
    for field, name in arrays.named(one):
        rounds = arrays.rounds_in(field)
        if field.element is not None:
            yield _of_struct(field, field.element, name)
        elif rounds is not None:
            yield _of_numbers(field, rounds, name)


def _of_struct(field: FieldDescription, struct: StructDescription, name: str) -> Functions:
    within, tables, type = f"{name}_", bits.flag_tables(struct), struct_path(struct, struct.seen_from)
    value = literal(struct.members, [bits.reading(one, tables, within=within) for one in struct.members], type)
    writings = [line for one in struct.blocks for line in bits.writing(one, "part", within)]
    return Functions(*_called(field, name), struct.model.length, type, sorted(tables), value, writings)


def _of_numbers(field: FieldDescription, rounds: Rounds, name: str) -> Functions:
    type, pad, many = one_type(field), STEP * DEPTH, rounds.in_round > 1
    members = rounds.members(field, lambda element: f"part[{element}]" if many else "part")
    if many:
        rows = "".join(f"{pad}{STEP}{bits.reading(one, set(), DEPTH + 1)},\n" for one in members)
        value = f"{pad}[\n{rows}{pad}]"
    else:
        value = bits.reading(members[0], set(), DEPTH - 1)  # a block is the body of the function
        value = value[2:-2].rstrip() if value.startswith("{\n") else pad + value
    writings = [line for one in members for line in bits.writing(one, "")]
    type = f"[{type}; {rounds.in_round}]" if many else type
    return Functions(*_called(field, name), rounds.step, type, [], value, writings)


def _called(field: FieldDescription, name: str) -> tuple[str, str, str]:
    return arrays.reader(name), arrays.writer(name), field.model.name


def literal(fields: tuple[FieldDescription, ...], values: list[str], type: str = "Self") -> str:
    """``Self { ... }`` in the body of a function."""
    lines = "".join(f"            {own_name(field)}: {value},\n" for field, value in zip(fields, values, strict=True))
    return f"        {type} {{\n{lines}        }}" if fields else f"        {type} {{}}"
