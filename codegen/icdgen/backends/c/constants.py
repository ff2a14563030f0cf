"""Macros: ids, the only valid raw values, raw values with a meaning of their own, limits."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import NamedTuple

from icdgen import naming
from icdgen.backends.c import about
from icdgen.backends.c.plan import Plan
from icdgen.backends.c.storage import mask
from icdgen.backends.c.text import comment, plain
from icdgen.icd.model import Field, Node


class Constant(NamedTuple):
    """A macro."""

    comment: str
    name: str
    value: str


def ids(plan: Plan) -> list[Constant]:
    """The id, or the set id and the get id."""
    message, stem = plan.message, plan.stem.upper()
    if message.id is not None:
        return [Constant(f"/** Id of the {message.kind}. */", f"{stem}_ID", f"{message.id}u")]
    return [
        Constant("/** Id of the telecommand that sets it. */", f"{stem}_SET_ID", f"{message.set_id}u"),
        Constant("/** Id of the telemetry that gets it. */", f"{stem}_GET_ID", f"{message.get_id}u"),
    ]


def constants(plan: Plan) -> list[Constant]:
    """The only valid raw values, raw values with a meaning of their own, and limits."""
    rows = []
    for field, name, storage in plan.members:
        what = plain(field.name)
        for end, value, meaning in specials(field, plan.node.vocabulary):
            literal_value = str(value) if storage.signed else mask(value, storage.bits)
            rows.append(Constant(comment([f"{what}: {meaning}"]), constant_name(plan, name, end), literal_value))
        for end, value in limits(field):
            unit = f" in {plain(field.unit.symbol)}" if field.unit else ""
            text = f"({about.number(value)})" if value < 0 else about.number(value)
            rows.append(Constant(comment([f"{what}: {_LIMITS[end]}{unit}."]), constant_name(plan, name, end), text))
    return rows


_LIMITS = {"min": "least value", "max": "largest value", "above": "must be above this", "below": "must be below this"}


def specials(field: Field, vocabulary: tuple[str, ...]) -> Iterator[tuple[str, int, str]]:
    """(end of the name, raw value, meaning) of raw values with a name of their own."""
    if field.const is not None:
        yield "const", field.const, "the only valid raw value."
    for special in field.special:
        words = naming.words(special.meaning, vocabulary)
        end = naming.snake(words) if 0 < len(words) <= 4 else f"special_{special.value}".replace("-", "minus_")
        yield end, special.value, about.sentence(special.meaning)


def limits(field: Field) -> Iterator[tuple[str, Fraction]]:
    """(end of the name, value) of the limits that there are."""
    if field.limits is not None:
        for end in _LIMITS:
            value = getattr(field.limits, end)
            if value is not None:
                yield end, value


def constant_name(plan: Plan, name: str, end: str) -> str:
    """``DEMO_RESET_MAGIC_NUMBER_CONST``"""
    return f"{plan.stem}_{name}_{end}".upper()


def initial(plan: Plan) -> list[str]:
    """Statements that give fields with only one valid value that value."""
    return [
        f"message->{name} = {constant_name(plan, name, 'const')};"
        for field, name, _ in plan.members
        if field.const is not None
    ]  # fmt: skip


def of_node(node: Node) -> list[Constant]:
    """What the node says of itself."""
    upper, rows = node.name.upper(), []
    if node.node_type is not None:
        text = "/** What the node answers when asked for its type. */"
        rows.append(Constant(text, f"{upper}_NODE_TYPE", f"{node.node_type}u"))
    if node.interface_version is not None:
        text = "/** Version of the interface that it reports. */"
        rows.append(Constant(text, f"{upper}_INTERFACE_VERSION", f"{node.interface_version}u"))
    return rows
