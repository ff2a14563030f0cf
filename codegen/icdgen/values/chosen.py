"""Values of the fields of an envelope that a user chooses."""

from __future__ import annotations

from collections.abc import Sequence

from icdgen.errors import UserError
from icdgen.protocol.envelope import GIVEN
from icdgen.protocol.facts import Facts
from icdgen.values import numbers


def values_of(known: Facts, chosen: Sequence[str]) -> dict[str, int]:
    """``ROLE=NUMBER`` of fields of the envelope. Raises `icdgen.errors.UserError`."""
    fields = {field.role: field for field in known.stream.fields if field.role in GIVEN} if known.stream else {}
    values = {}
    for text in chosen:
        role, _, number = text.partition("=")
        value, field = numbers.integer(number.strip()), fields.get(role.strip())
        if field is None:
            has = f"it has {', '.join(fields)}" if fields else "it has none to choose"
            raise UserError(f"`{text}`: the envelope of {known.node.name} has no field `{role.strip()}`", has)
        if value is None or not 0 <= value <= field.mask:
            raise UserError(f"`{text}` does not fit", f"{role.strip()}=NUMBER, from 0 to {field.mask}")
        values[field.role] = value
    return values
