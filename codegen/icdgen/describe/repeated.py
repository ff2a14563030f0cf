"""The arrays of structs of a message: what reads and writes an element of each is a function of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

from icdgen.describe.description import Composite, FieldDescription, StructDescription


class Repeated(NamedTuple):
    """An array of structs, of a message or of an element of another array of it."""

    part: FieldDescription  # the array as one
    element: StructDescription  # in the orders that hold here
    name: str  # from the message on: ``satellites_signals``

    @property
    def begin(self) -> int:
        """The first byte, counted in what it stands in."""
        return self.part.model.at // 8

    @property
    def step(self) -> int:
        """Bytes of an element."""
        return self.element.model.length


def repeated_in(one: Composite[Any], within: str = "") -> tuple[Repeated, ...]:
    """Those of a message or struct itself, its open end among them; ``within`` is where their names begin."""
    return tuple(Repeated(part, part.element, within + part.name) for part in one.blocks if part.element is not None)


def all_repeated(one: Composite[Any]) -> Iterator[Repeated]:
    """All of a message, those in others before them."""
    for part, name in arrays_named(one, lambda part: part.element is not None):
        if part.element is not None:
            yield Repeated(part, part.element, name)


def arrays_named(
    one: Composite[Any], wanted: Callable[[FieldDescription], bool], within: str = ""
) -> Iterator[tuple[FieldDescription, str]]:
    """The arrays of a message that are wanted, arrays of structs among them, and their names; those in others come first."""
    for part in one.blocks:
        if wanted(part):
            name = within + part.name
            if part.element is not None:
                yield from arrays_named(part.element, wanted, f"{name}_")
            yield part, name
