"""Arrays that are read and written by a function for an element, or for as many as are whole bytes; and its names."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from icdgen.describe import FieldDescription
from icdgen.describe.arrays import loop_of, named_arrays
from icdgen.describe.description import Composite


def named(one: Composite[Any]) -> Iterator[tuple[FieldDescription, str]]:
    """Those of a message, those in elements of others before these; and their names, from the message on."""
    return named_arrays(one, lambda field: loop_of(field) is not None)


def helper_of(field: FieldDescription) -> str:
    """The helper of the support module that calls the function for all of them; empty of what has none."""
    loop = loop_of(field)
    return "" if loop is None else "rounds" if loop.in_round > 1 else "each"


def reader(name: str) -> str:
    """The function that reads an element, or a round of them; ``name`` is that of the array, from the message on."""
    return f"read_{name}"


def writer(name: str) -> str:
    """The function that writes it."""
    return f"write_{name}"
