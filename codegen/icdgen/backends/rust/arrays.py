"""Which arrays are read and written by a function for an element, or for as many as are whole bytes; and its names."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from icdgen.describe import FieldDescription
from icdgen.describe.arrays import ElementRounds, arrays_named, rounds_of
from icdgen.describe.description import Composite


def named(one: Composite[Any]) -> Iterator[tuple[FieldDescription, str]]:
    """Those of a message, those in elements of others before these; and their names, from the message on."""
    return arrays_named(one, lambda field: bool(helper_of(field)))


def helper_of(field: FieldDescription) -> str:
    """The helper of the support module that calls the function for all of them; empty of what has none."""
    if field.element is not None:
        return "each"
    rounds = rounds_in(field)
    return "" if rounds is None else "rounds" if rounds.in_round > 1 else "each"


def rounds_in(field: FieldDescription) -> ElementRounds | None:
    """How the elements of an array of numbers are read and written, where a function does it."""
    if not field.count or field.struct is not None or is_run(field):
        return None
    rounds = rounds_of(field, field.count)
    return rounds if rounds is not None and rounds.elements == field.count else None


def is_run(field: FieldDescription) -> bool:
    """Whether the elements of an array are words that lie in the frame as they do in memory, but for their byte order."""
    return field.model.is_bytes or field.is_plain_word


def reader(name: str) -> str:
    """The function that reads an element, or a round of them; ``name`` is that of the array, from the message on."""
    return f"read_{name}"


def writer(name: str) -> str:
    """The function that writes it."""
    return f"write_{name}"
