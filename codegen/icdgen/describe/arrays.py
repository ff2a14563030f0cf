"""The arrays of a message that are read and written by a loop, or by a function for an element.

Of structs, and of flags and numbers that are no words: as many of these as are whole bytes are read and written alike, in rounds.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from math import gcd
from typing import Any, NamedTuple

from icdgen.describe.description import Composite, FieldDescription, Into, StructDescription

MANY_ENOUGH = 4
"""From this many elements on there are rounds; of fewer, each is read and written by itself."""


class StructArray(NamedTuple):
    """An array of structs, of a message or of an element of another array of it."""

    field: FieldDescription  # the array as one
    element_struct: StructDescription  # in the orders that hold here
    name: str  # from the message on: ``satellites_signals``

    @property
    def begin(self) -> int:
        """The first byte, counted in what it stands in."""
        return self.field.model.at // 8

    @property
    def step(self) -> int:
        """Bytes of an element."""
        return self.element_struct.model.length


def struct_arrays_in(one: Composite[Any], within: str = "") -> tuple[StructArray, ...]:
    """Those of a message or struct itself, its open end among them; ``within`` is where their names begin."""
    return tuple(
        StructArray(part, part.element_struct, within + part.name)
        for part in one.walk(Into.STRUCTS)
        if part.element_struct is not None
    )


def all_struct_arrays(one: Composite[Any]) -> Iterator[StructArray]:
    """All of a message, those in others before them."""
    for part, name in named_arrays(one, lambda part: part.element_struct is not None):
        if part.element_struct is not None:
            yield StructArray(part, part.element_struct, name)


def named_arrays(
    one: Composite[Any], wanted: Callable[[FieldDescription], bool], within: str = ""
) -> Iterator[tuple[FieldDescription, str]]:
    """The arrays of a message that are wanted, arrays of structs among them, and their names; those in others come first."""
    for part in one.walk(Into.STRUCTS):
        if wanted(part):
            name = within + part.name
            if part.element_struct is not None:
                yield from named_arrays(part.element_struct, wanted, f"{name}_")
            yield part, name


class ElementRounds(NamedTuple):
    """``repetitions`` rounds of ``in_round`` elements, as many as are whole bytes; elements behind the last round are not in it."""

    in_round: int
    repetitions: int
    begin: int  # the first byte of the first
    step: int  # bytes of each

    @property
    def elements(self) -> int:
        """How many there are in all rounds."""
        return self.repetitions * self.in_round

    @property
    def length(self) -> int:
        """Bytes of all rounds."""
        return self.repetitions * self.step

    def members(self, first: FieldDescription, name: Callable[[int], str]) -> tuple[FieldDescription, ...]:
        """The elements of one round, counted from where its bytes begin; ``name`` is what they are called by in code."""
        found = []
        for element in range(self.in_round):
            one = first.moved(replace(first.model, at=element * first.model.bits, count=0))
            one.member = name(element)
            found.append(one)
        return tuple(found)


def rounds_of(first: FieldDescription, count: int) -> ElementRounds | None:
    """Those of an array of ``count`` elements, which begins with ``first``; None of few, and of what begins within a byte.

    Words that lie in memory as in the frame need no rounds: they are copied.
    """
    at, bits = first.model.at, first.model.bits
    if at % 8 or first.is_copied or first.model.when:
        return None
    in_round = 8 // gcd(8, bits)
    rounds = ElementRounds(in_round, count // in_round, at // 8, in_round * bits // 8)
    return rounds if rounds.repetitions > 1 and rounds.elements >= MANY_ENOUGH else None


def loop_of(field: FieldDescription) -> ElementRounds | None:
    """The loop that reads or writes all elements of an array; None if they are copied, or read and written one by one."""
    if field.element_struct is not None:
        return ElementRounds(1, field.count, field.model.at // 8, field.element_struct.model.length)
    if not field.count or field.struct is not None:
        return None
    rounds = rounds_of(field, field.count)
    return rounds if rounds is not None and rounds.elements == field.count else None
