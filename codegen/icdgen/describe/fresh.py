"""What a new message holds."""

from __future__ import annotations

from icdgen.icd.model import Field, Message


def fresh_value(field: Field) -> int | bytes:
    """The only valid raw value, or 0: of a float its bits, of bytes all of them."""
    return bytes(field.bits // 8) if field.is_bytes else field.const or 0


def fresh_values(message: Message) -> dict[str, int | bytes]:
    """The raw values of a new message by the names of its fields."""
    return {field.name: fresh_value(field) for field in message.fields}
