"""Optional fields: the method that returns whether a field is present, and the code
that depends on it.

Absent is `None`.
"""

from __future__ import annotations

from icdgen.backends.lines import STEP
from icdgen.backends.rust import bits
from icdgen.backends.rust.names import field_name, has
from icdgen.backends.rust.text import assigned, string
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.comments import presence_comment
from icdgen.describe.description import Need


def conditional(message: MessageDescription) -> list[dict[str, object]]:
    """Return the values for the template per optional field: ``decode`` sets the
    member, ``encode`` writes it into ``bytes``.
    """
    return [
        {
            "name": has(field),
            "about": presence_comment(field.model, message.model),
            "test": " && ".join(map(_test, field.needs)),
            "decode": _read(field),
            "encode": [
                f"let {bits.RAW} = there({string(field.model.name)}, self.{field_name(field)})?;",
                *(bits.fitting(field) if field.is_narrow else ()),
                *bits.writing(field),
            ],
        }
        for field in message.optional_members
    ]


def _read(field: FieldDescription) -> str:
    value = f"Some({bits.reading(field, set())})"
    line = f"{STEP * 3}message.{field_name(field)} = {value};"
    return (
        line
        if "\n" in value
        else assigned(f"message.{field_name(field)} =", value, ";", STEP * 3)
    )


def _test(need: Need) -> str:
    """Return the test whether a field has one of the values."""
    field, member = need.field, f"self.{field_name(need.field)}"
    if field.model.type == "bool":
        is_any = len(need.values) > 1
        return "true" if is_any else member if need.values[0] else f"!{member}"
    member += ".raw()" if field.enum is not None else ""
    if len(need.values) == 1:
        return f"{member} == {need.values[0]}"
    return f"matches!({member}, {' | '.join(map(str, need.values))})"
