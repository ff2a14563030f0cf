"""Optional fields: the test whether a field is present, and the code that depends on
it.

Absent is `None`.
"""

from __future__ import annotations

from icdgen.backends.lines import STEP
from icdgen.backends.rust import bits
from icdgen.backends.rust.names import field_name
from icdgen.backends.rust.text import assigned, string
from icdgen.describe import FieldDescription
from icdgen.describe.description import PresenceCondition


def presence_test(field: FieldDescription) -> str:
    """Return the condition under which an optional field is present."""
    return " && ".join(map(_value_test, field.needs))


def write_optional(field: FieldDescription) -> list[str]:
    """Return the statements that write an optional field into ``bytes``."""
    member = f"self.{field_name(field)}"
    return [
        # A field that must be present can still be `None`. `there` then returns an
        # error in place of a frame with zeros.
        f"let {bits.RAW} = there({string(field.model.name)}, {member})?;",
        *(bits.check_range(field) if field.is_narrow else ()),
        *bits.write_field(field),
    ]


def read_optional(field: FieldDescription) -> str:
    """Return the statement that sets the member of an optional field."""
    value = f"Some({bits.read_expression(field, set())})"
    line = f"{STEP * 3}message.{field_name(field)} = {value};"
    return (
        line
        if "\n" in value
        else assigned(f"message.{field_name(field)} =", value, ";", STEP * 3)
    )


def _value_test(need: PresenceCondition) -> str:
    """Return the test whether a field has one of the values."""
    field, member = need.field, f"self.{field_name(need.field)}"
    if field.model.type == "bool":
        # A flag has two values, so with more than one value the condition is always
        # met.
        if len(need.values) > 1:
            return "true"
        return member if need.values[0] else f"!{member}"
    member += ".raw()" if field.enum is not None else ""
    if len(need.values) == 1:
        return f"{member} == {need.values[0]}"
    return f"matches!({member}, {' | '.join(map(str, need.values))})"
