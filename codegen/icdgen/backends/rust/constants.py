"""Associated constants: ids, and what the ICD says about single values of a field."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from icdgen.backends.rust import names
from icdgen.backends.rust.text import doc, double, integer, prose, rhs
from icdgen.icd.model import Field, Message, Node
from icdgen.naming import upper, words

SPECIAL_WORDS = 5  # so many words of a special value's meaning make its constant's name
_LIMITS = (
    ("min", "Smallest valid"),
    ("max", "Largest valid"),
    ("above", "Must be above this"),
    ("below", "Must be below this"),
)


class Constant(NamedTuple):
    """An associated constant."""

    name: str
    doc: str
    declaration: str


def ids(message: Message, id_type: str) -> list[Constant]:
    """The id constants of a message."""
    rows = (
        ("ID", message.id, f"The {message.kind} id."),
        ("SET_ID", message.set_id, "The telecommand id that sets it."),
        ("GET_ID", message.get_id, "The telemetry id that gets it."),
    )
    return [
        Constant(name, f"    /// {text}", f"    pub const {name}: {id_type} = {integer(id)};")
        for name, id, text in rows
        if id is not None
    ]


def has_some(field: Field) -> bool:
    """Whether the ICD says anything about single values of the field."""
    return field.const is not None or bool(field.special) or field.limits is not None


def of_field(field: Field, node: Node) -> Iterator[Constant]:
    """The constant of a field with only one valid value, its special values, its limits."""
    if field.const is not None:
        yield _raw(field, const_name(field, node), field.const, f"The only valid value of {prose(field.name)}.")
    for name, special in zip(special_names(field, node), field.special, strict=True):
        yield _raw(field, name, special.value, f"{prose(field.name)}: {prose(special.meaning)}.")
    if field.limits is not None:
        yield from _limits(field, node)


def const_name(field: Field, node: Node) -> str:
    """``MAGIC_NUMBER_CONST``"""
    return f"{names.constant_name(field, node)}_CONST"


def special_names(field: Field, node: Node) -> list[str]:
    """``TIMEOUT_NO_TIMEOUT``; by number where the meaning gives no name of its own."""
    prefix = names.constant_name(field, node)
    found: list[str] = []
    for special in field.special:
        name = f"{prefix}_{upper(words(special.meaning, node.vocabulary)[:SPECIAL_WORDS])}"
        if name.endswith("_") or name in found:
            name = f"{prefix}_SPECIAL_{'MINUS_' if special.value < 0 else ''}{abs(special.value)}"
        found.append(name)
    return found


def _raw(field: Field, name: str, value: int, text: str) -> Constant:
    kind, literal = names.integer_type(field), integer(value)
    if field.type == "bool":
        kind, literal = "bool", "true" if value else "false"
    return Constant(name, doc([text], "    "), rhs("    ", f"pub const {name}: {kind} =", literal, ";"))


def limit_names(field: Field, node: Node) -> dict[str, str]:
    """``REFERENCE_SPIN_RATE_DEG_PER_S_BELOW`` by ``below``, and so on; of the limits that the field has."""
    if field.limits is None:
        return {}
    prefix = names.constant_name(field, node)
    if field.scale is not None:
        prefix = names.physical_name(field, prefix).upper()
    return {key: f"{prefix}_{key.upper()}" for key, _ in _LIMITS if getattr(field.limits, key) is not None}


def _limits(field: Field, node: Node) -> Iterator[Constant]:
    known = limit_names(field, node)
    unit = f" in {prose(field.unit.symbol)}" if field.unit else ""
    for key, text in _LIMITS:
        if key not in known:
            continue
        name, bound = known[key], getattr(field.limits, key)
        kind, literal = "f64", double(bound.numerator / bound.denominator)
        if (
            field.scale is None
            and field.type != "float"
            and bound.denominator == 1
            and field.raw_min <= bound <= field.raw_max
        ):
            kind, literal = names.integer_type(field), integer(int(bound))
        declaration = rhs("    ", f"pub const {name}: {kind} =", literal, ";")
        yield Constant(name, doc([f"{text}: {prose(field.name)}{unit}."], "    "), declaration)
