"""Associated constants: ids, and values with a name of their own."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.rust.names import integer_type
from icdgen.backends.rust.text import assigned, doc, double, integer, prose
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe import constants as described


class Constant(NamedTuple):
    """An associated constant."""

    name: str
    doc: str
    declaration: str


def of_message(message: MessageDescription, id_type: str) -> list[Constant]:
    """The ids, then the values of fields."""
    ids = [_constant(id.name, id_type, integer(id.value), id.comment) for id in message.ids]
    return ids + [_of_field(field, one) for field in message.fields for one in field.constants]


def _of_field(field: FieldDescription, one: described.Constant) -> Constant:
    if field.model.type == "bool" and one.is_raw:
        return _constant(one.name, "bool", "true" if one.value else "false", one.comment)
    if isinstance(one.value, int):
        return _constant(one.name, integer_type(field), integer(one.value), one.comment)
    return _constant(one.name, "f64", double(one.value.numerator / one.value.denominator), one.comment)


def _constant(name: str, kind: str, literal: str, comment: str) -> Constant:
    upper = name.upper()
    return Constant(upper, doc([prose(comment)], "    "), assigned(f"pub const {upper}: {kind} =", literal, ";"))
