"""Values that a user chooses for fields of the framing, such as a source address."""

from __future__ import annotations

from collections.abc import Sequence

from icdgen.errors import UserError
from icdgen.protocol.facts import Facts
from icdgen.values import numbers


def chosen_values(facts: Facts, chosen: Sequence[str]) -> dict[str, int]:
    """Return the values of fields of the framing by role, from texts ``ROLE=NUMBER``.

    Raises `icdgen.errors.UserError`.
    """
    fields = facts.stream.chosen("telecommand") if facts.stream else {}
    values = {}
    for text in chosen:
        role, _, number = text.partition("=")
        value, field = numbers.integer(number.strip()), fields.get(role.strip())
        if field is None:
            has = f"it has {', '.join(fields)}" if fields else "it has none to choose"
            raise UserError(
                f"`{text}`: no packet of {facts.node.name} has a field `{role.strip()}`",
                has,
            )
        if value is None or not 0 <= value <= field.mask:
            raise UserError(
                f"`{text}` does not fit",
                f"{role.strip()}=NUMBER, from 0 to {field.mask}",
            )
        values[field.role] = value
    return values
