"""Types and values of associated constants."""

from __future__ import annotations

from typing import Any

from icdgen.backends.rust.names import integer_type
from icdgen.backends.rust.text import double, integer
from icdgen.describe import FieldDescription
from icdgen.describe.constants import Constant
from icdgen.describe.description import Composite


def of_fields(message: Composite[Any]) -> list[tuple[Constant, str, str]]:
    """The constants of a message's fields, their types and values."""
    return [(one, *_value(field, one)) for field in message.all_members for one in field.constants]


def _value(field: FieldDescription, one: Constant) -> tuple[str, str]:
    if one.number:
        kind = f"f{field.model.bits}"
        named = {"nan": "NAN", "inf": "INFINITY", "-inf": "NEG_INFINITY"}.get(one.number)
        return kind, f"{kind}::{named}" if named else double(float(one.number))
    if field.model.type == "bool" and one.is_raw:
        return "bool", "true" if one.value else "false"
    if isinstance(one.value, int):
        return integer_type(field), integer(one.value)
    return "f64", double(one.value.numerator / one.value.denominator)
